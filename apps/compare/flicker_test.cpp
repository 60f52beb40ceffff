// Tests of the flicker of sequences: motions and noise whose flicker is known in closed form, the sequences of
// `umbrage compare --sequence`, and their recorded scores.
#include "apps/compare/flicker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <random>

#include "apps/compare/report.h"
#include "build_paths.h"
#include "renderer/devices.h"
#include "run_program.h"

namespace umbrage {
namespace {

constexpr int kSide = 96;
const auto kAsItIs = [](float value) { return value; };

/// Returns what a parallel camera sees of a plane that faces it, `shift` pixels to the right of the first frame.
FrameSurfaces plane_before(float shift, float depth = 2.0f) {
  FrameSurfaces frame;
  PictureInfo& info = frame.gbuffer.info;
  info.width = info.height = kSide;
  info.camera.projection = Projection::kOrthographic;
  info.camera.view_from_world = glm::translate(glm::mat4(1.0f), {-shift * info.pixel_width(), 0.0f, 0.0f});
  Image planes(kSide, kSide);
  for (const auto& [name, value] :
       {std::pair("depth", depth), {"normal.x", 0.0f}, {"normal.y", 0.0f}, {"normal.z", 1.0f}, {"object_id", 3.0f}})
    planes.add(name) = Plane(kSide, kSide, value);
  frame.gbuffer.layers.push_back(std::move(planes));
  return frame;
}

Image ao_of(const std::function<float(int, int)>& value) {
  Image image(kSide, kSide);
  Plane& plane = image.add("ao") = Plane(kSide, kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) plane.at(x, y) = value(x, y);
  return image;
}

SequencePlanes constant(std::size_t frames, float value = 0.5f) {
  return SequencePlanes(frames, ao_of([=](int, int) { return value; }));
}

/// Measures frames of planes whose truth is constant.
Flicker measured(const std::vector<FrameSurfaces>& surfaces, const SequencePlanes& frames, Plane* map = nullptr) {
  const SequencePlanes truth = constant(frames.size());
  return measure_flicker(Warps(surfaces), frames, {truth, truth}, surfaces, kAsItIs, map);
}

/// Returns frames of independent noise of this standard deviation.
SequencePlanes noisy(std::size_t frames, float deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0.5f, deviation);
  SequencePlanes planes;
  for (std::size_t k = 0; k < frames; ++k) planes.push_back(ao_of([&](int, int) { return noise(random); }));
  return planes;
}

TEST(Flicker, AConstantPlaneHasNone) {
  std::vector<FrameSurfaces> surfaces;
  for (const float shift : {0.0f, 1.3f, 2.9f, 4.0f}) surfaces.push_back(plane_before(shift));
  const Flicker flicker = measured(surfaces, constant(4));
  EXPECT_GT(flicker.pixels, 3 * (kSide - 3) * (kSide - 1) - 1);
  EXPECT_NEAR(flicker.next, 0.0, 1e-6);
  EXPECT_NEAR(flicker.far, 0.0, 1e-6);
  EXPECT_NEAR(flicker.own, 0.0, 1e-6);
  EXPECT_NEAR(flicker.error, 0.0, 1e-6);
  EXPECT_NEAR(flicker.flip, 0.0, 1e-3);
}

TEST(Flicker, APanByWholePixelsMapsPixelsExactly) {
  const std::vector<FrameSurfaces> surfaces = {plane_before(0.0f), plane_before(5.0f)};
  const Warp warp(surfaces[0], surfaces[1]);
  const Image image = ao_of([](int x, int y) { return float((7 * x + 13 * y) % 31) / 31.0f; });
  const Plane warped = warp.warped(image.planes[0]);
  int seen = 0;
  for (int y = 1; y < kSide - 1; ++y)
    for (int x = 0; x < kSide; ++x) {
      if (warp.seen().row(y)[x] == PixelClass::kBackground) continue;
      ++seen;
      ASSERT_NEAR(warped.at(x, y), image.planes[0].at(x + 5, y), 1e-4) << x << " " << y;
    }
  EXPECT_NEAR(seen, (kSide - 5) * (kSide - 2), kSide) << "only what enters the picture is not seen in both";
}

TEST(Flicker, NoiseHasThatOfItsVariance) {
  constexpr float kDeviation = 0.05f;
  // At rest and moved by whole pixels: the difference of two independent values. Moved by half a pixel: one of them is
  // the mean of two.
  for (const auto& [shift, factor] :
       {std::pair(0.0f, std::sqrt(2.0)), {4.0f, std::sqrt(2.0)}, {0.5f, std::sqrt(1.5)}}) {
    std::vector<FrameSurfaces> surfaces;
    for (int k = 0; k < 5; ++k) surfaces.push_back(plane_before(shift * float(k)));
    Plane map;
    const Flicker flicker = measured(surfaces, noisy(5, kDeviation, 1), &map);
    EXPECT_NEAR(flicker.next, factor * kDeviation, 0.02 * factor * kDeviation) << shift;
    EXPECT_NEAR(flicker.own, flicker.next, 1e-9) << "the truth does not change";
    EXPECT_NEAR(flicker.error, kDeviation, 0.02 * kDeviation);
    constexpr double kNormal99 = 2.5758;  // of a normal distribution, two-sided
    EXPECT_NEAR(flicker.open_p99, kNormal99 * factor * kDeviation, 0.05 * factor * kDeviation);
    EXPECT_NEAR(flicker.open_rms, flicker.next, 0.03 * flicker.next);
    double squares = 0.0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) squares += double(map.at(x, y)) * map.at(x, y);
    EXPECT_NEAR(squares, flicker.next * flicker.next * double(flicker.pixels) / 4.0, 1e-3 * squares);
  }
}

