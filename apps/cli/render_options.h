// The options of `umbrage render`.
#pragma once
#include <string>

#include "apps/cli/figure.h"
#include "apps/cli/options.h"
#include "apps/cli/sequence.h"
#include "io/image_file.h"

namespace umbrage::cli {

struct RenderOptions : CommonOptions {
  std::string output, svg, memory = "6G";
  int turntable = 0;        ///< number of frames; 0: one picture
  int steady = 3;           ///< frames before and after a frame of a sequence with which it is joined
  std::string camera_path;  ///< file of key cameras; empty: none
  bool animates = false;    ///< draws the animation of the file
  bool same_view = false;   ///< each model is drawn alone, to a file of its own
  SequenceOptions sequence;
  FigureOptions figure;
  std::string view_names;            ///< of a sheet: "front,top"
  std::vector<std::string> views;    ///< of a sheet; empty: one picture
  std::string projection = "third";  ///< of a sheet: "first" or "third" angle
  double frame_rate = 30.0;          ///< frames per second of a video
  double time_s = 0.0;               ///< for drawing each picture, seconds; 0: only the samples of the quality
  bool half = false, json = false;
  int picture_quality = WriteSettings().quality;  ///< of .jpg and .webp, 1 to 100

  int bits() const { return text_of("bits") == "16" ? 16 : 8; }
  bool writes_passes() const { return !request.passes.empty(); }
  /// Returns whether `pass` is the only entry of --passes; it may be "all".
  bool writes_only(std::string_view pass) const { return request.passes.size() == 1 && request.passes[0] == pass; }
};

}  // namespace umbrage::cli
