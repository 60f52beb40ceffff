#include "io/filled_regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <iterator>
#include <map>
#include <utility>

#include "io/stroke_outline.h"

namespace umbrage {
namespace {

constexpr int kNoRegion = -1, kOutside = -2;  // labels of pixels without an area, and around the picture
constexpr std::size_t kMaxTones = 8;          // of an object
constexpr float kMinToneDistance = 0.04f;     // of colours, sRGB
constexpr int kColorLevels = 32;              // per channel, of the histogram of colours
constexpr double kBorderTolerance = 1.0;      // pixels
constexpr float kOverlap = 0.6f;              // pixels: width of the stroke that hides seams between areas

/// The label of each pixel: the index of its region, kNoRegion or kOutside.
struct Labels {
  int width, height;
  std::vector<int> of;

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
  int at(int x, int y) const { return x < 0 || y < 0 || x >= width || y >= height ? kOutside : of[index(x, y)]; }
};

/// A region: its object and its colour.
struct Region {
  int object = 0;
  int first_of_object = 0;  ///< the first of the successive regions of this object
  glm::vec3 color{0.0f};
};

struct Bin {
  glm::vec3 sum{0.0f};
  float count = 0.0f;
  glm::vec3 mean() const { return sum / count; }
};

std::size_t nearest_tone(const std::vector<glm::vec3>& tones, const glm::vec3& color) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < tones.size(); ++k)
    if (glm::distance(color, tones[k]) < glm::distance(color, tones[nearest])) nearest = k;
  return nearest;
}

/// Returns the tones of a histogram: the most frequent colour, then in turn the one that is farthest from all tones,
/// weighted by its frequency; then the means of the colours that are nearest to each.
std::vector<glm::vec3> tones_of(const std::map<int, Bin>& histogram) {
  std::vector<glm::vec3> tones;
  while (tones.size() < kMaxTones) {
    const Bin* best = nullptr;
    float max_weight = 0.0f;
    for (const auto& [key, bin] : histogram) {
      const float distance = tones.empty() ? 1.0f : glm::distance(bin.mean(), tones[nearest_tone(tones, bin.mean())]);
      if (const float weight = bin.count * distance * distance; distance > kMinToneDistance && weight > max_weight)
        best = &bin, max_weight = weight;
    }
    if (!best) break;
    tones.push_back(best->mean());
  }
  for (int round = 0; round < 4; ++round) {
    std::vector<Bin> sums(tones.size());
    for (const auto& [key, bin] : histogram) {
      Bin& sum = sums[nearest_tone(tones, bin.mean())];
      sum.sum += bin.sum, sum.count += bin.count;
    }
    for (std::size_t k = 0; k < tones.size(); ++k)
      if (sums[k].count > 0.0f) tones[k] = sums[k].mean();
  }
  return tones;
}

/// Replaces each label by the most frequent one of the same object around it, so that no tone is a line of pixels.
void remove_slivers(Labels& labels, const std::vector<Region>& regions) {
  constexpr int kReach = 2;  // pixels
  for (int round = 0; round < 2; ++round) {
    const Labels before = labels;
    for (int y = 0; y < before.height; ++y)
      for (int x = 0; x < before.width; ++x) {
        const int label = before.at(x, y);
        if (label < 0) continue;
        const int first = regions[std::size_t(label)].first_of_object;
        std::array<int, kMaxTones> counts{};
        for (int j = y - kReach; j <= y + kReach; ++j)
          for (int i = x - kReach; i <= x + kReach; ++i)
            if (const int other = before.at(i, j); other >= 0 && regions[std::size_t(other)].first_of_object == first)
              ++counts[std::size_t(other - first)];
        const auto most = std::max_element(counts.begin(), counts.end());
        if (*most > counts[std::size_t(label - first)])
          labels.of[labels.index(x, y)] = first + int(most - counts.begin());
      }
  }
}

/// Labels the pixels. Sets `regions`.
Labels labels_of(const Image& picture, FillBy by, std::vector<Region>& regions) {
  const Plane &r = picture.plane("color.r"), &g = picture.plane("color.g"), &b = picture.plane("color.b");
  const Plane& ids = picture.plane("object_id");
  const auto each_pixel = [&](const auto& visit) {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        if (const int object = int(ids.at(x, y)); object >= 0)
          visit(x, y, object, glm::vec3(r.at(x, y), g.at(x, y), b.at(x, y)));
  };
  std::map<int, std::map<int, Bin>> histograms;  // by object and colour
  each_pixel([&](int, int, int object, const glm::vec3& color) {
    int key = 0;
    for (int c = 0; by == FillBy::kTone && c < 3; ++c)
      key = key * kColorLevels + std::clamp(int(color[c] * float(kColorLevels)), 0, kColorLevels - 1);
    Bin& bin = histograms[object][key];
    bin.sum += color, bin.count += 1.0f;
  });
  std::map<int, std::pair<int, std::vector<glm::vec3>>> tones;  // by object: the first region, the colours
  for (const auto& [object, histogram] : histograms) {
    auto& [first, colors] = tones[object] = {int(regions.size()), tones_of(histogram)};
    for (const glm::vec3& color : colors) regions.push_back({object, first, color});
  }
  Labels labels{picture.width, picture.height,
                std::vector<int>(std::size_t(picture.width) * std::size_t(picture.height), kNoRegion)};
  each_pixel([&](int x, int y, int object, const glm::vec3& color) {
    const auto& [first, colors] = tones[object];
    labels.of[labels.index(x, y)] = first + int(nearest_tone(colors, color));
  });
  if (by == FillBy::kTone) remove_slivers(labels, regions);
  return labels;
}

