// Tests of `umbrage compare`: scores, page, baseline, invalid input, and the recorded scores of every technique.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/compare/compare_support.h"
#include "apps/compare/report.h"
#include "faulty_vulkan.h"
#include "generators/builtin.h"
#include "looks/presets.h"
#include "reference/reference.h"
#include "renderer/devices.h"
#include "run_program.h"
#include "vulkan_support.h"

namespace umbrage {
namespace {

using test::compared;
using test::solids_settings;

namespace fs = std::filesystem;

// ---- Recorded scores ----

// The scores in tests/scores.json are a copy of the scores.json of
//   umbrage compare $(models) --ao all --filter none --resolution 240,135 --cameras 1 --samples 64 --runs 1 -o FOLDER
// with the models below. Record them again when a technique improves.
std::vector<std::string> recorded_models() {
  std::vector<std::string> models;
  for (const BuiltinScene& scene : builtin_scenes()) models.push_back(fmt::format("scene:{}?detail=20000", scene.name));
  models.push_back("/usr/share/glmark2/models/bunny.obj");
  return models;
}

void expect_none_worse(const char* file, CompareSettings settings) {
  const fs::path recorded = fs::path(test::kSourceFolder) / "tests" / file;
  const auto baseline = read_baseline(recorded);
  ASSERT_TRUE(baseline) << baseline.error().message;
  auto device = make_device("cpu", 0);
  ASSERT_TRUE(device);
  settings.sizes = {{240, 135}};
  settings.cameras = 1;
  settings.samples = 64;
  settings.runs = 1;
  settings.filter = kNoFilter;
  settings.pictures = false;
  const auto comparison = compare(**device, settings);
  ASSERT_TRUE(comparison) << comparison.error().message;
  const auto same = check_terms(*baseline, terms_of(settings), recorded.string());
  ASSERT_TRUE(same) << same.error().message;
  const auto check = check_baseline(*baseline, scores_json(*comparison), recorded.string());
  ASSERT_TRUE(check) << check.error().message;
  for (const std::string& sentence : check->worse) ADD_FAILURE() << sentence;
  for (const std::string& sentence : check->better)
    ADD_FAILURE() << sentence << "\nIt is better: record the scores again, so that it does not get worse unnoticed.";
  EXPECT_EQ(check->missing, 0) << "scores are recorded of a technique, variant or scene that no longer exists";
  EXPECT_EQ(check->compared, int(comparison->scores.size()))
      << "a technique, variant or scene has no recorded score: record them as described at the top of this file";
}

TEST(RecordedScores, NoTechniqueGotWorse) {
  CompareSettings settings;
  settings.models = recorded_models();
  expect_none_worse("scores.json", settings);
}

// The scores of light in tests/light_scores.json are a copy of the scores.json of
//   umbrage compare "scene:atrium?detail=20000" "scene:solids?detail=20000" --ao hemisphere,ssdo,bitmask,traced
//     --light --layers 2 --filter none --resolution 240,135 --cameras 1 --samples 64 --runs 1 -o FOLDER
TEST(RecordedScores, NoLightGotWorse) {
  CompareSettings settings;
  settings.models = {"scene:atrium?detail=20000", "scene:solids?detail=20000"};
  settings.techniques = {"hemisphere", "ssdo", "bitmask", "traced"};
  settings.light = true;
  settings.draw.layers = 2;
  expect_none_worse("light_scores.json", settings);
}

// ---- Scores and baseline ----

/// Returns a comparison of a small scene at two sizes, shared by several tests.
const Comparison& small_comparison() {
  static const Comparison comparison = [] {
    CompareSettings settings = solids_settings(7000, {96, 64}, 16);
    settings.sizes.push_back({48, 32});
    settings.cameras = 2;
    return compared(settings);
  }();
  return comparison;
}

TEST(Compare, EveryTechniqueInEveryVariantAtEverySizeAndCamera) {
  const Comparison& comparison = small_comparison();
  std::size_t variants = 0;
  for (const Effect* effect : effects_with_external())
    if (effect->kind == EffectKind::kOcclusion) {
      EXPECT_FALSE(effect->variants.empty()) << effect->name;
      EXPECT_EQ(std::count(effect->variants.begin(), effect->variants.end(), ""), 1) << effect->name;
      variants += effect->variants.size();
    }
  EXPECT_EQ(comparison.scores.size(), variants * 2 * 2);
  ASSERT_EQ(comparison.views.size(), 2u);
  for (const ComparedView& view : comparison.views) {
    EXPECT_EQ(view.techniques.size(), variants);
    EXPECT_EQ(view.truth.width, 96);
    EXPECT_EQ(view.classes.width, 96);
  }
  EXPECT_NE(comparison.views[0].camera, comparison.views[1].camera);
}

TEST(Compare, MoreRaysComeCloserToTheTruth) {
  std::map<std::string, double> rmse;
  for (const Score& score : small_comparison().scores)
    if (score.technique == "reference" && score.width == 96 && score.camera == "1")
      rmse[score.setting] = score.card.covered.rmse;
  EXPECT_GT(rmse["samples=1"], 1.5 * rmse["samples=4"]);
  EXPECT_GT(rmse["samples=4"], 1.5 * rmse["samples=16"]);
  EXPECT_GT(rmse["samples=16"], rmse[""]);
  EXPECT_GT(rmse[""], 0.0) << "the technique must not use the rays of the ground truth";
}

TEST(Compare, TheNoiseOfTheGroundTruthIsKnown) {
  // The RMSE is the root of the sum of the variances of technique and ground truth, which includes the latter's noise.
  const Comparison& comparison = small_comparison();
  EXPECT_GT(comparison.noise, 0.005);
  EXPECT_LT(comparison.noise, 0.1);
  for (const Score& score : comparison.scores)
    if (score.technique == "reference" && score.setting.empty()) {
      EXPECT_LT(score.card.covered.rmse, 2.0 * comparison.noise);
      EXPECT_GT(score.card.covered.rmse, 0.7 * comparison.noise);
    }
}

TEST(Compare, RecordsHoldWhatTheyPromise) {
  const nlohmann::json scores = scores_json(small_comparison());
  ASSERT_EQ(scores.size(), small_comparison().scores.size());
  for (const nlohmann::json& record : scores) {
    for (const char* text : {"scene", "camera", "technique", "setting", "device", "radius", "falloff", "normal"})
      EXPECT_TRUE(record.at(text).is_string()) << text;
    for (const char* number : {"width", "height", "ms", "rmse", "bias", "psnr", "ssim", "p99", "flip", "format"})
      EXPECT_TRUE(record.at(number).is_number()) << number;
    EXPECT_NEAR(record.at("psnr").get<double>(), -20.0 * std::log10(record.at("rmse").get<double>()), 1e-6);
    long pixels = 0;
    for (const std::string_view name : kPixelClassNames)
      pixels += record.at(fmt::format("pixels_{}", name)).get<long>();
    EXPECT_EQ(record.at("pixels").get<long>(), pixels);
  }
  const nlohmann::json read_again = nlohmann::json::parse(scores_text(scores));
  EXPECT_EQ(read_again, scores);
}

TEST(Compare, BaselineNoticesEachScoreThatGotWorse) {
  const nlohmann::json scores = scores_json(small_comparison());
  auto same = check_baseline(scores, scores, "b");
  ASSERT_TRUE(same);
  EXPECT_TRUE(same->worse.empty() && same->better.empty());
  EXPECT_EQ(same->compared, int(scores.size()));
  EXPECT_EQ(same->missing, 0);
  for (const auto& [field, change] : {std::pair{"rmse", 0.02}, {"flip", 0.02}, {"p99", 0.02}, {"ssim", -0.02}}) {
    nlohmann::json worse = scores, better = scores;
    worse[3][field] = worse[3][field].get<double>() + change;
    better[3][field] = better[3][field].get<double>() - change;
    const auto found = check_baseline(scores, worse, "b");
    ASSERT_TRUE(found);
    ASSERT_EQ(found->worse.size(), 1u) << field;
    EXPECT_NE(found->worse[0].find(field), std::string::npos) << found->worse[0];
    EXPECT_NE(found->worse[0].find("scene:solids"), std::string::npos);
    EXPECT_TRUE(found->better.empty()) << field;
    const auto improved = check_baseline(scores, better, "b");
    ASSERT_TRUE(improved);
    EXPECT_TRUE(improved->worse.empty()) << field;
    ASSERT_EQ(improved->better.size(), 1u) << field;
    EXPECT_NE(improved->better[0].find(field), std::string::npos) << improved->better[0];
  }
  nlohmann::json darker = scores;
  darker[0]["bias"] = -0.5;
  EXPECT_EQ(check_baseline(scores, darker, "b")->worse.size(), 1u);
}

TEST(Compare, BaselineOfSomethingElseIsAnError) {
  const nlohmann::json scores = scores_json(small_comparison());
  const Terms& terms = small_comparison().terms;
  EXPECT_TRUE(check_terms(scores, terms, "old.json"));
  const nlohmann::json other = {{"samples", 512},
                                {"radius", "11%"},
                                {"falloff", "smooth"},
                                {"normal", "shading"},
                                {"settings", "unsharp.kernel=3"},
                                {"guard", "10%"},
                                {"layers", 2},
                                {"extra_views", 1},
                                {"scale", "half"},
                                {"filter", "denoise"}};
  for (const auto& [field, value] : other.items()) {
    nlohmann::json other_terms = scores;
    for (auto& record : other_terms) record[field] = value;
    const auto wrong = check_terms(other_terms, terms, "old.json");
    ASSERT_FALSE(wrong) << field;
    EXPECT_EQ(wrong.error().kind, ErrorKind::kFile);
    EXPECT_NE(wrong.error().message.find(field + " " + value.dump()), std::string::npos) << wrong.error().message;
  }
  // Scores of one layer have no field `layers`.
  Terms deep = terms;
  deep.layers = 2;
  const auto shallow = check_terms(scores, deep, "old.json");
  ASSERT_FALSE(shallow);
  EXPECT_NE(shallow.error().message.find("layers 1, now 2"), std::string::npos) << shallow.error().message;
  nlohmann::json other_view = scores;
  for (auto& record : other_view) record["view"] = "perspective 1 2 3";
  const auto elsewhere = check_baseline(other_view, scores, "old.json");
  ASSERT_FALSE(elsewhere);
  EXPECT_EQ(elsewhere.error().kind, ErrorKind::kFile);
  nlohmann::json other_scene = scores;
  for (auto& record : other_scene) record["scene"] = "scene:moon";
  EXPECT_FALSE(check_baseline(other_scene, scores, "old.json"));
  nlohmann::json one_more = scores;
  one_more.push_back(other_scene[0]);
  EXPECT_EQ(check_baseline(one_more, scores, "old.json")->missing, 1);
}

TEST(Compare, ReturnsWhatGoesWrongOnTheDevice) {
  UMBRAGE_NEEDS_VULKAN(test::start_faulty());
  const auto device = test::new_vulkan_device({.get = test::faulty_get});
  UMBRAGE_NEEDS_VULKAN(device);
  test::faulty().faults.submit = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  const auto failed = compare(*device, solids_settings(2000, {32, 24}, 2));
  test::faulty().faults.submit = VK_SUCCESS;
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().kind, ErrorKind::kDevice);
}

TEST(Compare, TheProgressCanEndTheWork) {
  auto device = make_device("cpu", 0);
  CompareSettings settings;
  settings.models = {"scene:solids?detail=7000"};
  settings.sizes = {{64, 64}};
  int reported = 0;
  settings.progress = [&](const std::string&, double) { return ++reported < 5; };
  const auto ended = compare(**device, settings);
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::kInterrupted);
}

