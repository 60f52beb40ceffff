#include "apps/compare/report.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base64.h"
#include "core/check.h"
#include "core/color.h"
#include "core/version.h"
#include "io/image_file.h"

namespace umbrage {
namespace {

/// The content of page.html, which the build converts to a string literal.
constexpr std::string_view kPage =
#include "compare_page.inc"
    ;
constexpr float kMapGain = 16.0f;  // of the maps of flicker: white is a change of 1/16
constexpr std::string_view kDataPlaceholder = "/*UMBRAGE-DATA*/";

nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

/// Returns a picture as the data URL of a PNG: one plane times the exposure, or three planes of linear light, to which
/// exposure and the sRGB curve are applied.
Result<std::string> data_url(const Image& picture, float exposure) {
  constexpr const char* kColor[] = {"color.r", "color.g", "color.b"};
  const bool is_color = picture.planes.size() == 3;
  Image image(picture.width, picture.height);
  for (std::size_t p = 0; p < picture.planes.size(); ++p) {
    Plane& plane = image.add(is_color ? kColor[p] : "grey");
    plane = picture.planes[p];
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) {
        const float value = exposure * plane.at(x, y);
        plane.at(x, y) = is_color ? srgb_from_linear(std::clamp(value, 0.0f, 1.0f)) : value;
      }
  }
  const auto bytes = encode_png("index.html", image, {.small = true});
  if (!bytes) return bytes.error();
  return "data:image/png;base64," + base64(*bytes);
}

/// Returns the pixel classes as grey values: 60, 120, 180, 240 of 255 in the order of PixelClass, 0 for the background.
Image class_picture(const ClassMap& classes) {
  constexpr float kStep = 60.0f / 255.0f;
  Image image(classes.width, classes.height);
  Plane& plane = image.add("grey");
  for (int y = 0; y < plane.height; ++y)
    for (int x = 0; x < plane.width; ++x) {
      const PixelClass c = classes.classes[std::size_t(y) * plane.width + x];
      plane.at(x, y) = c == PixelClass::kBackground ? 0.0f : kStep * float(int(c) + 1);
    }
  return image;
}

/// Returns the page with its data.
std::string page_with(const nlohmann::json& data) {
  // Names come from the command line. They may contain text that would end the page's script element, or bytes that
  // are not UTF-8.
  std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at + 3))
    text.insert(at + 1, "\\");
  for (std::size_t at = text.find("<!--"); at != std::string::npos; at = text.find("<!--", at + 5))
    text.replace(at, 4, "\\u003c!--");
  std::string page(kPage);
  const std::size_t placeholder = page.find(kDataPlaceholder);
  if (placeholder == std::string::npos) fail_check("page.html has no placeholder for the data");
  return page.replace(placeholder, kDataPlaceholder.size(), text);
}

}  // namespace

nlohmann::json scores_json(const Comparison& comparison) {
  nlohmann::json records = nlohmann::json::array();
  for (const Score& score : comparison.scores) {
    nlohmann::json record = {
        {"scene", score.scene},     {"camera", score.camera}, {"technique", score.technique},
        {"setting", score.setting}, {"device", score.device}, {"width", score.width},
        {"height", score.height},   {"ms", score.ms},         {"quantity", kQuantityNames[int(score.quantity)]}};
    const auto add = [&](const Scores& scores, const std::string& suffix) {
      const bool has_scores = scores.pixels > 0 || suffix.empty();
      const auto set_score = [&](const char* name, double value) {
        record[name + suffix] = has_scores ? number_or_null(value) : nlohmann::json(nullptr);
      };
      set_score("rmse", scores.rmse);
      set_score("bias", scores.bias);
      set_score("psnr", scores.psnr);
      set_score("ssim", scores.ssim);
      set_score("p99", scores.p99);
      set_score("flip", scores.flip);
      record["pixels" + suffix] = scores.pixels;
    };
    add(score.card.covered, "");
    for (int c = 0; c < kPixelClasses; ++c) add(score.card.by_class[c], fmt::format("_{}", kPixelClassNames[c]));
    if (score.budget) {
      record["view_error"] = score.budget->view;
      record["own_error"] = score.budget->own;
    }
    record["format"] = kScoresFormat;
    record["view"] = score.view;
    record.update(terms_json(comparison.terms));
    records.push_back(std::move(record));
  }
  return records;
}

