// Implements the host step of `hatching`: seeds that stay on the surface, two sets of lines, and their widths.
#include "effects/hatching/hatching_strokes.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <unordered_map>

#include "core/gbuffer.h"
#include "effects/hatching/hatching_surfaces.h"
#include "effects/outline/outline_draw.h"

namespace umbrage {
namespace {

using Point = HatchingLine::Point;

constexpr int kPointsPerSpacing = 2;  // points of finished lines
constexpr int kTracedPerSpacing = 6;  // points of traced lines
constexpr std::size_t kStride = kTracedPerSpacing / kPointsPerSpacing;
constexpr std::size_t kMinPoints = 5;  // of a part of a line that is drawn
constexpr int kCorrections = 3;        // rounds in which widths are corrected
constexpr float kTaperPoints = 5.0f;   // traced points over which a free end gets thinner
constexpr float kFullInk = 0.6f;       // from which on ends are as wide as the line
// Keeps planes of round coordinates, such as the ground, off the borders of cells.
constexpr glm::vec3 kCellOffset = {0.379f, 0.283f, 0.417f};
constexpr float kMinWidth = 0.05f;      // pixels: thinner parts of a line are left out
constexpr float kMaxCorrection = 1.6f;  // of a width, in all rounds together

std::uint32_t scrambled(std::uint32_t v) {
  v = (v ^ (v >> 16)) * 0x7feb352du;
  v = (v ^ (v >> 15)) * 0x846ca68bu;
  return v ^ (v >> 16);
}

/// Returns the point within a pixel or beside it whose surface is nearest to `target`, world space.
Point nearest_point(const HatchingSurfaces& positions, const HatchingField& field, int x, int y,
                    const glm::vec3& target) {
  Point p = {float(x) + 0.5f, float(y) + 0.5f};
  const int breaks = int(field.breaks.row(y)[x]);
  if (breaks != 0 || x + 1 >= field.width || y + 1 >= field.height) return p;
  const glm::vec3 here = positions.at(x, y), right = positions.at(x + 1, y) - here,
                  down = positions.at(x, y + 1) - here;
  const float a = glm::dot(right, right), b = glm::dot(right, down), c = glm::dot(down, down);
  const float u = glm::dot(right, target - here), v = glm::dot(down, target - here), area = a * c - b * b;
  if (!(area > 1e-6f * a * c && std::isfinite(c * u - b * v) && std::isfinite(a * v - b * u))) return p;
  p.x += std::clamp((c * u - b * v) / area, -1.0f, 1.0f);
  p.y += std::clamp((a * v - b * u) / area, -1.0f, 1.0f);
  return p;
}

/// Returns points on surfaces from which lines can start: one for each visible cell of a grid in world space, about
/// `cell_px` pixels large, in the order of a hash of the cell. So the points stay on the surface when the camera moves.
std::vector<Point> seeds_of(const HostFrame& frame, const HatchingField& field, float cell_px) {
  const HatchingSurfaces positions(frame);
  struct Seed {
    int x, y;
    glm::vec3 center;  // of the cell, world space
    float off;         // squared distance from there, in cells
    std::uint32_t order;
  };
  std::unordered_map<std::uint32_t, Seed> cells;
  for (int y = 0; y < field.height; ++y)
    for (int x = 0; x < field.width; ++x) {
      if (field.x.row(y)[x] == 0.0f && field.y.row(y)[x] == 0.0f) continue;
      const int level = int(std::ceil(std::log2(std::clamp(cell_px * positions.pixel_size(x, y), 1e-30f, 1e30f))));
      const float side = std::exp2(float(level));
      const glm::vec3 place = positions.at(x, y) / side + kCellOffset, cell = glm::floor(place);
      if (!(std::abs(cell.x) + std::abs(cell.y) + std::abs(cell.z) < 1e9f)) continue;
      std::uint32_t hash = scrambled(std::uint32_t(level));
      for (int c = 0; c < 3; ++c) hash = scrambled(hash ^ std::uint32_t(std::int32_t(cell[c])));
      const glm::vec3 offset = place - cell - 0.5f;
      const Seed seed = {x, y, (cell + 0.5f - kCellOffset) * side, glm::dot(offset, offset), hash};
      const auto [found, added] = cells.try_emplace(hash, seed);
      if (!added && seed.off < found->second.off) found->second = seed;
    }
  std::vector<Seed> ordered;
  ordered.reserve(cells.size());
  for (const auto& [key, seed] : cells) ordered.push_back(seed);
  std::sort(ordered.begin(), ordered.end(), [](const Seed& a, const Seed& b) { return a.order < b.order; });
  std::vector<Point> points;
  points.reserve(ordered.size());
  for (const Seed& seed : ordered) points.push_back(nearest_point(positions, field, seed.x, seed.y, seed.center));
  return points;
}

/// Ink of one set of lines.
struct Ink {
  const HostPlane& total;  // of both sets
  float cross;             // ink from which on the second set takes a part
  bool second;

