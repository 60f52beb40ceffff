#include <algorithm>
#include <iterator>
#include <utility>

#include "core/lowercase.h"
#include "importer/gltf_file.h"
#include "importer/three_mf_parts.h"

namespace umbrage {
namespace {

using pugi::xml_node;

/// Names of parts that are not the model, as files have them, in lower case.
constexpr std::pair<std::string_view, std::string_view> kHidden[] = {
    {"parametermodifier", "modifiers"},
    {"modifier_part", "modifiers"},
    {"cura:infill_mesh", "modifiers"},
    {"supportblocker", "support blockers"},
    {"support_blocker", "support blockers"},
    {"cura:anti_overhang_mesh", "support blockers"},
    {"supportenforcer", "support enforcers"},
    {"support_enforcer", "support enforcers"},
    {"cura:support_mesh", "supports"},
    {"support", "supports"},
    {"solidsupport", "supports"},
    {"negativevolume", "negative volumes, which are not cut out"},
    {"negative_part", "negative volumes, which are not cut out"},
    {"cura:cutting_mesh", "modifiers"},
    {"surface", "surfaces"},
    {"other", "objects of type 'other'"}};

std::string_view hidden_as(std::string_view name) {
  const std::string plain = lowercase(std::string(name));
  for (const auto& [known, kind] : kHidden)
    if (plain == known) return kind;
  return {};
}

/// Returns a value of the metadata of an object or part.
std::string_view metadata(const xml_node& node, std::string_view key) {
  for (const xml_node& each : node.children("metadata"))
    if (each.attribute("key").value() == key) return each.attribute("value").value();
  return {};
}

}  // namespace

void SlicerProject::add_objects(const xml_node& config) {
  for (const xml_node& node : config.children("object")) {
    SlicerObject& object = objects[node.attribute("id").value()];
    object.extruder = number<int>(metadata(node, "extruder")).value_or(0);
    for (const xml_node& each : node.children()) {
      const std::string_view name = each.name();
      if (name != "volume" && name != "part") continue;
      const auto first = number<std::uint32_t>(each.attribute("firstid").value()).value_or(0);
      SlicerPart part;
      part.last = number<std::uint32_t>(each.attribute("lastid").value()).value_or(part.last);
      part.hidden_as = hidden_as(name == "part" ? each.attribute("subtype").value() : metadata(each, "volume_type"));
      if (part.hidden_as.empty() && metadata(each, "modifier") == "1") part.hidden_as = "modifiers";
      part.extruder = number<int>(metadata(each, "extruder")).value_or(0);
      object.parts[name == "part" ? each.attribute("id").value() : ""].emplace(first, std::move(part));
    }
  }
}

void SlicerProject::add_colors(std::string_view settings) {
  std::vector<std::string> found;
  const auto set = [&](std::size_t index, std::string color) {
    if (found.size() <= index) found.resize(index + 1);
    if (color.starts_with('#')) found[index] = std::move(color);
  };
  const Json json = Json::parse(settings, nullptr, false);
  if (json.is_object()) {
    const Json& list = member(json, "filament_colour");
    for (std::size_t k = 0; k < count_of(list); ++k) set(k, text_of(list[k]));
  }
  // The colour of an extruder, if it has one, is that of its filament.
  for (const std::string_view key : {"; filament_colour = ", "; extruder_colour = "}) {
    const std::size_t at = json.is_object() ? std::string_view::npos : settings.find(key);
    if (at == std::string_view::npos) continue;
    std::string_view line = settings.substr(at + key.size());
    line = line.substr(0, line.find_first_of("\r\n"));
    for (std::size_t k = 0; !line.empty(); ++k) {
      const std::size_t stop = std::min(line.find(';'), line.size());
      std::string color(line.substr(0, stop));
      std::erase(color, '"');
      set(k, std::move(color));
      line.remove_prefix(std::min(stop + 1, line.size()));
    }
  }
  if (!found.empty()) colors = std::move(found);
}

const SlicerPart* SlicerProject::find(std::string_view root, std::string_view object, std::uint32_t triangle) const {
  const auto known = objects.find(root);
  if (known == objects.end()) return nullptr;
  for (const std::string_view component : {root == object ? std::string_view() : object, object}) {
    const auto parts = known->second.parts.find(component);
    if (parts == known->second.parts.end()) continue;
    const auto next = parts->second.upper_bound(triangle);
    if (next == parts->second.begin()) continue;
    if (const SlicerPart& part = std::prev(next)->second; triangle <= part.last) return &part;
  }
  return nullptr;
}

std::string_view SlicerProject::color(std::string_view root, const SlicerPart* part) const {
  const auto object = objects.find(root);
  if (object == objects.end()) return {};
  const int extruder = part && part->extruder > 0 ? part->extruder : object->second.extruder;
  return extruder > 0 && std::size_t(extruder) <= colors.size() ? std::string_view(colors[std::size_t(extruder) - 1])
                                                                : std::string_view();
}

std::string_view hidden_kind(const xml_node& object) {
  if (const std::string_view kind = hidden_as(attribute(object, "type")); !kind.empty()) return kind;
  for (const xml_node& each : child(object, "metadatagroup").children())
    if (const std::string_view kind = hidden_as(attribute(each, "name"));
        !kind.empty() && lowercase(each.child_value()) == "true")
      return kind;
  return {};
}

}  // namespace umbrage