nlohmann::json scores_json(const SequenceComparison& comparison) {
  nlohmann::json records = nlohmann::json::array();
  for (const FlickerRow& row : comparison.rows) {
    nlohmann::json record = terms_json(comparison.terms);
    record.update({{"scene", row.scene},
                   {"camera", row.motion},
                   {"technique", row.technique},
                   {"setting", row.setting()},
                   {"device", row.device},
                   {"width", row.width},
                   {"height", row.height},
                   {"quantity", "flicker of " + row.quantity},
                   {"pixels", row.flicker.pixels},
                   {"format", kScoresFormat},
                   {"view", row.view}});
    record["ratio"] = number_or_null(row.flicker.ratio());
    for (const auto& [name, field] : kFlickerFields) record[name] = number_or_null(row.flicker.*field);
    records.push_back(std::move(record));
  }
  return records;
}

std::string scores_text(const nlohmann::json& scores) {
  std::string text = "[";
  for (const nlohmann::json& record : scores)
    text += (text.size() > 1 ? ",\n " : "\n ") + record.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return text + "\n]\n";
}

Result<std::string> report_page(const Comparison& comparison, const std::string& command, const Device& device) {
  nlohmann::json data = {{"version", project_version()},      {"command", command},
                         {"device", device.description()},    {"truth", terms_json(comparison.terms)},
                         {"scores", scores_json(comparison)}, {"techniques", nlohmann::json::array()},
                         {"views", nlohmann::json::array()}};
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  data["truth"]["noise"] = rounded(comparison.noise);
  data["truth"]["mean"] = rounded(comparison.mean);
  data["truth"]["light_noise"] = rounded(comparison.light_noise);
  for (const Effect* effect : effects_with_external())
    if (effect->kind == EffectKind::kOcclusion)
      data["techniques"].push_back({{"name", effect->name}, {"summary", effect->summary}});
  for (const ComparedView& view : comparison.views) {
    const auto truth = data_url(view.truth, view.exposure), classes = data_url(class_picture(view.classes), 1.0f);
    if (!truth) return truth.error();
    if (!classes) return classes.error();
    nlohmann::json record = {{"quantity", kQuantityNames[int(view.quantity)]},
                             {"scene", view.scene},
                             {"camera", view.camera},
                             {"width", view.truth.width},
                             {"height", view.truth.height},
                             {"radius", view.radius},
                             {"truth", *truth},
                             {"classes", *classes},
                             {"images", nlohmann::json::array()}};
    for (const ComparedView::Technique& technique : view.techniques) {
      const auto picture = data_url(technique.picture, view.exposure);
      if (!picture) return picture.error();
      record["images"].push_back(
          {{"technique", technique.name}, {"setting", technique.setting}, {"picture", *picture}});
    }
    data["views"].push_back(std::move(record));
  }
  return page_with(data);
}

Result<std::string> report_page(const SequenceComparison& comparison, const std::string& command,
                                const Device& device) {
  nlohmann::json data = {{"version", project_version()},
                         {"command", command},
                         {"device", device.description()},
                         {"sequences", scores_json(comparison)}};
  for (std::size_t k = 0; k < comparison.rows.size(); ++k) {
    const FlickerRow& row = comparison.rows[k];
    if (row.map.planes.empty()) continue;
    for (const auto& [name, picture, gain] : {std::tuple("strip", &row.strip, 1.0f),
                                              {"truth_strip", &row.truth_strip, 1.0f},
                                              {"map", &row.map, kMapGain}}) {
      const auto url = data_url(*picture, gain);
      if (!url) return url.error();
      data["sequences"][k][name] = *url;
    }
  }
  return page_with(data);
}

}  // namespace umbrage
