// Writes the text of one fragment shader from the text of a kernel.
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/effect.h"
#include "kit/frame_fields.h"

namespace umbrage {

enum class ShaderLanguage { kGlsl, kGlslEs, kHlsl, kMsl, kSpirv };

/// Returns whether the language is GLSL of OpenGL or OpenGL ES: textures have row 0 at the bottom, and no bindings.
inline bool is_opengl(ShaderLanguage language) {
  return language == ShaderLanguage::kGlsl || language == ShaderLanguage::kGlslEs;
}

/// Returns the first line of a shader in GLSL.
inline std::string_view version_line(ShaderLanguage language) {
  if (language == ShaderLanguage::kGlslEs) return "#version 300 es\n";
  return is_opengl(language) ? "#version 430 core\n" : "#version 450\n";
}

/// A plane of a shader: a texture that it reads, or an output.
struct ShaderPlane {
  std::string name;  ///< of the plane, a colour or vector without its channel: "normal"
  int channels = 1;  ///< 1, 3, or 4 with alpha
};

/// The parts of a shader that its kernel needs: what its entry calls, and what that calls.
struct ShaderParts {
  std::string about;              ///< comment lines
  std::string entry;              ///< "denoise", of denoise_pixel()
  std::vector<KernelItem> items;  ///< GLSL, in order
  std::vector<ShaderPlane> inputs, outputs;
  std::set<std::string> frame, settings;  ///< the names of F.NAME and C.NAME that it reads
};

/// Returns the parts of the shader of a kernel. `absent`: planes that nothing writes, with the value that they have
/// everywhere. `is_first_round_alone`: it runs in round 0 only.
ShaderParts shader_parts(const KernelText& kernel, const EffectFields& fields,
                         const std::map<std::string, float>& absent, bool is_first_round_alone,
                         ShaderLanguage language);

/// How a shader is written down.
struct ShaderHead {
  std::string title;              ///< "bitmask, dispatch occlusion"
  std::string block;              ///< name of the uniform block: "BitmaskFrame"
  std::string settings;           ///< name of the struct of settings: "BitmaskSettings"
  std::vector<FrameField> frame;  ///< the members of the block, in order
};

/// Returns the text of a shader in GLSL, for a language or for the compiler that translates it to the language.
std::string shader_text(const ShaderParts& parts, const EffectFields& fields, const ShaderHead& head,
                        ShaderLanguage language);

/// Returns a number as GLSL, C and JavaScript write it; `bits`: of an int or a float.
std::string number_literal(const ConstantField& field, std::uint32_t bits);

}  // namespace umbrage
