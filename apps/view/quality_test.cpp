// The resolution of moving frames, the encoding of pictures, the map of errors, and the tables.
#include "apps/view/quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/view/encoder.h"
#include "apps/view/error_map.h"
#include "apps/view/tables.h"
#include "apps/view/view_model.h"
#include "devices/cpu/cpu_device.h"
#include "looks/looks.h"
#include "renderer/options.h"

namespace umbrage::view {
namespace {

/// Draws frames on a machine that takes `overhead_ms` and `ms_per_megapixel`; returns the last size.
std::pair<int, int> settle(ResolutionControl& control, double overhead_ms, double ms_per_megapixel, int frames,
                           int* changes = nullptr) {
  std::pair<int, int> last{0, 0};
  for (int k = 0; k < frames; ++k) {
    const auto size = control.size("key", 1280, 720);
    if (changes && k > 0 && size != last) ++*changes;
    last = size;
    const double noise = k % 3 == 0 ? 1.1 : 0.95;
    control.add("key", size.first, size.second,
                noise * (overhead_ms + ms_per_megapixel * 1e-6 * size.first * size.second));
  }
  return last;
}

TEST(ViewResolution, FollowsTheTimeWithoutPumping) {
  ResolutionControl control;
  const auto fast = settle(control, 1.0, 10.0, 30);
  EXPECT_EQ(fast, std::pair(1280, 720));
  const auto slow = settle(control, 4.0, 200.0, 30);
  const double ms = 4.0 + 200.0e-6 * slow.first * slow.second;
  EXPECT_LT(ms, 1.5 * kMovingFrame_ms);
  EXPECT_GT(ms, 0.5 * kMovingFrame_ms);
  EXPECT_EQ(slow.first % 8, 0);
  EXPECT_EQ(slow.second % 8, 0);
  int changes = 0;
  EXPECT_EQ(settle(control, 4.0, 200.0, 60, &changes), slow);
  EXPECT_EQ(changes, 0);
  // However slow, something remains to be seen.
  EXPECT_GE(settle(control, 500.0, 5000.0, 40).first, 1280 / 5);
}

TEST(ViewRequest, IsThatOfTheOptions) {
  umbrage::view::View view{
      .options = {{"look", {"ao"}}, {"set", {"bitmask.slices=3", "bitmask.steps=5"}}}, .show = "depth", .device = ""};
  const auto request = request_of(view, 640, 480, false);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->look, "ao");
  EXPECT_EQ(request->settings, (std::vector<std::string>{"bitmask.slices=3", "bitmask.steps=5"}));
  EXPECT_EQ(request->passes, std::vector<std::string>{"depth"});
  EXPECT_EQ(request->width, 640);
  view.options["camera-view-angle"] = {"500"};
  const auto refused = request_of(view, 640, 480, false);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("--camera-view-angle"), std::string::npos) << refused.error().message;
}

TEST(ViewEncode, JpegIsCloseAndSmall) {
  Image picture(61, 35);
  for (const char* name : {"color.r", "color.g", "color.b"}) picture.add(name) = Plane(61, 35, 0.5f);
  picture.planes[0].at(3, 3) = std::numeric_limits<float>::quiet_NaN();
  const auto jpeg = encode(picture, false);
  ASSERT_TRUE(jpeg);
  EXPECT_STREQ(jpeg->format, "image/jpeg");
  EXPECT_TRUE(jpeg->bytes.starts_with("\xff\xd8"));
  EXPECT_TRUE(jpeg->bytes.ends_with("\xff\xd9"));
  EXPECT_LT(jpeg->bytes.size(), 2000u);
  const auto png = encode(picture, true);
  ASSERT_TRUE(png);
  EXPECT_STREQ(png->format, "image/png");
  picture.add("color.a") = Plane(61, 35, 0.25f);
  EXPECT_STREQ(encode(picture, false)->format, "image/png") << "JPEG has no transparency";
}

TEST(ViewErrorMap, ColorsAndNumbersAreThoseOfTheDifference) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  Plane ao(16, 1, 0.5f), truth(16, 1, 0.5f), depth(16, 1, 2.0f);
  ao.at(0, 0) = 0.5f + kErrorRange;  // too bright
  ao.at(1, 0) = 0.5f - kErrorRange;  // too dark
  ao.at(2, 0) = 1.0f;
  depth.at(2, 0) = kFar;  // no surface: not counted
  ErrorNumbers numbers;
  const Image picture = error_picture(ao, truth, depth, numbers);
  const Plane &red = picture.plane("color.r"), &blue = picture.plane("color.b");
  EXPECT_GT(red.at(0, 0), 2.0f * blue.at(0, 0));
  EXPECT_GT(blue.at(1, 0), 2.0f * red.at(1, 0));
  EXPECT_EQ(red.at(2, 0), blue.at(2, 0));
  EXPECT_GT(red.at(3, 0), 0.9f);
  EXPECT_NEAR(numbers.mean, 0.0, 1e-7);
  EXPECT_NEAR(numbers.rmse, std::sqrt(2.0 * kErrorRange * kErrorRange / 15.0), 1e-6);
}

