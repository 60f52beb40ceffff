// What the decisions of conventions.cpp have in common, and the facts and warnings about depth. Internal to gbuffers/.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gbuffers/conventions.h"
#include "gbuffers/depth_guess.h"
#include "gbuffers/depth_values.h"
#include "gbuffers/fit.h"

namespace umbrage {

/// The inputs of the decisions, and what has been decided.
struct Deciding {
  GBufferSettings settings;
  std::span<const LayeredFile> headers;
  const Roles& roles;
  const Samples& samples;
  GBufferFacts& facts;
  Conventions out;
  std::vector<glm::dvec3> normals;  ///< of each sample, in their stored space, unit; 0: none
  std::optional<ProjectionFit> position;
  DepthValues values;
  DepthGuess guess;
  const Conventions* first = nullptr;  ///< of the first frame of a sequence

  const LayeredFile& header_of(Role role) const { return headers[std::size_t(roles[role].file)]; }
  /// Returns the first channel of a role, whose encoding is that of the others.
  const Channel& channel_of(Role role) const { return header_of(role).channels[std::size_t(roles[role].channels[0])]; }
  bool has(Role role) const { return !roles[role].empty(); }
  /// Returns whether Umbrage wrote the layer of a role, so that its conventions are known.
  bool is_own(Role role, std::string_view layer) const {
    return has(role) && is_own_file(header_of(role)) && channel_of(role).layer == layer;
  }
  void fact(std::string line) { facts.lines.push_back(std::move(line)); }
  /// Adds a warning, unless it is empty.
  void warn(std::string line) {
    if (!line.empty()) facts.warnings.push_back(std::move(line));
  }
};

/// Tells what was decided about depth, and warns of what it lacks.
void report_depth(Deciding& d);

/// Finds the meanings that the motion vectors may have, and tells them.
void decide_motion(Deciding& d);

/// Warns if background is at the bottom of the picture rather than at the top.
void warn_of_flip(Deciding& d);

}  // namespace umbrage
