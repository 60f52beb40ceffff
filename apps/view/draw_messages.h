// The messages that tell pages of models and of frames.
#pragma once
#include <optional>
#include <string>

#include "apps/view/encoder.h"
#include "apps/view/messages.h"
#include "apps/view/view_model.h"

namespace umbrage::view {

/// The error of a technique against the ground truth, over the pixels that show a surface.
struct ErrorNumbers {
  double rmse = 0.0, mean = 0.0;
};

/// What the page gets with a frame.
struct FrameHeader {
  std::int64_t frame = 0, id = 0;
  int view = 0, model = 0, width = 0, height = 0;
  bool is_moving = false;
  int samples = 0;
  bool is_final = false;
  std::optional<ErrorNumbers> error = {};
  StageTimes times = {};
};

/// Returns the binary message of a frame that was encoded in `encode_ms`.
std::string frame_text(const FrameHeader& header, const Encoded& encoded, double encode_ms);

/// Returns the message about a loaded model; `camera`: the first one, unless it is a G-buffer.
std::string model_text(int model, const ModelFacts& facts, const std::optional<ViewCamera>& camera, long version);

/// Returns the answer to a Pick: the point, in the coordinates of the file, or that there is no surface.
std::string pick_text(const std::optional<glm::dvec3>& point);

/// Returns the options of a view's camera as one text, to compare them.
std::string camera_text(const View& view);

}  // namespace umbrage::view
