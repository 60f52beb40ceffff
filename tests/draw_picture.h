// Draws a scene on the CPU, for tests of whole pictures.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "devices/cpu/cpu_device.h"
#include "renderer/draw.h"

namespace umbrage::test {

struct DrawnPicture {
  Image image;  ///< the planes that were asked for
  PictureInfo info;
};

/// Draws a scene as `complete_scene` leaves it for the request, and expects that this succeeds.
inline DrawnPicture drawn_picture(Scene scene, const Request& request, const std::vector<std::string>& planes) {
  EXPECT_TRUE(complete_scene(scene, *make_recipe(request)));
  const auto device = make_cpu_device();
  EXPECT_TRUE(device->prepare(scene));
  StageTimes times;
  const auto frame = draw(*device, scene, request, times);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  return {*device->download(*frame, planes), frame->info};
}

}  // namespace umbrage::test
