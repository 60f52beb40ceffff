// Implements lines between key frames: those of both key frames, which move on their surfaces.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "core/gbuffer.h"
#include "effects/hatching/hatching_points.h"
#include "effects/hatching/hatching_surfaces.h"

namespace umbrage {
namespace {

using Point = HatchingLine::Point;

constexpr float kRankCost = 0.3f;    // of a partner of another rank, in spacings
constexpr float kOtherCost = 1.4f;   // factor for another partner than that of the point before
constexpr float kMinCosine = 0.85f;  // between partners
constexpr int kSmoothSteps = 9;      // radius over which lines turn to a partner or away: 1.5 spacings

/// The lines of a set of a key frame, and the world-space positions of their points.
struct Set {
  std::vector<HatchingLine> lines;
  std::vector<std::vector<glm::vec3>> at;
};

struct Key {
  explicit Key(const HostFrame& frame) : surfaces(frame) {
    for (HostPlane* plane : {&surfaces.depth, &surfaces.breaks}) {
      std::vector<float>& values = planes.emplace_back();
      for (int y = 0; y < frame.frame.height; ++y)
        values.insert(values.end(), plane->row(y), plane->row(y) + frame.frame.width);
      *plane = {"", values.data(), frame.frame.width};
    }
  }
  std::vector<std::vector<float>> planes;
  HatchingSurfaces surfaces;
  float spacing_px = 1.0f;
  std::array<Set, 2> sets;
};

/// Where a point of a line is in the other key frame.
struct Partner {
  int line = -1, step = 0;  // the nearest parallel line there, and its point; -1: none
  bool hidden = false;      // the other key frame does not show the surface
};
using Partners = std::vector<std::vector<Partner>>;  // by line and point

/// What happens to a point of a line until the other key frame.
struct Change {
  glm::vec3 slide{0.0f};  // to the line of the partner, world space
  float level = 0.0f;     // of the partner
  float paired = 0.0f;    // 1: the line becomes its partner; 0: it fades
  float alone = 0.0f;     // 1: it remains, since the other key frame does not show the surface
};
using Changes = std::vector<std::vector<Change>>;

struct Joined {
  std::array<std::shared_ptr<const Key>, 2> keys;
  std::array<std::array<Changes, 2>, 2> changes;  // by key and set
};

/// Returns the unit direction from a to b.
Point direction_of(Point a, Point b) {
  const float length = std::max(std::hypot(b.x - a.x, b.y - a.y), 1e-20f);
  return {(b.x - a.x) / length, (b.y - a.y) / length};
}

/// Returns the partners among the lines `others` of the key frame `there`.
Partners partners_of(const Set& own, const Key& there, const Set& others) {
  HatchingPoints points(there.surfaces.f.width, there.surfaces.f.height, there.spacing_px);
  for (std::size_t k = 0; k < others.lines.size(); ++k)
    for (std::size_t n = 0; n < others.lines[k].points.size(); ++n)
      points.add(others.lines[k].points[n], int(k), int(n));
  Partners partners(own.lines.size());
  tbb::parallel_for(std::size_t(0), own.lines.size(), [&](std::size_t index) {
    constexpr float kAbreast = 0.1f;  // spacings: a bit more than half a step
    std::vector<std::optional<Point>> seen;
    for (const glm::vec3& at : own.at[index]) seen.push_back(there.surfaces.seen(at));
    for (std::size_t n = 0; n < seen.size(); ++n) {
      Partner& partner = partners[index].emplace_back();
      partner.hidden = !seen[n];
      const auto &before = seen[n > 0 ? n - 1 : n], &after = seen[std::min(n + 1, seen.size() - 1)];
      if (!seen[n] || !before || !after) continue;
      const Point d = direction_of(*before, *after);
      const int last = n > 0 ? partners[index][n - 1].line : -1;
      float least = 1e9f;
      const auto visit = [&](int line, int step, float side) {
        const HatchingLine& other = others.lines[std::size_t(line)];
        const auto m = std::size_t(step);
        const float off = std::abs(side) / there.spacing_px;
        const float cost = (off + kRankCost * std::abs(other.level[m] - own.lines[index].level[n])) *
                           (line == last ? 1.0f : kOtherCost);
        if (off > 1.0f || cost >= least) return;
        const Point e =
            direction_of(other.points[m > 0 ? m - 1 : m], other.points[std::min(m + 1, other.points.size() - 1)]);
        if (std::abs(dot(d, e)) > kMinCosine) least = cost, partner.line = line, partner.step = step;
      };
      points.for_points_beside(*seen[n], there.spacing_px, d, kAbreast * there.spacing_px, -1, visit);
    }
  });
  return partners;
}

/// Returns the changes of lines with these partners, whose own partners are `back`.
Changes changes_of(const Set& own, const Set& others, const Partners& partners, const Partners& back) {
  Changes changes(own.lines.size());
  tbb::parallel_for(std::size_t(0), own.lines.size(), [&](std::size_t index) {
    const std::vector<Partner>& p = partners[index];
    const int count = int(p.size());
    for (int n = 0; n < count; ++n) {
      Change& change = changes[index].emplace_back();
      float pairs = 0.0f, hidden = 0.0f, all = 0.0f;
      for (int m = std::max(n - kSmoothSteps, 0); m <= std::min(n + kSmoothSteps, count - 1); ++m) {
        const auto k = std::size_t(m), line = std::size_t(p[k].line), step = std::size_t(p[k].step);
        all += 1.0f, hidden += p[k].hidden ? 1.0f : 0.0f;
        if (p[k].line < 0 || back[line][step].line != int(index)) continue;
        pairs += 1.0f;
        change.slide += others.at[line][step] - own.at[index][k];
        change.level += others.lines[line].level[step] - own.lines[index].level[std::size_t(n)];
      }
      // Beyond the end of a pair the line bends back to its own place.
      const float mean = std::min(1.0f / std::max(pairs, 1.0f), 2.0f / all);
      change.slide *= mean;
      change.level = own.lines[index].level[std::size_t(n)] + change.level * mean;
      change.paired = pairs / std::max(all - hidden, 1.0f);
      change.alone = p[std::size_t(n)].hidden ? hidden / all : 0.0f;
    }
  });
  return changes;
}

/// Returns the visible parts of a line of a key frame, `gone` of the way to the other one.
std::vector<HatchingLine> visible_parts(const HatchingSurfaces& picture, const HatchingLine& line,
                                        const std::vector<glm::vec3>& at, const std::vector<Change>& changes,
                                        float gone) {
  std::vector<HatchingLine> parts;
  bool goes_on = false;
  for (std::size_t n = 0; n < line.points.size(); ++n) {
    const Change& change = changes[n];
    const auto p = picture.seen(at[n] + gone * change.slide);
    // Two partners are both drawn when they meet halfway, and at each key frame only its own lines.
    const float left = 1.0f - gone, fading = left + change.paired * (std::min(2.0f * left, 1.0f) - left);
    const float weight = fading + change.alone * (1.0f - fading);
    const bool is_drawn = p && weight > 0.0f;
    if (is_drawn && !goes_on)
      parts.push_back({.rank = line.rank, .free_start = n == 0 && line.free_start, .gone = gone});
    goes_on = is_drawn;
    if (!is_drawn) continue;
    HatchingLine& part = parts.back();
    part.free_end = n + 1 == line.points.size() && line.free_end;
    part.points.push_back(*p);
    part.room.push_back(line.room[n]);
    part.level.push_back(line.level[n]);
    part.next_level.push_back(change.level);
    part.weight.push_back(weight);
  }
  return parts;
}

}  // namespace

SurfaceLines hatching_key(const HostFrame& frame) {
  auto key = std::make_shared<Key>(frame);
  key->spacing_px = static_cast<const HatchingConstants*>(frame.constants)->spacing_px;
  auto traced = traced_sets(frame);
  for (std::size_t k = 0; k < traced.size(); ++k) {
    Set& set = key->sets[k];
    set.lines = std::move(traced[k]);
    for (const HatchingLine& line : set.lines) {
      std::vector<glm::vec3>& at = set.at.emplace_back();
      for (const Point p : line.points) at.push_back(key->surfaces.at(p));
    }
  }
  return key;
}

SurfaceLines hatching_join(const SurfaceLines& first, const SurfaceLines& second) {
  auto joined = std::make_shared<Joined>();
  joined->keys = {std::static_pointer_cast<const Key>(first), std::static_pointer_cast<const Key>(second)};
  for (std::size_t set = 0; set < 2; ++set) {
    const Key &a = *joined->keys[0], &b = *joined->keys[1];
    const Partners after = partners_of(a.sets[set], b, b.sets[set]), before = partners_of(b.sets[set], a, a.sets[set]);
    joined->changes[0][set] = changes_of(a.sets[set], b.sets[set], after, before);
    joined->changes[1][set] = changes_of(b.sets[set], a.sets[set], before, after);
  }
  return joined;
}

std::optional<HatchingSets> lines_between_keys(const HostFrame& frame) {
  const LinesBetween& between = *frame.info.lines_between;
  const auto& joined = *static_cast<const Joined*>(between.lines.get());
  const HatchingSurfaces picture(frame);
  constexpr int kStep = 12;  // pixels
  int missing = 0;
  for (int y = 0; y < picture.f.height; y += kStep)
    for (int x = 0; x < picture.f.width; x += kStep) {
      const bool is_shown = std::any_of(joined.keys.begin(), joined.keys.end(), [&](const auto& key) {
        const auto p = key->surfaces.seen(picture.at(x, y));
        const float scale = p ? key->surfaces.pixel_size(int(p->x), int(p->y)) / picture.pixel_size(x, y) : 0.0f;
        return scale > 0.6f && scale < 1.7f;
      });
      missing += !std::isfinite(picture.depth.row(y)[x]) ? 0 : is_shown ? -1 : 2;
    }
  if (missing > 0) return {};
  HatchingSets all;
  for (std::size_t k = 0; k < 4; ++k) {
    const Set& set = joined.keys[k % 2]->sets[k / 2];
    const Changes& changes = joined.changes[k % 2][k / 2];
    std::vector<std::vector<HatchingLine>> parts(set.lines.size());
    tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t n) {
      const float gone = k % 2 == 0 ? between.after : 1.0f - between.after;
      parts[n] = visible_parts(picture, set.lines[n], set.at[n], changes[n], gone);
    });
    for (auto& of_line : parts) std::move(of_line.begin(), of_line.end(), std::back_inserter(all[k / 2]));
  }
  return all;
}

}  // namespace umbrage
