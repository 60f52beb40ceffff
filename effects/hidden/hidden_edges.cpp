// Implements hidden_edges.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "effects/hidden/hidden_lines.h"
#include "kernel/host_surface.h"

namespace umbrage {
namespace {

// Factors of the turn beside a window that is subtracted, of windows up to HiddenConstants::narrow wide and of others.
constexpr float kRoundness = 0.5f, kWideRoundness = 2.0f;
// Instead of the number of a surface: the surface ends, or it is unknown whether it does.
constexpr int kEnds = -1, kUnknown = -2;
constexpr int kClearance = 2;  // max distance of a hidden edge from a visible one at which it is left out, pixels

/// A surface in a pixel, in view space.
struct Sheet {
  float depth = 0.0f;
  scalar::Vec3 position{}, normal{};
};

/// The surfaces along the ray of a pixel, nearest first.
struct Stack {
  int count = 0;
  std::array<Sheet, kLayersRead> sheets;
};

class Surfaces {
 public:
  Surfaces(const HostFrame& frame, const HiddenConstants& c)
      : host_{frame.frame}, c_(c), pixel_(std::abs(frame.frame.ray_scale_x)) {
    // The host step's inputs: five planes of each layer, in order.
    for (std::size_t layer = 0; layer < std::size_t(c.captured); ++layer)
      for (std::size_t k = 0; k < 4; ++k) planes_[layer][k] = layer_input(frame, layer, k);
  }

  Stack stack(int x, int y) const {
    Stack stack;
    for (int layer = 0; layer < c_.captured; ++layer) {
      const auto& [depth, nx, ny, nz] = planes_[std::size_t(layer)];
      Sheet sheet{.depth = depth.row(y)[x]};
      if (!HostSurface::is_surface(sheet.depth)) break;
      sheet.position = host_.view_position(x, y, sheet.depth);
      sheet.normal = host_.unit_normal({nx.row(y)[x], ny.row(y)[x], nz.row(y)[x]}, sheet.position);
      stack.sheets[std::size_t(stack.count++)] = sheet;
    }
    return stack;
  }

  /// Returns the number of the surface in `to` that continues surface `k` of `from`, or kEnds. Beyond the last
  /// captured surface it is unknown: kUnknown.
  int continuation(const Stack& from, int k, const Stack& to) const {
    const Sheet& a = from.sheets[std::size_t(k)];
    if (k < to.count && is_same(a, to.sheets[std::size_t(k)])) return k;
    for (int j = 0; j < to.count; ++j)
      if (j != k && is_same(a, to.sheets[std::size_t(j)])) return j;
    const bool full = to.count == c_.captured;
    return full && a.depth >= to.sheets[std::size_t(to.count) - 1].depth ? kUnknown : kEnds;
  }

 private:
  using Planes = std::array<HostPlane, 4>;  // depth, normal

  static HostPlane layer_input(const HostFrame& frame, std::size_t layer, std::size_t plane) {
    constexpr std::size_t kPerLayer = 5;
    return frame.inputs[layer * kPerLayer + plane];
  }

  /// Returns whether both lie on one smooth surface: the chord between two points of a plane, and of a sphere, is
  /// perpendicular to the mean of their normals.
  bool is_same(const Sheet& a, const Sheet& b) const {
    const scalar::Vec3 &n = a.normal, &m = b.normal;
    if (!(n.x * m.x + n.y * m.y + n.z * m.z >= c_.min_cosine)) return false;
    const float sx = n.x + m.x, sy = n.y + m.y, sz = n.z + m.z;
    const float off =
        sx * (b.position.x - a.position.x) + sy * (b.position.y - a.position.y) + sz * (b.position.z - a.position.z);
    const float size = host_.frame.orthographic ? pixel_ : pixel_ * std::min(a.depth, b.depth);
    const float bound = c_.depth * size;
    return off * off <= bound * bound * (sx * sx + sy * sy + sz * sz);
  }

  HostSurface host_;
  const HiddenConstants& c_;
  float pixel_;
  std::array<Planes, kLayersRead> planes_{};
};

/// The surfaces along a row or column of pixels, and their edges.
class Scanline {
 public:
  Scanline(const Surfaces& surfaces, const HiddenConstants& c, int x, int y, bool down, int count) : c_(c) {
    for (int i = 0; i < count; ++i) stacks_.push_back(surfaces.stack(x + (down ? 0 : i), y + (down ? i : 0)));
    next_.resize(stacks_.size(), all_ending()), before_ = next_;
    for (std::size_t i = 0; i + 1 < stacks_.size(); ++i) {
      for (int k = 0; k < stacks_[i].count; ++k)
        next_[i][std::size_t(k)] = surfaces.continuation(stacks_[i], k, stacks_[i + 1]);
      for (int k = 0; k < stacks_[i + 1].count; ++k)
        before_[i + 1][std::size_t(k)] = surfaces.continuation(stacks_[i + 1], k, stacks_[i]);
    }
    creases_.resize(stacks_.size());
    for (int i = 0; i + 1 < count; ++i)
      for (int k = 0; k < std::min(stacks_[std::size_t(i)].count, c.drawn); ++k)
        if (next(i, k) >= 0) creases_[std::size_t(i)][std::size_t(k)] = crease_at(i, k);
  }

