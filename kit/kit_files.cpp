// The files of a kit that are for programs: pass.json, frame.h and frame.js.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/version.h"
#include "kit/kit.h"
#include "kit/text.h"

namespace umbrage {
namespace {

constexpr std::string_view kRoles[] = {"input", "inout", "intermediate", "output"};

/// The view in C and JavaScript: type, names, comment.
struct ViewField {
  const char *type, *c, *script, *about;
};
constexpr ViewField kView[] = {
    {"int", "width", "width", "pixels"},
    {"int", "height", "height", "pixels"},
    {"int", "orthographic", "orthographic", "0: perspective; 1: orthographic"},
    {"float", "left", "left", "window of the picture at depth 1, view space; orthographic: in scene units"},
    {"float", "right", "right", "so the horizontal field of view is atan(right) - atan(left)"},
    {"float", "bottom", "bottom", "y points up"},
    {"float", "top", "top", "row 0 of the picture"},
    {"float", "scene_radius", "sceneRadius",
     "lengths in percent refer to it, such as the radius of occlusion; scene units"},
    {"float", "depth_min", "depthMin", "range of depths that contains the scene, scene units"},
    {"float", "depth_max", "depthMax", ""},
    {"float", "light_x", "lightX", "unit vector to the light, view space: x to the right, y up, z to the viewer"},
    {"float", "light_y", "lightY", ""},
    {"float", "light_z", "lightZ", ""},
};

nlohmann::ordered_json record_of(const KitTexture& texture) {
  nlohmann::ordered_json record = {{"name", texture.name},
                                   {"channels", texture.channels},
                                   {"role", kRoles[int(texture.role)]},
                                   {"format", texture.channels == 1 ? "R32F" : "RGBA32F"},
                                   {"size", texture.is_reduced ? "reduced" : "full"},
                                   {"exact", texture.is_exact}};
  if (texture.has_neutral) record["neutral"] = texture.neutral;
  return record;
}

nlohmann::ordered_json record_of(const KitBlock& block) {
  nlohmann::ordered_json fields = nlohmann::json::array();
  for (std::size_t k = 0; k < block.fields.size(); ++k) {
    const FrameField& field = block.fields[k];
    fields.push_back({{"name", field.member},
                      {"type", field.field.type},
                      {"offset", 4 * k},
                      {"formula", field.formula},
                      {"about", field.field.about}});
  }
  return {{"name", block.name}, {"size", block.size()}, {"fields", fields}};
}

nlohmann::ordered_json record_of(const KitPass& pass, std::string_view extension) {
  const std::string file = pass.file.substr(0, pass.file.rfind('.')) + std::string(extension);
  return {{"file", file},
          {"effect", pass.effect},
          {"round", pass.round},
          {"size", pass.is_reduced ? "reduced" : "full"},
          {"samplers", pass.samplers},
          {"inputs", pass.inputs},
          {"outputs", pass.outputs}};
}

/// Returns the words of all formulas of a block.
std::set<std::string> formula_words(const KitBlock& block) {
  std::set<std::string> words;
  for (const FrameField& field : block.fields)
    for (const std::string& word : words_of(field.formula)) words.insert(word);
  return words;
}

bool uses_mips(const Kit& kit) {
  return std::any_of(kit.blocks.begin(), kit.blocks.end(),
                     [](const KitBlock& block) { return formula_words(block).count("mip_levels") > 0; });
}

std::string c_formula(std::string formula) {
  for (const char* name : {"min", "max"}) formula = with_word(formula, name, fmt::format("f{}", name));
  return formula;
}

constexpr std::string_view kDepthInC = R"(
/* The uniform block of linear_depth. */
typedef struct DepthFrame {
  int kind;
  float a, b, background;
} DepthFrame;

/* Returns it for a perspective camera. `z_far` 0: infinite. `reversed`: depth is 1 at the near plane. */
static inline DepthFrame depth_frame(float z_near, float z_far, int reversed) {
  const float near_inverse = 1 / z_near, far_inverse = z_far > 0 ? 1 / z_far : 0;
  DepthFrame f;
  f.kind = 0;
  f.a = reversed ? far_inverse : near_inverse;
  f.b = reversed ? near_inverse - far_inverse : far_inverse - near_inverse;
  f.background = reversed ? 0 : 1;
  return f;
}
)";

// FUNCTION and INTEGER are the words of C or JavaScript; >> divides in both.
constexpr std::string_view kMips = R"(
/* The levels that fit into a texture of the picture's size, one below the other, and the rows of the first of them. */
FUNCTION mip_rows_of(PARAMETER height, PARAMETER levels) {
  INTEGER multiple = 1 << (levels - 1);
  return ((((height >> 1) + multiple - 1) >> (levels - 1)) * multiple);
}
FUNCTION mip_levels(PARAMETER width, PARAMETER height) {
  INTEGER levels = 5;
  for (; levels > 0; --levels) {
    INTEGER rows = mip_rows_of(height, levels);
    if (2 * rows - (rows >> (levels - 1)) <= height && width >> levels > 0 && height >> levels > 0) break;
  }
  return levels;
}
FUNCTION mip_rows(PARAMETER width, PARAMETER height) {
  INTEGER levels = mip_levels(width, height);
  return levels > 0 ? mip_rows_of(height, levels) : 0;
}
)";

