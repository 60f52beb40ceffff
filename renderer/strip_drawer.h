// StripDrawer: runs a look on the strips of a picture, wherever their frames come from. Internal to renderer/.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/strokes.h"
#include "program/program.h"
#include "renderer/drawing.h"
#include "renderer/strokes.h"
#include "renderer/times.h"

namespace umbrage {

/// A picture to draw in strips: its size, its look, and where the frames of its strips come from.
struct StripSource {
  LookRun run;             ///< the drawer sets `after`, `monitor` and `meter`; with `stops`, nothing is metered
  PictureInfo info;        ///< of the whole picture
  StrokeParameters lines;  ///< parameters of the effects that make the lines
  GivenPlanes given;       ///< planes before `before`
  std::vector<EffectStep> before = {};  ///< what make_frame runs
  Margins after = {};                   ///< planes that are read around the rows of a finished strip
  /// Returns the frame of a strip before any effect of the look has run. Called once for each strip of each sweep.
  std::function<Result<Frame>(const Strip&)> make_frame;
};

/// How a picture is split into strips.
struct StripSizes {
  int rows = 0;        ///< rows of a strip, a multiple of 64; 0: the picture is drawn whole
  double bytes = 0.0;  ///< memory for drawing, bytes
  /// Whether that is more than the limit, on a device that holds pictures in the memory of the host.
  bool exceeds = false;
};

/// The memory of several pictures that are averaged, in planes.
struct SumPlanes {
  double held = 0.0;      ///< of the whole picture, while each picture is drawn, also in strips
  double finished = 0.0;  ///< while a drawn picture is added, or the sum is finished
  /// While marked samples are drawn, an eighth of the picture at a time, beside the first one; 0: there are none.
  double marked = 0.0;
  double released = 0.0;  ///< of each frame of the first sample, before further marked samples are drawn
  bool blended = false;   ///< marked samples have a picture of blended surfaces, too
};

/// Plans a picture for about `memory` bytes: whole if they suffice and it has at most kMaxPixels pixels, else in
/// strips, of the minimum height if even these need more, or whole if strips would not need less. Devices that cannot
/// draw strips and techniques that trace the scene draw the picture whole. Errors: kUsage if it is too large for that.
Result<StripSizes> plan_strips(const Device& device, const StripSource& source, const SumPlanes& sum, double memory);

/// Draws the strips of pictures of one size.
class StripDrawer {
 public:
  /// `rows`: rows of a strip, a multiple of 4. The source's parameters of lines must outlive the drawer.
  StripDrawer(Device& device, StripSource source, int rows, DrawProgress& progress, StageTimes& times);

  /// Sets the effects that draw the lines of later pictures.
  void set_lines(std::vector<EffectStep> steps) { source_.run.lines = std::move(steps); }

  /// Receives the inner rows of a finished strip; `first` is the index of the first row.
  using Finish = std::function<Result<void>(Frame& frame, Image& rows, int first)>;

  /// Draws all strips in as many sweeps as needed and passes `planes` of the finished rows to `finish`. Returns the
  /// lines of the picture if `lines` is set.
  Result<Strokes> draw_picture(const std::vector<std::string>& planes, bool lines, const Finish& finish);

  /// Returns the exposure of the last picture, as LookDone::stops. Later pictures of the drawer use it too.
  float stops() const { return stops_; }

 private:
  Result<void> add_edges(const Frame& frame, const Rows& rows);
  Result<bool> draw_strip(const Strip& strip, const std::vector<std::string>& planes, const Finish& finish);
  void prepare_plane_pool(const Rows& rows);
  Result<std::optional<float>> meter(Device& device, const Frame& frame);

  Device& device_;
  StripSource source_;
  const int rows_;
  DrawProgress& progress_;
  StageTimes& times_;
  Metering metering_;
  float stops_from_lights_ = 0.0f;  // exposure that metering starts from
  float stops_ = 0.0f;
  bool metered_in_sweep_ = false;  // whether the sweep collects values for metering
  PictureInfo info_;
  Image edges_;  // planes from which lines are traced, with the guard band
  std::optional<ScopedPlanePool> kept_;
  int kept_rows_ = 0;
  int first_ = 0;  // first inner row of the strip
};

}  // namespace umbrage
