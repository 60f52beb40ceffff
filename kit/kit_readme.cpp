// README.md of a kit.
#include <algorithm>
#include <set>

#include "core/version.h"
#include "kit/kit.h"

namespace umbrage {
namespace {

/// What the planes that callers bring or get contain.
constexpr struct {
  std::string_view name, about;
} kPlanes[] = {
    {"depth",
     "distance along the view axis, scene units, above 0; 0: background. `linear_depth` makes it of a depth buffer"},
    {"normal",
     "unit vector, view space: x to the right, y up, z to the viewer; 0: background. The effect `normals` makes it "
     "of depth"},
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

int bytes_of(const KitTexture& texture) { return texture.channels == 1 ? 4 : 16; }

const KitTexture& texture_of(const Kit& kit, const std::string& name) {
  return *std::find_if(kit.textures.begin(), kit.textures.end(),
                       [&](const auto& texture) { return texture.name == name; });
}

constexpr std::string_view kFirst = R"(# {0} as {1} shaders

Made by Umbrage {2}: `umbrage shaders {3} --language {1}`. MIT licence. `pass.json` has the content of this page for programs.

Each shader is a fragment shader for a triangle that covers the picture (`screen`). Run the passes in order. Bind the textures to the
samplers, without filtering, and draw to the outputs, by location. {4}Row 0 of a plane is the {5}. A pass that reads a plane that it
writes needs two textures, which are then swapped.

`linear_depth` is not among the passes: it makes the input `depth` of a depth buffer, which is its `buffer_texture`.{6}

)";

constexpr std::string_view kUniforms = R"(
## Uniform blocks

std140, one per effect; `{0}` fills them. `width` and `height` are pixels of the pass; `left`, `right`, `bottom` and `top` the
window of the picture at depth 1 (orthographic: in scene units), `pixel_width` = (right - left) / width, `pixel_height` = (top -
bottom) / height. For a camera with a vertical field of view a: top = tan(a / 2), bottom = -top, right = top width / height, left =
-right. Of a perspective matrix P of OpenGL, P[column][row]: right = (1 + P[2][0]) / P[0][0], left = (P[2][0] - 1) / P[0][0],
top = (1 + P[2][1]) / P[1][1], bottom = (P[2][1] - 1) / P[1][1].

The block of `linear_depth`, DepthFrame: int `kind`, floats `a`, `b` and `background`. {1}
)";

constexpr std::string_view kDepthKinds =
    "Perspective: kind 0, a = 1 / near, b = 1 / far - 1 / near; reversed depth: a = 1 / far, b = 1 / near - 1 / far; "
    "of an "
    "infinite far plane 1 / far is 0. Orthographic: kind 1, a = near, b = far - near. Logarithmic depth of three.js: "
    "kind 2, b = "
    "log2(far + 1). background: 1, with reversed depth 0.";

/// Returns where a language binds blocks and textures.
std::string_view bindings_text(ShaderLanguage language) {
  switch (language) {
    case ShaderLanguage::kHlsl:
      return "The entry point is `main`. The block is register b0; textures are t1, t2 and so on, in the order of "
             "`reads`, each "
             "with a sampler of its number, which `Load` does not use. The text is translated; that in GLSL has "
             "comments. ";
    case ShaderLanguage::kMsl:
      return "The entry point is `main0`. The block is buffer 0; textures are 0, 1 and so on, in the order of "
             "`reads`, each with a sampler of its number, which `read` does not use. The text is translated; that in "
             "GLSL has "
             "comments. ";
    case ShaderLanguage::kSpirv:
      return "The entry point is `main`. In set 0 the block is binding 0; textures are 1, 2 and so on, in the order of "
             "`reads`: combined image samplers. ";
    default:
      return "Blocks and samplers are found by name. ";
  }
}

std::string reduced_view_call(const Kit& kit) {
  return kit.language == ShaderLanguage::kGlslEs ? fmt::format("reducedView(view, {})", kit.factor)
                                                 : fmt::format("umbrage_reduced_view(&view, {})", kit.factor);
}

/// Returns the samplers of a pass, each with its texture if that has another name.
std::string samplers_text(const KitPass& pass) {
  std::string text;
  for (std::size_t k = 0; k < pass.samplers.size(); ++k) {
    text += (k > 0 ? ", " : "") + fmt::format("`{}`", pass.samplers[k]);
    if (pass.samplers[k] != pass.inputs[k] + "_texture") text += fmt::format(": {}", pass.inputs[k]);
  }
  return text;
}

}  // namespace

std::string_view kit_error(const Kit& kit) {
  std::string effects = fmt::format("{}", fmt::join(kit.effects, ","));
  if (effects.starts_with("normals,")) effects.erase(0, 8);
  for (const auto& row : kErrors)
    if (row.effects == effects && row.changed == fmt::format("{}", fmt::join(kit.changed, " "))) return row.rmse;
  return {};
}

std::string kit_readme(const Kit& kit) {
  const bool is_gl = is_opengl(kit.language);
  const std::string extension(language_extension(kit.language));
  std::string text = fmt::format(kFirst, fmt::join(kit.effects, ", "), language_name(kit.language), project_version(),
                                 fmt::join(kit.effects, ","), bindings_text(kit.language),
                                 is_gl ? "last row of the picture, as OpenGL draws" : "top row of the picture",
                                 kit.factor > 1 ? fmt::format(" Blocks of passes of size 1/{0} are filled for "
                                                              "`{1}`, the others for the whole view.",
                                                              kit.factor, reduced_view_call(kit))
                                                : "");
  text += "## Textures\n\n| name | | channels | format | content |\n|---|---|---|---|---|\n";
  for (const KitTexture& texture : kit.textures) {
    constexpr std::string_view kRoles[] = {"input", "input and output", "intermediate", "output"};
    std::string content = about(texture.name);
    if (is_gl && texture.name == "normal")
      content +=
          ". `#define UMBRAGE_NORMALS 1` after the line of `#version` for vectors stored as 0 to 1, 2 for octahedral "
          "ones "
          "in two channels";
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
                        round, pass.is_reduced ? fmt::format("1/{}", kit.factor) : "full", samplers_text(pass),
                        fmt::join(pass.outputs, ", "), bytes);
  }
  text += fmt::format(kUniforms, kit.language == ShaderLanguage::kGlslEs ? "frame.js" : "frame.h", kDepthKinds);
  for (const KitBlock& block : kit.blocks) {
    text += fmt::format("\n### {}, {} bytes\n\n| offset | field | formula | |\n|---|---|---|---|\n", block.name,
                        block.size());
    for (std::size_t k = 0; k < block.fields.size(); ++k) {
      const FrameField& field = block.fields[k];
      text += fmt::format("| {} | {} `{}` | `{}` | {} |\n", 4 * k, field.field.type, field.member, field.formula,
                          field.field.about);
    }
  }
  text += "\n## Settings\n\nWritten into the shaders as `const`; another `--set` gives other shaders.\n\n";
  for (const std::string& setting : kit.settings) text += fmt::format("* `{}`\n", setting);
  if (const std::string_view error = kit_error(kit); !error.empty())
    text += fmt::format("\nRMSE of `ao` with these settings against ray tracing, over eight scenes: {}.\n", error);
  text += "\nErrors and costs of other settings: docs/shaders.md of Umbrage.\n";
  return text;
}

}  // namespace umbrage