/// A corner of pixels.
using Corner = std::array<int, 2>;

/// A border between two regions, from one corner where more than two meet to the next, or closed.
struct Border {
  int left = kNoRegion, right = kNoRegion;
  bool closed = false;
  std::vector<Corner> corners;
};

/// Finds borders between pixels of different labels.
class BorderTracer {
 public:
  explicit BorderTracer(const Labels& labels)
      : labels_(labels), done_(std::size_t(labels.width + 1) * std::size_t(labels.height + 1)) {}

  std::vector<Border> trace() {
    std::vector<Border> borders;
    for (const bool from_nodes : {true, false})  // the others are closed
      for (int y = 0; y <= labels_.height; ++y)
        for (int x = 0; x <= labels_.width; ++x)
          for (int way = 0; way < 4; ++way)
            if (is_border({x, y}, way) && !is_done({x, y}, way) && (!from_nodes || is_node({x, y})))
              borders.push_back(follow({x, y}, way, !from_nodes));
    return borders;
  }

 private:
  static constexpr int kDx[] = {1, 0, -1, 0}, kDy[] = {0, 1, 0, -1};

  static Corner next(Corner c, int way) { return {c[0] + kDx[way], c[1] + kDy[way]}; }

  /// Returns the labels on both sides of the edge from a corner: left, right.
  std::pair<int, int> sides(Corner c, int way) const {
    const auto [x, y] = c;
    const int up_left = labels_.at(x - 1, y - 1), up_right = labels_.at(x, y - 1);
    const int down_left = labels_.at(x - 1, y), down_right = labels_.at(x, y);
    const std::pair<int, int> all[] = {
        {up_right, down_right}, {down_right, down_left}, {down_left, up_left}, {up_left, up_right}};
    return all[way];
  }
  bool is_border(Corner c, int way) const {
    const auto [left, right] = sides(c, way);
    return left != right;
  }
  bool is_node(Corner c) const {
    int count = 0;
    for (int way = 0; way < 4; ++way) count += is_border(c, way);
    const bool is_end = (c[0] == 0 || c[0] == labels_.width) && (c[1] == 0 || c[1] == labels_.height);
    return count != 2 || is_end;
  }
  unsigned char& done(Corner c) {
    return done_[std::size_t(c[1]) * std::size_t(labels_.width + 1) + std::size_t(c[0])];
  }
  bool is_done(Corner c, int way) { return done(c) >> way & 1; }

  Border follow(Corner c, int way, bool closed) {
    Border border{.closed = closed};
    std::tie(border.left, border.right) = sides(c, way);
    border.corners.push_back(c);
    while (way < 4) {
      done(c) |= static_cast<unsigned char>(1 << way);
      c = next(c, way);
      done(c) |= static_cast<unsigned char>(1 << (way + 2) % 4);
      border.corners.push_back(c);
      if (is_node(c)) break;
      for (way = 0; way < 4; ++way)
        if (is_border(c, way) && !is_done(c, way)) break;
    }
    return border;
  }

  const Labels& labels_;
  std::vector<unsigned char> done_;  // ways of each corner
};

