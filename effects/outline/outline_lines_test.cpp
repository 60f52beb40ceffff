// Tests the lines that `outline` traces, on scenes with known edges.
#include <algorithm>
#include <chrono>
#include <map>
#include <random>

#include "core/strokes.h"
#include "devices/shared/dispatches.h"
#include "effects/outline/outline_draw.h"
#include "effects/outline/outline_test_scenes.h"
#include "tilted_plane.h"

namespace umbrage {
namespace {

using namespace test;
using glm::dvec2;

/// The planes that the effect writes, and its lines.
struct Traced {
  Image planes;
  Strokes lines;
};

Traced traced(const GBuffer& g, const Settings& settings = {}, const CpuSettings& cpu = {}) {
  const Effect& effect = *find_effect("outline");
  Traced t{run_effect(effect, g, settings, cpu), {}};
  const auto constants = constants_of<OutlineConstants>("outline", g.info, settings);
  std::vector<HostPlane> inputs;
  for (const char* name : {"outline_edge_right", "outline_edge_below"})
    inputs.push_back({name, t.planes.plane(name).row(0), t.planes.plane(name).stride});
  for (const char* name : {"depth", "object_id"}) {
    const Plane& plane = g.layers[0].plane(name);
    inputs.push_back({name, const_cast<float*>(plane.row(0)), plane.stride});
  }
  const HostFrame frame{g.info, frame_constants(g.info, inputs[0].stride, 0), &constants, inputs, {}};
  t.lines = trace_lines(frame);
  return t;
}

double distance_to_segment(dvec2 p, dvec2 a, dvec2 b) {
  const dvec2 along = b - a;
  const double f = std::clamp(glm::dot(p - a, along) / std::max(glm::dot(along, along), 1e-12), 0.0, 1.0);
  return glm::length(p - a - f * along);
}

dvec2 place(const StrokePoint& p) { return {p.x, p.y}; }

/// Returns the distance of a point to a line.
double distance_to_line(dvec2 p, const Stroke& line) {
  double min = kInfinity;
  for (std::size_t k = 0; k + 1 < line.points.size(); ++k)
    min = std::min(min, distance_to_segment(p, place(line.points[k]), place(line.points[k + 1])));
  return min;
}

double distance_to_lines(dvec2 p, const Strokes& lines, const Stroke* except = nullptr) {
  double min = kInfinity;
  for (const Stroke& line : lines.strokes)
    if (&line != except) min = std::min(min, distance_to_line(p, line));
  return min;
}

/// Returns the ends of lines that meet neither another line nor the picture's border.
std::vector<dvec2> free_ends(const Strokes& lines) {
  constexpr double kMeets = 1.0, kBorder = 2.0;  // pixels
  std::vector<dvec2> ends;
  for (const Stroke& line : lines.strokes) {
    if (line.closed) continue;
    for (const StrokePoint* end : {&line.points.front(), &line.points.back()}) {
      const dvec2 p = place(*end);
      const bool border = p.x < kBorder || p.y < kBorder || p.x > lines.width - kBorder || p.y > lines.height - kBorder;
      // A line may end on itself.
      const dvec2 other = place(end == &line.points.front() ? line.points.back() : line.points.front());
      if (!border && distance_to_lines(p, lines, &line) > kMeets && glm::length(p - other) > kMeets) ends.push_back(p);
    }
  }
  return ends;
}

double length_of(const Strokes& lines) {
  double sum = 0.0;
  for (const Stroke& line : lines.strokes)
    for (std::size_t k = 0; k + 1 < line.points.size(); ++k)
      sum += glm::length(place(line.points[k + 1]) - place(line.points[k]));
  return sum;
}

dvec2 projected(const Lens& lens, dvec3 p) {
  const double scale = lens.orthographic ? 1.0 : -1.0 / p.z;
  return {(p.x * scale - lens.left()) / lens.pixel(), (lens.top() - p.y * scale) / lens.pixel()};
}

/// Returns the edges of a cube's visible faces, in pixels of the picture.
std::vector<std::array<dvec2, 2>> visible_edges(const Lens& lens, dvec3 center, const dmat3& turn, double half) {
  const auto is_visible = [&](dvec3 normal) {
    const dvec3 to_eye = lens.orthographic ? dvec3(0, 0, 1) : -(center + turn * (half * normal));
    return glm::dot(turn * normal, to_eye) > 0.0;
  };
  std::vector<std::array<dvec2, 2>> edges;
  for (int axis = 0; axis < 3; ++axis)
    for (const int s : {-1, 1})
      for (const int t : {-1, 1}) {
        dvec3 a(0.0), b(0.0), first(0.0), second(0.0);
        a[axis] = -1, b[axis] = 1;
        a[(axis + 1) % 3] = b[(axis + 1) % 3] = first[(axis + 1) % 3] = s;
        a[(axis + 2) % 3] = b[(axis + 2) % 3] = second[(axis + 2) % 3] = t;
        if (is_visible(first) || is_visible(second))
          edges.push_back({projected(lens, center + turn * (half * a)), projected(lens, center + turn * (half * b))});
      }
  return edges;
}

void expect_cube(int size, bool orthographic, int turned) {
  const Lens lens{size, size, orthographic};
  const dvec3 center(0.0, 0.0, -kFocus);
  const dmat3 turn = rotation(24.0 + 1.7 * turned, 31.0 + 2.3 * turned, 30.0 * turned + 7.0);
  const Strokes lines = traced(seen(lens, box(center, turn, 1.0))).lines;
  const auto edges = visible_edges(lens, center, turn, 1.0);
  ASSERT_EQ(edges.size(), 9u);
  EXPECT_TRUE(free_ends(lines).empty());
  long near = 0, all = 0;
  for (const auto& [a, b] : edges)
    for (int k = 0; k <= 200; ++k, ++all) near += distance_to_lines(a + (b - a) * (k / 200.0), lines) < 0.3;
  EXPECT_GE(double(near), 0.95 * double(all));
  for (const Stroke& line : lines.strokes)
    for (const StrokePoint& p : line.points) {
      double off = kInfinity;
      for (const auto& [a, b] : edges) off = std::min(off, distance_to_segment(place(p), a, b));
      EXPECT_LT(off, 1.5) << p.x << " " << p.y;
    }
}

TEST(OutlineLines, ACubeHasItsNineEdges) {
  for (const int size : {256, 1024, 2160})
    for (const bool orthographic : {false, true})
      for (int turned = 0; turned < 12; ++turned) {
        SCOPED_TRACE(
            fmt::format("{} pixels, {}, turn {}", size, orthographic ? "orthographic" : "perspective", turned));
        expect_cube(size, orthographic, turned);
      }
}

TEST(OutlineLines, RoundObjectsHaveOnlySilhouettes) {
  for (const int size : {256, 1024})
    for (const bool orthographic : {false, true}) {
      SCOPED_TRACE(size);
      const Lens lens{size, size, orthographic};
      const Strokes ball = traced(seen(lens, sphere({0.1, -0.2, -kFocus}, 1.2, 0))).lines;
      ASSERT_EQ(ball.strokes.size(), 1u);
      EXPECT_TRUE(ball.strokes[0].closed);
      EXPECT_EQ(ball.strokes[0].kind, StrokeKind::kOutline);
      // The ring has two silhouettes. Where it occludes itself, no line ends before the background.
      const GBuffer g = seen(lens, ring({0.0, 0.0, -kFocus}, rotation(50.0, 20.0), 1.1, 0.4, 0));
      const Strokes lines = traced(g).lines;
      int closed = 0;
      for (const Stroke& line : lines.strokes) closed += line.closed;
      EXPECT_GE(closed, 1);
      for (const dvec2& end : free_ends(lines))
        for (int y = int(end.y) - 3; y <= int(end.y) + 3; ++y)
          for (int x = int(end.x) - 3; x <= int(end.x) + 3; ++x)
            EXPECT_TRUE(std::isfinite(g.layers[0].plane("depth").at(x, y))) << end.x << " " << end.y;
    }
}

TEST(OutlineLines, FlatAndNoisySurfacesHaveNone) {
  const Lens lens{512, 512};
  // The only line may be the plane's horizon, if it is visible.
  const Strokes flat = traced(seen(lens, ground(2.0, 0.0))).lines;
  EXPECT_LE(flat.strokes.size(), 1u);
  EXPECT_LT(length_of(flat), 520.0);
  GBuffer noisy = seen({512, 512}, ground(25.0, 8.0));
  std::mt19937 random(7);
  std::normal_distribution<float> error(0.0f, 0.06f);  // about 5 degrees
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 512; ++x)
      for (int c = 1; c < 3; ++c) noisy.layers[0].planes[std::size_t(c)].at(x, y) += error(random);
  EXPECT_LT(length_of(traced(noisy).lines), 1100.0);  // horizon and borders
}

TEST(OutlineLines, GrazingPlanesHaveNoneAndStepsHaveOne) {
  const auto add_ids = [](GBuffer& g) {
    for (const char* name : {"object_id", "material_id"})
      g.layers[0].add(name) = Plane(g.info.width, g.info.height, 0.0f);
  };
  at_grazing_angles({.error_deg = 2.0}, [&](const TiltedPlane& plane) {
    GBuffer g = seen(plane);
    add_ids(g);
    EXPECT_TRUE(traced(g).lines.strokes.empty());
  });
  at_grazing_angles({.step_px = 20.0}, [&](const TiltedPlane& plane) {
    GBuffer g = seen(plane);
    add_ids(g);
    const Strokes lines = traced(g).lines;
    ASSERT_EQ(lines.strokes.size(), 1u);
    EXPECT_NEAR(length_of(lines), 64.0, 4.0);
    for (const StrokePoint& p : lines.strokes[0].points) EXPECT_NEAR(p.x, 32.0, 0.6);
  });
}

TEST(OutlineLines, ANutHasItsThirtyDegreeEdges) {
  std::vector<HalfSpace> sides;
  const dmat3 turn = rotation(62.0, 0.0, 8.0);
  const dvec3 center(0.0, 0.0, -kFocus);
  for (int k = 0; k < 12; ++k) {
    const dvec3 n = turn * dvec3(std::cos(radians(30.0 * k)), std::sin(radians(30.0 * k)), 0.0);
    sides.push_back({n, 1.3 + glm::dot(n, center)});
  }
  for (const int s : {-1, 1}) {
    const dvec3 n = turn * dvec3(0.0, 0.0, s);
    sides.push_back({n, 0.8 + glm::dot(n, center)});
  }
  const Lens lens{512, 512};
  const Strokes lines = traced(seen(lens, convex_solid(sides))).lines;
  EXPECT_TRUE(free_ends(lines).empty());
  const double outer = 1.3 / std::cos(radians(15.0));
  int visible_sides = 0;
  for (int k = 0; k < 12; ++k) {
    const double angle = radians(30.0 * k + 15.0);
    const dvec3 n = turn * dvec3(std::cos(angle), std::sin(angle), 0.0);
    if (glm::dot(n, -center) < 0.3 * glm::length(center)) continue;  // near the silhouette or behind
    ++visible_sides;
    for (const double z : {-0.6, 0.0, 0.6}) {
      const dvec3 p = center + turn * dvec3(outer * std::cos(angle), outer * std::sin(angle), z);
      EXPECT_LT(distance_to_lines(projected(lens, p), lines), 0.5) << k;
    }
  }
  EXPECT_GE(visible_sides, 3);
}

TEST(OutlineLines, HaveTheRequestedWidth) {
  const GBuffer g = seen({512, 512}, sphere({0.0, 0.0, -kFocus}, 1.4, 0));
  for (const double width : {0.5, 1.0, 2.0, 8.0, 16.0}) {
    const Traced t = traced(g, {{"width", fmt::format("{}", width)}});
    double covered = 0.0;
    const Plane& plane = t.planes.plane("outline");
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) covered += plane.at(x, y);
    EXPECT_NEAR(covered / length_of(t.lines), width, 0.3) << width;
  }
}

