// Shaders of every kit that no effect has.
#include "kit/kit.h"
#include "kit/text.h"

namespace umbrage {
namespace {

/// Returns the first lines of a shader, and its text without what the language does not have.
std::string with_head(ShaderLanguage language, std::string text) {
  const std::string first(version_line(language));
  if (language == ShaderLanguage::kGlslEs) return first + "precision highp float;\nprecision highp int;\n" + text;
  return first + replaced(std::move(text), "highp ", "");
}

}  // namespace

std::string_view language_name(ShaderLanguage language) {
  constexpr std::string_view kNames[] = {"glsl", "glsl-es", "hlsl", "msl", "spirv"};
  return kNames[int(language)];
}

std::string_view language_extension(ShaderLanguage language) {
  constexpr std::string_view kExtensions[] = {".frag", ".frag", ".hlsl", ".metal", ".spv"};
  return kExtensions[int(language)];
}

std::string triangle_shader(ShaderLanguage language) {
  const std::string index = is_opengl(language) ? "gl_VertexID" : "gl_VertexIndex";
  return with_head(language,
                   fmt::format(R"(// A triangle that covers the picture: draw three vertices, without a vertex buffer.
void main() {{
  vec2 corner = vec2({0} == 1 ? 3.0 : -1.0, {0} == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}}
)",
                               index));
}

std::string linear_depth_shader(ShaderLanguage language) {
  const bool binds = !is_opengl(language);
  return with_head(
      language,
      fmt::format(
          R"(// Makes the plane `depth` of a depth buffer d: distance along the view axis in scene units, 0 for background.
// kind 0, perspective:  depth = 1 / (a + b d)
// kind 1, orthographic: depth = a + b d
// kind 2, logarithmic:  depth = 2^(b d) - 1
// background: the value to which the buffer is cleared. README.md has a and b.
layout(std140{0}) uniform DepthFrame {{
  int kind;
  float a, b, background;
}} F;
{1}uniform highp sampler2D buffer_texture;
layout(location = 0) out highp float depth_out;

void main() {{
  float d = texelFetch(buffer_texture, ivec2(gl_FragCoord.xy), 0).r;
  float depth = F.kind == 0 ? 1.0 / (F.a + F.b * d) : F.kind == 1 ? F.a + F.b * d : exp2(F.b * d) - 1.0;
  depth_out = d == F.background ? 0.0 : depth;
}}
)",
          binds ? ", binding = 0" : "", binds ? "layout(binding = 1) " : ""));
}

std::string reduction_shader(ShaderLanguage language, int factor) {
  const bool binds = !is_opengl(language);
  const std::string place =
      binds ? fmt::format("ivec2(gl_FragCoord.xy) * {}", factor)
            : fmt::format("ivec2(int(gl_FragCoord.x) * {0}, size.y - 1 - (rows - 1 - int(gl_FragCoord.y)) * {0})",
                          factor);
  const std::string rows = binds ? "" : fmt::format("  int rows = (size.y + {0} - 1) / {0};\n", factor);
  return with_head(language, fmt::format(R"(// Takes one of {0} x {0} pixels of a plane, the upper left one.
{1}uniform highp sampler2D plane_texture;
layout(location = 0) out highp vec4 plane_out;

void main() {{
  ivec2 size = textureSize(plane_texture, 0);
{2}  plane_out = texelFetch(plane_texture, {3}, 0);
}}
)",
                                         factor, binds ? "layout(binding = 1) " : "", rows, place));
}

}  // namespace umbrage
