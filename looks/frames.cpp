#include "looks/frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/exponential.hpp>
#include <limits>

#include "core/check.h"

namespace umbrage {
namespace {

bool is_color(std::string_view name) { return name.starts_with("color."); }

glm::vec2 r2(int k) {
  constexpr double kX = 0.7548776662466927, kY = 0.5698402909980532;  // 1 over the plastic number, and its square
  const double x = 0.5 + k * kX, y = 0.5 + k * kY;
  return {float(x - std::floor(x) - 0.5), float(y - std::floor(y) - 0.5)};
}

/// Adds rows of a picture's lines.
void add_lines(PictureSum& total, const Plane& rows, int first, glm::vec2 offset) {
  if (first == 0) {
    if (total.lines.size() == std::size_t(kMostLinePictures)) total.lines.erase(total.lines.begin());
    total.lines.push_back({offset, std::vector<std::uint8_t>(std::size_t(rows.width) * total.sum.height)});
  }
  for (int y = 0; y < rows.height; ++y) {
    const float* in = rows.row(y);
    std::uint8_t* out = total.lines.back().cover.data() + std::size_t(first + y) * rows.width;
    for (int x = 0; x < rows.width; ++x)
      out[x] = std::uint8_t(in[x] > 0.0f ? std::min(in[x] / total.opacity, 1.0f) * kFullCover + 0.5f : 0.0f);
  }
}

}  // namespace

glm::vec2 frame_offset(int frame, int count) {
  if (frame == 0 || count < 3) return frame == 0 ? glm::vec2(0.0f) : glm::vec2(0.5f, 0.5f) * 0.999f;
  glm::vec2 mean(0.0f);
  for (int k = 1; k < count; ++k) mean += r2(k) / float(count - 1);
  return glm::clamp(r2(frame) - mean, glm::vec2(-0.4999f), glm::vec2(0.4999f));
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

void add_picture(PictureSum& total, const Image& picture, glm::vec2 offset) {
  add_rows(total, picture, 0, picture.height, offset);
}

void add_rows(PictureSum& total, const Image& rows, int first, int height, glm::vec2 offset) {
  if (rows.height == 0) return;
  if (total.sum.planes.empty()) {
    total.sum = Image(rows.width, height);
    for (const std::string& name : rows.names) total.sum.add(name) = Plane(rows.width, height, 0.0f);
  }
  if (total.sum.names != rows.names || total.sum.width != rows.width || total.sum.height != height)
    fail_check("pictures that are averaged must have the same planes");
  total.count += first == 0;
  if (total.opacity > 0.0f) add_lines(total, rows.plane("outline"), first, offset);
  const Plane& alpha = rows.plane("color.a");
  for (std::size_t k = 0; k < rows.names.size(); ++k) {
    const bool multiplied = is_color(rows.names[k]) && rows.names[k] != "color.a";
    for (int y = 0; y < rows.height; ++y) {
      const float* in = rows.planes[k].row(y);
      const float* share = alpha.row(y);
      float* out = total.sum.planes[k].row(first + y);
      if (multiplied && total.for_eye)
        for (int x = 0; x < rows.width; ++x) out[x] += std::sqrt(std::max(in[x], 0.0f)) * share[x];
      else if (multiplied)
        for (int x = 0; x < rows.width; ++x) out[x] += in[x] * share[x];
      else
        for (int x = 0; x < rows.width; ++x) out[x] += in[x];
    }
  }
}

Plane some_rows(const Plane& from, int first, int count) {
  Plane rows(from.width, count);
  for (int y = 0; y < count; ++y) std::copy_n(from.row(first + y), from.width, rows.row(y));
  return rows;
}

PictureSum rows_of(const PictureSum& total, int first, int count) {
  PictureSum rows{.for_eye = total.for_eye,
                  .opacity = total.opacity,
                  .line_px = total.line_px,
                  .count = total.count,
                  .sum = Image(total.sum.width, count),
                  .lines = {},
                  .agreed = {}};
  for (const std::string& name : total.sum.names) rows.sum.add(name) = some_rows(total.sum.plane(name), first, count);
  if (total.agreed.height > 0) rows.agreed = some_rows(total.agreed, first, count);
  return rows;
}

namespace {

Plane mean_plane(const PictureSum& total, std::string_view name) {
  Plane mean = total.sum.plane(name);
  const auto count = float(total.count);
  for (int y = 0; y < mean.height; ++y)
    for (int x = 0; x < mean.width; ++x) mean.row(y)[x] /= count;
  return mean;
}

/// What lines cover that pictures agreed on, or else in the mean.
Plane final_lines(const PictureSum& total) {
  return total.agreed.height > 0 ? total.agreed : mean_plane(total, "outline");
}

/// Lets lines cover what was agreed on, in a mean of pictures: `roots`, its colour, multiplied by `alpha`.
void draw_agreed_lines(const PictureSum& total, glm::vec3 root, std::array<Plane*, 3> roots, Plane& alpha) {
  constexpr float kAllLine = 1e-3f;  // less than this beside a line does not tell what it is
  const Plane lines = mean_plane(total, "outline");
  for (int y = 0; y < lines.height; ++y)
    for (int x = 0; x < lines.width; ++x) {
      const float mean = lines.row(y)[x], rest = 1.0f - mean, covered = total.agreed.row(y)[x];
      if (covered == mean || rest < kAllLine) continue;
      const float scale = (1.0f - covered) / rest;
      for (int c = 0; c < 3; ++c) {
        float& v = roots[c]->row(y)[x];
        v = std::max(v - root[c] * mean, 0.0f) * scale + root[c] * covered;
      }
      float& share = alpha.row(y)[x];
      share = std::max(share - mean, 0.0f) * scale + covered;
    }
}

}  // namespace

void agree_on_lines(PictureSum& total) {
  if (!(total.opacity > 0.0f) || int(total.lines.size()) < kLeastThatAgree) return;
  total.agreed = agreed_lines(total.lines, mean_plane(total, "outline"), total.opacity, total.line_px);
  total.lines.clear();
}

GBuffer mean_picture(const PictureSum& total, const PictureInfo& info, glm::vec3 line) {
  GBuffer g;
  g.info = info;
  g.info.more_layers.clear();
  Image& image = g.layers.emplace_back(total.sum.width, total.sum.height);
  Plane alpha = mean_plane(total, "color.a");
  for (const std::string channel : {"r", "g", "b"}) image.add("lit." + channel) = mean_plane(total, "color." + channel);
  const std::array<Plane*, 3> lit = {&image.plane("lit.r"), &image.plane("lit.g"), &image.plane("lit.b")};
  if (total.agreed.height > 0) draw_agreed_lines(total, glm::sqrt(line), lit, alpha);
  if (total.for_eye)
    for (Plane* plane : lit)
      for (int y = 0; y < plane->height; ++y)
        for (int x = 0; x < plane->width; ++x)
          if (const float share = alpha.row(y)[x]; share > 0.0f) plane->row(y)[x] *= plane->row(y)[x] / share;
  image.add(total.for_eye ? "outline" : "cover") = alpha;
  image.add("depth") = Plane(image.width, image.height, std::numeric_limits<float>::infinity());
  return g;
}

Image mean_planes(const PictureSum& total, std::span<const std::string> names) {
  Image means(total.sum.width, total.sum.height);
  for (const std::string& name : names)
    means.add(name) = name == "outline" ? final_lines(total) : mean_plane(total, name);
  return means;
}

}  // namespace umbrage