TEST(OutlineLines, MoveWithTheCamera) {
  const RayScene scene = together({box({-0.7, 0.3, -kFocus}, rotation(33, 38, 7), 0.7, 0.05),
                                   sphere({0.9, -0.4, -5.2}, 0.6, 1), ground(40.0, 0.0, 9.0, 2)});
  Lens lens{512, 512};
  const Strokes before = traced(seen(lens, scene)).lines;
  for (const auto& [x, y] : {std::pair(0.37, -0.21), {-0.5, 0.5}, {0.13, 0.44}}) {
    lens.shift_x_px = x;
    lens.shift_y_px = y;
    const Strokes after = traced(seen(lens, scene)).lines;
    double sum = 0.0;
    long count = 0;
    for (const Stroke& line : after.strokes)
      for (const StrokePoint& p : line.points) {
        const double off = distance_to_lines(place(p) + dvec2(x, -y), before);
        EXPECT_LT(off, 2.0) << p.x << " " << p.y;
        sum += off;
        ++count;
      }
    EXPECT_LT(sum / double(count), 0.15);
    EXPECT_NEAR(length_of(after), length_of(before), 0.01 * length_of(before));
  }
}

TEST(OutlineLines, VarySmoothlyAsTheModelTurns) {
  double before = 0.0;
  for (int frame = 0; frame < 72; ++frame) {
    const RayScene scene = together({box({0, 0, -kFocus}, rotation(25.0, 27.0 + 0.5 * frame), 0.9, 0.02),
                                     sphere({0.0, 1.3, -kFocus}, 0.4, 1), ground(40.0, 0.0, 9.0, 2)});
    const double length = length_of(traced(seen({256, 256}, scene)).lines);
    if (frame > 0) {
      EXPECT_NEAR(length, before, 0.03 * before) << frame;
    }
    before = length;
  }
}

