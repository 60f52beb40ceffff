// The encoding and the space of stored normals.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "gbuffers/conventions.h"
#include "gbuffers/depth_trial.h"

namespace umbrage {

struct EncodingGuess {
  bool is_unsigned = false;  ///< components from 0 to 1 stand for -1 to 1
  bool is_clear = false;     ///< the lengths leave no doubt
  bool lacks_z = false;      ///< the third channel is constant: the others hold the normals
};

/// Guesses the encoding of stored normals: the one that gives lengths nearer to 1. `has_surface`: of each sample
/// whether it shows a surface; others have any normal.
EncodingGuess guess_encoding(const Samples& samples, const std::vector<char>& has_surface,
                             const GBufferSettings& settings, double max_integer);

/// Returns the stored normals of the samples, unit, in their own space; 0 where there is none.
std::vector<glm::dvec3> decode_normals(const Samples& samples, const std::vector<char>& has_surface, double max_integer,
                                       const EncodingGuess& guess, NormalConvention& convention);

/// A rotation to view space that something else suggests.
struct KnownRotation {
  glm::dmat3 view_from_stored{1.0};
  bool is_camera_space = false;
  std::string source;
};

struct NormalChoice {
  glm::dmat3 view_from_stored{1.0};
  bool is_world = false;
  std::string meaning;               ///< for the facts: "camera space"
  double score_deg = 180.0;          ///< see DirectionFit
  std::optional<double> median_deg;  ///< angle to normals rebuilt from depth; none if these are missing
  bool is_open = false;              ///< surfaces of one direction fit other axes as well
};

/// Chooses the rotation of normals to view space: an option, a known one, one of the axis directions of camera space
/// (all rotations and mirrorings by right angles, the usual ones first), or one that is fitted; the first in this order
/// that is about as good as the best, or worse by `slack_deg` at most.
NormalChoice choose_rotation(const GBufferSettings& settings, const RebuiltNormals& rebuilt,
                             const std::vector<KnownRotation>& known, double slack_deg);

/// Angle in the median above which normals do not fit those rebuilt from depth.
inline constexpr double kNormalMismatch_deg = 10.0;

/// What the values of normals in memory say, which are signed and in view space after settings.view_from_normal unless
/// the settings say otherwise.
struct NormalCheck {
  std::optional<double> unsigned_max;  ///< components from 0 to this number, 1, 255 or 65535, stand for -1 to 1
  std::string mismatch;                ///< a warning if they do not fit the depth, with the rotation that would
};

/// Checks samples of normals and view depth.
NormalCheck check_normals(const Samples& samples, const Camera& camera, const GBufferSettings& settings);

}  // namespace umbrage
