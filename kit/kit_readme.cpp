// README.md of a kit.
#include <algorithm>
#include <set>

#include "core/version.h"
#include "kit/kit.h"

namespace umbrage {
namespace {

using Role = KitTexture::Role;

/// What the planes that callers bring or get contain.
constexpr struct {
  std::string_view name, about;
} kPlanes[] = {
    {"depth",
     "distance along the view axis, scene units, above 0; 0: background. `linear_depth` makes it of a depth buffer"},
    {"normal",
     "unit vector, view space: x to the right, y up, z to the viewer; 0: background. `#define UMBRAGE_NORMALS 1` "
     "before the shader for vectors stored as 0 to 1, 2 for octahedral ones in two channels. The effect "
     "`normals` makes it of depth"},
    {"ao", "fraction of ambient light that arrives, 0 to 1"},
    {"indirect", "light that arrives from other surfaces, linear: multiply it by the albedo"},
    {"albedo", "diffuse reflectance, linear"},
    {"direct", "light of the lights that the surface reflects, linear"},
    {"ambient", "ambient light that the surface reflects, without occlusion, linear"},
    {"shadow", "fraction of the key light that arrives, 0 to 1"},
    {"specular", "peak of the highlight, 0 to 1"},
    {"shininess", "Blinn-Phong exponent"},
    {"color", "finished picture, display values, with alpha"},
    {"lit", "linear light"},
    {"outline", "fraction of the pixel that lines cover, 0 to 1"},
    {"bent", "mean unoccluded direction, unit, view space"},
};

std::string about(const std::string& name) {
  for (const auto& row : kPlanes)
    if (name == row.name || name == reduced_plane(row.name)) return std::string(row.about);
  return "";
}

/// Presets and the RMSE of their `ao` against ray tracing, over eight scenes: docs/shaders.md.
constexpr struct {
  std::string_view effects, changed, rmse;
} kErrors[] = {
    {"bitmask,denoise", "", ".084"},
    {"bitmask,denoise,upsample", "", ".089"},
    {"bitmask,denoise", "bitmask.slices=1 bitmask.steps=6", ".096"},
    {"bitmask,denoise", "bitmask.slices=4 bitmask.steps=24", ".078"},
    {"bitmask", "", ".103"},
    {"hemisphere,denoise", "", ".112"},
    {"ssdo,denoise", "", ".112"},
    {"sphere,denoise", "", ".186"},
    {"unsharp", "", ".274"},
};

std::string error_text(const Kit& kit) {
  std::string effects = fmt::format("{}", fmt::join(kit.effects, ","));
  if (effects.starts_with("normals,")) effects.erase(0, 8);
  for (const auto& row : kErrors)
    if (row.effects == effects && row.changed == fmt::format("{}", fmt::join(kit.changed, " ")))
      return fmt::format("RMSE of `ao` with these settings against ray tracing, over eight scenes: {}. ", row.rmse);
  return "";
}

int bytes_of(const KitTexture& texture) { return texture.channels == 1 ? 4 : 16; }

const KitTexture& texture_of(const Kit& kit, const std::string& name) {
  return *std::find_if(kit.textures.begin(), kit.textures.end(),
                       [&](const auto& texture) { return texture.name == name; });
}

}  // namespace

std::string kit_readme(const Kit& kit) {
  const bool is_gl = kit.language == ShaderLanguage::kGlsl || kit.language == ShaderLanguage::kGlslEs;
  const std::string extension(language_extension(kit.language));
  std::string text = fmt::format(
      "# {} as {} shaders\n\nMade by Umbrage {}: `umbrage shaders {} --language {}`. MIT licence. `pass.json` has the "
      "content of "
      "this page for programs.\n\n"
      "Each shader is a fragment shader for a triangle that covers the picture (`screen`). Run the passes in order. "
      "Bind the "
      "textures to the samplers, without filtering, and draw to the outputs, by location. Row 0 of a plane is the {} "
      "of the "
      "picture{}. A pass that reads a plane that it writes needs two textures, which are then swapped.\n\n",
      fmt::join(kit.effects, ", "), language_name(kit.language), project_version(), fmt::join(kit.effects, ","),
      language_name(kit.language), is_gl ? "last row" : "top row", is_gl ? ", as OpenGL draws" : "");
  text += "## Textures\n\n| name | | channels | format | content |\n|---|---|---|---|---|\n";
  for (const KitTexture& texture : kit.textures) {
    constexpr std::string_view kRoles[] = {"input", "input and output", "intermediate", "output"};
    std::string content = about(texture.name);
    if (texture.is_reduced) content += fmt::format("{}1/{} of the size", content.empty() ? "" : "; ", kit.factor);
    if (texture.has_neutral)
      content += fmt::format("{}optional: without it, bind a texture of one pixel with {}", content.empty() ? "" : "; ",
                             texture.neutral);
    if (texture.is_exact) content += fmt::format("{}packed bits: 32-bit floats only", content.empty() ? "" : "; ");
    text += fmt::format("| `{}` | {} | {} | {} | {} |\n", texture.name, kRoles[int(texture.role)], texture.channels,
                        texture.channels == 1
                            ? texture.is_exact || texture.name.ends_with("depth") ? "R32F" : "R32F or R16F"
                            : "RGBA32F or RGBA16F",
                        content);
  }
  text += "\n## Passes\n\n| pass | size | reads | writes | bytes written per pixel |\n|---|---|---|---|---|\n";
  for (const KitPass& pass : kit.passes) {
    int bytes = 0;
    for (const std::string& name : pass.outputs) bytes += bytes_of(texture_of(kit, name));
    const std::string round = pass.round > 0 ? fmt::format(", round {}", pass.round) : "";
    text += fmt::format("| `{}`{} | {} | {} | {} | {} |\n", pass.file.substr(0, pass.file.rfind('.')) + extension,
                        round, pass.is_reduced ? fmt::format("1/{}", kit.factor) : "full", fmt::join(pass.inputs, ", "),
                        fmt::join(pass.outputs, ", "), bytes);
  }
  text += fmt::format(
      "\n## Uniform blocks\n\nstd140, one per effect; `{}` fills them. `width` and `height` are pixels of the pass; "
      "`left`, "
      "`right`, `bottom` and `top` the window of the picture at depth 1 (orthographic: in scene units), `pixel_width` "
      "= (right - "
      "left) / width, `pixel_height` = (top - bottom) / height. For a camera with a vertical field of view a: top = "
      "tan(a / 2), "
      "bottom = -top, right = top width / height, left = -right. Of a perspective matrix P of OpenGL, P[column][row]: "
      "right = (1 + P[2][0]) / P[0][0], left = (P[2][0] - 1) / P[0][0], top = (1 + P[2][1]) / P[1][1], bottom = "
      "(P[2][1] - 1) / "
      "P[1][1].\n",
      kit.language == ShaderLanguage::kGlslEs ? "frame.js" : "frame.h");
  for (const KitBlock& block : kit.blocks) {
    text += fmt::format("\n### {}, {} bytes\n\n| offset | field | formula | |\n|---|---|---|---|\n", block.name,
                        block.size());
    for (std::size_t k = 0; k < block.fields.size(); ++k) {
      const FrameField& field = block.fields[k];
      text += fmt::format("| {} | {} `{}`{} | `{}` | {} |\n", block.offset(k), field.field.type, field.member,
                          field.field.is_array ? "[1]" : "", field.formula, field.field.about);
    }
  }
  text += "\n## Settings\n\nWritten into the shaders as `const`; another `--set` gives other shaders.\n\n";
  for (const std::string& setting : kit.settings) text += fmt::format("* `{}`\n", setting);
  text += fmt::format("\n{}Errors and costs of other settings: docs/shaders.md of Umbrage.\n", error_text(kit));
  return text;
}

}  // namespace umbrage