// Slats three pixels wide become a grey tone, not broken lines.
TEST(OutlineLines, DenseLinesFadeToTone) {
  GBuffer g = seen({256, 256}, ground(90.0, 0.0));
  for (int y = 0; y < 256; ++y)
    for (int x = 64; x < 192; ++x)
      if (y >= 64 && y < 192) g.layers[0].plane("object_id").at(x, y) = float(1 + x / 3 % 2);
  const Image planes = traced(g).planes;
  for (int y = 80; y < 176; ++y) {
    double covered = 0.0;
    for (int x = 80; x < 176; ++x) covered += planes.plane("outline").at(x, y) / 96.0;
    EXPECT_GT(covered, 0.3) << y;
    EXPECT_LT(covered, 0.7) << y;
  }
}

// Between the two silhouettes of a pole three pixels wide, a third of its colour remains visible.
TEST(OutlineLines, LeaveColourInsideThinObjects) {
  GBuffer g = seen({256, 256}, ground(90.0, 0.0));
  for (int y = 20; y < 236; ++y)
    for (int x = 100; x < 103; ++x) g.layers[0].plane("object_id").at(x, y) = 1.0f;
  const Image planes = traced(g, {{"width", "4"}}).planes;
  for (int y = 60; y < 200; ++y) EXPECT_LT(planes.plane("outline").at(101, y), 0.67f) << y;
}

