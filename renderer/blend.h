// Pictures with blended surfaces. A sample is drawn twice: once with blended surfaces as if they were opaque (in
// front), and once without them (behind). Each pixel is the sum of both, weighted by the opacity and the transmittance
// of the blended surfaces along its ray. So effects see only opaque surfaces, and what is behind keeps its occlusion,
// shadows and lines. Internal to renderer/.
#pragma once
#include <string>
#include <vector>

#include "renderer/plan.h"

namespace umbrage {

/// Returns `names` and the planes of the weights, which are captured with the picture in front.
std::vector<std::string> with_blend_planes(std::vector<std::string> names);

/// The weights of a sample, and the lines of its picture in front; whole pictures without the guard band.
class BlendedSample {
 public:
  /// Takes the planes of the weights from rows of the picture in front and multiplies the other planes by the opacity;
  /// `first`: index of the first row; `height`: that of the picture.
  void take_front(Image& rows, int first, int height);
  /// Takes the planes `names`, lines of the picture in front. The weights must have been taken.
  void take_lines(const Image& rows, const std::vector<std::string>& names, int first, int height);
  /// Multiplies rows of the picture behind by the transmittance (planes of colour) or by 1 - opacity (others).
  void weigh_behind(Image& rows, int first) const;
  /// Replaces the lines in rows of the picture behind by the maximum of both pictures. Lines keep their strength,
  /// except where a blended surface is nearly clear or nearly opaque, so that they end softly where its opacity does.
  /// Does nothing if no lines have been taken.
  void join_lines(Image& rows, int first) const;

 private:
  Image weights_, lines_;
};

}  // namespace umbrage
