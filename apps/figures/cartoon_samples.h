// The samples of appendix B of [Lajzer and Nottingham], and what they share with the other figures of this paper.
#pragma once
#include <string_view>

#include "apps/figures/studio.h"

namespace umbrage {

struct CartoonPreset {
  std::string_view look, name, tag;  ///< tag: suffix of figure ids and file names
};
inline constexpr CartoonPreset kCartoonPaper = {"cartoon-paper", "paper preset", ""},
                               kCartoonOurs = {"cartoon", "our own", "-ours"};

inline constexpr int kCartoonBlurRounds = 4;  ///< gaussian.rounds of both looks
inline constexpr int kCartoonSamples = 4;

/// Returns the sample radius of listing 1: 16 pixels of 512.
int cartoon_radius_px(const Image& image);

const Mesh& mesh_named(const Scene& scene, std::string_view name);

/// Draws a pair of pictures of appendix B in both presets: sample `number`, 1 to kCartoonSamples.
Result<Figure> cartoon_sample(Device& device, int number, int size);

}  // namespace umbrage
