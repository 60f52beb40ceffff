// Colour maps: tables of control points, and files of colours.
#include "scene/color_maps.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "core/color.h"
#include "core/numbers.h"
#include "core/suggest.h"

namespace umbrage {
namespace {

struct BuiltinMap {
  std::string_view name;
  bool smooth;
  std::string_view colors;  ///< rrggbb of each control point
};

// Control points fitted to the published tables of 256 colours, from which the curves through them differ by at most
// 1.94/255 in a channel. RdBu and Spectral are the tables themselves.
constexpr BuiltinMap kMaps[] = {
    {"viridis", true,
     "4401544814664825754634804144873b528b345f8d2f6c8e2a788e25848e21908c1e9c8922a8842fb47c43bf715dc9637ad1519ad93d"
     "bcdf28dee318fde724"},
    {"cividis", true,
     "00224e002757002b61002f6d02327115366f1f3a6f283e6e30426d37466c3d4a6c434e6c49526c4e566c545a6d595e6e5e626e636770"
     "686b716d6f727273747777767c7b788280788784798d8878928d789891779e9676a39a74a99f73afa371b5a86fbbad6cc1b26ac7b767"
     "cdbc63d4c15fdac65be0cb56e7d050edd649f4db43fbe137fee836"},
    {"magma", true,
     "0000030a08211d114635106b51127c691c808225829c2e7fb63779cf4170e65163f5695cfb8761fea571fec387fde0a2fcfdbf"},
    {"inferno", true,
     "00000307051c170c3b2c0b58420a6857106d6b176e7f1f6c932667a82d5fbb3755cd4248dd513ae9622af3771bf98d09fca50afbbd23"
     "f7d644f1ee72fbffa5"},
    {"plasma", true,
     "0d07872206903105963f049c4c02a15901a56600a77201a87e03a88909a69511a29f1a9ca92396b22c8ebb3587c33e80cb4778d25071"
     "d9596ae06263e66c5ceb7555f07f4ff48a48f89441fb9f3afdab33feb72dfdc328fcd025f9dd24f5eb28f0f923"},
    {"turbo", true,
     "31123c4040a3466be24393ff29bbec17dcc330f2996cfd64a3fd3ccbed34edd03afdae35fb8022ec520fd23105ac17017b0402"},
    {"coolwarm", true,
     "3b4cc0475fd05471de6282ea7092f37ea2fa8db0fe9cbcffaac7fdb8cff9c5d6f2d2dae8dddcdce7d7cdefcfbdf4c4adf7b89cf7aa8b"
     "f49a7bef886be7755bde604dd2493fc43032b40526"},
    {"RdBu", false, "67001fb2182bd6604df4a582fddbc7f7f7f7d1e5f092c5de4393c32166ac053061"},
    {"Spectral", false, "9e0142d53e4ff46d43fdae61fee08bffffbfe6f598abdda466c2a53288bd5e4fa2"},
    {"gray", false, "000000ffffff"}};

constexpr std::string_view kReversed = "_r";
constexpr std::size_t kMaxBytes = 1 << 20;  // of a file

std::optional<ColorMap> builtin_map(std::string_view name) {
  const bool reversed = name.ends_with(kReversed);
  const std::string_view base = reversed ? name.substr(0, name.size() - kReversed.size()) : name;
  for (const BuiltinMap& builtin : kMaps) {
    if (builtin.name != base) continue;
    ColorMap map{std::string(name), {}, builtin.smooth};
    constexpr std::size_t kDigits = 6;
    for (std::size_t k = 0; k < builtin.colors.size(); k += kDigits)
      map.colors.push_back(*named_color("#" + std::string(builtin.colors.substr(k, kDigits))));
    if (reversed) std::reverse(map.colors.begin(), map.colors.end());
    return map;
  }
  return std::nullopt;
}

/// Returns the words of a line between commas, semicolons and blanks.
std::vector<std::string> words_of_line(const std::string& line) {
  std::vector<std::string> words;
  constexpr std::string_view kBlank = " \t\r,;";
  for (std::size_t at = line.find_first_not_of(kBlank); at < line.size(); at = line.find_first_not_of(kBlank, at)) {
    const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// Returns the colour of a line: a name, or three numbers from 0 to 255; nothing if it is none. `numbers`: set if it is
/// numbers.
std::optional<std::array<float, 3>> color_of_line(const std::vector<std::string>& words, bool& numbers) {
  numbers = words.size() == 3;
  if (words.size() == 1) return named_color(words[0]);
  if (words.size() != 3) return std::nullopt;
  std::array<float, 3> color{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto value = parse_number(words[c], {0.0, 255.0});
    if (!value) return std::nullopt;
    color[c] = float(*value);
  }
  return color;
}

Result<ColorMap> map_of_file(const std::string& path) {
  std::ifstream whole(path, std::ios::binary);
  if (!whole) return file_error("'{}' cannot be opened: it is to hold a colour map", path);
  std::string text(kMaxBytes + 1, '\0');
  text.resize(std::size_t(whole.read(text.data(), std::streamsize(text.size())).gcount()));
  if (text.size() > kMaxBytes)
    return file_error("'{}' has more than {} bytes, which are too many for a colour map", path, kMaxBytes);
  std::istringstream file(text);
  ColorMap map{path, {}, false};
  std::vector<std::size_t> scaled;  // colours of numbers
  float max = 0.0f;
  std::size_t number = 0;
  bool has_heading = false;
  for (std::string line; std::getline(file, line);) {
    ++number;
    const auto words = words_of_line(line);
    if (words.empty()) continue;
    bool numbers = false;
    const auto color = color_of_line(words, numbers);
    if (!color && map.colors.empty() && !has_heading && !parse_number(words[0])) {
      has_heading = true;
      continue;
    }
    if (!color)
      return file_error(
          "'{}' has no colour in line {}: it takes three numbers, from 0 to 1 or from 0 to 255, #rrggbb or a CSS name",
          path, number);
    if (numbers) scaled.push_back(map.colors.size());
    if (numbers) max = std::max({max, (*color)[0], (*color)[1], (*color)[2]});
    map.colors.push_back(*color);
  }
  if (map.colors.size() < 2)
    return file_error("'{}' has {}: a colour map takes two or more", path,
                      map.colors.empty() ? "no colours" : "one colour");
  if (max > 1.0f)
    for (const std::size_t k : scaled)
      for (float& v : map.colors[k]) v /= 255.0f;
  return map;
}

}  // namespace

std::array<float, 3> ColorMap::at(float position) const {
  const int last = int(colors.size()) - 1;
  const float x = std::clamp(position, 0.0f, 1.0f) * float(last);
  const int i = std::min(int(x), last - 1);
  const float f = x - float(i);
  std::array<float, 3> color{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto of = [&](int k) { return colors[std::size_t(k)][c]; };
    const float b = of(i), d = of(i + 1);
    color[c] = b + f * (d - b);
    if (!smooth) continue;
    // The curve of [Catmull and Rom 1974], continued straight at the ends.
    const float a = i > 0 ? of(i - 1) : 2.0f * b - d, e = i + 2 <= last ? of(i + 2) : 2.0f * d - b;
    color[c] = b + 0.5f * f * (d - a + f * (2.0f * a - 5.0f * b + 4.0f * d - e + f * (3.0f * (b - d) + e - a)));
    color[c] = std::clamp(color[c], 0.0f, 1.0f);
  }
  return color;
}

std::vector<std::string_view> color_map_names() {
  std::vector<std::string_view> names;
  for (const BuiltinMap& map : kMaps) names.push_back(map.name);
  return names;
}

Result<ColorMap> color_map(const std::string& name_or_file) {
  if (auto map = builtin_map(name_or_file)) return std::move(*map);
  std::error_code ignored;
  const bool is_file =
      name_or_file.find_first_of("/.") != std::string::npos || std::filesystem::is_regular_file(name_or_file, ignored);
  if (is_file) {
    auto map = map_of_file(name_or_file);
    return map ? std::move(map) : with_field(map.error(), "color_map", name_or_file);
  }
  return field_error("color_map", name_or_file,
                     "`{}` cannot be '{}': it takes a file of colours, or {}, also with _r{}",
                     joined_by_or(color_map_names()), did_you_mean(nearest_name(name_or_file, color_map_names())));
}

}  // namespace umbrage
