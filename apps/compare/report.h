// Report: writes a comparison as flat JSON records and as one self-contained HTML page.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "apps/compare/baseline.h"
#include "apps/compare/compare.h"
#include "apps/compare/flicker.h"

namespace umbrage {

/// Returns one record per score: quantity (one of kQuantityNames), scene, camera, technique, setting, device, width,
/// height, ms, rmse, bias, psnr (null if infinite), ssim, p99, flip; the same scores for each class of pixels, such
/// as rmse_open (null if a class has no pixels); view_error and own_error where there is an ErrorBudget; `view`, the
/// camera as text; `format` and the fields of Terms.
nlohmann::json scores_json(const Comparison& comparison);

/// Returns one record per row of sequences. As above, but `quantity` is "flicker of" a plane and `camera` the motion;
/// in place of bias, psnr and ssim the fields `flicker`, `flicker3`, `truth_flicker`, `truth_flicker3` and
/// `own_flicker` of Flicker; rmse is Flicker::error; p99 and rms_open are of the changes in open parts. null: too few
/// frames.
nlohmann::json scores_json(const SequenceComparison& comparison);

/// Returns the text of scores.json: the records, one per line.
std::string scores_text(const nlohmann::json& scores);

/// Returns the complete page: scores, pictures and script. `command` is shown in its head.
Result<std::string> report_page(const Comparison& comparison, const std::string& command, const Device& device);
Result<std::string> report_page(const SequenceComparison& comparison, const std::string& command, const Device& device);

}  // namespace umbrage