  float at(int x, int y) const {
    const float light = 1.0f - total.row(y)[x], limit = 1.0f - cross;
    if (light >= limit) return second ? 0.0f : 1.0f - light;
    // The light that the two sets leave is the product of theirs. The first remains until the second is as dark.
    const float crossing = std::max(light / limit, std::sqrt(light));
    return 1.0f - (second ? crossing : light / std::max(crossing, 1e-6f));
  }
};

/// Factors of widths in blocks of the picture, by which lines get the ink that they should have.
class Correction {
 public:
  Correction(int width, int height, float block_px)
      : block_(std::max(int(std::lround(block_px)), 4)),
        columns_(width / block_ + 1),
        rows_(height / block_ + 1),
        factors_(std::size_t(columns_) * std::size_t(rows_), 1.0f) {}

  /// Returns the factor at a point, interpolated between the middles of blocks.
  float at(float x, float y) const {
    const float px = x / float(block_) - 0.5f, py = y / float(block_) - 0.5f;
    const int u = int(std::floor(px)), v = int(std::floor(py));
    const float fx = px - float(u), fy = py - float(v);
    return (1.0f - fy) * ((1.0f - fx) * of(u, v) + fx * of(u + 1, v)) +
           fy * ((1.0f - fx) * of(u, v + 1) + fx * of(u + 1, v + 1));
  }

  void improve(const HostPlane& drawn, const HostPlane& region, const Ink& ink, int width, int height) {
    std::vector<float> wanted(factors_.size()), actual(factors_.size());
    tbb::parallel_for(0, rows_, [&](int row) {
      for (int y = row * block_; y < std::min((row + 1) * block_, height); ++y)
        for (int x = 0; x < width; ++x) {
          if (region.row(y)[x] == 0.0f) continue;
          const std::size_t k = index(x / block_, row);
          wanted[k] += ink.at(x, y), actual[k] += drawn.row(y)[x];
        }
    });
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) {
        float want = 0.0f, have = 0.0f;
        for (int j = std::max(row - 1, 0); j <= std::min(row + 1, rows_ - 1); ++j)
          for (int i = std::max(column - 1, 0); i <= std::min(column + 1, columns_ - 1); ++i)
            want += wanted[index(i, j)], have += actual[index(i, j)];
        float& factor = factors_[index(column, row)];
        if (have > 0.0f) factor = std::clamp(factor * want / have, 1.0f / kMaxCorrection, kMaxCorrection);
      }
  }

 private:
  std::size_t index(int u, int v) const { return std::size_t(v) * std::size_t(columns_) + std::size_t(u); }
  float of(int u, int v) const { return factors_[index(std::clamp(u, 0, columns_ - 1), std::clamp(v, 0, rows_ - 1))]; }