std::string mips_text(bool is_script) {
  std::string text = replaced(std::string(kMips), "FUNCTION", is_script ? "function" : "static inline int");
  text = replaced(text, "INTEGER", is_script ? "let" : "int");
  return replaced(text, "PARAMETER ", is_script ? "" : "int ");
}

/// Returns the declarations of the variables that the formulas of a block need.
std::string variables(const KitBlock& block, bool is_script) {
  const std::set<std::string> words = formula_words(block);
  const bool width = words.count("pixel_width") > 0, height = words.count("pixel_height") > 0;
  std::string text;
  for (const ViewField& field : kView) {
    const std::string name = field.c;
    const bool is_needed = words.count(name) > 0 || (width && (name == "left" || name == "right" || name == "width")) ||
                           (height && (name == "top" || name == "bottom" || name == "height"));
    if (!is_needed) continue;
    text += is_script ? fmt::format("    const {} = +view.{};\n", field.c, field.script)
                      : fmt::format("  const {} {} = v->{};\n", name == "width" || name == "height" ? "int" : "double",
                                    field.c, field.c);
  }
  const char* kind = is_script ? "    const" : "  const double";
  if (width) text += fmt::format("{} pixel_width = (right - left) / width;\n", kind);
  if (height) text += fmt::format("{} pixel_height = (top - bottom) / height;\n", kind);
  return text;
}

std::string struct_text(const KitBlock& block) {
  std::string text =
      fmt::format("\n/* The uniform block of {}, std140. */\ntypedef struct {} {{\n", block.effect, block.name);
  for (const FrameField& field : block.fields)
    text += fmt::format("  {} {};{}\n", field.field.type, field.member,
                        field.field.about.empty() ? "" : fmt::format("  /* {} */", field.field.about));
  if (const std::size_t pad = std::size_t(block.size()) / 4 - block.fields.size(); pad > 0)
    text += fmt::format("  float pad[{}];\n", pad);
  text += fmt::format(
      "}} {};\n\nstatic inline {} {}(const UmbrageView* v, int round) {{\n{}  {} f;\n  memset(&f, 0, sizeof f);\n",
      block.name, block.name, block.effect + "_frame", variables(block, false), block.name);
  for (const FrameField& field : block.fields)
    text += fmt::format("  f.{} = ({})({});\n", field.member, field.field.type, c_formula(field.formula));
  if (!formula_words(block).count("round")) text += "  (void)round;\n";
  return text + "  return f;\n}\n";
}

}  // namespace

std::string kit_json(const Kit& kit, const std::vector<std::string>& files) {
  nlohmann::ordered_json record = {{"umbrage", std::string(project_version())},
                                   {"effects", kit.effects},
                                   {"settings", kit.settings},
                                   {"language", std::string(language_name(kit.language))},
                                   {"factor", kit.factor}};
  for (const KitTexture& texture : kit.textures) record["textures"].push_back(record_of(texture));
  for (const KitBlock& block : kit.blocks) record["blocks"][block.effect] = record_of(block);
  for (const KitPass& pass : kit.passes) record["passes"].push_back(record_of(pass, language_extension(kit.language)));
  if (const std::string_view error = kit_error(kit); !error.empty()) record["rmse"] = std::stod(std::string(error));
  if (!files.empty()) record["files"] = files;
  return record.dump(1) + "\n";
}