TEST(ViewTables, HaveEveryOptionEffectAndLook) {
  const nlohmann::json tables = hello_tables();
  const auto names = [&](const char* table) {
    std::set<std::string> all;
    for (const auto& record : tables[table]) all.insert(record["name"].get<std::string>());
    return all;
  };
  const auto option_names = names("options");
  for (const Option& option : options())
    if ((option.commands & kRender) && !option.option.empty()) {
      EXPECT_TRUE(option_names.contains(std::string(option.option))) << option.option;
    }
  EXPECT_EQ(names("effects").size(), effects_with_external().size());
  EXPECT_EQ(names("looks").size(), looks().size());
  EXPECT_TRUE(names("devices").contains("cpu"));
  const auto kind_of = [&](const std::string& name) -> std::string {
    for (const auto& record : tables["options"])
      if (record["name"] == name) return record["kind"];
    return "";
  };
  EXPECT_EQ(kind_of("look"), "choice");
  EXPECT_EQ(kind_of("ao-radius"), "length");
  EXPECT_EQ(kind_of("anti-aliasing"), "integer");
  EXPECT_EQ(kind_of("camera-position"), "vector");
  EXPECT_EQ(kind_of("background-color"), "color");
  EXPECT_EQ(kind_of("no-background"), "flag");
  EXPECT_EQ(kind_of("hdri-intensity"), "number");
}

/// Returns the root mean square difference of two pictures where neither has a strong edge.
double noise_of(const Image& a, const Image& b) {
  const Plane &p = a.planes[0], &q = b.planes[0];
  double sum = 0.0;
  int count = 0;
  for (int y = 1; y + 1 < a.height; ++y)
    for (int x = 1; x + 1 < a.width; ++x) {
      if (q.at(x, y) == 1.0f || std::fabs(q.at(x + 1, y) - q.at(x - 1, y)) > 0.05f ||
          std::fabs(q.at(x, y + 1) - q.at(x, y - 1)) > 0.05f)
        continue;
      sum += std::pow(p.at(x, y) - q.at(x, y), 2.0);
      ++count;
    }
  EXPECT_GT(count, 1000);
  return std::sqrt(sum / count);
}

TEST(ViewModelMoving, FramesAreJoinedWithThoseBefore) {
  Request request;
  request.look = "ao";
  request.width = 240;
  request.height = 160;
  request.passes = {"ao"};
  const auto model = ViewModel::load("scene:solids?detail=2000", false, request);
  ASSERT_TRUE(model) << model.error().message;
  DrawingDevice device{make_cpu_device({})};
  const auto drawn = [&](float azimuth_deg, bool moving, int samples) {
    Request turned = moving_request(request);
    turned.camera.azimuth_deg = azimuth_deg;
    turned.anti_aliasing = samples;
    Image image;
    DrawControl control{.moving = moving, .aspect = moving ? 1.5 : 0.0};
    control.take = [&](const Image& picture, int, bool) -> Result<void> {
      image = Image(picture.width, picture.height);
      image.add("ao") = picture.planes[0];
      return {};
    };
    StageTimes times;
    const auto status = (*model)->draw(device, turned, control, times);
    EXPECT_TRUE(status) << status.error().message;
    return image;
  };
  const Image exact = drawn(4.0f, false, 64);
  const double single = noise_of(drawn(4.0f, true, 1), exact);
  for (const float azimuth_deg : {0.0f, 1.0f, 2.0f, 3.0f}) drawn(azimuth_deg, true, 1);
  const double joined = noise_of(drawn(4.0f, true, 1), exact);
  EXPECT_LT(joined, 0.8 * single) << joined << ", single " << single;
}

TEST(ViewTables, TellTheTechniqueOfALook) {
  const nlohmann::json looks = hello_tables()["looks"];
  const auto studio =
      std::find_if(looks.begin(), looks.end(), [](const auto& look) { return look["name"] == "studio"; });
  ASSERT_NE(studio, looks.end());
  EXPECT_EQ((*studio)["gbuffer_technique"], "bitmask");
  EXPECT_EQ((*studio)["techniques"][""], "traced");
  EXPECT_EQ((*studio)["techniques"]["draft"], "bitmask");
  const auto technique_with = [&](const std::string& name, const std::string& text) -> std::string {
    for (const auto& change : (*studio)["technique_changes"])
      if (change["name"] == name && (!change.contains("text") || change["text"] == text)) return change["technique"];
    return (*studio)["techniques"][""];
  };
  EXPECT_EQ(technique_with("ao-scale", "half"), "bitmask");
  EXPECT_EQ(technique_with("ao-scale", "full"), "traced");
  EXPECT_EQ(technique_with("ground", "off"), "traced");
  EXPECT_EQ(technique_with("bitmask.slices", "4"), "bitmask");
  EXPECT_EQ(technique_with("hemisphere.samples", "4"), "traced");
}

}  // namespace
}  // namespace umbrage::view