/// Returns the points of a border: the middle of each run of edges in one direction, where the outline that the pixels
/// approximate crosses it, and corners between two runs that are no steps of one pixel.
std::vector<glm::dvec2> points_of(Border border) {
  std::vector<Corner>& corners = border.corners;
  const auto is_turn = [](const Corner& before, const Corner& after) {
    return before[0] != after[0] && before[1] != after[1];
  };
  if (border.closed) {  // it starts at a turn
    corners.pop_back();
    const std::size_t count = corners.size();
    std::size_t start = 0;
    while (start < count && !is_turn(corners[(start + count - 1) % count], corners[(start + 1) % count])) ++start;
    std::rotate(corners.begin(), corners.begin() + std::ptrdiff_t(start), corners.end());
    corners.push_back(corners.front());
  }
  std::vector<std::size_t> ends = {0};  // of runs
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    if (is_turn(corners[k - 1], corners[k + 1])) ends.push_back(k);
  ends.push_back(corners.size() - 1);
  const auto point = [&](std::size_t k) { return glm::dvec2(corners[k][0], corners[k][1]); };
  std::vector<glm::dvec2> points;
  if (!border.closed) points.push_back(point(0));
  const std::size_t runs = ends.size() - 1;
  for (std::size_t k = 0; k < runs; ++k) {
    points.push_back(0.5 * (point(ends[k]) + point(ends[k + 1])));
    const std::size_t next = (k + 1) % runs;
    const bool is_corner = ends[k + 1] - ends[k] > 1 && ends[next + 1] - ends[next] > 1;
    if (is_corner && (next > 0 || border.closed)) points.push_back(point(ends[k + 1]));
  }
  points.push_back(border.closed ? points.front() : point(corners.size() - 1));
  return points;
}

/// Returns the straight line between two points.
SpinePiece line_between(const glm::dvec2& from, const glm::dvec2& to) {
  SpinePiece line{{.from = from, .to = to}, {1.0f}};
  line.piece.make_straight();
  return line;
}

/// Returns the curves of a border, which end where it ends.
SpinePieces curves_of(const Border& border) {
  const std::vector<glm::dvec2> points = points_of(border);
  Stroke stroke{.closed = border.closed};
  for (const glm::dvec2& p : points) stroke.points.push_back({float(p.x), float(p.y), 1.0f});
  SpinePieces curves;
  for (const CurvePiece& piece : fit_curve(stroke, kBorderTolerance, false).pieces) curves.push_back({piece, {1.0f}});
  if (curves.empty() || border.closed) return curves;
  // A line is moved to the end; an arc would be another one.
  CurvePiece &first = curves.front().piece, &last = curves.back().piece;
  const SpinePiece before = line_between(points.front(), first.from), after = line_between(last.to, points.back());
  const bool is_arc_first = first.curve.radius > 0.0, is_arc_last = last.curve.radius > 0.0;
  if (!is_arc_first) first.from = points.front();
  if (!is_arc_last) last.to = points.back();
  if (is_arc_first) curves.insert(curves.begin(), before);
  if (is_arc_last) curves.push_back(after);
  return curves;
}

SpinePieces reversed(SpinePieces curves) {
  std::reverse(curves.begin(), curves.end());
  for (auto& [piece, widths] : curves) {
    std::swap(piece.from, piece.to);
    piece.curve.along = -piece.curve.along;
    piece.curve.turns_right = !piece.curve.turns_right;
  }
  return curves;
}

/// Returns the closed paths around a region, with it on the left of all.
std::vector<DrawnPath> loops_of(std::multimap<Corner, std::pair<Corner, SpinePieces>>& sides) {
  std::vector<DrawnPath> loops;
  while (!sides.empty()) {
    const Corner start = sides.begin()->first;
    SpinePieces loop;
    Corner at = start;
    do {
      const auto side = sides.find(at);
      if (side == sides.end()) break;
      at = side->second.first;
      std::move(side->second.second.begin(), side->second.second.end(), std::back_inserter(loop));
      sides.erase(side);
    } while (at != start);
    if (loop.empty()) continue;
    loops.push_back(path_of(loop));
    loops.back().closed = true;
  }
  return loops;
}

}  // namespace

std::vector<DrawnLayer> filled_regions(const Image& picture, FillBy by) {
  std::vector<Region> regions;
  const Labels labels = labels_of(picture, by, regions);
  std::vector<std::multimap<Corner, std::pair<Corner, SpinePieces>>> sides(regions.size());
  for (const Border& border : BorderTracer(labels).trace()) {
    const SpinePieces curves = curves_of(border);
    if (border.left >= 0)
      sides[std::size_t(border.left)].insert({border.corners.front(), {border.corners.back(), curves}});
    if (border.right >= 0)
      sides[std::size_t(border.right)].insert({border.corners.back(), {border.corners.front(), reversed(curves)}});
  }
  std::vector<DrawnLayer> layers;
  for (std::size_t k = 0; k < regions.size(); ++k) {
    std::vector<DrawnPath> loops = loops_of(sides[k]);
    if (loops.empty()) continue;
    DrawnPath area = std::move(loops.front());
    area.holes.assign(std::make_move_iterator(loops.begin() + 1), std::make_move_iterator(loops.end()));
    const glm::vec3& color = regions[k].color;
    area.fill = area.stroke = DrawnColor{color.r, color.g, color.b};
    area.width = kOverlap;
    if (layers.empty() || layers.back().object != regions[k].object)
      layers.push_back({.name = "fill", .object = regions[k].object, .opacity = 1.0f, .shapes = {}});
    layers.back().shapes.emplace_back(std::move(area));
  }
  return layers;
}

}  // namespace umbrage