  int block_, columns_, rows_;
  std::vector<float> factors_;
};

/// Returns the indices of the points of a line that are drawn: every kStride-th, and of a line between key frames the
/// last one, so that what hides it does so gradually.
std::vector<std::size_t> drawn_points(const HatchingLine& line) {
  std::vector<std::size_t> drawn;
  for (std::size_t k = 0; k < line.points.size(); k += kStride) drawn.push_back(k);
  if (!line.weight.empty() && drawn.back() + 1 < line.points.size()) drawn.push_back(line.points.size() - 1);
  return drawn;
}

/// Returns the ink along a line at its drawn points, averaged over about two spacings.
std::vector<float> ink_along(const HatchingLine& line, const Ink& ink, int width, int height) {
  constexpr int kRadius = 2;
  std::vector<float> own, mean;
  for (const std::size_t k : drawn_points(line)) {
    const Point p = line.points[k];
    own.push_back(ink.at(std::clamp(int(p.x), 0, width - 1), std::clamp(int(p.y), 0, height - 1)));
  }
  const int count = int(own.size());
  for (int k = 0; k < count; ++k) {
    float sum = 0.0f;
    const int first = std::max(k - kRadius, 0), last = std::min(k + kRadius, count - 1);
    for (int j = first; j <= last; ++j) sum += own[std::size_t(j)];
    mean.push_back(sum / float(last - first + 1));
  }
  return mean;
}

/// Returns the parts of lines that have a width.
Strokes with_widths(const std::vector<HatchingLine>& traced, const Ink& ink, const HostPlane& objects,
                    const Correction& correction, const HatchingConstants& c, int width, int height) {
  Strokes lines{width, height, {}};
  // The crossing lines of all ranks begin together, since single ones would look like scratches.
  const float width_px = ink.second ? 0.0f : c.width_px;
  for (const HatchingLine& line : traced) {
    Stroke part{.kind = ink.second ? StrokeKind::kCrossHatch : StrokeKind::kHatch};
    const auto finish = [&] {
      if (part.points.size() >= (line.weight.empty() ? kMinPoints : 2)) lines.strokes.push_back(part);
      part.points.clear();
    };
    const std::vector<float> along = ink_along(line, ink, width, height);
    const std::vector<std::size_t> drawn = drawn_points(line);
    for (std::size_t n = 0; n < along.size(); ++n) {
      const std::size_t k = drawn[n];
      const Point p = line.points[k];
      const float from_start = float(k + 1) / kTaperPoints, from_end = float(line.points.size() - k) / kTaperPoints;
      // In dark parts, thinner ends would be light spots, and lines are as wide as their room needs.
      const float light = std::clamp((kFullInk - along[n]) / kFullInk, 0.0f, 1.0f);
      const float fill = light + (1.0f - light) * line.room[k] / c.spacing_px;
      const float thinness = std::min({line.free_start ? from_start : 1.0f, line.free_end ? from_end : 1.0f, 1.0f});
      const float taper = 1.0f + light * (thinness - 1.0f);
      float w = hatching_width(line.level[k], along[n], c.spacing_px, width_px);
      if (!line.weight.empty()) {
        const float next = hatching_width(line.next_level[k], along[n], c.spacing_px, width_px);
        w = (w + line.gone * (next - w)) * line.weight[k];
      }
      w = w * fill * taper * correction.at(p.x, p.y);
      if (w < kMinWidth) {
        finish();
        continue;
      }
      if (part.points.empty()) {
        const float id = objects.row(std::clamp(int(p.y), 0, height - 1))[std::clamp(int(p.x), 0, width - 1)];
        part.object = std::abs(id) < 1e9f ? int(id) : 0;
      }
      part.points.push_back({p.x, p.y, w});
    }
    finish();
  }
  return lines;
}

HatchingField field_of(const HostFrame& frame, const HatchingConstants& c, bool second) {
  return {frame.frame.width,
          frame.frame.height,
          frame.input(second ? "hatching_cross_x" : "hatching_x"),
          frame.input(second ? "hatching_cross_y" : "hatching_y"),
          frame.input("hatching_break"),
          c.spacing_px};
}

Strokes lines_of_set(const HostFrame& frame, const std::vector<HatchingLine>& traced, bool second) {
  const auto& c = *static_cast<const HatchingConstants*>(frame.constants);
  const int width = frame.frame.width, height = frame.frame.height;
  const HostPlane &ink_plane = frame.input("hatching_ink"), &objects = frame.input("object_id");
  const Ink ink{ink_plane, c.cross, second};
  Correction correction(width, height, 2.0f * c.spacing_px);
  std::vector<float> values(std::size_t(width) * std::size_t(height));
  HostPlane drawn{"", values.data(), width};
  for (int round = 0; round < kCorrections; ++round) {
    draw_lines(with_widths(traced, ink, objects, correction, c, width, height), 1.0f, drawn);
    correction.improve(drawn, ink_plane, ink, width, height);
  }
  return with_widths(traced, ink, objects, correction, c, width, height);
}

}  // namespace

float hatching_width(float level, float ink, float spacing_px, float width_px) {
  // The widths of the lines of rank 0, 1 and 2 within four spacings add up to this: there are 1, 1 and 2 of them.
  const float sum = float(1 << (kHatchingRanks - 1)) * spacing_px * ink;
  if (sum >= 4.0f * width_px) return 0.25f * sum;
  const float width[] = {std::min(sum, width_px), std::clamp(sum - width_px, 0.0f, width_px),
                         std::clamp(0.5f * (sum - 2.0f * width_px), 0.0f, width_px)};
  const int rank = std::min(int(level), kHatchingRanks - 2);
  return width[rank] + (level - float(rank)) * (width[rank + 1] - width[rank]);
}

HatchingSets traced_sets(const HostFrame& frame) {
  const auto& c = *static_cast<const HatchingConstants*>(frame.constants);
  const HatchingField field = field_of(frame, c, false);
  HatchingSeeds seeds;
  tbb::parallel_for(0, kHatchingRanks, [&](int rank) {
    const float cell_px = 0.5f * c.spacing_px * float(1 << (kHatchingRanks - 1 - rank));
    seeds[std::size_t(rank)] = seeds_of(frame, field, cell_px);
  });
  HatchingSets sets;
  tbb::parallel_invoke([&] { sets[0] = trace_hatching(field, seeds); },
                       [&] {
                         if (c.cross < 1.0f) sets[1] = trace_hatching(field_of(frame, c, true), seeds);
                       });
  return sets;
}

Strokes hatching_lines(const HostFrame& frame) {
  auto between = frame.info.lines_between ? lines_between_keys(frame) : std::nullopt;
  const HatchingSets sets = between ? std::move(*between) : traced_sets(frame);
  Strokes lines, crossing;
  tbb::parallel_invoke([&] { lines = lines_of_set(frame, sets[0], false); },
                       [&] {
                         if (!sets[1].empty()) crossing = lines_of_set(frame, sets[1], true);
                       });
  lines.strokes.insert(lines.strokes.end(), crossing.strokes.begin(), crossing.strokes.end());
  return lines;
}

}  // namespace umbrage
