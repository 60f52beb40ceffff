// Conventions: what the stored values of a G-buffer mean, decided once from headers, names and a sample of the pixels.
// Plain data: convert.h applies it to any rows.
#pragma once
#include <array>
#include <glm/mat3x3.hpp>
#include <span>
#include <vector>

#include "gbuffers/depth_model.h"
#include "gbuffers/gbuffer_file.h"
#include "gbuffers/motion.h"
#include "gbuffers/roles.h"
#include "gbuffers/samples.h"

namespace umbrage {

struct DepthConvention {
  DepthModel model;
  std::vector<double> background;  ///< stored depths that mean no surface, besides those that always do
  bool from_position = false;      ///< there is no usable depth layer: it is computed from positions
  double unit = 0.0;               ///< difference of depths that are stored as integers; 0: unknown
  bool is_own = false;             ///< Umbrage wrote it, so that it is exact
};

struct NormalConvention {
  double scale = 1.0, offset = 0.0;  ///< component = offset + scale * stored value
  glm::dmat3 view_from_stored{1.0};
  bool lacks_z = false;  ///< the third channel says nothing: z is towards the camera

  /// Returns the vector of stored channels, not of unit length.
  glm::dvec3 decoded(const glm::dvec3& stored) const {
    const glm::dvec3 n = offset + scale * stored;
    return lacks_z ? glm::dvec3(n.x, n.y, std::sqrt(std::max(1.0 - n.x * n.x - n.y * n.y, 0.0))) : n;
  }
};

/// view depth = dot(forward, position - eye).
struct PositionConvention {
  glm::dvec3 forward{0.0, 0.0, -1.0}, eye{0.0};
};

struct ColorConvention {
  double max_integer = 0.0;  ///< stored value that means 1; 0: floats
  bool is_srgb = false;
};

struct Conventions {
  int width = 0, height = 0;
  Camera camera;
  bool has_place = false;  ///< the place of the camera is known
  DepthConvention depth;
  NormalConvention normal;
  PositionConvention position;
  std::array<ColorConvention, kRoleCount> color;  ///< by role
  bool is_premultiplied = false;                  ///< the beauty is multiplied by its alpha
  std::array<bool, kRoleCount> is_unusable{};     ///< by role: most of its values are NaN
  std::vector<MotionMeanings> motion;             ///< of each pair of channels
  std::string step_warning;                       ///< its beginning, if there are few different depths
  std::string step_cure;                          ///< what the file would need
};

/// Returns a stored depth, or NaN where it means that there is no surface.
double stored_depth(const DepthConvention& depth, double stored);

/// Decides all conventions, and adds a line to the facts for each. There is depth, or there are positions. Errors:
/// kUsage for options that contradict each other; kFile for a colour picture that was taken for depth. `first`: as for
/// GBufferFile::open.
Result<Conventions> decide_conventions(const GBufferSettings& settings, std::span<const LayeredFile> headers,
                                       const Roles& roles, const Samples& samples, GBufferFacts& facts,
                                       const Conventions* first = nullptr);

/// Returns a warning of colours that are not linear reflectance from 0 to 1, or, for the beauty, that are integers
/// of 8 bits; else nothing. `name`: as the message shows the role's float channels.
std::string color_warning(const Samples& samples, Role role, std::string_view name);

/// Returns the text for a number in messages: 3 to 6 digits.
std::string number_text(double value);

}  // namespace umbrage
