#include "apps/compare/baseline.h"

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "apps/compare/compare.h"

namespace umbrage {
namespace {

/// Returns the quantity of a record. Records of earlier versions have no such field; they score occlusion.
std::string quantity_of(const nlohmann::json& record) {
  return record.value("quantity", std::string(kQuantityNames[int(Quantity::kOcclusion)]));
}

/// Returns a key that is equal for two records of the same measurement.
std::string key_of(const nlohmann::json& record) {
  std::string key = quantity_of(record) + '\n';
  for (const char* field : {"scene", "camera", "technique", "setting"})
    key += record.at(field).get<std::string>() + '\n';
  return key + fmt::format("{}x{}", record.at("width").get<int>(), record.at("height").get<int>());
}

/// Returns the scores that a record must have: that of a sequence has no bias and no ssim.
std::vector<const char*> scores_of(const nlohmann::json& record) {
  return record.contains("flicker") ? std::vector{"flicker", "rmse", "p99", "flip"}
                                    : std::vector{"rmse", "bias", "ssim", "p99", "flip"};
}

/// Max change of a score that counts as equal. The tolerance covers differences in rounding between SIMD
/// targets only.
struct Tolerance {
  const char* field;
  double absolute, relative;
};
constexpr Tolerance kTolerances[] = {{"rmse", 5e-4, 0.01},    {"flip", 5e-4, 0.01}, {"p99", 4e-3, 0.01},
                                     {"bias", 5e-4, 0.01},    {"ssim", 1e-3, 0.0},  {"flicker", 1e-4, 0.01},
                                     {"flicker3", 1e-4, 0.01}};

/// Returns a score of a record, converted so that lower is better.
double lower_is_better(const nlohmann::json& record, std::string_view field) {
  const double value = record.at(field).get<double>();
  if (field == "ssim") return 1.0 - value;
  return std::abs(value);
}

/// Returns a JSON value for an error message, on one line and shortened.
std::string shown(const nlohmann::json& value) {
  if (value.is_structured()) return value.is_array() ? "a list" : "an object";
  constexpr std::size_t kMaxLength = 200;
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).substr(0, kMaxLength);
}

}  // namespace

nlohmann::json terms_json(const Terms& terms) {
  nlohmann::json json = {{"radius", terms.radius}, {"samples", terms.samples},   {"falloff", terms.falloff},
                         {"normal", terms.normal}, {"settings", terms.settings}, {"guard", terms.guard}};
  // Written only if they differ from the default.
  if (terms.layers != 1) json["layers"] = terms.layers;
  if (terms.extra_views != 0) json["extra_views"] = terms.extra_views;
  if (terms.scale != "full") json["scale"] = terms.scale;
  if (!terms.filter.empty()) json["filter"] = terms.filter;
  if (!terms.quality.empty()) json["quality"] = terms.quality;
  return json;
}

Result<nlohmann::json> read_baseline(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return file_error("the baseline '{}' cannot be read", file.string());
  std::ostringstream text;
  text << stream.rdbuf();
  nlohmann::json baseline = nlohmann::json::parse(text.str(), nullptr, false);
  const auto no_scores = [&] {
    return file_error("'{}' is not a list of scores; use a scores.json that compare wrote", file.string());
  };
  if (!baseline.is_array() || baseline.empty()) return no_scores();
  for (const nlohmann::json& record : baseline) {
    if (!record.is_object() || !record.contains("format")) return no_scores();
    if (record["format"] != kScoresFormat)
      return file_error(
          "'{}': its scores have format {}, written by another version; this version writes format {}: measure the "
          "baseline again",
          file.string(), shown(record["format"]), kScoresFormat);
    for (const char* field :
         {"scene", "camera", "technique", "setting", "view", "radius", "falloff", "normal", "settings", "guard"})
      if (!record.contains(field) || !record[field].is_string()) return no_scores();
    if (record.contains("quantity") && !record["quantity"].is_string()) return no_scores();
    for (const char* field : {"width", "height", "samples"})
      if (!record.contains(field) || !record[field].is_number()) return no_scores();
    for (const char* field : scores_of(record))
      if (!record.contains(field) || !record[field].is_number()) return no_scores();
    for (const char* side : {"width", "height"})
      if (!record[side].is_number_integer() || record[side] < 1 || record[side] > kMaxSide) return no_scores();
  }
  return baseline;
}

Result<void> check_terms(const nlohmann::json& baseline, const Terms& terms, const std::string& name) {
  nlohmann::json now = terms_json(terms);
  now["layers"] = terms.layers;
  now["extra_views"] = terms.extra_views;
  now["scale"] = terms.scale;
  now["filter"] = terms.filter;
  now["quality"] = terms.quality;
  const nlohmann::json default_terms = {
      {"layers", 1}, {"extra_views", 0}, {"scale", "full"}, {"filter", ""}, {"quality", ""}};
  for (const nlohmann::json& record : baseline)
    for (const auto& [field, value] : now.items()) {
      const nlohmann::json& before = record.contains(field) ? record.at(field) : default_terms.at(field);
      if (before != value)
        return file_error("'{}': the baseline was measured with other settings: {} {}, now {}", name, field,
                          shown(before), shown(value));
    }
  return {};
}

Result<BaselineCheck> check_baseline(const nlohmann::json& baseline, const nlohmann::json& scores,
                                     const std::string& name) {
  std::map<std::string, const nlohmann::json*> now;
  for (const nlohmann::json& record : scores) now[key_of(record)] = &record;
  BaselineCheck check;
  for (const nlohmann::json& before : baseline) {
    const auto found = now.find(key_of(before));
    if (found == now.end()) {
      ++check.missing;
      continue;
    }
    const nlohmann::json& after = *found->second;
    if (before.at("view") != after.at("view"))
      return file_error("'{}': its camera '{}' of '{}' has another view: {}, now {}", name,
                        before.at("camera").get<std::string>(), before.at("scene").get<std::string>(),
                        shown(before.at("view")), shown(after.at("view")));
    ++check.compared;
    for (const auto& [field, absolute, relative] : kTolerances) {
      const auto has_score = [&](const auto& record) { return record.contains(field) && record.at(field).is_number(); };
      if (!has_score(before) || !has_score(after)) continue;
      const double bad_before = lower_is_better(before, field), bad_now = lower_is_better(after, field);
      const double max_change = absolute + relative * bad_before;
      if (std::abs(bad_now - bad_before) <= max_change) continue;
      (bad_now < bad_before ? check.better : check.worse)
          .push_back(fmt::format(
              "{}, camera {}, {}x{}, {} {}: {}{} was {:.4f} and is {:.4f}", after.at("scene").get<std::string>(),
              after.at("camera").get<std::string>(), after.at("width").get<int>(), after.at("height").get<int>(),
              after.at("technique").get<std::string>(),
              after.at("setting").get<std::string>().empty() ? "look defaults" : after.at("setting").get<std::string>(),
              quantity_of(after) == kQuantityNames[0] ? "" : quantity_of(after) + "'s ", field,
              before.at(field).get<double>(), after.at(field).get<double>()));
    }
  }
  if (check.compared == 0)
    return file_error("'{}': none of its {} scores has a scene, camera, size and technique of this comparison", name,
                      check.missing);
  return check;
}

}  // namespace umbrage
