#include "renderer/pass_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/srgb.h"
#include "effects/effects.h"
#include "effects/outline/outline.h"

namespace umbrage {

Image picture_of_passes(const Image& frame, const std::vector<std::string>& names, const PictureInfo& info) {
  Image out(frame.width, frame.height);
  constexpr std::array kChannels = {"color.r", "color.g", "color.b", "color.a"};
  // Min depth range, relative to the max depth. Avoids 0 / 0 for a scene that is one plane facing the camera.
  constexpr float kMinDepthRange = 1e-4f;
  const float span = std::max(info.depth_max - info.depth_min, kMinDepthRange * info.depth_max);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Plane& in = frame.plane(names[k]);
    Plane& plane = out.add(names.size() == 1 ? names[0] : kChannels[std::min(k, kChannels.size() - 1)]);
    const bool colour = names[k].ends_with(".r") || names[k].ends_with(".g") || names[k].ends_with(".b");
    const bool light = colour && !names[k].starts_with("color.");  // `color` has display values already
    const bool vector = names[k].ends_with(".x") || names[k].ends_with(".y") || names[k].ends_with(".z");
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) {
        float v = in.at(x, y);
        if (vector) v = 0.5f * v + 0.5f;
        if (light) v = srgb_from_linear(v);
        if (names[k] == "depth" || names[k].ends_with(".depth"))
          v = std::isfinite(v) ? 1.0f - (v - info.depth_min) / span : 0.0f;
        plane.at(x, y) = v;
      }
  }
  return out;
}

Image picture_of_lines(const Plane& cover, const EffectSettings& settings) {
  const auto& line = as<OutlineParams>(params_of(settings, "outline"));
  const Parameter& transfer = *find_parameter(*find_effect("output"), "transfer");
  const bool srgb = parameter_text(transfer, params_of(settings, "output")) == "srgb";
  Image out(cover.width, cover.height);
  for (const auto& [name, value] : {std::pair{"color.r", line.r}, {"color.g", line.g}, {"color.b", line.b}})
    out.add(name) = Plane(cover.width, cover.height, srgb ? srgb_from_linear(value) : value);
  out.add("color.a") = cover;
  return out;
}

}  // namespace umbrage