TEST(Compare, EachQualityComesCloserToTheTruth) {
  auto device = make_device("cpu", 0);
  CompareSettings settings = solids_settings(20000, {256, 192}, 64);
  settings.techniques = {"bitmask"};
  settings.filter = "denoise";
  double before = 1.0;
  for (const Quality& quality : qualities()) {
    settings.draw.quality = quality.name;
    const auto comparison = compare(**device, settings);
    ASSERT_TRUE(comparison) << comparison.error().message;
    const auto& scores = comparison->scores;
    const auto default_score =
        std::find_if(scores.begin(), scores.end(), [](const Score& s) { return s.setting.empty(); });
    ASSERT_NE(default_score, scores.end());
    EXPECT_LT(default_score->card.covered.rmse, before) << quality.name;
    before = default_score->card.covered.rmse;
  }
  settings.draw.quality = "best";
  const auto refused = compare(**device, settings);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  EXPECT_NE(refused.error().message.find("draft, normal, high, ultra"), std::string::npos) << refused.error().message;
}

TEST(Compare, GuardBandIsCutOffBeforeScoring) {
  auto device = make_device("cpu", 0);
  CompareSettings settings = solids_settings(7000, {64, 48}, 16);
  settings.draw.camera.zoom = 3.0f;  // surfaces fill the picture
  const auto without = compare(**device, settings);
  settings.draw.guard_band = 25.0f;
  const auto with = compare(**device, settings);
  ASSERT_TRUE(without && with);
  EXPECT_EQ(with->views[0].truth.width, 64);
  EXPECT_EQ(with->views[0].truth.height, 48);
  // Both score the same surface pixels.
  EXPECT_EQ(with->scores[0].card.covered.pixels, without->scores[0].card.covered.pixels);
  // The ground truth is the same except where rounding moves a silhouette. Kernel windows at the border cover more
  // pixels.
  long different = 0;
  const Plane &a = with->views[0].truth.plane("ao"), &b = without->views[0].truth.plane("ao");
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) different += a.at(x, y) != b.at(x, y);
  EXPECT_LT(different, a.width * a.height / 100);
  int changed = 0;
  for (std::size_t k = 0; k < with->scores.size(); ++k)
    changed += with->scores[k].technique == "unsharp" &&
               std::abs(with->scores[k].card.covered.rmse - without->scores[k].card.covered.rmse) > 1e-4;
  EXPECT_GT(changed, 0);
}