TEST(Flicker, NoiseOfTheTruthCancels) {
  const std::vector<FrameSurfaces> surfaces(6, plane_before(0.0f));
  const SequencePlanes frames = constant(6);
  const Flicker flicker =
      measure_flicker(Warps(surfaces), frames, {noisy(6, 0.1f, 1), noisy(6, 0.1f, 2)}, surfaces, kAsItIs, nullptr);
  EXPECT_EQ(flicker.next, 0.0);
  EXPECT_LT(flicker.truth_next, 0.02) << "of .14 in each half";
  // Products of independent changes of variance 2 s^2 have that standard deviation.
  const double expected = std::sqrt(2.0 * 0.1 * 0.1 / std::sqrt(double(flicker.pixels)));
  EXPECT_NEAR(flicker.truth_noise, expected, 0.05 * expected);
  EXPECT_LT(flicker.own, 0.02);
  EXPECT_LT(flicker.error, 0.02);
}

TEST(Flicker, ChangesAddUpOverFrames) {
  // Each frame is .01 brighter than the one before, and the truth .004.
  const std::vector<FrameSurfaces> surfaces(5, plane_before(0.0f));
  SequencePlanes frames, truth;
  for (int k = 0; k < 5; ++k) {
    frames.push_back(constant(1, 0.5f + 0.01f * float(k))[0]);
    truth.push_back(constant(1, 0.5f + 0.004f * float(k))[0]);
  }
  const Flicker flicker = measure_flicker(Warps(surfaces), frames, {truth, truth}, surfaces, kAsItIs, nullptr);
  EXPECT_NEAR(flicker.next, 0.01, 1e-6);
  EXPECT_NEAR(flicker.far, 0.03, 1e-6);
  EXPECT_NEAR(flicker.truth_next, 0.004, 1e-6);
  EXPECT_NEAR(flicker.truth_far, 0.012, 1e-6);
  EXPECT_NEAR(flicker.own, 0.006, 1e-6);
  EXPECT_NEAR(flicker.ratio(), 2.5, 1e-3);
  EXPECT_GT(flicker.flip, flicker.truth_flip);
  EXPECT_GT(flicker.truth_flip, 0.0);
}

