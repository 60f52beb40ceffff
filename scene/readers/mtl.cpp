#include "scene/readers/mtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "core/lists.h"
#include "core/lowercase.h"
#include "scene/readers/obj_text.h"
#include "scene/readers/read_number.h"
#include "scene/readers/text_rules.h"

namespace umbrage {
namespace {

/// Removes the first word of a line and returns it.
std::string_view take_word(std::string_view& line) {
  line = trimmed(line);
  const std::size_t size = std::size_t(std::find_if(line.begin(), line.end(), is_blank) - line.begin());
  const std::string_view word = line.substr(0, size);
  line = trimmed(line.substr(size));
  return word;
}

/// Faults of one kind: their count and the first of them.
struct Faults {
  std::size_t count = 0, line = 0;
  std::string statement;
  void add(std::size_t at, std::string_view text) {
    if (count++ > 0) return;
    line = at;
    constexpr std::size_t kMaxShown = 60;  // bytes in a message
    statement = text.substr(0, kMaxShown);
    if (text.size() > kMaxShown) statement += "...";
  }
  std::string others() const {
    return count == 1 ? "" : count == 2 ? " and in another line" : fmt::format(" and in {} other lines", count - 1);
  }
};

/// Where statements store their numbers, and the range of these.
struct NumberRow {
  std::string_view word;
  std::optional<float> MtlMaterial::*member;
  float max;
};
constexpr float kAny = 3e38f;
constexpr NumberRow kNumbers[] = {{"ns", &MtlMaterial::exponent, kAny},     {"d", &MtlMaterial::opacity, 1.0f},
                                  {"tr", &MtlMaterial::transparency, 1.0f}, {"ni", &MtlMaterial::refraction, kAny},
                                  {"pr", &MtlMaterial::roughness, 1.0f},    {"pm", &MtlMaterial::metallic, 1.0f}};

struct ColorRow {
  std::string_view word;
  std::optional<glm::vec3> MtlMaterial::*member;
  float max;
};
constexpr ColorRow kColors[] = {{"kd", &MtlMaterial::diffuse, 1.0f},
                                {"ks", &MtlMaterial::specular, 1.0f},
                                {"ke", &MtlMaterial::emission, kAny},
                                {"tf", &MtlMaterial::filter, 1.0f}};

struct MapRow {
  std::string_view word;
  MtlMapKind kind;
};
constexpr MapRow kMaps[] = {{"map_kd", kMapKd}, {"map_d", kMapD},         {"map_opacity", kMapD},
                            {"map_ke", kMapKe}, {"map_emissive", kMapKe}, {"map_pr", kMapPr},
                            {"map_pm", kMapPm}, {"norm", kNorm},          {"map_norm", kNorm},
                            {"map_kn", kNorm},  {"bump", kMapBump},       {"map_bump", kMapBump}};

/// Statements that change what a renderer should draw, but not here. Ambient reflection (Ka, map_Ka) is not among them:
/// it repeats the diffuse one.
constexpr std::string_view kNotDrawn[] = {"map_Ks", "map_Ns", "map_Tr", "refl", "map_refl", "disp",  "map_disp",
                                          "decal",  "Ps",     "map_Ps", "Pc",   "Pcr",      "aniso", "anisor"};
constexpr std::string_view kHarmless[] = {"ka", "map_ka", "sharpness", "map_aat", "km", "tm"};

class LibraryParser {
 public:
  LibraryParser(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  MtlLibrary parse() {
    for (std::size_t at = 0; at < text_.size(); ++line_) {
      const std::size_t end = std::min(text_.find('\n', at), text_.size());
      const std::string_view line = trimmed(text_.substr(at, end - at));
      joined_ = std::size_t(std::count(text_.begin() + std::ptrdiff_t(at), text_.begin() + std::ptrdiff_t(end), '\v'));
      if (!line.empty() && line[0] != '#') statement(line);
      line_ += joined_;
      at = end + 1;
    }
    warn();
    return std::move(library_);
  }

 private:
  void statement(std::string_view line) {
    std::string_view rest = line;
    const std::string_view word = take_word(rest);
    const std::string key = lowercase(word);
    if (key == "newmtl") return start_material(without_comment(rest));
    if (!material_) return unknown_.add(line_, word);
    for (const NumberRow& row : kNumbers)
      if (key == row.word) return read_number_row(row, rest, line);
    for (const ColorRow& row : kColors)
      if (key == row.word) return read_color_row(row, rest, line);
    for (const MapRow& row : kMaps)
      if (key == row.word) return read_map(row.kind, rest, line);
    if (key == "illum") {
      const auto model = number_of(take_word(rest));
      if (model && *model >= 0.0 && *model <= 10.0) {
        material_->illumination = int(*model);
      } else {
        bad_.add(line_, line);
      }
      return;
    }
    for (const std::string_view name : kNotDrawn) {
      if (key != lowercase(name)) continue;
      const auto amount = number_of(take_word(rest));  // no effect if it is 0
      if (!(amount && *amount == 0.0)) ignore(std::string(name));
      return;
    }
    if (!contains(kHarmless, key)) unknown_.add(line_, word);
  }

  void start_material(std::string_view name) {
    auto& all = library_.materials;
    const auto [known, is_new] = number_of_.emplace(name, all.size());
    material_ = is_new ? &all.emplace_back() : &all[known->second];
    material_->name = name;
  }

  void ignore(const std::string& what) {
    auto& ignored = material_->ignored;
    constexpr std::size_t kMaxIgnored = 64;  // more are only in a file that is something else
    if (ignored.size() < kMaxIgnored && !contains(ignored, what)) ignored.push_back(what);
  }

  /// Clamps a number to 0 to max.
  float limited(double value, float max, std::string_view line) {
    const double inside = std::clamp(value, 0.0, double(max));
    if (inside != value) outside_.add(line_, line);
    return float(inside);
  }

  void read_number_row(const NumberRow& row, std::string_view rest, std::string_view line) {
    std::string_view word = take_word(rest);
    if (lowercase(word) == "-halo") {  // d -halo: transparent where it faces the viewer
      ignore("d -halo");
      word = take_word(rest);
    }
    const auto value = number_of(word);
    if (!value || !std::isfinite(*value)) return bad_.add(line_, line);
    (*material_).*row.member = limited(*value, row.max, line);
  }

  void read_color_row(const ColorRow& row, std::string_view rest, std::string_view line) {
    std::array<double, 3> values{};
    std::size_t count = 0;
    const std::string_view first = trimmed(rest);
    if (first.starts_with("spectral") || first.starts_with("xyz")) {
      ignore(fmt::format("{} as a spectrum or CIE XYZ", line.substr(0, 2)));
      return;
    }
    for (; count < 3 && !rest.empty() && rest[0] != '#'; ++count) {
      const auto value = number_of(take_word(rest));
      if (!value || !std::isfinite(*value)) return bad_.add(line_, line);
      values[count] = *value;
    }
    if (count == 1) values[1] = values[2] = values[0];  // the standard: green and blue equal red
    if (count != 1 && count != 3) return bad_.add(line_, line);
    glm::vec3 color;
    for (int c = 0; c < 3; ++c) color[c] = limited(values[std::size_t(c)], row.max, line);
    (*material_).*row.member = color;
  }

  /// Reads up to `max` numbers in front of a line and returns how many there are. Leaves what may be the file's name.
  std::size_t take_numbers(std::string_view& rest, std::span<double> values) {
    std::size_t count = 0;
    while (count < values.size()) {
      std::string_view after = rest;
      const auto value = number_of(take_word(after));
      if (!value || !std::isfinite(*value)) break;
      values[count++] = *value;
      rest = after;
    }
    return count;
  }

  /// Reads the options and the file's name, which may contain blanks, in any order. A '#' starts a comment after a
  /// quoted name or one with an extension: "wood #2.png # oak". Other words after a quoted name are ignored.
  void read_map(MtlMapKind kind, std::string_view rest, std::string_view line) {
    MtlMap map;
    bool is_quoted = false;
    std::string_view name;
    while (!rest.empty()) {
      std::string_view after = rest;
      const std::string_view word = take_word(after);
      if (word[0] == '"' && name.empty() && !is_quoted) {
        is_quoted = true;
        const std::size_t close = std::min(rest.find('"', 1), rest.size());
        name = rest.substr(1, close - 1);
        rest = trimmed(rest.substr(std::min(close + 1, rest.size())));
      } else if (word[0] == '#' && (is_quoted || name.find('.') != std::string_view::npos)) {
        break;
      } else if (word[0] == '-' && word.size() > 1 && word.find('.') == std::string_view::npos) {
        rest = after;
        read_option(lowercase(word), rest, map, line);
      } else {
        const char* const start = name.empty() ? word.data() : name.data();
        if (!is_quoted) name = {start, std::size_t(word.data() + word.size() - start)};
        rest = after;
      }
    }
    if (name.empty()) return;  // some exporters write the statement without a file
    map.file = name;
    material_->maps[kind] = std::move(map);
  }

  void read_option(const std::string& option, std::string_view& rest, MtlMap& map, std::string_view line) {
    std::array<double, 3> values{};
    const auto is_one_of = [&](std::initializer_list<std::string_view> names) { return contains(names, option); };
    if (is_one_of({"-s", "-o", "-t"})) {
      const std::size_t count = take_numbers(rest, values);
      if (count == 0) return bad_.add(line_, line);
      // A missing second number is the default.
      const glm::vec2 pair(values[0], count > 1 ? values[1] : option == "-s" ? 1.0 : 0.0);
      if (option == "-s") map.scale = pair;
      if (option == "-o") map.offset = pair;
      if (option == "-t" && pair != glm::vec2(0.0f)) ignore("-t (turbulence) of maps");
    } else if (option == "-mm") {
      if (take_numbers(rest, std::span(values).first(2)) != 2) return bad_.add(line_, line);
      map.base = float(values[0]);
      map.gain = float(values[1]);
    } else if (option == "-bm") {
      if (take_numbers(rest, std::span(values).first(1)) != 1) return bad_.add(line_, line);
      map.bump = float(values[0]);
    } else if (option == "-clamp") {
      map.clamp = lowercase(take_word(rest)) == "on";
    } else if (is_one_of({"-boost", "-texres", "-blendu", "-blendv", "-cc", "-colorspace", "-type"})) {
      take_word(rest);  // for filters and memory of old renderers, and for reflections
    } else if (option == "-imfchan") {
      const std::string channel = lowercase(take_word(rest));
      if (channel.size() == 1 && std::string_view("rgbml").find(channel[0]) != std::string_view::npos)
        map.channel = channel[0];
      else
        ignore(fmt::format("-imfchan {} of maps", channel));
    } else {
      ignore(fmt::format("{} of maps", option));
      // It has numbers, or else one word, which is no name of a file.
      std::string_view after = rest;
      const std::string_view word = take_word(after);
      if (take_numbers(rest, values) == 0 && !after.empty() && word.find('.') == std::string_view::npos) rest = after;
    }
  }

  void warn() {
    const auto add = [&](const Faults& faults, const char* what, const char* consequence) {
      if (faults.count == 0) return;
      library_.warnings.push_back(fmt::format("'{}' has {} in line {} ('{}'){}; {}", name_, what, faults.line,
                                              faults.statement, faults.others(), consequence));
    };
    add(bad_, "something other than a number", "the default applies");
    add(outside_, "a value out of range", "the nearest valid value applies");
    add(unknown_, "a statement that is not known", "it is ignored");
  }

  std::string_view text_;
  const std::string& name_;
  MtlLibrary library_;
  MtlMaterial* material_ = nullptr;
  std::map<std::string_view, std::size_t> number_of_;
  std::size_t line_ = 1, joined_ = 0;
  Faults bad_, outside_, unknown_;
};

constexpr float kNeutral = 0.8f;  ///< reflectance of surfaces without a colour in the file

/// Returns whether light passes through a material that is not transparent by d or Tr. Maya writes opaque materials as
/// illum 4 with Ni 1 and Tf 1 1 1, which as glass would be air.
bool is_glass(const MtlMaterial& source) {
  const int model = source.illumination;
  if (model != 4 && model != 6 && model != 7 && model != 9) return false;
  const bool refracts = source.refraction.value_or(0.0f) > 1.0f,
             filters = source.filter.value_or(glm::vec3(1.0f)) != glm::vec3(1.0f);
  if (refracts || filters) return true;
  return !source.refraction && (source.filter || model == 6 || model == 7);
}

}  // namespace

bool MtlMaterial::has_maps() const {
  return std::any_of(maps.begin(), maps.end(), [](const MtlMap& map) { return !map.file.empty(); });
}

MtlLibrary read_mtl(std::string_view text, const std::string& name) { return LibraryParser(text, name).parse(); }

bool is_invisible_by_tr(const MtlMaterial& source) {
  return !source.opacity && source.transparency == 1.0f && !is_glass(source);
}

Material material_of(const MtlMaterial& source) {
  Material material;
  material.name = source.name;
  material.albedo = source.diffuse.value_or(glm::vec3(source.maps[kMapKd].file.empty() ? kNeutral : 1.0f));
  const bool glass = is_glass(source);
  if ((source.illumination == 2 || glass) && source.specular && source.exponent.value_or(0.0f) > 0.0f) {
    material.specular_strength = std::max({source.specular->x, source.specular->y, source.specular->z});
    material.specular_exponent = std::clamp(*source.exponent, kMinExponent, kMaxExponent);
  }
  if (source.emission) material.emission = *source.emission;
  if (source.roughness || source.metallic) {
    material.roughness = source.roughness.value_or(std::pow(2.0f / (material.specular_exponent + 2.0f), 0.25f));
    material.metallic = source.metallic.value_or(0.0f);
  }
  float opacity = source.opacity.value_or(1.0f - source.transparency.value_or(0.0f));
  const bool contradicts = source.opacity == 0.0f && source.transparency == 0.0f;
  if (is_invisible_by_tr(source) || contradicts) opacity = 1.0f;
  if (glass) opacity = opacity < 1.0f ? std::max(opacity, kGlassOpacity) : kGlassOpacity;
  material.blended = opacity < 1.0f;
  material.glass = glass;
  material.opacity = opacity;
  if (material.blended && source.filter) material.tint = *source.filter;
  material.ignored = source.ignored;
  return material;
}

}  // namespace umbrage
