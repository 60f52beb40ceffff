// Baseline: the scores of an earlier comparison, read and held against those of now.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/result.h"

namespace umbrage {

struct Terms;

/// Number of the records' meaning: it grows when the truth or a metric is defined anew, and scores no longer compare.
inline constexpr int kScoresFormat = 2;

/// What became of an earlier run's scores.
struct BaselineCheck {
  std::vector<std::string> worse;  ///< a sentence for each score that got worse
  int compared = 0, missing = 0;   ///< records of the baseline that were measured again, and that were not
};

/// Reads what scores_json made. Errors: kFile for a file that is no list of scores, or of another format.
Result<nlohmann::json> read_baseline(const std::filesystem::path& file);

/// The fields that say on what terms scores were measured.
nlohmann::json terms_json(const Terms& terms);

/// Whether a baseline was measured on these terms. Errors: kFile, naming the first that differs. `name` is what errors
/// call the baseline.
Result<void> check_terms(const nlohmann::json& baseline, const Terms& terms, const std::string& name);

/// Holds scores against those of a baseline, which `name` is called in errors. A score got worse where rmse, flip, p99,
/// 1 - ssim or |bias| grew by more than its tolerance, which covers what another SIMD target's rounding changes. Times
/// do not count. Errors: kFile where a camera of the same name looked elsewhere, or nothing was measured again.
Result<BaselineCheck> check_baseline(const nlohmann::json& baseline, const nlohmann::json& scores,
                                     const std::string& name);

}  // namespace umbrage
