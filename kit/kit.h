// The shader kit: effects as fragment shaders for other engines, with what a program needs to run them.
#pragma once
#include <string>
#include <vector>

#include "kit/shader_text.h"
#include "looks/settings.h"

namespace umbrage {

/// A texture that the passes read or write.
struct KitTexture {
  enum class Role { kInput, kInOut, kIntermediate, kOutput };
  std::string name;
  int channels = 1;
  Role role = Role::kInput;
  bool is_reduced = false;  ///< of reduced size
  bool is_exact = false;    ///< its floats hold packed bits: half floats would destroy them
  bool has_neutral = false;
  float neutral = 0.0f;  ///< of an input that may be left out: its value everywhere
};

/// One draw of a triangle that covers the picture.
struct KitPass {
  std::string file;    ///< "bitmask_occlusion.frag"
  std::string effect;  ///< empty: the pass that reduces planes
  int round = 0;
  bool is_reduced = false;            ///< it draws to textures of reduced size
  std::vector<std::string> samplers;  ///< "depth_texture"
  std::vector<std::string> inputs;    ///< the textures of the samplers, in this order
  std::vector<std::string> outputs;   ///< by location
};

/// The uniform block of an effect.
struct KitBlock {
  std::string effect, name;        ///< "bitmask", "BitmaskFrame"
  std::vector<FrameField> fields;  ///< in order
  /// Returns the size in bytes, a multiple of 16. By std140, field k is at 4 k.
  int size() const { return (int(fields.size()) + 3) / 4 * 16; }
};

struct KitFile {
  std::string name, text;
};

struct Kit {
  std::vector<std::string> effects, settings;  ///< names; "effect.parameter=value" of all parameters
  std::vector<std::string> changed;            ///< the settings that are not the defaults
  ShaderLanguage language = ShaderLanguage::kGlsl;
  int factor = 1;  ///< of the reduced size
  std::vector<KitTexture> textures;
  std::vector<KitBlock> blocks;
  std::vector<KitPass> passes;
  std::vector<KitFile> shaders;  ///< GLSL; what other languages are translated from
};

/// Returns the kit of effects that run one after the other. Before one that upsamples, those from the first on that
/// writes `ao` run at reduced size. Errors: kUsage if an effect is not among those that kits are tested with; if one of
/// them has steps on the processor, traces rays, writes more than four planes at a time, or depends on the view in a
/// way that has no formula.
Result<Kit> make_kit(const std::vector<const Effect*>& effects, EffectSettings settings, ShaderLanguage language);

/// Returns the RMSE of the kit's occlusion against ray tracing, ".084", if its settings are a preset that was measured.
std::string_view kit_error(const Kit& kit);

/// Return the files beside the shaders: pass.json, which lists `files`, and README.md, and frame.h for C and C++ or
/// frame.js for JavaScript, which fill the uniform blocks. frame.js also has the content of pass.json and the shaders.
std::string kit_json(const Kit& kit, const std::vector<std::string>& files = {});
std::string kit_readme(const Kit& kit);
std::string kit_header(const Kit& kit);
std::string kit_script(const Kit& kit, const std::vector<KitFile>& files);

/// Return the vertex shader of the triangle; the fragment shader that makes `depth` of a depth buffer; and the one that
/// takes every `factor`th pixel of a plane.
std::string triangle_shader(ShaderLanguage language);
std::string linear_depth_shader(ShaderLanguage language);
std::string reduction_shader(ShaderLanguage language, int factor);

/// Returns the name of a language, or of its files' extension: ".frag".
std::string_view language_name(ShaderLanguage language);
std::string_view language_extension(ShaderLanguage language);

/// Writes the kit into a folder, which is created. Errors: kUsage if the folder holds other files; kFile; kDevice if a
/// program that translates shaders is missing.
Result<void> write_kit(const Kit& kit, const std::string& folder);

}  // namespace umbrage
