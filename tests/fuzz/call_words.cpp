#include "call_words.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <sstream>

namespace umbrage::fuzz {
namespace {

std::vector<std::string> listed(UmbList list) {
  std::vector<std::string> names;
  const char* name = nullptr;
  for (int k = 0; umbGetListEntry(list, k, &name, nullptr) == UMB_ERROR_NONE; ++k) names.emplace_back(name);
  return names;
}

void add_parameters(const std::string& owner, std::vector<ListedParameter>& all) {
  UmbParameter row{};
  row.size = sizeof row;
  for (int k = 0; umbGetParameter(owner.c_str(), k, &row) == UMB_ERROR_NONE; ++k) {
    ListedParameter listed{row.name, row.type, {}, row.min, row.max};
    std::istringstream choices(row.choices);
    for (std::string choice; choices >> choice;) listed.choices.push_back(choice);
    all.push_back(std::move(listed));
  }
}

std::string number_text(double number) {
  char text[64];
  std::snprintf(text, sizeof text, "%.9g", number);
  return text;
}

/// Writes a small depth image. Returns its file.
std::string depth_file() {
  constexpr int kWidth = 9, kHeight = 7;
  const std::string file = std::filesystem::temp_directory_path().string() + "/umbrage_calls_depth.pfm";
  std::vector<float> depth;
  for (int k = 0; k < kWidth * kHeight; ++k) depth.push_back(2.0f + float(k % 4));
  const char* names[] = {"depth"};
  UmbImage image{};
  image.data = depth.data();
  image.type = UMB_TYPE_FLOAT32;
  image.width = kWidth;
  image.height = kHeight;
  image.channels = 1;
  umbWriteImages(file.c_str(), names, &image, 1, 8, false);
  return file;
}

/// Max number, since larger ones make pictures that take seconds.
constexpr double kMaxNumber = 24.0;

}  // namespace

const Words& words() {
  static const Words& all = *[] {
    auto* result = new Words;
    result->effects = listed(UMB_LIST_EFFECTS);
    result->looks = listed(UMB_LIST_LOOKS);
    for (const std::string& scene : listed(UMB_LIST_SCENES)) result->scenes.push_back(scene + "?detail=1000");
    if (result->scenes.empty()) result->scenes.push_back("scene:none");  // a build without built-in scenes
    add_parameters("render", result->parameters);
    add_parameters("shade", result->parameters);
    for (const std::string& effect : result->effects) add_parameters(effect, result->parameters);
    // Calls must not read other files or stdin.
    std::erase_if(result->parameters, [](const ListedParameter& p) { return p.name == "hdri_file"; });
    result->files = {depth_file(), depth_file() + ":depth", "/none/depth.exr", "/"};
    result->passes = {"depth",
                      "normal",
                      "albedo",
                      "color",
                      "ao",
                      "object_id",
                      "material_id",
                      "lit",
                      "layer1.depth",
                      "layer1.normal",
                      "layer01.depth",
                      "layer1x.depth",
                      "layer-1.depth",
                      "layer7.object_id",
                      "layer99999999999.depth",
                      "all",
                      "uv",
                      "position",
                      "occlusion",
                      "shadow"};
    result->odd = {"",
                   ".",
                   "=",
                   "\xff\xfe",
                   "\xc3\x28\x80",
                   "%s%n{}{0}",
                   "a\nb",
                   std::string(70000, 'x'),
                   "camera.",
                   "bitmask.radius=3",
                   "nan",
                   "inf",
                   "1e999",
                   "-1",
                   "1%",
                   "99999999999999999999",
                   "1,2,3",
                   "0x10",
                   "scene:",
                   "scene:solids?detail=-1"};
    return result;
  }();
  return all;
}

std::string Text::shown() const { return is_null_ ? "NULL" : "\"" + text_.substr(0, 40) + "\""; }

Text any_odd(Choices& choose) { return choose.one_in(8) ? Text() : Text(choose.one_of(words().odd)); }

Text any_pass(Choices& choose) { return choose.one_in(10) ? any_odd(choose) : Text(choose.one_of(words().passes)); }

float any_number(Choices& choose) {
  static const std::vector<float> kSpecial = {0.0f,
                                              -1.0f,
                                              1e-45f,
                                              1e30f,
                                              3e38f,
                                              std::numeric_limits<float>::infinity(),
                                              std::numeric_limits<float>::quiet_NaN(),
                                              2147483648.0f};
  return choose.one_in(6) ? choose.one_of(kSpecial) : float(choose.below(400)) / 100.0f - 1.0f;
}

std::string value_of(Choices& choose, const ListedParameter& parameter) {
  if (choose.one_in(12)) return choose.one_of(words().odd);
  if (!parameter.choices.empty()) return choose.one_of(parameter.choices);
  if (parameter.name == "file" || parameter.name.ends_with("_file")) return choose.one_of(words().files);
  if (parameter.name == "look") return choose.one_of(words().looks);
  if (parameter.name == "effects") {
    std::string names = choose.one_of(words().effects);
    while (choose.below(2)) names += "," + choose.one_of(words().effects);
    return names;
  }
  if (parameter.type == "bool") return choose.below(2) ? "true" : "false";
  int count = 1;
  if (parameter.type.starts_with("float") && parameter.type.size() > 5) count = parameter.type[5] - '0';
  std::string text;
  for (int k = 0; k < count; ++k) {
    double number = double(any_number(choose));
    if (parameter.min < parameter.max) {
      const double max = std::min(parameter.max, std::max(parameter.min, kMaxNumber));
      const double fraction = choose.below(5) / 4.0;
      number = parameter.min + fraction * (max - parameter.min);
      if (parameter.type == "int") number = std::floor(number);
      if (choose.one_in(10)) number = choose.below(2) ? parameter.min - 1.0 : 2.0 * std::abs(parameter.max) + 1.0;
    } else if (parameter.type == "int") {
      number = double(choose.below(5));
    }
    text += (k ? "," : "") + number_text(number);
  }
  return parameter.type == "length" && choose.below(2) ? text + "%" : text;
}

}  // namespace umbrage::fuzz