/// Returns a comparison of light of one small picture, shared by several tests.
const Comparison& light_comparison() {
  static const Comparison comparison = [] {
    CompareSettings settings = solids_settings(7000, {96, 64}, 64);
    settings.techniques = {"unsharp", "hemisphere", "reference"};
    settings.light = true;
    return compared(settings);
  }();
  return comparison;
}

TEST(Compare, LightIsScoredForTechniquesThatGatherIt) {
  const Comparison& comparison = light_comparison();
  std::map<std::string, ScoreCard> light;
  std::size_t occlusion = 0;
  for (const Score& score : comparison.scores)
    if (score.quantity == Quantity::kLight)
      light[score.technique + " " + score.setting] = score.card;
    else if (score.quantity == Quantity::kOcclusion)
      ++occlusion;
  std::size_t variants = 0, bleeding = 0;
  for (const char* name : {"unsharp", "hemisphere", "reference"})
    for (const Effect* effect : effects_with_external())
      if (effect->name == name)
        for (const std::string_view variant : effect->variants) {
          ++variants;
          bleeding += effect == &reference_effect() || variant.find("bleeding") != std::string_view::npos;
        }
  EXPECT_EQ(occlusion, variants);
  EXPECT_EQ(light.size(), bleeding);
  // Under each environment, the other variants are scored, but not the reference.
  const auto of_sky = std::count_if(comparison.scores.begin(), comparison.scores.end(),
                                    [](const Score& score) { return score.quantity == Quantity::kSunset; });
  EXPECT_EQ(std::size_t(of_sky), variants - bleeding);
  EXPECT_GT(bleeding, 5u);
  // With more rays, the reference comes closer, without bias.
  EXPECT_GT(light["reference samples=1"].covered.rmse, 1.5 * light["reference samples=4"].covered.rmse);
  EXPECT_GT(light["reference samples=4"].covered.rmse, 1.3 * light["reference samples=16"].covered.rmse);
  EXPECT_GT(light["reference samples=16"].covered.rmse, light["reference "].covered.rmse);
  EXPECT_LT(std::abs(light["reference "].covered.bias), 0.03);
  EXPECT_LT(light["reference "].covered.rmse, 2.0 * comparison.light_noise);
  EXPECT_GT(light["reference "].covered.rmse, 0.7 * comparison.light_noise);
  // The gathered light is closer to the ground truth than no light, which has a bias of -1.
  const ScoreCard& gathered = light["hemisphere samples=64 bleeding=1"];
  EXPECT_LT(std::abs(gathered.covered.bias), 0.5);
  EXPECT_GT(gathered.covered.rmse, 3.0 * light["reference "].covered.rmse);
}

