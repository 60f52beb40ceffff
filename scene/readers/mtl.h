// Reader for MTL, the material libraries of OBJ files [Wavefront 1995], with the later statements for metalness and
// roughness (Pr, Pm, norm, map_Ke).
#pragma once
#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace umbrage {

/// A texture of a material with the options of its statement.
struct MtlMap {
  std::string file;                     ///< as in the library, without quotation marks; empty: no map
  glm::vec2 scale{1.0f}, offset{0.0f};  ///< -s, -o: the map is at uv * scale + offset
  float bump = 1.0f;                    ///< -bm
  float base = 0.0f, gain = 1.0f;       ///< -mm: values of texels, 0 to 1, become base + gain * value
  char channel = '\0';                  ///< -imfchan: r, g, b, m (alpha) or l (luminance)
  bool clamp = false;                   ///< -clamp on

  bool same_place(const MtlMap& other) const { return scale == other.scale && offset == other.offset; }
};

enum MtlMapKind { kMapKd, kMapD, kMapKe, kMapPr, kMapPm, kNorm, kMapBump, kMtlMaps };
/// The statements of the maps, for messages.
inline constexpr std::array<const char*, kMtlMaps> kMtlMapNames{"map_Kd", "map_d", "map_Ke",  "map_Pr",
                                                                "map_Pm", "norm",  "map_Bump"};

/// A material as in the library; numbers are in their range.
struct MtlMaterial {
  std::string name;
  std::optional<glm::vec3> diffuse, specular, emission, filter;                           ///< Kd, Ks, Ke, Tf
  std::optional<float> exponent, opacity, transparency, refraction, roughness, metallic;  ///< Ns, d, Tr, Ni, Pr, Pm
  int illumination = 1;
  std::array<MtlMap, kMtlMaps> maps;
  std::vector<std::string> ignored;  ///< statements that are not drawn: "map_Ks"

  bool has_maps() const;
};

struct MtlLibrary {
  std::vector<MtlMaterial> materials;
  std::vector<std::string> warnings;  ///< one sentence each
};

/// Reads the text of a library, which normalize_lines (scene/readers/obj_text.h) has prepared. A value that is not a
/// number, not finite or out of range causes a warning that names `name`, the library, and its line; the first two keep
/// the default, the last is clamped. Of several definitions of a name the last value of each statement applies.
MtlLibrary read_mtl(std::string_view text, const std::string& name);

/// Returns a material without its maps. It is blended with opacity d, else 1 - Tr, if that is below 1, or if it is
/// glass: illum is 4, 6, 7 or 9, and Tf or Ni says that light passes.
Material material_of(const MtlMaterial& source);

/// Returns whether Tr alone makes a material invisible. It is drawn opaque, since some programs write the opacity as
/// Tr.
bool is_invisible_by_tr(const MtlMaterial& source);

}  // namespace umbrage
