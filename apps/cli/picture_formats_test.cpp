// JPEG and WebP: they show the picture of the PNG.
#include <gtest/gtest.h>
#include <webp/decode.h>

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "run_program.h"
#include "scene/readers/texture_file.h"

namespace umbrage::test {
namespace {

class PictureFormats : public ProgramTest {
 protected:
  /// Returns the root mean square difference between a picture and out.png, in steps of 8 bits.
  double difference(const std::vector<std::uint8_t>& rgba) {
    const Image png = image("out.png");
    double sum = 0.0;
    const char* const names[] = {"color.r", "color.g", "color.b"};
    for (int y = 0; y < png.height; ++y)
      for (int x = 0; x < png.width; ++x)
        for (int c = 0; c < 3; ++c) {
          const double d = 255.0 * png.plane(names[c]).at(x, y) - rgba[4 * std::size_t(y * png.width + x) + c];
          sum += d * d;
        }
    return std::sqrt(sum / (3.0 * png.width * png.height));
  }
  std::vector<std::uint8_t> webp(const std::string& name) {
    const std::string bytes = text_of(folder_ / name);
    int width = 0, height = 0;
    std::uint8_t* decoded =
        WebPDecodeRGBA(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), &width, &height);
    EXPECT_NE(decoded, nullptr);
    if (!decoded) return {};
    std::vector<std::uint8_t> rgba(decoded, decoded + std::size_t(4) * width * height);
    WebPFree(decoded);
    return rgba;
  }
};

TEST_F(PictureFormats, ColoursOfPassesReturnFromPng) {
  const std::string scene =
      "scene:solids?detail=2000 --device cpu --resolution 64x48 --anti-aliasing 1 --passes albedo";
  good(scene + " --bits 16 -o out.png");
  good(scene + " -o out.exr");
  const Image png = image("out.png"), exr = image("out.exr");
  double max = 0.0;
  for (const char* channel : {"r", "g", "b"})
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const float light = exr.plane(std::string("albedo.") + channel).at(x, y);
        max = std::max(max, double(light));
        ASSERT_NEAR(linear_from_srgb(png.plane(std::string("color.") + channel).at(x, y)), light, 1e-3);
      }
  EXPECT_GT(max, 0.5);
}

constexpr const char* kPicture = "tri.obj --resolution 96,64 --background-color steelblue -o ";

TEST_F(PictureFormats, JpegShowsThePictureOfThePng) {
  good(std::string(kPicture) + "out.png");
  for (const char* name : {"out.jpg", "out.jpeg", "OUT.JPG"}) {
    good(std::string(kPicture) + name);
    const auto read = read_texture(folder_ / name);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_LT(difference(read->rgba), 2.5) << name;
  }
  const std::string bytes = text_of(folder_ / "out.jpg");
  EXPECT_NE(bytes.find("ICC_PROFILE"), std::string::npos);
  good(std::string(kPicture) + "small.jpg --picture-quality 30");
  EXPECT_LT(text_of(folder_ / "small.jpg").size(), bytes.size());
  good("tri.obj --resolution 32 --look ao --passes depth -o depth.jpg");
  EXPECT_TRUE(read_texture(folder_ / "depth.jpg"));
}

TEST_F(PictureFormats, WebpShowsThePictureOfThePng) {
  good(std::string(kPicture) + "out.png");
  good(std::string(kPicture) + "out.webp");
  EXPECT_LT(difference(webp("out.webp")), 4.0);
  good(std::string(kPicture) + "out.webp --picture-quality 100");
  EXPECT_LT(difference(webp("out.webp")), 1e-3) << "lossless";
  good("tri.obj --resolution 32 --no-background -o clear.webp --picture-quality 100");
  const auto clear = webp("clear.webp");
  ASSERT_EQ(clear.size(), 4u * 32 * 32);
  EXPECT_EQ(clear[3], 0) << "a corner is transparent";
  EXPECT_EQ(clear[4 * (16 * 32 + 16) + 3], 255);
}

TEST_F(PictureFormats, SequencesAndThumbnailsUseThem) {
  good("tri.obj --resolution 32 --look ao --turntable 2 -o turn.jpg");
  EXPECT_TRUE(fs::exists(folder_ / "turn_0001.jpg"));
  good("thumbnails tri.obj -o one.webp --size 32");
  EXPECT_FALSE(webp("one.webp").empty());
  good("thumbnails tri.obj -o all --format jpg --size 32");
  EXPECT_TRUE(read_texture(folder_ / "all/tri.obj.jpg"));
}

TEST_F(PictureFormats, RefusesWhatTheFormatsLack) {
  bad("tri.obj -o out.jpg --no-background", 2, {"--no-background", "a .jpg has no transparency"});
  bad("tri.obj -o out.jpg --bits 16", 2, {"--bits"});
  bad("tri.obj -o out.png --picture-quality 50", 2, {"--picture-quality is for .jpg and .webp"});
  bad("tri.obj -o out.jpg --picture-quality 0", 2, {"--picture-quality", "1 to 100"});
  bad("thumbnails tri.obj -o all --format bmp", 2, {"--format", "'bmp'"});
  bad("tri.obj -o out.webp --resolution 16384,1 --look ao", 2, {"--resolution", ".webp", "16383"});
  good(std::string(kPicture) + "out.jpg");
  EXPECT_NE(read_image(folder_ / "out.jpg").error().message.find("only written"), std::string::npos);
}

}  // namespace
}  // namespace umbrage::test
