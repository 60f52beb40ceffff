#include "renderer/accumulation.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

#include "core/check.h"
#include "core/rows.h"

namespace umbrage {
namespace {

bool is_color(std::string_view name) { return name.starts_with("color."); }
bool is_beauty(std::string_view name) { return name.starts_with("beauty."); }

/// Adds a row of colour with straight alpha. `fraction`: alpha.
void add_color(const float* in, const float* fraction, int width, bool as_square_roots, float* out) {
  if (as_square_roots)
    for (int x = 0; x < width; ++x) out[x] += std::sqrt(std::max(in[x], 0.0f)) * fraction[x];
  else
    for (int x = 0; x < width; ++x) out[x] += in[x] * fraction[x];
}

/// Adds a row of values, or of light that is premultiplied by `fraction` as square roots.
void add_values(const float* in, const float* fraction, int width, bool as_square_roots, float* out) {
  if (as_square_roots)
    for (int x = 0; x < width; ++x) out[x] += std::sqrt(std::max(in[x] * fraction[x], 0.0f));
  else
    for (int x = 0; x < width; ++x) out[x] += in[x];
}

glm::vec2 r2(int k) {
  constexpr double kX = 0.7548776662466927, kY = 0.5698402909980532;  // 1 / p and 1 / p^2; p is the plastic number
  const double x = 0.5 + k * kX, y = 0.5 + k * kY;
  return {float(x - std::floor(x) - 0.5), float(y - std::floor(y) - 0.5)};
}

}  // namespace

glm::vec2 sample_offset(int sample, int count) {
  if (sample >= count) return r2(sample);
  if (sample == 0 || count < 3) return sample == 0 ? glm::vec2(0.0f) : glm::vec2(0.5f, 0.5f) * 0.999f;
  if (count % 2 == 1) {
    int step = int(0.618 * count);  // a lattice: any row and column of `count` has one sample
    while (std::gcd(step, count) > 1) ++step;
    // Edges of models lie at simple fractions of a pixel more often than anywhere else.
    constexpr float kOffTheGrid = 0.997f;
    const auto centred = [&](int k) { return kOffTheGrid * float((k + count / 2) % count - count / 2) / float(count); };
    return {centred(sample), centred(sample * step)};
  }
  glm::vec2 mean(0.0f);
  for (int k = 1; k < count; ++k) mean += r2(k) / float(count - 1);
  return glm::clamp(r2(sample) - mean, glm::vec2(-0.4999f), glm::vec2(0.4999f));
}

Camera shifted_camera(const Camera& camera, glm::vec2 offset, int width, int height) {
  Camera shifted = camera;
  const float right = (camera.right - camera.left) / float(width) * offset.x;
  const float down = (camera.top - camera.bottom) / float(height) * offset.y;
  shifted.left += right;
  shifted.right += right;
  shifted.bottom -= down;
  shifted.top -= down;
  return shifted;
}

namespace {

/// Calls work(y) for all rows on this number of threads.
template <class Work>
void for_rows_on(int threads, int height, const Work& work) {
  tbb::task_arena arena(std::max(threads, 1));
  arena.execute([&] { for_rows(0, height, work); });
}

/// Calls work(x0, x1) for the pixels of a row to which a picture is added: all of a `whole` one, otherwise the marked.
template <class Work>
void for_added_pixels(const PictureSum& total, bool whole, int y, int width, const Work& work) {
  if (total.marks.width == 0 || whole) return work(0, width);
  const float* marks = total.marks.row(y);
  for (int x = 0; x < width; ++x) {
    const int begin = x;
    while (x < width && marks[x] > 0.0f) ++x;
    if (x > begin) work(begin, x);
  }
}

}  // namespace

PictureSum empty_sum(const std::vector<std::string>& names, int width, const Rows& rows) {
  PictureSum total{.first = rows.begin, .sum = Image(width, rows.count())};
  for (const std::string& name : names) total.sum.add(name) = Plane(width, rows.count(), 0.0f);
  return total;
}

void count_sample(PictureSum& total, bool whole) {
  ++total.count;
  total.whole += whole ? 1 : 0;
}

void add_rows(PictureSum& total, const Image& rows, int first, bool whole) {
  if (total.sum.width != rows.width) fail_check("samples that are averaged must have the same size");
  const Plane *alpha = rows.find("color.a"), *beauty_alpha = rows.find("beauty.a");
  for_rows_on(total.threads, rows.height, [&](int y) {
    for (std::size_t k = 0; k < total.sum.names.size(); ++k) {
      const std::string& name = total.sum.names[k];
      const Plane& plane = rows.plane(name);
      const bool color = alpha && is_color(name) && &plane != alpha;
      const bool beauty = beauty_alpha && is_beauty(name) && &plane != beauty_alpha;
      const float* in = plane.row(y);
      const int to = first - total.first + y;
      float* out = total.sum.planes[k].row(to);
      for_added_pixels(total, whole, to, rows.width, [&](int x0, int x1) {
        if (color)
          add_color(in + x0, alpha->row(y) + x0, x1 - x0, total.as_square_roots, out + x0);
        else
          add_values(in + x0, beauty ? beauty_alpha->row(y) + x0 : nullptr, x1 - x0, beauty && total.as_square_roots,
                     out + x0);
      });
    }
  });
}

void count_as_one(PictureSum& total) {
  if (total.count == total.whole) return;
  const float scale = float(total.whole) / float(total.count);
  for (Plane& plane : total.sum.planes)
    for_rows_on(total.threads, plane.height, [&](int y) {
      const float* marks = total.marks.row(y);
      float* row = plane.row(y);
      for (int x = 0; x < plane.width; ++x)
        if (marks[x] > 0.0f) row[x] *= scale;
    });
  total.count = total.whole;
}

void repeat_mean(PictureSum& total, int first) {
  const float scale = float(total.count) / float(total.count - 1);
  for (Plane& plane : total.sum.planes)
    for (int y = first - total.first; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.row(y)[x] *= scale;
}

PictureSum rows_of(const PictureSum& total, int first, int count) {
  PictureSum rows{.as_square_roots = total.as_square_roots,
                  .threads = total.threads,
                  .first = first,
                  .count = total.count,
                  .whole = total.whole,
                  .sum = Image(total.sum.width, count)};
  for (const std::string& name : total.sum.names) {
    const Plane& from = total.sum.plane(name);
    Plane& to = rows.sum.add(name);
    for (int y = 0; y < count; ++y) std::copy_n(from.row(first - total.first + y), from.width, to.row(y));
  }
  return rows;
}

namespace {

/// Returns the mean of a plane of the sum. `mean`: that plane, or a copy.
Plane mean_plane(const PictureSum& total, Plane mean) {
  const auto count = float(total.count), whole = float(total.whole);
  for_rows_on(total.threads, mean.height, [&](int y) {
    float* row = mean.row(y);
    if (total.marks.width == 0) {
      for (int x = 0; x < mean.width; ++x) row[x] /= count;
      return;
    }
    const float* marks = total.marks.row(y);
    for (int x = 0; x < mean.width; ++x) row[x] /= marks[x] > 0.0f ? count : whole;
  });
  return mean;
}

}  // namespace

GBuffer mean_picture(PictureSum& total, const PictureInfo& info, const std::string& pass) {
  GBuffer g;
  g.info = info;
  g.info.more_layers.clear();
  Image& image = g.layers.emplace_back(total.sum.width, total.sum.height);
  Plane alpha = mean_plane(total, std::move(total.sum.plane(pass + ".a")));
  for (const std::string channel : {".r", ".g", ".b"})
    image.add("lit" + channel) = mean_plane(total, std::move(total.sum.plane(pass + channel)));
  const std::array<Plane*, 3> lit = {&image.plane("lit.r"), &image.plane("lit.g"), &image.plane("lit.b")};
  if (total.as_square_roots)
    for_rows_on(total.threads, image.height, [&](int y) {
      for (Plane* plane : lit)
        for (int x = 0; x < plane->width; ++x)
          if (const float fraction = alpha.row(y)[x]; fraction > 0.0f) plane->row(y)[x] *= plane->row(y)[x] / fraction;
    });
  image.add(total.as_square_roots ? "cover_for_eye" : "cover") = std::move(alpha);
  image.add("depth") = Plane(image.width, image.height, std::numeric_limits<float>::infinity());
  return g;
}

Image mean_planes(const PictureSum& total, std::span<const std::string> names) {
  Image means(total.sum.width, total.sum.height);
  for (const std::string& name : names) means.add(name) = mean_plane(total, total.sum.plane(name));
  return means;
}

}  // namespace umbrage