TEST(Compare, OcclusionIsTheSameBesideLight) {
  auto device = make_device("cpu", 0);
  CompareSettings settings = solids_settings(7000, {96, 64}, 64);
  settings.techniques = {"hemisphere"};
  const auto alone = compare(**device, settings);
  ASSERT_TRUE(alone);
  std::size_t found = 0;
  for (const Score& score : alone->scores)
    for (const Score& other : light_comparison().scores)
      if (other.quantity == Quantity::kOcclusion && other.technique == score.technique &&
          other.setting == score.setting) {
        EXPECT_EQ(score.card.covered.rmse, other.card.covered.rmse) << score.setting;
        ++found;
      }
  EXPECT_EQ(found, alone->scores.size());
}

TEST(Compare, LightHasItsOwnRecordsAndPictures) {
  const Comparison& comparison = light_comparison();
  ASSERT_EQ(comparison.views.size(), std::size_t(kQuantities));
  for (int q = 0; q < kQuantities; ++q) EXPECT_EQ(comparison.views[std::size_t(q)].quantity, Quantity(q));
  const ComparedView& view = comparison.views[1];
  EXPECT_EQ(view.truth.planes.size(), 3u);
  EXPECT_NEAR(view.exposure * mean_of(view.truth, view.classes), kMiddleGrey, 1e-6);
  const nlohmann::json scores = scores_json(comparison);
  nlohmann::json worse = scores;
  std::size_t of_light = 0;
  for (auto& record : worse)
    if (record.at("quantity") == "light") {
      ++of_light;
      record["rmse"] = record["rmse"].get<double>() * 1.1;
    }
  const auto found = check_baseline(scores, worse, "b");
  ASSERT_TRUE(found);
  ASSERT_GT(of_light, 0u);
  ASSERT_EQ(found->worse.size(), of_light);
  EXPECT_NE(found->worse[0].find("light's rmse"), std::string::npos) << found->worse[0];
  // Records of earlier versions have no field `quantity`; they score occlusion.
  nlohmann::json old = nlohmann::json::array();
  for (nlohmann::json record : scores)
    if (record.at("quantity") == "occlusion") {
      record.erase("quantity");
      old.push_back(record);
    }
  const auto with_old = check_baseline(old, scores, "old");
  ASSERT_TRUE(with_old);
  EXPECT_EQ(with_old->compared, int(old.size()));
  EXPECT_EQ(with_old->missing, 0);
  EXPECT_TRUE(with_old->worse.empty());
}

