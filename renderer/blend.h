// Pictures with blended surfaces. A sample is drawn twice: once with blended surfaces as if they were opaque (in
// front), and once without them (behind). Each pixel is the sum of both, weighted by the opacity and the transmittance
// of the blended surfaces along its ray. So effects see only opaque surfaces, and what is behind keeps its occlusion,
// shadows and lines. Internal to renderer/.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "renderer/plan.h"

namespace umbrage {

/// Returns `names` and the planes of the weights, which are captured with the picture in front.
std::vector<std::string> with_blend_planes(std::vector<std::string> names);

/// The weights of a sample whose picture in front has been drawn, and the lines of that picture. `first`: index of the
/// first row in the picture, without the guard band.
class BlendedSample {
 public:
  /// Takes the planes of the weights and the `lines` out of rows of the picture in front, and multiplies the other
  /// planes by the opacity.
  void take_front(Image& rows, const std::vector<std::string>& lines, int first);
  /// Multiplies rows of the picture behind by the transmittance (planes of colour) or by 1 - opacity (others). Uses the
  /// weights up; rows without weights have nothing in front.
  void weigh_behind(Image& rows, int first);
  /// Replaces the lines in rows of the picture behind by the maximum of both pictures. Lines keep their strength,
  /// except where a blended surface is nearly clear or nearly opaque, so that they end softly where its opacity does.
  void join_lines(Image& rows, int first) const;

 private:
  std::map<int, Image> weights_, lines_;  // by first row; lines with the opacity
};

}  // namespace umbrage
