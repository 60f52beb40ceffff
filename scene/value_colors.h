// Values as colours: shows a field of a finished scene by a colour map.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>

#include "core/result.h"
#include "scene/color_maps.h"
#include "scene/scene.h"

namespace umbrage {

/// How values became the colours of a scene: what a colour bar shows.
struct ValueColors {
  enum class Scale {
    kLinear,
    kLog,     ///< low > 0
    kSymlog,  ///< logarithmic on both sides of 0, and linear between -linear_threshold and linear_threshold
  };
  std::string name;  ///< of the field, with its component: "velocity.x"
  float low = 0.0f, high = 1.0f;
  Scale scale = Scale::kLinear;
  float linear_threshold = 0.0f;   ///< of kSymlog, > 0
  ColorMap map;                    ///< from low to high
  int bands = 0;                   ///< number of equal intervals of one colour; 0: the colours change steadily
  std::array<float, 3> missing{};  ///< sRGB: colour of values that are missing or not finite
  std::size_t missing_count = 0;   ///< number of such values

  /// Returns the sRGB colour at a position on the scale, 0 to 1; beyond, that of the nearer end.
  std::array<float, 3> at(float position) const;
};

struct ValueSettings {
  std::string field;             ///< name of the field
  std::optional<int> component;  ///< from 0; not set: the value, of a vector its length
  ColorMap map;
  std::optional<std::array<float, 2>> range;  ///< low < high; not set: that of the finite values
  ValueColors::Scale scale = ValueColors::Scale::kLinear;
  int bands = 0;                   ///< see ValueColors
  std::array<float, 3> missing{};  ///< sRGB
};

/// Returns the value at a position of a mesh: a component of a field on positions, or else the length of a vector.
float value_of(const Field& field, std::size_t position, const std::optional<int>& component);

/// Returns a text that differs between settings with different colours. Files of colours differ by their colours.
std::string key_of(const ValueSettings& settings);

/// Returns where a value is on a scale, 0 at `low` and 1 at `high`; NaN for one that the scale does not have: one that
/// is not finite, and for ValueColors::Scale::kLog one that is not above 0. With kSymlog, the scale of v is
/// v / linear_threshold up to 1 and 1 + ln(v / linear_threshold) above, and the negative of this for -v.
float position_on_scale(const ValueColors& colors, float value);

/// Returns the value at a position on a scale.
float value_on_scale(const ValueColors& colors, float position);

/// Returns the range and the colours with which scenes show a field together, without missing_count. Adds sentences
/// about the choice of the range to `warnings`. Errors: kUsage if no scene has the field, which names the fields that
/// there are, if it lacks the component, or has no value on the scale.
Result<ValueColors> value_colors(const ValueSettings& settings, std::span<const Scene* const> scenes,
                                 std::vector<std::string>& warnings);

/// Gives the surfaces of a finished scene the colours of their values, with matt materials: textures along the scale
/// for triangles, so that values are interpolated and then become colours, and colours for points. What has no value
/// gets the missing colour and is counted in a warning. Sets Scene::value_colors, or takes the range from it if it is
/// set; the fields are removed. Errors: those of value_colors.
Result<void> show_values(const ValueSettings& settings, Scene& scene);

}  // namespace umbrage
