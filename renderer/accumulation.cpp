#include "renderer/accumulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "core/check.h"

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
  if (sample == 0 || count < 3) return sample == 0 ? glm::vec2(0.0f) : glm::vec2(0.5f, 0.5f) * 0.999f;
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

void add_picture(PictureSum& total, const Image& picture) { add_rows(total, picture, 0, picture.height); }

void add_rows(PictureSum& total, const Image& rows, int first, int height) {
  if (rows.height == 0) return;
  if (total.sum.planes.empty()) {
    total.sum = Image(rows.width, height);
    for (const std::string& name : rows.names) total.sum.add(name) = Plane(rows.width, height, 0.0f);
  }
  if (total.sum.names != rows.names || total.sum.width != rows.width || total.sum.height != height)
    fail_check("pictures that are averaged must have the same planes");
  total.count += first == 0;
  const Plane *alpha = rows.find("color.a"), *beauty_alpha = rows.find("beauty.a");
  for (std::size_t k = 0; k < rows.names.size(); ++k) {
    const bool color = alpha && is_color(rows.names[k]) && &rows.planes[k] != alpha;
    const bool beauty = beauty_alpha && is_beauty(rows.names[k]) && &rows.planes[k] != beauty_alpha;
    for (int y = 0; y < rows.height; ++y) {
      const float* in = rows.planes[k].row(y);
      float* out = total.sum.planes[k].row(first + y);
      if (color)
        add_color(in, alpha->row(y), rows.width, total.as_square_roots, out);
      else
        add_values(in, beauty ? beauty_alpha->row(y) : nullptr, rows.width, beauty && total.as_square_roots, out);
    }
  }
}

PictureSum rows_of(const PictureSum& total, int first, int count) {
  PictureSum rows{.as_square_roots = total.as_square_roots,
                  .per_sample = total.per_sample,
                  .count = total.count,
                  .sum = Image(total.sum.width, count)};
  for (const std::string& name : total.sum.names) {
    const Plane& from = total.sum.plane(name);
    Plane& to = rows.sum.add(name);
    for (int y = 0; y < count; ++y) std::copy_n(from.row(first + y), from.width, to.row(y));
  }
  return rows;
}

namespace {

Plane mean_plane(const PictureSum& total, std::string_view name) {
  Plane mean = total.sum.plane(name);
  const float count = float(total.count) / float(total.per_sample);
  for (int y = 0; y < mean.height; ++y)
    for (int x = 0; x < mean.width; ++x) mean.row(y)[x] /= count;
  return mean;
}

}  // namespace

GBuffer mean_picture(const PictureSum& total, const PictureInfo& info, const std::string& pass) {
  GBuffer g;
  g.info = info;
  g.info.more_layers.clear();
  Image& image = g.layers.emplace_back(total.sum.width, total.sum.height);
  const Plane alpha = mean_plane(total, pass + ".a");
  for (const std::string channel : {".r", ".g", ".b"}) image.add("lit" + channel) = mean_plane(total, pass + channel);
  const std::array<Plane*, 3> lit = {&image.plane("lit.r"), &image.plane("lit.g"), &image.plane("lit.b")};
  if (total.as_square_roots)
    for (Plane* plane : lit)
      for (int y = 0; y < plane->height; ++y)
        for (int x = 0; x < plane->width; ++x)
          if (const float fraction = alpha.row(y)[x]; fraction > 0.0f) plane->row(y)[x] *= plane->row(y)[x] / fraction;
  image.add(total.as_square_roots ? "cover_for_eye" : "cover") = alpha;
  image.add("depth") = Plane(image.width, image.height, std::numeric_limits<float>::infinity());
  return g;
}

Image mean_planes(const PictureSum& total, std::span<const std::string> names) {
  Image means(total.sum.width, total.sum.height);
  for (const std::string& name : names) means.add(name) = mean_plane(total, name);
  return means;
}

}  // namespace umbrage