TEST(Compare, PicturesWithoutLightHaveNoLightScore) {
  // A single square receives no indirect light.
  const auto folder = fs::temp_directory_path() / fmt::format("umbrage_flat_{}", ::getpid());
  fs::create_directories(folder);
  std::ofstream(folder / "flat.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  auto device = make_device("cpu", 0);
  CompareSettings settings;
  settings.models = {(folder / "flat.obj").string()};
  settings.sizes = {{32, 32}};
  settings.techniques = {"hemisphere"};
  settings.cameras = 1;
  settings.samples = 16;
  settings.runs = 1;
  settings.light = true;
  const auto result = compare(**device, settings);
  fs::remove_all(folder);
  ASSERT_TRUE(result) << result.error().message;
  for (const Score& score : result->scores) EXPECT_NE(score.quantity, Quantity::kLight);
  EXPECT_EQ(result->views.size(), std::size_t(kQuantities - 1));
  ASSERT_EQ(result->warnings.size(), 1u);
  EXPECT_NE(result->warnings[0].find("light is not compared"), std::string::npos) << result->warnings[0];
}

TEST(Compare, FiltersAndScaleChangeWhatTheySay) {
  auto device = make_device("cpu", 0);
  CompareSettings settings;
  settings.models = {"scene:solids?detail=7000"};
  settings.sizes = {{192, 128}};
  settings.techniques = {"hemisphere", "reference"};
  settings.cameras = 1;
  settings.samples = 64;
  settings.runs = 1;
  settings.light = true;
  const auto rows_of = [&] {
    std::map<std::string, double> rows;
    const auto result = compare(**device, settings);
    EXPECT_TRUE(result) << result.error().message;
    for (const Score& score : result->scores)
      rows[fmt::format("{} {} {}", kQuantityNames[int(score.quantity)], score.technique, score.setting)] =
          score.card.covered.rmse;
    return rows;
  };
  settings.filter = kNoFilter;
  auto plain = rows_of();
  settings.filter = "denoise";
  auto filtered = rows_of();
  settings.filter.clear();
  EXPECT_EQ(rows_of(), filtered) << "by default, the filter is that of the look";
  EXPECT_EQ(terms_of(settings).filter, "denoise");
  settings.filter = kNoFilter;
  EXPECT_EQ(terms_of(settings).filter, "");
  settings.draw.occlusion_scale = "quarter";
  auto quarter = rows_of();
  for (const char* row : {"occlusion hemisphere samples=8", "light hemisphere samples=32 bleeding=1"}) {
    EXPECT_LT(filtered[row], 0.95 * plain[row]) << row;
    EXPECT_GT(std::abs(quarter[row] - plain[row]), 0.01 * plain[row]) << row;
  }
  // The reference is neither filtered nor run at reduced resolution.
  for (const char* row : {"occlusion reference samples=1", "light reference samples=1"}) {
    EXPECT_EQ(filtered[row], plain[row]) << row;
    EXPECT_EQ(quarter[row], plain[row]) << row;
  }
}

TEST(Compare, PageIsSelfContained) {
  auto device = make_device("cpu", 0);
  const auto page = report_page(small_comparison(), "umbrage compare </script><!-- \xff", **device);
  ASSERT_TRUE(page);
  EXPECT_EQ(page->find("/*UMBRAGE-DATA*/"), std::string::npos);
  std::string text = *page;
  const std::string svg = "http://www.w3.org/";  // names of namespaces, never fetched
  for (std::size_t at = text.find(svg); at != std::string::npos; at = text.find(svg)) text.erase(at, svg.size());
  for (const char* outside : {"http://", "https://", "src=\"//", "@import", "url(http"})
    EXPECT_EQ(text.find(outside), std::string::npos) << outside;
  const std::string_view opening = "<script type=\"application/json\" id=\"data\">";
  const std::size_t start = page->find(opening) + opening.size(), end = page->find("</script>", start);
  const nlohmann::json data = nlohmann::json::parse(page->substr(start, end - start), nullptr, false);
  ASSERT_FALSE(data.is_discarded());
  EXPECT_EQ(data.at("scores").size(), small_comparison().scores.size());
  EXPECT_EQ(data.at("views").size(), 2u);
  EXPECT_NE(data.at("command").get<std::string>().find("</script><!--"), std::string::npos);
  const std::string url = data.at("views")[0].at("truth");
  EXPECT_EQ(url.rfind("data:image/png;base64,iVBORw0KGgo", 0), 0u) << url.substr(0, 40);
}

// ---- The command ----

class CompareCli : public test::ProgramTest {};

const std::string kQuick = "compare tri.obj --resolution 48,48 --samples 4 --runs 1 --cameras 1";

TEST_F(CompareCli, WritesPageAndScores) {
  const auto outcome = good(kQuick + " -o deep/report");
  EXPECT_NE(outcome.out.find("unsharp"), std::string::npos);
  EXPECT_NE(outcome.out.find("truth: mean"), std::string::npos);
  const auto scores = nlohmann::json::parse(test::text_of(folder_ / "deep/report/scores.json"));
  EXPECT_GT(scores.size(), 5u);
  EXPECT_NE(test::text_of(folder_ / "deep/report/index.html").find("<!doctype html>"), std::string::npos);
}

TEST_F(CompareCli, BaselineDecidesTheExitCode) {
  good(kQuick + " -o one");
  const auto again = good(kQuick + " -o two --baseline one/scores.json");
  EXPECT_NE(again.out.find("no score is worse"), std::string::npos) << again.out;
  auto scores = nlohmann::json::parse(test::text_of(folder_ / "one/scores.json"));
  auto& worst = *std::max_element(scores.begin(), scores.end(),
                                  [](const auto& a, const auto& b) { return a["rmse"] < b["rmse"]; });
  ASSERT_GT(worst["rmse"], 0.05);
  worst["rmse"] = worst["rmse"].get<double>() * 0.5;
  write("better.json", scores.dump());
  const auto worse = run(kQuick + " -o two --baseline better.json");
  EXPECT_EQ(worse.code, 1);
  EXPECT_NE(worse.err.find("worse: tri.obj, camera 1, 48x48"), std::string::npos) << worse.err;
}

TEST_F(CompareCli, BadInputGetsASentence) {
  bad(kQuick + " --ao unsharpp -o r", 2, {"unsharpp", "unsharp"});
  bad(kQuick + " --ao none -o r", 2, {"none"});
  bad(test::Words{"compare", "tri.obj", "--ao", "", "-o", "r"}, 2, {"--ao", "needs a value"});
  for (const char* radius : {"0", "-1", "0%", "nan", "big", "900", "201%"})
    bad(test::words_of(kQuick + " -o r --ao-radius=" + radius), 2, {"--ao-radius", radius});
  for (const char* samples : {"0", "-2", "3", "5000"})
    bad(test::words_of("compare tri.obj -o r --samples=" + std::string(samples)), 2, {"--samples", samples});
  bad("compare tri.obj -o r --set reference.samples=0", 2, {"reference.samples", "'0'"});
  bad("compare tri.obj -o r --set reference.radius=0%", 2, {"reference.radius", "above 0"});
  bad("compare tri.obj -o r --cameras 0", 2, {"--cameras"});
  bad(kQuick + " --filter denoize -o r", 2, {"denoize", "denoise"});
  bad(kQuick + " --filter hemisphere -o r", 2, {"hemisphere", "box", "gaussian", "none"});
  bad(kQuick + " --budget --set reference.occluders=window -o r", 2, {"--budget", "reference.occluders", "all"});
  bad(kQuick + " --ao-scale third -o r", 2, {"--ao-scale", "third", "quarter"});
  bad(kQuick + " --light --layers 5 -o r", 2, {"layers"});
  bad("compare tri.obj -o r --runs 0", 2, {"--runs"});
  bad("compare tri.obj -o r --resolution 0,5", 2, {"--resolution"});
  bad("compare tri.obj tri.obj -o r", 2, {"tri.obj", "twice"});
  bad("compare missing.obj -o r", 3, {"missing.obj"});
  bad("compare scene:attrium -o r", 2, {"attrium", "atrium"});
  bad(kQuick + " -o tri.obj", 3, {"tri.obj"});
  bad(kQuick + " -o tri.obj/sub", 3, {"tri.obj/sub"});
  bad(kQuick + " -o /proc/report", 3, {"/proc/report"});
  bad(test::Words{"compare", "tri.obj", "-o", ""}, 3, {"folder"});
}

TEST_F(CompareCli, BadBaselineGetsASentence) {
  good(kQuick + " -o one");
  auto scores = nlohmann::json::parse(test::text_of(folder_ / "one/scores.json"));
  write("nothing.json", "");
  write("object.json", "{}");
  write("words.json", "[1, 2]");
  auto lacking = scores;
  lacking[0].erase("flip");
  write("lacking.json", lacking.dump());
  auto newer = scores;
  for (auto& record : newer) record["format"] = 99;
  write("newer.json", newer.dump());
  for (const char* file : {"nothing.json", "object.json", "words.json", "lacking.json"})
    bad(kQuick + " -o r --baseline " + file, 3, {file, "not a list of scores"});
  bad(kQuick + " -o r --baseline newer.json", 3, {"newer.json", "99", "another version"});
  bad(kQuick + " -o r --baseline missing.json", 3, {"missing.json"});
  // This error is found before any work.
  bad("compare tri.obj --resolution 48,48 --samples 8 --runs 1 --cameras 1 -o r --baseline one/scores.json", 3,
      {"other settings", "samples 4, now 8"});
  // A camera of the same name has another view.
  const auto moved = run(kQuick + " --camera-azimuth-angle 50 -o r --baseline one/scores.json");
  EXPECT_EQ(moved.code, 3);
  EXPECT_NE(moved.err.find("has another view"), std::string::npos) << moved.err;
}

}  // namespace
}  // namespace umbrage