TEST(Flicker, WhatIsHiddenInOneFrameDoesNotCount) {
  FrameSurfaces before = plane_before(0.0f), after = plane_before(0.0f);
  // A column of another surface, another normal, and another object, in the first frame only.
  for (int y = 0; y < kSide; ++y) {
    before.gbuffer.layers[0].plane("depth").at(20, y) = 1.0f;
    before.gbuffer.layers[0].plane("normal.x").at(40, y) = 0.8f;
    before.gbuffer.layers[0].plane("normal.z").at(40, y) = 0.6f;
    before.gbuffer.layers[0].plane("object_id").at(60, y) = 4.0f;
  }
  const Warp warp(before, after);
  for (int x = 1; x < kSide - 1; ++x)
    EXPECT_EQ(warp.seen().row(kSide / 2)[x] == PixelClass::kBackground, x == 20 || x == 40 || x == 60) << x;
}

TEST(Flicker, AMovingObjectIsFollowed) {
  // Object 4 covers a square that moves by 6 pixels to the right; the plane behind it stands still.
  const auto frame = [](int offset) {
    FrameSurfaces surfaces = plane_before(0.0f);
    Image& planes = surfaces.gbuffer.layers[0];
    for (int y = 30; y < 60; ++y)
      for (int x = 30 + offset; x < 60 + offset; ++x)
        planes.plane("depth").at(x, y) = 1.0f, planes.plane("object_id").at(x, y) = 4.0f;
    surfaces.moving_object = 4;
    const double pixel = surfaces.gbuffer.info.pixel_width();
    surfaces.object_pose = glm::translate(glm::dmat4(1.0), {pixel * offset, 0.0, 0.0});
    return surfaces;
  };
  const std::vector<FrameSurfaces> surfaces = {frame(0), frame(6)};
  const auto image = [](int offset) {  // a pattern on the square, another one on the plane
    return ao_of([=](int x, int y) {
      const bool on = y >= 30 && y < 60 && x >= 30 + offset && x < 60 + offset;
      return on ? float((x - offset) % 5) / 5.0f : float(x % 7) / 7.0f;
    });
  };
  EXPECT_NEAR(measured(surfaces, {image(0), image(6)}).next, 0.0, 1e-4);
  std::vector<FrameSurfaces> still = surfaces;
  for (FrameSurfaces& each : still) each.moving_object = -1;
  EXPECT_GT(measured(still, {image(0), image(6)}).next, 0.1);
}

// ---- Sequences of scenes ----

SequenceSettings small_settings() {
  SequenceSettings settings;
  settings.models = {"scene:solids?detail=7000"};
  settings.sizes = {{96, 96}};
  settings.samples = 16;
  settings.looks = {"ao"};
  return settings;
}

