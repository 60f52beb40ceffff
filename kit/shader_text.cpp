#include "kit/shader_text.h"

#include <algorithm>
#include <regex>

#include "core/check.h"
#include "core/version.h"
#include "kit/dialect.h"
#include "kit/fold.h"
#include "kit/text.h"

namespace umbrage {
namespace {

using Kind = KernelPlane::Kind;

/// Returns the name of the texture of a plane: that of a colour for its alpha.
std::string texture_of(const KernelPlane& plane) {
  return plane.is_alpha ? plane.name.substr(0, plane.name.size() - 2) : plane.name;
}

bool is_depth(const std::string& name) { return name == "depth" || name == "reduced_depth"; }
bool is_normal(const std::string& name) { return name == "normal" || name == "reduced_normal"; }

/// Returns the expression that a plane's functions return, of the variable `texel`.
std::string fetched(const KernelPlane& plane) {
  if (plane.is_alpha) return "texel.a";
  if (is_depth(plane.name)) return "texel.r > 0.0 ? texel.r : kFar";
  if (is_normal(plane.name)) return "decoded_normal(texel)";
  return plane.type == "vec3" ? "texel.rgb" : "texel.r";
}

/// Splits the body of a macro into items; a function may have several lines.
std::vector<KernelItem> items_of_body(const std::string& body) {
  std::vector<KernelItem> items;
  std::string text;
  for (std::size_t begin = 0; begin < body.size();) {
    const std::size_t end = body.find('\n', begin);
    const std::string line = body.substr(begin, end - begin);
    begin = end + 1;
    text += (text.empty() ? "" : "\n") + line;
    const bool is_one_line = text.find('\n') == std::string::npos;
    if (is_one_line ? line.ends_with('{') : line != "}") continue;
    const auto words = words_of(text.substr(0, text.find_first_of("(;[", text.starts_with("layout") ? 8 : 0)));
    items.push_back({"", text, {words.back()}});
    text.clear();
  }
  return items;
}

/// Returns the items of a plane, list or sum.
std::vector<KernelItem> items_of_plane(const KernelPlane& plane, const std::map<std::string, float>& absent) {
  std::string body;
  const auto fill = [&](std::string_view macro, const std::string& set, const std::string& value) {
    std::string text = plane_template(macro);
    text = replaced(text, "name_texture", texture_of(plane) + "_texture");
    text = replaced(text, "name_out", texture_of(plane) + "_out");
    text = replaced(text, "name_", plane.local + "_");
    text = replaced(text, "_name", "_" + plane.local);
    text = with_word(text, "type", plane.type);
    text = with_word(text, "length", plane.length);
    text = with_word(text, "set", set);
    body += with_word(text, "fetched", value);
  };
  if (plane.kind == Kind::kList) fill("LIST_PLANE", "", "");
  if (plane.kind == Kind::kSums) fill("SUMS_PLANE", "", "");
  if (plane.kind == Kind::kIn || plane.kind == Kind::kInOut) fill("IN_PLANE", "", fetched(plane));
  if ((plane.kind == Kind::kOut || plane.kind == Kind::kInOut) && !plane.is_alpha)
    fill("OUT_PLANE", texture_of(plane) + "_out = " + (plane.type == "vec3" ? "vec4(v, 1.0)" : "v"), "");
  if (plane.kind == Kind::kOut && plane.is_alpha)
    body = fmt::format("void store_{0}_alpha(float v) {{ {0}_out.a = v; }}\n", texture_of(plane));
  const std::string zero = plane.type == "vec3" ? "vec3(0.0)" : "0.0";
  if (plane.kind == Kind::kAbsent)
    body = fmt::format(
        "{0} near_{1}(int i, int j) {{ return {2}; }}\n{0} read_{1}_of(int layer, int place) {{ return {2}; }}\n"
        "void store_{1}({0} v) {{}}\n",
        plane.type, plane.local, zero);
  std::vector<KernelItem> items = items_of_body(body);
  if (const auto constant = absent.find(texture_of(plane)); constant != absent.end() && plane.kind == Kind::kIn) {
    for (KernelItem& item : items) {
      if (!item.names[0].starts_with("texel_of_")) continue;
      const std::string value = fmt::format("{:#.9g}", constant->second);
      item.text = fmt::format("{} {}(ivec2 pixel) {{ return {}; }}", plane.type, item.names[0],
                              plane.type == "vec3" ? "vec3(" + value + ")" : value);
      item.comment = "// Nothing writes this plane with these settings.\n";
    }
  }
  return items;
}

/// Returns the values of constants, and of the settings that are one number.
KnownValues known_values(const std::vector<KernelItem>& items, const EffectFields& fields) {
  KnownValues known;
  for (const KernelItem& item : items) {
    if (!item.text.starts_with("const ")) continue;
    for (const std::string& name : item.names) {
      const std::size_t begin = item.text.find(name + " = ") + name.size() + 3;
      const std::string value = item.text.substr(begin, item.text.find_first_of(",;", begin) - begin);
      const bool is_integer = !value.empty() && value.find_first_not_of("-0123456789") == std::string::npos;
      if (is_integer) known[name] = std::stod(value);
      if (const auto flag = decided(value, {}); flag && !is_integer) known[name] = *flag;
    }
  }
  for (const SettingField& setting : fields.settings)
    if (!setting.field.is_array)
      known["C." + setting.field.name] = std::stod(number_literal(setting.field, setting.values[0]));
  return known;
}

/// Keeps the items that `entry` needs, in order; of a line of constants those that are needed.
std::vector<KernelItem> needed(const std::vector<KernelItem>& items, const std::string& entry) {
  std::map<std::string, std::vector<std::size_t>> by_name;
  for (std::size_t k = 0; k < items.size(); ++k)
    for (const std::string& name : items[k].names) by_name[name].push_back(k);
  std::set<std::size_t> kept;
  std::set<std::string> words;
  std::vector<std::string> todo = {entry, "here"};
  while (!todo.empty()) {
    const std::string name = todo.back();
    todo.pop_back();
    if (!words.insert(name).second) continue;
    for (const std::size_t k : by_name[name])
      if (kept.insert(k).second)
        for (const std::string& word : words_of(items[k].text)) todo.push_back(word);
  }
  std::vector<KernelItem> result;
  for (const std::size_t k : kept) result.push_back(items[k]);
  return result;
}

/// Returns a line of constants without those that no other item reads. `words`: those of the other items.
std::string without_unread(const KernelItem& item, const std::set<std::string>& words) {
  std::string text = item.text;
  if (!text.starts_with("const ") || item.names.size() < 2) return text;
  for (const std::string& name : item.names) {
    if (words.count(name)) continue;
    const std::size_t at = text.find(name + " = ");
    std::size_t end = text.find_first_of(",;", at);
    const bool is_last = text[end] == ';';
    text.erase(is_last ? text.rfind(',', at) : at, is_last ? end - text.rfind(',', at) : end + 1 - at);
    if (!is_last && text[at] == ' ') text.erase(at, 1);
  }
  return text;
}

/// Adds the names after "F." or "C.".
void add_members(const std::string& text, char owner, std::set<std::string>& names) {
  const std::string code = blanked(text);
  const std::regex member(fmt::format("\\b{}\\.([a-z_0-9]+)", owner));
  for (std::sregex_iterator at(code.begin(), code.end(), member), end; at != end; ++at) names.insert((*at)[1]);
}

void add_plane(std::vector<ShaderPlane>& planes, const std::string& name, int channels) {
  for (ShaderPlane& plane : planes) {
    if (plane.name != name) continue;
    plane.channels = std::max(plane.channels, channels);
    return;
  }
  planes.push_back({name, channels});
}

std::string array_or(const ConstantField& field, std::size_t count, std::string_view text) {
  return field.is_array ? fmt::format("{}[{}]{}", field.type, count, text) : std::string(text);
}

}  // namespace

std::string number_literal(const ConstantField& field, std::uint32_t bits) {
  const double value = value_of(field, bits);
  if (field.type == "int") return fmt::format("{}", int(value));
  std::string text = fmt::format("{}", float(value));
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

ShaderParts shader_parts(const KernelText& kernel, const EffectFields& fields,
                         const std::map<std::string, float>& absent, bool is_first_round_alone,
                         ShaderLanguage language) {
  const KernelItems source = kernel_items(kernel);
  std::set<std::string> floats;
  std::map<std::string, std::string> varying;  // names of constants, and of the members of F that they are
  for (const SettingField& setting : fields.settings)
    if (setting.field.type == "float") floats.insert("C." + setting.field.name);
  for (const FrameField& frame : fields.frame) {
    if (frame.field.type == "float") floats.insert({"F." + frame.field.name, "C." + frame.field.name});
    varying[frame.field.name] = frame.member;
  }
  // Planes come before the functions that use them, and behind those of glsl_images.h that their functions use.
  const auto images_end = std::find_if(source.items.begin(), source.items.end(),
                                       [](const KernelItem& item) { return item.text.starts_with("FN "); });
  std::vector<KernelItem> items(source.items.begin(), images_end);
  std::set<std::string> declared;
  for (const KernelPlane& plane : source.planes)
    for (KernelItem& item : items_of_plane(plane, absent))
      if (declared.insert(item.text).second) items.push_back(std::move(item));
  items.insert(items.end(), images_end, source.items.end());
  for (KernelItem& item : items) {
    if (item.text.starts_with("CONST float") || item.text.starts_with("const float"))
      floats.insert(item.names.begin(), item.names.end());
    item.text = glsl_of(item.text, floats);
  }
  KnownValues known = known_values(items, fields);
  if (is_first_round_alone) known["F.round"] = 0.0;
  for (KernelItem& item : items) {
    if (item.text.ends_with("}")) item.text = folded(item.text, known);
    if (item.text.starts_with("const bool ") && known.count(item.names[0]))
      item.text = fmt::format("const bool {} = {};", item.names[0], known.at(item.names[0]) != 0.0);
  }
  ShaderParts parts;
  parts.about = source.about;
  parts.entry = kernel.entry;
  parts.items = needed(items, fmt::format("{}_pixel", kernel.entry));
  std::set<std::string> words;
  for (const KernelItem& item : parts.items)
    if (item.names.size() == 1 || !item.text.starts_with("const "))
      for (const std::string& word : words_of(item.text)) words.insert(word);
  static const std::regex array_element("F\\.([a-z_0-9]+)\\[[^\\]]*\\]");  // of the first layer or light, the only one
  for (KernelItem& item : parts.items) {
    item.text = without_unread(item, words);
    for (const auto& [name, member] : varying)
      if (item.text.find("C." + name) != std::string::npos)
        item.text = replaced(with_word(replaced(item.text, "C.", "C__"), "C__" + name, "F." + member), "C__", "C.");
    item.text = std::regex_replace(item.text, array_element, "F.$1");
    item.text = replaced(item.text, "ROW_0_AT_TOP ? pixel : ivec2(pixel.x, size.y - 1 - pixel.y)",
                         is_opengl(language) ? "ivec2(pixel.x, size.y - 1 - pixel.y)" : "pixel");
    if (language == ShaderLanguage::kGlslEs) item.text = replaced(item.text, "fma(a, b, c)", "a * b + c");
    if (language != ShaderLanguage::kGlslEs) item.text = replaced(item.text, "highp ", "");
    add_members(item.text, 'F', parts.frame);
    add_members(item.text, 'C', parts.settings);
  }
  parts.frame.insert({"width", "height"});
  for (const std::string& name : parts.frame)
    if (std::none_of(fields.frame.begin(), fields.frame.end(), [&](auto& frame) { return frame.member == name; }))
      fail_check(fmt::format("{} reads F.{}", kernel.name, name));
  for (const KernelPlane& plane : source.planes) {
    const bool is_read = words.count(texture_of(plane) + "_texture") > 0;
    const bool is_written = words.count(texture_of(plane) + "_out") > 0;
    const int channels = plane.is_alpha ? 4 : plane.type == "vec3" ? 3 : 1;
    if (is_read && (plane.kind == Kind::kIn || plane.kind == Kind::kInOut))
      add_plane(parts.inputs, texture_of(plane), channels);
    if (is_written && (plane.kind == Kind::kOut || plane.kind == Kind::kInOut))
      add_plane(parts.outputs, texture_of(plane), channels);
  }
  return parts;
}

std::string shader_text(const ShaderParts& parts, const EffectFields& fields, const ShaderHead& head,
                        ShaderLanguage language) {
  const bool is_es = language == ShaderLanguage::kGlslEs, is_gl = is_opengl(language);
  std::string text(version_line(language));
  text += fmt::format("// {}, by Umbrage {}. MIT licence.\n//\n", head.title, project_version());
  text += parts.about + "\n";
  if (is_es) text += "precision highp float;\nprecision highp int;\n\n";
  const bool reads_normals = std::any_of(parts.inputs.begin(), parts.inputs.end(),
                                         [](const ShaderPlane& plane) { return is_normal(plane.name); });
  if (reads_normals)
    text +=
        "// How textures of normals hold them: see decoded_normal().\n#ifndef UMBRAGE_NORMALS\n"
        "#define UMBRAGE_NORMALS 0\n#endif\n\n";
  int binding = 0;
  text += fmt::format("// What depends on the view: README.md has the formulas.\nlayout(std140{}) uniform {} {{\n",
                      is_gl ? "" : fmt::format(", binding = {}", binding), head.block);
  for (const FrameField& frame : head.frame) {
    text += fmt::format("  {} {};{}\n", frame.field.type, frame.member,
                        frame.field.about.empty() ? "" : "  // " + frame.field.about);
  }
  text += "} F;\n\n";
  std::string members, values;
  for (const SettingField& setting : fields.settings) {
    if (!parts.settings.count(setting.field.name)) continue;
    const std::size_t count = setting.values.size();
    members += fmt::format("  {} {};\n", setting.field.type,
                           setting.field.name + (setting.field.is_array ? fmt::format("[{}]", count) : ""));
    std::string numbers;
    for (const std::uint32_t bits : setting.values)
      numbers += (numbers.empty() ? "" : ", ") + number_literal(setting.field, bits);
    if (!values.empty()) values.insert(values.rfind("  //"), ",");
    values += fmt::format("  {}  // {}{}\n",
                          array_or(setting.field, count, setting.field.is_array ? "(" + numbers + ")" : numbers),
                          setting.field.name, setting.field.about.empty() ? "" : ": " + setting.field.about);
  }
  if (!members.empty())
    text += fmt::format("// The settings.\nstruct {0} {{\n{1}}};\nconst {0} C = {0}(\n{2});\n\n", head.settings,
                        members, values);
  std::map<std::string, int> locations;
  for (const ShaderPlane& plane : parts.outputs) locations.emplace(plane.name, int(locations.size()));
  bool was_short = false;
  for (const KernelItem& item : parts.items) {
    std::string body = item.text;
    if (body.starts_with("layout(location = ")) {
      const std::string name = item.names[0].substr(0, item.names[0].size() - 4);
      const auto plane =
          std::find_if(parts.outputs.begin(), parts.outputs.end(), [&](auto& p) { return p.name == name; });
      if (plane == parts.outputs.end()) continue;
      body = fmt::format("layout(location = {}) out {}{} {}_out;", locations[name], is_es ? "highp " : "",
                         plane->channels == 1 ? "float" : "vec4", name);
    }
    if (body.starts_with("uniform ") && !is_gl) body = fmt::format("layout(binding = {}) {}", ++binding, body);
    const bool is_short = body.find('\n') == std::string::npos && item.comment.empty();
    if (!(is_short && was_short) || body.find(" uniform ") != std::string::npos || body.starts_with("uniform "))
      text += "\n";
    text += item.comment + body + "\n";
    was_short = body.find('\n') == std::string::npos;
  }
  text += fmt::format("\nvoid main() {{\n  here = ivec2(gl_FragCoord.xy);\n{}  {}_pixel(here.x, here.y);\n}}\n",
                      is_gl ? "  here.y = F.height - 1 - here.y;\n" : "", parts.entry);
  std::string out;  // at most one empty line in a row
  for (const char c : text)
    if (!(c == '\n' && out.ends_with("\n\n"))) out += c;
  return out;
}

}  // namespace umbrage
