// Tests of `umbrage tune`: the search, its output, invalid input.
#include <gtest/gtest.h>

#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/compare/tune.h"
#include "core/check.h"
#include "renderer/devices.h"
#include "run_program.h"

namespace umbrage {
namespace {

TuneSettings quick(int trials) {
  TuneSettings settings;
  settings.models = {"scene:solids?detail=20000"};
  settings.draw.width = 96;
  settings.draw.height = 54;
  settings.draw.look = "studio";
  settings.draw.occlusion = "bitmask";
  settings.cameras = 1;
  settings.samples = 32;
  settings.runs = 1;
  settings.trials = trials;
  return settings;
}

Tuning tuned(const TuneSettings& settings) {
  const auto device = make_device("cpu", 0);
  if (!device) fail_check(device.error().message);
  auto tuning = tune(**device, settings);
  if (!tuning) fail_check(tuning.error().message);
  return std::move(*tuning);
}

std::string name_of(const Trial& trial) { return trial.scale + fmt::format(" {}", fmt::join(trial.settings, " ")); }

TEST(Tune, FindsWhatIsCloserThanTheStart) {
  TuneSettings settings = quick(30);
  settings.budget_ms = 1e5;  // no time limit: the closest trial is the best
  const Tuning tuning = tuned(settings);
  EXPECT_EQ(tuning.technique, "bitmask");
  EXPECT_EQ(tuning.filter, "denoise");
  ASSERT_EQ(tuning.trials.size(), 30u);
  const auto closest = std::min_element(tuning.trials.begin(), tuning.trials.end(),
                                        [](const Trial& a, const Trial& b) { return a.rmse < b.rmse; });
  EXPECT_LE(tuning.best.rmse, 1.005 * closest->rmse);
  for (const Trial& trial : tuning.trials)
    if (trial.rmse <= 1.005 * closest->rmse && trial.scale == tuning.start.scale) {
      EXPECT_LE(tuning.best.settings.size(), trial.settings.size() + 1) << name_of(trial);
    }
  EXPECT_LT(tuning.best.rmse, 0.97 * tuning.start.rmse);
  std::set<std::string> names;
  for (const Trial& trial : tuning.trials) EXPECT_TRUE(names.insert(name_of(trial)).second) << name_of(trial);
}

TEST(Tune, TheFrontierIsWhatNothingBeats) {
  const Tuning tuning = tuned(quick(20));
  int on_it = 0;
  for (const Trial& trial : tuning.trials) {
    bool beaten = false;
    for (const Trial& other : tuning.trials)
      beaten |= other.ms <= trial.ms && other.rmse <= trial.rmse && (other.ms < trial.ms || other.rmse < trial.rmse);
    EXPECT_EQ(trial.frontier, !beaten) << name_of(trial);
    on_it += trial.frontier;
  }
  EXPECT_GE(on_it, 1);
  EXPECT_EQ(tuning.budget_ms, tuning.start.ms);
  EXPECT_LE(tuning.best.ms, tuning.budget_ms);
  EXPECT_LE(tuning.best.rmse, tuning.start.rmse);
}

TEST(Tune, ABudgetBelowTheStartIsMetByFasterSettings) {
  TuneSettings settings = quick(2);
  settings.draw.width = 192;  // with fewer pixels, time that no setting changes is most of it
  settings.draw.height = 108;
  const double start_ms = tuned(settings).start.ms;
  settings.trials = 60;
  settings.budget_ms = 0.7 * start_ms;  // kMaxTimeFactor does not reach the start
  const Tuning tuning = tuned(settings);
  EXPECT_LE(tuning.best.ms, tuning.budget_ms);
  EXPECT_FALSE(tuning.options.empty());
}

TEST(Tune, ABudgetThatNoSettingMeetsIsAnError) {
  TuneSettings settings = quick(30);
  settings.budget_ms = 1e-3;
  const auto device = make_device("cpu", 0);
  const auto tuning = tune(**device, settings);
  ASSERT_FALSE(tuning);
  EXPECT_EQ(tuning.error().kind, ErrorKind::kInternal);
  EXPECT_NE(tuning.error().message.find("none of the 30 settings"), std::string::npos) << tuning.error().message;
  EXPECT_NE(tuning.error().message.find("the fastest takes"), std::string::npos) << tuning.error().message;
}

TEST(Tune, OptionsMakeTheBestOneAgain) {
  TuneSettings settings = quick(25);
  settings.budget_ms = 1e5;
  const Tuning tuning = tuned(settings);
  // With these options as the start, the score is the same.
  TuneSettings again = quick(2);
  for (std::size_t k = 0; k + 1 < tuning.options.size(); k += 2) {
    const std::string &option = tuning.options[k], &value = tuning.options[k + 1];
    if (option == "--look") again.draw.look = value;
    if (option == "--ao") again.draw.occlusion = value;
    if (option == "--ao-scale") again.draw.occlusion_scale = value;
    if (option == "--set") again.draw.settings.push_back(value);
  }
  EXPECT_GE(again.draw.settings.size(), 1u);
  EXPECT_NEAR(tuned(again).start.rmse, tuning.best.rmse, 1e-9);
}

TEST(Tune, WhatTheUserSetStays) {
  TuneSettings settings = quick(40);
  settings.draw.settings = {"bitmask.slices=3", "denoise.rounds=1"};
  settings.draw.occlusion_scale = "half";
  for (const Trial& trial : tuned(settings).trials) {
    EXPECT_EQ(trial.scale, "half");
    for (const std::string& setting : trial.settings) {
      EXPECT_FALSE(setting.starts_with("bitmask.slices")) << setting;
      EXPECT_FALSE(setting.starts_with("denoise.rounds")) << setting;
    }
  }
}

TEST(Tune, EveryTechniqueThatHasSettingsIsSearched) {
  for (const Effect* effect : effects_with_external()) {
    if (effect->kind != EffectKind::kOcclusion) continue;
    TuneSettings settings = quick(4);
    settings.draw.occlusion = effect->name;
    settings.budget_ms = 1000.0;  // otherwise measured times could end the search
    if (effect->tunable.empty()) {
      EXPECT_FALSE(check_tune(settings)) << effect->name;
      continue;
    }
    EXPECT_EQ(tuned(settings).trials.size(), 4u) << effect->name;
    for (const std::string_view name : effect->tunable) EXPECT_TRUE(find_parameter(*effect, name)) << name;
  }
}

TEST(Tune, TheProgressCanEndTheWork) {
  TuneSettings settings = quick(100);
  settings.progress = [](const std::string& what, double) { return what.find("trial 3") == std::string::npos; };
  const auto device = make_device("cpu", 0);
  const auto tuning = tune(**device, settings);
  ASSERT_FALSE(tuning);
  EXPECT_EQ(tuning.error().kind, ErrorKind::kInterrupted);
}

class TuneCli : public test::ProgramTest {};

const std::string kQuick = "tune tri.obj --resolution 48,48 --samples 4 --runs 1 --cameras 1 --trials 6";

TEST_F(TuneCli, PrintsTheFrontierAndOptions) {
  const auto outcome = good(kQuick + " --ao bitmask");
  EXPECT_NE(outcome.out.find("bitmask with denoise, 6 settings tried"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\n--look studio --ao bitmask"), std::string::npos) << outcome.out;
  const auto records = nlohmann::json::parse(good(kQuick + " --ao bitmask --json").out);
  ASSERT_EQ(records.size(), 6u);
  EXPECT_EQ(
      std::count_if(records.begin(), records.end(), [](const auto& r) { return r.at("best").template get<bool>(); }),
      1);
}

TEST_F(TuneCli, BadInputGetsASentence) {
  bad(kQuick + " --ao none", 2, {"none", "bitmask"});
  bad(kQuick + " --ao reference", 2, {"reference", "bitmask"});
  bad(kQuick + " --ao bitmaks", 2, {"bitmaks", "bitmask"});
  bad(kQuick + " --look studioo", 2, {"studioo", "studio"});
  bad(kQuick + " --time=-1", 2, {"--time", "-1"});
  bad(kQuick + " --time 0.0001", 1, {"0.0001 ms", "the fastest takes", "--time"});
  bad("tune tri.obj --trials 1", 2, {"--trials", "1"});
  bad("tune tri.obj --samples 3", 2, {"--samples", "3"});
  bad("tune tri.obj --runs 0", 2, {"--runs"});
  bad("tune tri.obj tri.obj", 2, {"tri.obj", "twice"});
  bad("tune missing.obj", 3, {"missing.obj"});
  bad(kQuick + " --camera-position 0,0,5 --camera-direction 0,0,1", 2, {"is in view"});
}

}  // namespace
}  // namespace umbrage
