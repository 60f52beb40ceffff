// Report: a comparison as flat JSON records, as one HTML page that opens offline, and held against an earlier one.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/compare/compare.h"

namespace umbrage {

/// Number of the records' meaning: it grows when the truth or a metric is defined anew, and scores no longer compare.
inline constexpr int kScoresFormat = 2;

/// One record per score: quantity (one of kQuantityNames), scene, camera, technique, setting, device, width, height,
/// ms, rmse, bias, psnr (null where it is infinite), ssim, p99, flip, the same for each class of pixel as rmse_open ...
/// (null where a class has no pixels), `view`, the camera in numbers, and what the scores rest on: `format` and the
/// fields of Terms.
nlohmann::json scores_json(const Comparison& comparison);

/// The text of scores.json: the records, one per line.
std::string scores_text(const nlohmann::json& scores);

/// The page, whole: scores, pictures, script. `command` is shown in its head.
Result<std::string> report_page(const Comparison& comparison, const std::string& command, const Device& device);

/// What became of an earlier run's scores.
struct BaselineCheck {
  std::vector<std::string> worse;  ///< a sentence for each score that got worse
  int compared = 0, missing = 0;   ///< records of the baseline that were measured again, and that were not
};

/// Reads what scores_json made. Errors: kFile for a file that is no list of scores, or of another format.
Result<nlohmann::json> read_baseline(const std::filesystem::path& file);

/// Whether a baseline was measured on these terms. Errors: kFile, naming the first that differs. `name` is what errors
/// call the baseline.
Result<void> check_terms(const nlohmann::json& baseline, const Terms& terms, const std::string& name);

/// Holds scores against those of a baseline, which `name` is called in errors. A score got worse where rmse, flip, p99,
/// 1 - ssim or |bias| grew by more than its tolerance, which covers what another SIMD target's rounding changes. Times
/// do not count. Errors: kFile where a camera of the same name looked elsewhere, or nothing was measured again.
Result<BaselineCheck> check_baseline(const nlohmann::json& baseline, const nlohmann::json& scores,
                                     const std::string& name);

}  // namespace umbrage
