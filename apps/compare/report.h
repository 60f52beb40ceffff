// Report: a comparison as flat JSON records and as one HTML page that opens offline.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "apps/compare/baseline.h"
#include "apps/compare/compare.h"

namespace umbrage {

/// One record per score: quantity (one of kQuantityNames), scene, camera, technique, setting, device, width, height,
/// ms, rmse, bias, psnr (null where it is infinite), ssim, p99, flip, the same for each class of pixel as rmse_open ...
/// (null where a class has no pixels), `view`, the camera in numbers, and what the scores rest on: `format` and the
/// fields of Terms.
nlohmann::json scores_json(const Comparison& comparison);

/// The text of scores.json: the records, one per line.
std::string scores_text(const nlohmann::json& scores);

/// The page, whole: scores, pictures, script. `command` is shown in its head.
Result<std::string> report_page(const Comparison& comparison, const std::string& command, const Device& device);

}  // namespace umbrage
