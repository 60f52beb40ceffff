// Baseline: reads the scores of an earlier comparison and compares new scores with them.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/result.h"

namespace umbrage {

struct Terms;

/// Version of the records. Increase it when the definition of the ground truth or of a metric changes, so that scores
/// are no longer comparable.
inline constexpr int kScoresFormat = 2;

/// Result of a comparison with a baseline.
struct BaselineCheck {
  std::vector<std::string> worse;   ///< one sentence for each score that is worse
  std::vector<std::string> better;  ///< one sentence for each score that is better
  int compared = 0, missing = 0;    ///< records of the baseline with and without a new score
};

/// Reads records written by scores_json. Errors: kFile for a file that is not a list of scores or has another format.
Result<nlohmann::json> read_baseline(const std::filesystem::path& file);

/// Returns the fields of `terms` as JSON; those with their default value may be omitted.
nlohmann::json terms_json(const Terms& terms);

/// Checks that a baseline was measured under these terms. Errors: kFile, naming the first field that differs. `name` is
/// the name of the baseline in errors.
Result<void> check_terms(const nlohmann::json& baseline, const Terms& terms, const std::string& name);

/// Compares scores with those of a baseline. `name` is the name of the baseline in errors. A score is worse if rmse,
/// flip, p99, 1 - ssim or |bias| increased by more than its tolerance, which covers differences in rounding between
/// SIMD targets; it is better if one of them decreased by more. Times are not compared. Errors: kFile if a camera of
/// the same name has another view, or if no record was measured again.
Result<BaselineCheck> check_baseline(const nlohmann::json& baseline, const nlohmann::json& scores,
                                     const std::string& name);

}  // namespace umbrage
