// Which constants of an effect depend on the view, and how.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/effect.h"
#include "kit/kernel_items.h"

namespace umbrage {

/// A constant that depends on the view: a member of the uniform block F. Of an array it is the first element.
struct FrameField {
  ConstantField field;
  /// How it follows from the view: an expression of C and JavaScript with the names of kViewNames; empty: unknown.
  std::string formula;
  std::string member;  ///< its name in the block
};

/// A constant that depends on the settings alone: a member of C.
struct SettingField {
  ConstantField field;
  std::vector<std::uint32_t> values;  ///< bits; entries of an array behind the last that is not 0 are left out
};

struct EffectFields {
  std::vector<FrameField> frame;
  std::vector<SettingField> settings;
};

/// The names in formulas: sizes of the picture in pixels, its window at depth 1 (orthographic: in scene units), size of
/// a pixel there, radius of the scene and range of depths, scene units; unit vector to the light, view space; index of
/// the round.
inline constexpr const char* kViewNames[] = {
    "width",        "height",       "orthographic", "left",      "right",   "bottom",  "top",     "pixel_width",
    "pixel_height", "scene_radius", "depth_min",    "depth_max", "light_x", "light_y", "light_z", "round"};

/// Returns the constants of an effect with these params, in a picture whose sides are 1 / `factor` of the whole one.
EffectFields effect_fields(const Effect& effect, const ParameterBytes& params, std::string_view header,
                           std::string_view constants, int factor = 1);

/// Returns a picture of the usual size, to find out which dispatches an effect runs.
PictureInfo usual_picture();

}  // namespace umbrage
