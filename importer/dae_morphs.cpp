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

/// The elements of a file by the references to them, "#id".
using Elements = std::map<std::string, xml_node, std::less<>>;

/// Returns the array that the first input of a meaning below an element refers to; an empty element if there is none.
xml_node array_of(const Elements& elements, const xml_node& owner, const char* semantic) {
  const xml_node input = owner.find_node([&](const xml_node& each) {
    return std::string_view(each.name()) == "input" && std::string_view(each.attribute("semantic").value()) == semantic;
  });
  const auto source = elements.find(input.attribute("source").value());
  if (source == elements.end()) return {};
  return source->second.find_child(
      [](const xml_node& each) { return std::string_view(each.name()).ends_with("_array"); });
}

void apply(const xml_node& morph, const Elements& elements, const xml_node& geometry) {
  const bool is_relative = std::string_view(morph.attribute("method").value()) == "RELATIVE";
  const std::vector<std::string> targets = words_of(array_of(elements, morph, "MORPH_TARGET"));
  const std::vector<double> weights = numbers_of(array_of(elements, morph, "MORPH_WEIGHT"));
  for (const char* semantic : {"POSITION", "NORMAL"}) {
    xml_node array = array_of(elements, geometry, semantic);
    const std::vector<double> base = numbers_of(array);
    std::vector<double> sum = base;
    for (std::size_t k = 0; k < std::min(targets.size(), weights.size()); ++k) {
      const auto target = elements.find("#" + targets[k]);
      if (weights[k] == 0.0 || target == elements.end()) continue;
      const std::vector<double> moved = numbers_of(array_of(elements, target->second, semantic));
      for (std::size_t i = 0; moved.size() == base.size() && i < base.size(); ++i)
        sum[i] += weights[k] * (is_relative ? moved[i] : moved[i] - base[i]);
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
  Elements elements;
  for (const pugi::xpath_node& each : document.select_nodes("//*[@id]"))
    elements.emplace(std::string("#") + each.node().attribute("id").value(), each.node());
  std::map<std::string, std::string, std::less<>> geometry_of;  // references, by that to the controller
  std::set<std::string> done;
  for (const pugi::xpath_node& each : document.select_nodes("//controller/morph")) {
    const std::string source = each.node().attribute("source").value();
    const auto geometry = elements.find(source);
    if (geometry == elements.end()) continue;
    geometry_of["#" + std::string(each.parent().attribute("id").value())] = source;
    if (done.insert(source).second) apply(each.node(), elements, geometry->second);
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