  /// Calls emit(i, place) for each edge of a surface that `first` to `end` - 1 number: it lies between the centres of
  /// pixel i and the next, at the fraction `place` of their distance.
  template <class Emit>
  void for_edges(int first, int end, const Emit& emit) const {
    for (int i = 0; i + 1 < int(stacks_.size()); ++i) {
      const int here = std::min(stacks_[std::size_t(i)].count, end);
      const int there = std::min(stacks_[std::size_t(i) + 1].count, end);
      bool ends = false;
      for (int k = first; k < here; ++k) {
        ends = ends || next(i, k) == kEnds;
        if (next(i, k) >= 0 && is_peak(i, k)) {
          const auto [pixel, place] = middle(i, k);
          emit(pixel, place);
        }
      }
      for (int k = first; k < there; ++k) ends = ends || before_[std::size_t(i) + 1][std::size_t(k)] == kEnds;
      if (ends) emit(i, 0.5f);
    }
  }

 private:
  using PerSheet = std::array<int, kLayersRead>;
  /// A surface at a pixel of the line; `sheet` < 0: none.
  struct Place {
    int pixel, sheet;
  };
  /// The strength of a crease in units of the crease angle, and the half width of the window where it is strongest.
  struct Crease {
    float strength = 0.0f;
    int window = 0;
  };
  /// Normals along a surface, in order.
  struct Run {
    int count = 0;
    std::array<scalar::Vec3, 2 * kHiddenMaxWindow + 2> normals{};
  };

  static PerSheet all_ending() {
    PerSheet all;
    all.fill(kEnds);
    return all;
  }
  int next(int i, int k) const { return next_[std::size_t(i)][std::size_t(k)]; }
  /// Moves along a surface by a pixel, forward or backward, where each of two surfaces continues the other; so the way
  /// back is the same.
  Place moved(const Place& from, int step) const {
    const auto& links = step > 0 ? next_ : before_;
    const auto& back = step > 0 ? before_ : next_;
    const Place to{from.pixel + step, links[std::size_t(from.pixel)][std::size_t(from.sheet)]};
    const bool mutual = to.sheet >= 0 && back[std::size_t(to.pixel)][std::size_t(to.sheet)] == from.sheet;
    return mutual ? to : Place{to.pixel, kUnknown};
  }
  const scalar::Vec3& normal(const Place& at) const {
    return stacks_[std::size_t(at.pixel)].sheets[std::size_t(at.sheet)].normal;
  }

  static float distance(const scalar::Vec3& a, const scalar::Vec3& b) {
    return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
  }

  Run run_from(Place at, int step, int max) const {
    Run run;
    while (run.count < max && at.sheet >= 0) {
      run.normals[std::size_t(run.count++)] = normal(at);
      if (at.pixel + step < 0 || at.pixel + step >= int(stacks_.size())) break;
      at = moved(at, step);
    }
    return run;
  }

  /// Returns the crease between pixel i and the next: the turn of the normals across a window, less the turn of the
  /// surface beside it over the same width, for the window where this is largest, as in the kernel outline_turns.
  Crease crease_at(int i, int k) const {
    const Place first{i, k}, second = moved(first, 1);
    if (second.sheet < 0) return {};
    if (distance(normal(first), normal(second)) * float(2 * c_.max_window + 1) < c_.crease_chord) return {};
    const Run left = run_from(first, -1, 2 * c_.max_window + 2), right = run_from(second, 1, 2 * c_.max_window + 2);
    Crease best;
    for (int h = 0; h <= c_.max_window; h += h < 2 ? 1 : 2) {
      const int before = std::min(left.count - 1 - h, h + 1), after = std::min(right.count - 1 - h, h + 1);
      if (std::min(before, after) < (h > 0 ? 1 : 0) || before + after < 1) break;
      const auto at = std::size_t(h);
      const auto rate = [&](const Run& side, int count) {
        return distance(side.normals[at], side.normals[at + std::size_t(count)]) / float(count);
      };
      const float rate_before = before > 0 ? rate(left, before) : rate(right, after);
      const float rate_after = after > 0 ? rate(right, after) : rate(left, before);
      const float width = float(2 * h + 1), roundness = width <= c_.narrow ? kRoundness : kWideRoundness;
      const float turn = distance(left.normals[at], right.normals[at]) - width * roundness * (rate_before + rate_after);
      if (turn > best.strength) best = {turn, h};
    }
    best.strength /= c_.crease_chord;
    return best;
  }