SequenceComparison compared(const SequenceSettings& settings) {
  const auto device = make_device("cpu", 0);
  auto result = compare_sequences(**device, settings);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

TEST(Sequences, EveryMotionIsMeasured) {
  SequenceSettings settings = small_settings();
  settings.looks = {"studio"};
  const SequenceComparison comparison = compared(settings);
  for (const std::string_view motion : motion_names())
    for (const char* plane : {"ao", "shadow", "indirect", "color"})
      for (const int reach : {0, 3}) {
        const auto row = std::find_if(comparison.rows.begin(), comparison.rows.end(), [&](const FlickerRow& each) {
          return each.motion == motion && each.quantity == plane && each.reach == reach;
        });
        ASSERT_NE(row, comparison.rows.end()) << motion << " " << plane << " " << reach;
        EXPECT_GT(row->flicker.pixels, 3 * 2000) << motion;
        EXPECT_TRUE(std::isfinite(row->flicker.far));
        EXPECT_EQ(row->strip.width, 4 * 96);
        EXPECT_EQ(row->map.width, 96);
        const bool changes = motion != "light" || std::string(plane) != "ao" || reach > 0;
        EXPECT_EQ(row->flicker.next > 0.0, changes) << motion << " " << plane;
      }
}

TEST(Sequences, SteadyFramesFlickerLessAndAreCloserToTheTruth) {
  SequenceSettings settings = small_settings();
  settings.motions = {"turntable", "pan"};
  const SequenceComparison comparison = compared(settings);
  int compared_rows = 0;
  for (const FlickerRow& single : comparison.rows)
    for (const FlickerRow& steady : comparison.rows) {
      if (single.reach != 0 || steady.reach == 0 || single.motion != steady.motion ||
          single.quantity != steady.quantity)
        continue;
      ++compared_rows;
      EXPECT_LT(steady.flicker.next, 0.8 * single.flicker.next) << single.motion << " " << single.quantity;
      EXPECT_LT(steady.flicker.error, single.flicker.error) << single.motion << " " << single.quantity;
      EXPECT_EQ(steady.flicker.truth_next, single.flicker.truth_next);
    }
  EXPECT_EQ(compared_rows, 4);
}

// tests/sequence_scores.json is a copy of the scores.json of
//   umbrage compare "scene:solids?detail=7000" --sequence --look studio --motion turntable,pan,object
//     --resolution 128 --samples 4 -o FOLDER
TEST(RecordedScores, NoSequenceFlickersMore) {
  const std::string recorded = std::string(test::kSourceFolder) + "/tests/sequence_scores.json";
  const auto baseline = read_baseline(recorded);
  ASSERT_TRUE(baseline) << baseline.error().message;
  SequenceSettings settings = small_settings();
  settings.looks = {"studio"};
  settings.motions = {"turntable", "pan", "object"};
  settings.sizes = {{128, 128}};
  settings.samples = 4;
  settings.pictures = false;
  const SequenceComparison comparison = compared(settings);
  const auto same = check_terms(*baseline, terms_of(settings), recorded);
  ASSERT_TRUE(same) << same.error().message;
  const auto check = check_baseline(*baseline, scores_json(comparison), recorded);
  ASSERT_TRUE(check) << check.error().message;
  for (const std::string& sentence : check->worse) ADD_FAILURE() << sentence;
  for (const std::string& sentence : check->better)
    ADD_FAILURE() << sentence << "\nIt is better: record the scores again, so that it does not get worse unnoticed.";
  EXPECT_EQ(check->missing, 0);
  EXPECT_EQ(check->compared, int(comparison.rows.size()));
}

// ---- The command ----

class SequencesCli : public test::ProgramTest {};

const std::string kQuick = "compare scene:solids?detail=7000 --sequence --resolution 48 --samples 2 --look ao ";

TEST_F(SequencesCli, WritesPageAndScoresAndHoldsABaseline) {
  const auto outcome = good(kQuick + "--motion pan,turntable -o one");
  for (const char* word : {"flicker, 48x48", "turntable", "pan", "color"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
  EXPECT_NE(test::text_of(folder_ / "one/index.html").find("truth_strip"), std::string::npos);
  auto scores = nlohmann::json::parse(test::text_of(folder_ / "one/scores.json"));
  ASSERT_EQ(scores.size(), 8u);
  good(kQuick + "--motion pan,turntable -o two --baseline one/scores.json");
  scores[0]["flicker"] = 0.5 * scores[0]["flicker"].get<double>();
  test::ProgramTest::write("better.json", scores.dump());
  const auto worse = run(kQuick + "--motion pan,turntable -o two --baseline better.json");
  EXPECT_EQ(worse.code, 1);
  EXPECT_NE(worse.err.find("flicker was"), std::string::npos) << worse.err;
}

TEST_F(SequencesCli, BadInputGetsASentence) {
  bad(kQuick + "--motion pann -o r", 2, {"pann", "pan"});
  bad("compare scene:solids --sequence --look aoo -o r", 2, {"aoo", "ao"});
  bad(kQuick + "--ao reference -o r", 2, {"--ao", "reference", "truth"});
  bad(kQuick + "--light -o r", 2, {"--sequence", "--light"});
  bad(kQuick + "--filter none -o r", 2, {"--sequence", "--filter"});
  bad("compare scene:solids --motion pan -o r", 2, {"--motion", "--sequence"});
  bad("compare -o r", 2, {"MODEL"});
}

}  // namespace
}  // namespace umbrage
