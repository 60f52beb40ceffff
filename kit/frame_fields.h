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
  /// How it follows from the view, as an expression of C and JavaScript; empty: unknown. Names in it: `width`,
  /// `height`, pixels; `left`, `right`, `bottom`, `top`, the window of the picture at depth 1 (orthographic: in scene
  /// units), and `pixel_width`, `pixel_height` there; `orthographic`, 0 or 1; `scene_radius`, `depth_min`, `depth_max`,
  /// scene units; `light_x`, `light_y`, `light_z`, the unit vector to the light, view space; `round`, its index.
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

/// Returns the value of a constant, of its bits.
double value_of(const ConstantField& field, std::uint32_t bits);

/// Returns the constants of an effect with these params, in a picture whose sides are 1 / `factor` of the whole one.
EffectFields effect_fields(const Effect& effect, const ParameterBytes& params, std::string_view header,
                           std::string_view constants, int factor = 1);

/// Returns a picture of the usual size, to find out which dispatches an effect runs.
PictureInfo usual_picture();

}  // namespace umbrage
