// Morphs of DAE files [COLLADA 1.4.1, "morph"], applied to the text before Assimp reads it: Assimp 5.2 leaves out the
// geometries that have them.
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <pugixml.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "importer/importer.h"
#include "importer/readers.h"
#include "scene/readers/read_number.h"

namespace umbrage {
namespace {

using pugi::xml_node;

std::vector<std::string> words_of(const xml_node& node) {
  std::istringstream text(node.text().get());
  return {std::istream_iterator<std::string>(text), {}};
}

std::vector<double> numbers_of(const xml_node& node) {
  std::vector<double> numbers;
  for (const std::string& word : words_of(node)) numbers.push_back(number_of(word).value_or(0.0));
  return numbers;
}

/// The elements of a file by the references to them, "#id", and the numbers of its arrays, each parsed once.
struct Ids {
  std::map<std::string, xml_node, std::less<>> elements = {};
  std::map<std::size_t, std::vector<double>> parsed = {};  ///< by the hash of an array's element

  const std::vector<double>& numbers(const xml_node& array) {
    const auto [found, is_new] = parsed.try_emplace(array.hash_value());
    if (is_new) found->second = numbers_of(array);
    return found->second;
  }
};

/// Returns the array that the first input of a meaning below an element refers to; an empty element if there is none.
xml_node array_of(const Ids& ids, const xml_node& owner, const char* semantic) {
  const xml_node input = owner.find_node([&](const xml_node& each) {
    return std::string_view(each.name()) == "input" && std::string_view(each.attribute("semantic").value()) == semantic;
  });
  const auto source = ids.elements.find(input.attribute("source").value());
  if (source == ids.elements.end()) return {};
  return source->second.find_child(
      [](const xml_node& each) { return std::string_view(each.name()).ends_with("_array"); });
}

/// Moves the arrays of a geometry. `moved`: those that a morph has moved; geometries may share them.
void apply(const xml_node& morph, Ids& ids, const xml_node& geometry, std::set<std::size_t>& moved) {
  const bool is_relative = std::string_view(morph.attribute("method").value()) == "RELATIVE";
  const std::vector<std::string> targets = words_of(array_of(ids, morph, "MORPH_TARGET"));
  const std::vector<double> weights = ids.numbers(array_of(ids, morph, "MORPH_WEIGHT"));
  std::map<std::string, double> weight_of;
  for (std::size_t k = 0; k < std::min(targets.size(), weights.size()); ++k) weight_of["#" + targets[k]] += weights[k];
  for (const char* semantic : {"POSITION", "NORMAL"}) {
    xml_node array = array_of(ids, geometry, semantic);
    if (!array || !moved.insert(array.hash_value()).second) continue;
    const std::vector<double>& base = ids.numbers(array);
    std::vector<double> sum = base;
    for (const auto& [id, weight] : weight_of) {
      const auto target = ids.elements.find(id);
      if (weight == 0.0 || target == ids.elements.end()) continue;
      const std::vector<double>& other = ids.numbers(array_of(ids, target->second, semantic));
      for (std::size_t i = 0; other.size() == base.size() && i < base.size(); ++i)
        sum[i] += weight * (is_relative ? other[i] : other[i] - base[i]);
    }
    if (sum != base) array.text().set(fmt::format("{}", fmt::join(sum, " ")).c_str());
  }
}

}  // namespace

std::string with_dae_morphs(const std::string& text) {
  if (text.find("<morph") == std::string::npos) return {};
  pugi::xml_document document;
  constexpr double kMemoryPerByte = 2.0;
  raise_limits_by(kMemoryPerByte * double(text.size()));
  if (!document.load_buffer(text.data(), text.size())) return {};
  Ids ids;
  for (const pugi::xpath_node& each : document.select_nodes("//*[@id]"))
    ids.elements.emplace(std::string("#") + each.node().attribute("id").value(), each.node());
  std::map<std::string, std::string, std::less<>> geometry_of;  // references, by that to the controller
  std::set<std::string> done;
  std::set<std::size_t> moved;
  for (const pugi::xpath_node& each : document.select_nodes("//controller/morph")) {
    const std::string source = each.node().attribute("source").value();
    const auto geometry = ids.elements.find(source);
    if (geometry == ids.elements.end()) continue;
    geometry_of["#" + std::string(each.parent().attribute("id").value())] = source;
    if (done.insert(source).second) apply(each.node(), ids, geometry->second, moved);
    each.parent().set_name("extra");
  }
  for (const char* name : {"url", "source"})
    for (const pugi::xpath_node& each : document.select_nodes(fmt::format("//*[@{}]", name).c_str())) {
      xml_node node = each.node();
      const auto geometry = geometry_of.find(node.attribute(name).value());
      if (geometry == geometry_of.end()) continue;
      node.attribute(name).set_value(geometry->second.c_str());
      if (std::string_view(node.name()) == "instance_controller") node.set_name("instance_geometry");
    }
  std::ostringstream changed;
  document.save(changed, "", pugi::format_raw);
  return changed.str();
}

}  // namespace umbrage