std::string kit_header(const Kit& kit) {
  std::string text = fmt::format(
      "/* Fills the uniform blocks of {}, by Umbrage {}. MIT licence. C99 and C++. */\n#pragma once\n#include "
      "<math.h>\n#include <string.h>\n\n"
      "typedef struct UmbrageView {{\n",
      fmt::join(kit.effects, ", "), project_version());
  for (const ViewField& field : kView)
    text += fmt::format("  {} {};{}\n", field.type, field.c, *field.about ? fmt::format(" /* {} */", field.about) : "");
  text += "} UmbrageView;\n";
  text += R"(
/* Returns the view of the picture that has every `factor`th pixel of every `factor`th row. */
static inline UmbrageView umbrage_reduced_view(const UmbrageView* v, int factor) {
  UmbrageView r = *v;
  const float pixel_width = (v->right - v->left) / (float)v->width;
  const float pixel_height = (v->top - v->bottom) / (float)v->height;
  r.width = (v->width + factor - 1) / factor;
  r.height = (v->height + factor - 1) / factor;
  r.left = v->left + 0.5f * pixel_width * (float)(1 - factor);
  r.right = r.left + pixel_width * (float)(factor * r.width);
  r.top = v->top - 0.5f * pixel_height * (float)(1 - factor);
  r.bottom = r.top - pixel_height * (float)(factor * r.height);
  return r;
}
)";
  text += kDepthInC;
  if (uses_mips(kit)) text += mips_text(false);
  for (const KitBlock& block : kit.blocks) text += struct_text(block);
  return text;
}

std::string kit_script(const Kit& kit, const std::vector<KitFile>& files) {
  std::string text = fmt::format(
      "// Fills the uniform blocks of {}, by Umbrage {}. MIT licence. An ES module.\n"
      "// A view has these fields:\n",
      fmt::join(kit.effects, ", "), project_version());
  for (const ViewField& field : kView)
    text += fmt::format("//   {}{}\n", field.script, *field.about ? fmt::format(": {}", field.about) : "");
  text += "const { min, max, floor, sqrt } = Math;\n";
  if (uses_mips(kit)) text += mips_text(true);
  text += R"(
// Returns the view of the picture that has every `factor`th pixel of every `factor`th row.
export function reducedView(view, factor) {
  const pixelWidth = (view.right - view.left) / view.width, pixelHeight = (view.top - view.bottom) / view.height;
  const width = Math.ceil(view.width / factor), height = Math.ceil(view.height / factor);
  const left = view.left + 0.5 * pixelWidth * (1 - factor), top = view.top - 0.5 * pixelHeight * (1 - factor);
  return { ...view, width, height, left, top, right: left + pixelWidth * factor * width,
    bottom: top - pixelHeight * factor * height };
}

// Return the content of a uniform block, an ArrayBuffer.
export const frames = {
)";
  for (const KitBlock& block : kit.blocks) {
    text += fmt::format("  {}(view, round = 0) {{\n{}    const data = new DataView(new ArrayBuffer({}));\n",
                        block.effect, variables(block, true), block.size());
    for (std::size_t k = 0; k < block.fields.size(); ++k) {
      const FrameField& field = block.fields[k];
      text += fmt::format("    data.set{}({}, {}, true);  // {}\n", field.field.type == "int" ? "Int32" : "Float32",
                          4 * k, field.formula, field.member);
    }
    text += "    return data.buffer;\n  },\n";
  }
  text += "};\n\n// The content of pass.json.\nexport const kit = " + kit_json(kit);
  text.pop_back();
  text += ";\n\n// The shaders.\nexport const sources = {\n";
  for (const KitFile& file : files)
    text += fmt::format("  {}: {},\n", nlohmann::json(file.name).dump(), nlohmann::json(file.text).dump());
  return text + "};\n";
}

}  // namespace umbrage
