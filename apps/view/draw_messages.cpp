#include "apps/view/draw_messages.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/view/quality.h"

namespace umbrage::view {
namespace {

std::string text_of(const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

/// Rounds a time for display, ms.
double rounded(double ms) { return std::round(ms * 10.0) / 10.0; }

}  // namespace

std::string frame_text(const FrameHeader& header, const Encoded& encoded, double encode_ms) {
  nlohmann::json stages = nlohmann::json::array();
  for (const StageTimes::Stage& stage : header.times.stages) stages.push_back({stage.name, rounded(stage.ms)});
  stages.push_back({"encode", rounded(encode_ms)});
  nlohmann::json json = {{"frame", header.frame},
                         {"id", header.id},
                         {"view", header.view},
                         {"model", header.model},
                         {"width", header.width},
                         {"height", header.height},
                         {"format", encoded.format},
                         {"moving", header.is_moving},
                         {"samples", header.samples},
                         {"final", header.is_final},
                         {"ms", rounded(header.times.total() + encode_ms)},
                         {"stages", std::move(stages)}};
  if (header.error) json["error"] = {{"rmse", header.error->rmse}, {"mean", header.error->mean}};
  return frame_bytes(json, encoded.bytes);
}

std::string model_text(int model, const ModelFacts& facts, const std::optional<ViewCamera>& camera, long version) {
  nlohmann::json warnings = nlohmann::json::array();
  for (const std::string& warning : facts.warnings) warnings.push_back(with_option_names(warning));
  nlohmann::json json = {{"type", "model"},
                         {"model", model},
                         {"summary", facts.summary},
                         {"warnings", std::move(warnings)},
                         {"version", version}};
  if (camera) {
    json["camera"] = {{"camera-position", text_of(camera->position)},
                      {"camera-focal-point", text_of(camera->focal_point)},
                      {"camera-view-up", text_of(camera->view_up)},
                      {"camera-view-angle", fmt::format("{}", camera->view_angle_deg)},
                      {"camera-orthographic", camera->orthographic ? "true" : "false"}};
    json["center"] = {facts.center.x, facts.center.y, facts.center.z};
    json["extent"] = {facts.extent.x, facts.extent.y, facts.extent.z};
    json["radius"] = facts.radius;
    json["up"] = {facts.up.x, facts.up.y, facts.up.z};
  } else {
    json["size"] = {facts.width, facts.height};
    if (!facts.look.empty()) json["look"] = facts.look;
  }
  return text_of_json(json);
}

std::string pick_text(const std::optional<glm::dvec3>& point) {
  nlohmann::json json = {{"type", "pick"}, {"point", nullptr}};
  if (point) json["point"] = {point->x, point->y, point->z};
  return text_of_json(json);
}

std::string camera_text(const View& view) {
  std::string text;
  for (const auto& [name, values] : view.options)
    if (name.starts_with("camera-")) text += fmt::format("{}={} ", name, fmt::join(values, " "));
  return text;
}

}  // namespace umbrage::view