  /// Returns where the normal is halfway between those at the ends of a crease's window.
  std::pair<int, float> middle(int i, int k) const {
    const int h = creases_[std::size_t(i)][std::size_t(k)].window;
    Place at{i, k}, end{i + 1, next(i, k)};
    for (int s = 0; s < h; ++s) at = moved(at, -1), end = moved(end, 1);
    const scalar::Vec3 a = normal(at), b = normal(end);
    const auto along = [&](const scalar::Vec3& n) {
      return (n.x - a.x) * (b.x - a.x) + (n.y - a.y) * (b.y - a.y) + (n.z - a.z) * (b.z - a.z);
    };
    const float halfway = 0.5f * along(b);
    for (int s = 0; s < 2 * h; ++s) {
      const Place next_place = moved(at, 1);
      const float here = along(normal(at)), there = along(normal(next_place));
      if (there > halfway) return {at.pixel, std::clamp((halfway - here) / std::max(there - here, 1e-6f), 0.0f, 1.0f)};
      at = next_place;
    }
    return {at.pixel, 0.5f};
  }

  /// Returns whether a crease is strong enough, and no weaker than others within the window.
  bool is_peak(int i, int k) const {
    const auto strength = [&](const Place& at) {
      return creases_[std::size_t(at.pixel)][std::size_t(at.sheet)].strength;
    };
    const Place here{i, k};
    if (strength(here) < 1.0f) return false;
    for (const int step : {-1, 1}) {
      Place at = here;
      for (int s = 0; s < c_.max_window; ++s) {
        if (at.pixel + step < 0 || at.pixel + step >= int(stacks_.size())) break;
        at = moved(at, step);
        if (at.sheet < 0) break;
        if (strength(at) > strength(here) || (step < 0 && strength(at) == strength(here))) return false;
      }
    }
    return true;
  }

  const HiddenConstants& c_;
  std::vector<Stack> stacks_;
  std::vector<PerSheet> next_, before_;  // of each surface: its continuation in the next pixel, and in the one before
  std::vector<std::array<Crease, kLayersRead>> creases_;  // between a pixel and the next
};

/// The edges of a row or column.
struct LineEdges {
  std::vector<Edge> visible, hidden;
};

LineEdges edges_of_line(const Surfaces& surfaces, const HiddenConstants& c, int index, bool down, int count) {
  LineEdges found;
  const Scanline line(surfaces, c, down ? index : 0, down ? 0 : index, down, count);
  const auto add_to = [&](std::vector<Edge>& edges) {
    return [&edges, index, down](int i, float place) {
      edges.push_back({.x = down ? index : i,
                       .y = down ? i : index,
                       .below = down,
                       .kind = 1,
                       .step_kind = 1,
                       .strength = 1.0f,
                       .place = place});
    };
  };
  line.for_edges(0, 1, add_to(found.visible));
  line.for_edges(1, c.drawn, add_to(found.hidden));
  return found;
}

}  // namespace

std::vector<Edge> hidden_edges(const HostFrame& frame, const HiddenConstants& c) {
  const int width = frame.frame.width, height = frame.frame.height;
  if (c.drawn < 2) return {};
  const Surfaces surfaces(frame, c);
  std::vector<LineEdges> lines;
  lines.resize(std::size_t(height + width));
  tbb::parallel_for(0, height + width, [&](int k) {
    const bool down = k >= height;
    lines[std::size_t(k)] = edges_of_line(surfaces, c, down ? k - height : k, down, down ? height : width);
  });
  std::vector<std::uint8_t> near_visible(std::size_t(width) * std::size_t(height), 0);
  for (const LineEdges& line : lines)
    for (const Edge& e : line.visible)
      for (int y = std::max(e.y - kClearance, 0); y <= std::min(e.y + e.below + kClearance, height - 1); ++y)
        for (int x = std::max(e.x - kClearance, 0); x <= std::min(e.x + !e.below + kClearance, width - 1); ++x)
          near_visible[std::size_t(y) * std::size_t(width) + std::size_t(x)] = 1;
  std::vector<Edge> all;
  for (const LineEdges& line : lines)
    for (const Edge& e : line.hidden)
      if (!near_visible[std::size_t(e.y) * std::size_t(width) + std::size_t(e.x)]) all.push_back(e);
  return without_noise(std::move(all), width);
}

}  // namespace umbrage
