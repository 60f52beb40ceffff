// Tests of `umbrage compare` with techniques that trace rays and filter themselves, and of the parts of errors.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "apps/compare/compare_support.h"
#include "apps/compare/report.h"

namespace umbrage {
namespace {

using test::compared;

/// Returns settings for one small picture of scene:solids.
CompareSettings solids_settings(int samples) { return test::solids_settings(7000, {96, 64}, samples); }

TEST(Compare, TechniquesThatFilterThemselvesGetNoFilter) {
  CompareSettings settings = solids_settings(16);
  settings.techniques = {"traced", "bitmask"};
  const Comparison plain = compared(settings);
  settings.filter = "denoise";
  const Comparison filtered = compared(settings);
  ASSERT_EQ(plain.scores.size(), filtered.scores.size());
  std::set<std::string> same;
  for (std::size_t k = 0; k < plain.scores.size(); ++k)
    if (plain.scores[k].card.covered.rmse == filtered.scores[k].card.covered.rmse)
      same.insert(plain.scores[k].technique);
  EXPECT_EQ(same, std::set<std::string>{"traced"});
}

TEST(Compare, TheBudgetDividesTheErrorOfScreenSpaceTechniques) {
  CompareSettings settings = solids_settings(64);
  settings.techniques = {"bitmask", "reference", "traced"};
  settings.budget = true;
  std::map<int, double> of_view;  // by number of layers
  for (const int layers : {1, 4}) {
    settings.draw.layers = layers;
    const Comparison comparison = compared(settings);
    for (const Score& score : comparison.scores) {
      EXPECT_EQ(score.budget.has_value(), score.technique == "bitmask") << score.technique;
      if (!score.budget) continue;
      of_view[layers] = score.budget->view;
      // The two parts are the sides of a triangle with the whole error.
      const double rmse = score.card.covered.rmse;
      EXPECT_LE(rmse, score.budget->view + score.budget->own + 1e-9);
      EXPECT_GE(rmse, std::abs(score.budget->view - score.budget->own) - 1e-9);
    }
    for (const nlohmann::json& record : scores_json(comparison))
      EXPECT_EQ(record.contains("own_error") && record.contains("view_error"), record.at("technique") == "bitmask");
  }
  EXPECT_GT(of_view[1], 0.02);
  EXPECT_LT(of_view[4], 0.8 * of_view[1]) << "more layers hold more occluders";
}

}  // namespace
}  // namespace umbrage