/// Returns random depths, normals and ids, constant in blocks of block x block pixels.
GBuffer random_gbuffer(int size, int block) {
  GBuffer g = seen({size, size}, ground(90.0, 0.0));
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<float> depth(1.0f, 20.0f);
  for (int y = 0; y < size; y += block)
    for (int x = 0; x < size; x += block) {
      const std::array<float, 5> values = {depth(random), normal(random), normal(random), normal(random),
                                           float(random() % 3)};
      for (int j = y; j < std::min(y + block, size); ++j)
        for (int i = x; i < std::min(x + block, size); ++i)
          for (std::size_t plane = 0; plane < values.size(); ++plane)
            g.layers[0].planes[plane].at(i, j) = values[plane];
    }
  return g;
}

TEST(OutlineLines, TakeAnyEdgesInBoundedTime) {
  for (const int block : {1, 2, 3}) {
    const GBuffer g = random_gbuffer(1024, block);
    const auto start = std::chrono::steady_clock::now();
    const Traced t = traced(g);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    RecordProperty(fmt::format("seconds_{}", block), fmt::format("{}", took.count()));
    EXPECT_LT(took.count(), 20.0) << block;  // for two tracings; enough with sanitizers on a busy machine
    if (block != 2) {
      EXPECT_EQ(t.lines.strokes.size() > 1000u, block > 1)
          << block;  // with blocks of one pixel, edges everywhere count as noise
    }
  }
  for (const Stroke& line : traced(hostile_gbuffer(300, 200, 1)).lines.strokes)
    for (const StrokePoint& p : line.points) {
      ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.width));
      ASSERT_TRUE(p.x > -20.0f && p.x < 320.0f && p.y > -20.0f && p.y < 220.0f);
    }
}

TEST(OutlineLines, AreTheSameAtAnyNumberOfThreads) {
  const GBuffer g = random_gbuffer(200, 2);
  const Traced one = traced(g, {}, {.threads = 1}), two = traced(g, {}, {.threads = 2});
  EXPECT_EQ(difference(one.planes.plane("outline"), two.planes.plane("outline"), 0.0).max, 0.0);
}

TEST(OutlineLines, WithoutWidthCoverNothing) {
  const Traced t = traced(random_gbuffer(200, 3), {{"width", "0%"}, {"inner", "1"}});
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) ASSERT_EQ(t.planes.plane("outline").at(x, y), 0.0f);
  const Traced inner = traced(random_gbuffer(200, 3), {{"inner", "1"}, {"depth", "0.5"}});
  for (const Stroke& line : inner.lines.strokes)
    for (const StrokePoint& p : line.points) ASSERT_TRUE(std::isfinite(p.width) && p.width >= 0.0f);
}

TEST(OutlineLines, KnowTheirKindsAndObjects) {
  const RayScene scene =
      together({box({-0.9, 0.2, -kFocus}, rotation(33, 38, 7), 0.7, 0.0, 4), ground(20.0, 0.0, 9.0, 7)});
  std::map<StrokeKind, double> lengths;
  for (const Stroke& line : traced(seen({512, 512}, scene)).lines.strokes) {
    for (std::size_t k = 0; k + 1 < line.points.size(); ++k)
      lengths[line.kind] += glm::length(place(line.points[k + 1]) - place(line.points[k]));
    if (line.kind == StrokeKind::kCrease) {
      EXPECT_EQ(line.object, 4);
    }
  }
  EXPECT_GT(lengths[StrokeKind::kOutline], 400.0);
  EXPECT_GT(lengths[StrokeKind::kCrease], 200.0);
}

}  // namespace
}  // namespace umbrage
