// Light from environment images: their decomposition against quadrature, their readers, and their effect on pictures.
#include <algorithm>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>
#include <random>

#include "renderer/hdri.h"
#include "run_program.h"
#include "scene/environment.h"
#include "scene/readers/import_in_child_process.h"
#include "umbrage/umbrage.hpp"
#include "vulkan_support.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace umbrage {
namespace {

using glm::dvec3;

constexpr double kPi = std::numbers::pi;

double luminance(const dvec3& color) { return glm::dot(color, dvec3(0.2126, 0.7152, 0.0722)); }

/// Makes a panorama from a function that returns the radiance of a direction in the panorama's axes. Each pixel is the
/// mean over samples x samples points.
Panorama panorama_of(int width, int height, const std::function<dvec3(dvec3)>& radiance, int samples = 3) {
  Panorama panorama{"made", width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      dvec3 sum(0.0);
      for (int k = 0; k < samples * samples; ++k)
        sum += radiance(
            dvec3(panorama_direction((float(x) + (float(k % samples) + 0.5f) / float(samples)) / float(width),
                                     (float(y) + (float(k / samples) + 0.5f) / float(samples)) / float(height))));
      for (int c = 0; c < 3; ++c) panorama.rgb.push_back(float(sum[c] / (samples * samples)));
    }
  return panorama;
}

/// Integrates radiance times weight(direction) numerically over several points per pixel; pixels have constant colour.
dvec3 quadrature(const Panorama& panorama, const std::function<double(dvec3)>& weight) {
  const int across = std::max(1, 512 / panorama.width), down = std::max(1, 256 / panorama.height);
  dvec3 sum(0.0);
  for (int j = 0; j < panorama.height * down; ++j) {
    const double above = std::cos(kPi * j / (panorama.height * down)),
                 below = std::cos(kPi * (j + 1) / (panorama.height * down));
    const double cosine = 0.5 * (above + below), sine = std::sqrt(1.0 - cosine * cosine);
    for (int i = 0; i < panorama.width * across; ++i) {
      const double angle = 2.0 * kPi * ((i + 0.5) / (panorama.width * across) - 0.5);
      const double solid_angle = (above - below) * 2.0 * kPi / (panorama.width * across);
      sum += dvec3(panorama.at(i / across, j / down)) *
             (solid_angle * weight({std::cos(angle) * sine, std::sin(angle) * sine, cosine}));
    }
  }
  return sum;
}

dvec3 mean_radiance(const Panorama& panorama) {
  return quadrature(panorama, [](dvec3) { return 1.0; }) / (4.0 * kPi);
}
dvec3 irradiance(const Panorama& panorama, dvec3 normal) {
  return quadrature(panorama, [&](dvec3 d) { return std::max(glm::dot(d, normal), 0.0); });
}

/// Returns the irradiance of lights and ambient light together.
dvec3 irradiance(const EnvironmentLight& light, dvec3 normal) {
  dvec3 sum(light.ambient + light.shape.at(glm::vec3(normal)));
  for (const Light& each : light.lights)
    sum += dvec3(each.color) * std::max(glm::dot(dvec3(each.direction), normal), 0.0);
  return kPi * sum;
}

std::vector<dvec3> normals_all_around() {
  std::vector<dvec3> normals = {{0, 0, 1}, {0, 0, -1}};
  for (int j = 1; j < 8; ++j)
    for (int i = 0; i < 12; ++i) normals.emplace_back(panorama_direction((float(i) + 0.3f) / 12.0f, float(j) / 8.0f));
  return normals;
}

dvec3 direction_at(double right_deg, double up_deg) {
  const double right = glm::radians(right_deg), up = glm::radians(up_deg);
  return {std::cos(right) * std::cos(up), std::sin(right) * std::cos(up), std::sin(up)};
}

/// Makes a disc of constant colour on a constant background.
Panorama disc(int width, int height, dvec3 middle, double half_angle_deg, dvec3 inside, dvec3 outside) {
  // Fine sampling at the edge, one sample elsewhere.
  const double edge = std::cos(glm::radians(half_angle_deg));
  Panorama out{"disc", width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      constexpr int kFine = 8;
      const dvec3 centre(panorama_direction((float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(height)));
      const double away = std::acos(std::clamp(glm::dot(centre, middle), -1.0, 1.0));
      const int samples = std::abs(away - glm::radians(half_angle_deg)) < 2.0 * kPi / height ? kFine : 1;
      double fraction = 0.0, all = 0.0;
      for (int k = 0; k < samples * samples; ++k) {
        const float down = (float(y) + (float(k / samples) + 0.5f) / float(samples)) / float(height);
        const dvec3 d(
            panorama_direction((float(x) + (float(k % samples) + 0.5f) / float(samples)) / float(width), down));
        const double weight = std::sin(kPi * double(down));
        all += weight;
        fraction += glm::dot(d, middle) >= edge ? weight : 0.0;
      }
      for (int c = 0; c < 3; ++c) out.rgb.push_back(float(glm::mix(outside[c], inside[c], fraction / all)));
    }
  return out;
}

// ---- decomposition of an image

TEST(Environment, UniformSkyIsOnlyAmbientLight) {
  for (const auto& [width, height] : {std::pair(1, 1), {2, 1}, {7, 3}, {33, 20}, {64, 32}, {101, 400}, {1500, 700}}) {
    SCOPED_TRACE(fmt::format("{} x {}", width, height));
    const Panorama white = panorama_of(
        width, height, [](dvec3) { return dvec3(1.0, 0.5, 2.0); }, 1);
    const EnvironmentLight light = environment_light(white);
    EXPECT_TRUE(light.lights.empty());
    for (const dvec3& n : normals_all_around()) {
      const dvec3 e = irradiance(light, n);
      EXPECT_NEAR(e.r, kPi, 1e-4);
      EXPECT_NEAR(e.g, kPi * 0.5, 1e-4);
      EXPECT_NEAR(e.b, kPi * 2.0, 1e-4);
    }
    EXPECT_NEAR(light.brightest, luminance({1.0, 0.5, 2.0}), 1e-4);
  }
}

TEST(Environment, ASmallDiscIsOneLight) {
  const dvec3 radiance(100.0, 80.0, 40.0);
  for (const dvec3& middle : {direction_at(20, 35), direction_at(-179.9, 5), direction_at(0, 90), direction_at(70, -88),
                              direction_at(-90, -30)})
    for (const double half_deg : {0.27, 2.0, 8.0, 15.0})
      for (const auto& [width, height] : {std::pair(1024, 512), {2000, 999}, {611, 512}}) {
        SCOPED_TRACE(
            fmt::format("{} {} {}, {} degrees, {} x {}", middle.x, middle.y, middle.z, half_deg, width, height));
        if (half_deg > 1.0 && width != 1024) continue;
        const Panorama image = disc(width, height, middle, half_deg, radiance, dvec3(0.0));
        const EnvironmentLight light = environment_light(image);
        ASSERT_EQ(light.lights.size(), 1u);
        const Light& sun = light.lights[0];
        EXPECT_TRUE(sun.casts_shadow);
        EXPECT_LT(glm::degrees(std::acos(std::min(1.0, glm::dot(middle, dvec3(sun.direction))))), 0.1);
        // The light must be as large as the disc that the pixels show; if the disc is large, as large as the disc
        // itself.
        double flux = 0.0, squares = 0.0;
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x) {
            const double l = luminance(dvec3(image.at(x, y)));
            const double angle = 2.0 * kPi / width * (std::cos(kPi * y / height) - std::cos(kPi * (y + 1) / height));
            flux += l * angle;
            squares += l * l * angle;
          }
        const double solid_angle = flux * flux / squares;
        const double span_deg = glm::degrees(2.0 * std::acos(1.0 - solid_angle / (2.0 * kPi)));
        EXPECT_NEAR(sun.angle_deg, span_deg, 0.02 * span_deg + 0.01);
        if (half_deg > 5.0) {
          EXPECT_NEAR(sun.angle_deg, 2.0 * half_deg, 0.02 * 2.0 * half_deg);
        }
        const dvec3 facing = irradiance(image, middle) / kPi;
        const dvec3 white = radiance * std::pow(std::sin(glm::radians(half_deg)), 2.0);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(sun.color[c], facing[c], 0.005 * facing[c]) << c;
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(sun.color[c], white[c], (half_deg > 5.0 ? 0.01 : 0.45) * white[c]) << c;
        // The remainder is small.
        EXPECT_LT(luminance(light.ambient), 0.02 * luminance(white));
      }
}

TEST(Environment, EnergyIsPreserved) {
  const Panorama images[] = {
      reduced_panorama(sky_panorama(), 512, 256),
      disc(400, 200, direction_at(40, 20), 6, {40, 40, 60}, {0.5, 0.4, 0.3}),
      // Windows of a dark room, a bright stripe along the horizon, and a colour gradient.
      panorama_of(
          301, 77,
          [](dvec3 d) { return std::abs(d.y) < 0.3 && std::abs(d.z) < 0.2 && d.x > 0 ? dvec3(9, 8, 7) : dvec3(0.2); }),
      panorama_of(512, 256, [](dvec3 d) { return std::abs(d.z) < 0.05 ? dvec3(30, 10, 5) : dvec3(0.1, 0.2, 0.4); }),
      panorama_of(64, 90, [](dvec3 d) { return dvec3(1.0 + d.x, 1.0 - d.y, 1.5 + d.z); }),
  };
  for (const Panorama& image : images) {
    SCOPED_TRACE(image.name + fmt::format(" {} x {}", image.width, image.height));
    const EnvironmentLight light = environment_light(image);
    // The mean irradiance over all normals is a quarter of the flux, also for lights.
    dvec3 mean(light.ambient);
    for (const Light& each : light.lights) mean += 0.25 * dvec3(each.color);
    const dvec3 expected = mean_radiance(image);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected[c], 2e-4 * expected[c]) << c;
    // The irradiance of each normal is as close as second-degree harmonics and a few lights permit.
    double max = 0.0, max_error = 0.0;
    for (const dvec3& n : normals_all_around()) max = std::max(max, luminance(irradiance(image, n)));
    for (const dvec3& n : normals_all_around())
      max_error = std::max(max_error, std::abs(luminance(irradiance(image, n)) - luminance(irradiance(light, n))));
    EXPECT_LT(max_error, (&image == &images[3] ? 0.07 : 0.04) * max);
    EXPECT_GE(light.brightest * kPi, 0.97 * max);
    EXPECT_LE(light.brightest * kPi, 1.1 * max);
  }
}

TEST(Environment, PolesCountByTheirSolidAngle) {
  // The bright row at the pole is one of 32 rows, but covers only 0.24 percent of the sphere.
  Panorama top = panorama_of(
      64, 32, [](dvec3) { return dvec3(1.0); }, 1);
  for (int x = 0; x < 64 * 3; ++x) top.rgb[std::size_t(x)] = 3.0f;
  const double fraction = 0.5 * (1.0 - std::cos(kPi / 32.0));
  EXPECT_NEAR(environment_light(top).ambient.g, 1.0 + 2.0 * fraction, 1e-5);
  const Panorama reduced = reduced_panorama(top, 64, 1);
  EXPECT_NEAR(reduced.at(7, 0).g, 1.0 + 2.0 * fraction, 1e-5);
}

TEST(Environment, SeparatesDistantLights) {
  const dvec3 a = direction_at(30, 40), b = direction_at(-100, 20), c = direction_at(170, -10);
  const Panorama three = panorama_of(512, 256, [&](dvec3 d) {
    if (glm::dot(d, a) > std::cos(glm::radians(4.0))) return dvec3(50.0);
    if (glm::dot(d, b) > std::cos(glm::radians(8.0))) return dvec3(20.0, 10.0, 5.0);
    return glm::dot(d, c) > std::cos(glm::radians(5.0)) ? dvec3(15.0) : dvec3(0.1);
  });
  const EnvironmentLight light = environment_light(three);
  ASSERT_EQ(light.lights.size(), 3u);
  EXPECT_GT(glm::dot(dvec3(light.lights[0].direction), a), 0.9999);
  EXPECT_GT(glm::dot(dvec3(light.lights[1].direction), b), 0.9999);
  EXPECT_GT(glm::dot(dvec3(light.lights[2].direction), c), 0.9999);
  EXPECT_NEAR(light.lights[1].angle_deg, 16.0f, 0.7f);
  // A long lamp becomes several lights, none much wider than it is high; the number of lights is limited.
  const EnvironmentLight strip = environment_light(
      panorama_of(512, 256, [](dvec3 d) { return std::abs(d.z) < 0.03 && d.x > 0.0 ? dvec3(10.0) : dvec3(0.0); }));
  EXPECT_GE(strip.lights.size(), 3u);
  EXPECT_LE(strip.lights.size(), std::size_t(kMaxEnvironmentLights));
  std::mt19937 random(1);
  Panorama noise = panorama_of(
      256, 128, [](dvec3) { return dvec3(0.1); }, 1);
  for (int k = 0; k < 500; ++k) noise.rgb[random() % noise.rgb.size()] = 300.0f;
  EXPECT_LE(environment_light(noise).lights.size(), std::size_t(kMaxEnvironmentLights));
}

TEST(Environment, DiscsOfLightsEndAtTheHorizon) {
  // Discs of 16 degrees about a middle that is this high; y is up, and the image is turned.
  for (const double height_deg : {3.0, 6.0, 20.0, -6.0}) {
    SCOPED_TRACE(height_deg);
    Hdri hdri{.file = "disc", .rotation_deg = 70.0f};
    hdri.panorama =
        std::make_shared<const Panorama>(disc(512, 256, direction_at(-100, height_deg), 8.0, dvec3(100.0), dvec3(0.0)));
    const Lighting lighting = image_lighting(hdri, {0.0f, 2.0f, 0.0f}, false);
    ASSERT_EQ(lighting.lights.size(), 1u);
    const Light& sun = lighting.lights[0];
    EXPECT_NEAR(glm::degrees(std::asin(sun.direction.y)), height_deg, 0.1);
    // A disc that reaches the horizon has twice the height of its middle as its diameter. One below is not limited:
    // it does not light the ground.
    EXPECT_NEAR(sun.angle_deg, height_deg > 0.0 ? std::min(16.0, 2.0 * height_deg) : 16.0, 0.3);
    // The limit does not change how bright the light is.
    EXPECT_NEAR(sun.color.g, 100.0 * std::pow(std::sin(glm::radians(8.0)), 2.0), 0.02);
  }
}

TEST(Environment, OddPixelsHaveDefinedResults) {
  const float infinity = std::numeric_limits<float>::infinity();
  Panorama odd{"odd", 2, 2, {NAN, 1, 1, -1, 2, 2, infinity, 3, 3, 4, 4, 3e38f}};
  EXPECT_EQ(clean_panorama(odd), 4u);
  EXPECT_EQ(odd.rgb, (std::vector<float>{0, 1, 1, 0, 2, 2, 65504, 3, 3, 4, 4, kMaxRadiance}));
  EXPECT_EQ(clean_panorama(odd), 0u);
  const EnvironmentLight light = environment_light(odd);
  for (const dvec3& n : normals_all_around()) EXPECT_TRUE(std::isfinite(luminance(irradiance(light, n))));
  const EnvironmentLight black = environment_light(panorama_of(
      16, 8, [](dvec3) { return dvec3(0.0); }, 1));
  EXPECT_TRUE(black.lights.empty());
  EXPECT_TRUE(black.shape.even());
  EXPECT_EQ(black.ambient, glm::vec3(0.0f));
  EXPECT_EQ(black.brightest, 0.0f);
}

TEST(Environment, TheGroundOfTheBuiltInSkyIsLitAndMeetsTheSkySoftly) {
  const Panorama sky = sky_panorama();
  const double up = luminance(irradiance(sky, dvec3(0, 0, 1)));
  // Straight below is the ground's own light, slightly veiled by air.
  const double below = luminance(dvec3(sky.at(0, sky.height - 1)));
  EXPECT_GT(below, 0.37 * up / kPi);
  EXPECT_LT(below, 0.45 * up / kPi);
  const double white = double(environment_light(sky).brightest);  // a white surface that faces the sun
  EXPECT_GT(below, 0.25 * white);
  for (int x = 0; x < sky.width; x += 7)
    for (int y = sky.height / 2 - 8; y + 1 < sky.height; ++y) {
      const double above = luminance(dvec3(sky.at(x, y))), here = luminance(dvec3(sky.at(x, y + 1)));
      ASSERT_GT(here, 0.2 * white) << x << " " << y;
      ASSERT_NEAR(here / above, 1.0, 0.05) << x << " " << y;
    }
}

// ---- orientation

void expect_near(glm::vec3 a, glm::vec3 b) { EXPECT_LT(glm::distance(a, b), 1e-5f) << a.x << " " << a.y << " " << a.z; }

TEST(Environment, HasTheDocumentedOrientation) {
  const glm::mat3 y_up = panorama_axes({0, 2, 0}, 0.0f);
  expect_near(y_up[0], {1, 0, 0});
  expect_near(y_up[1], {0, 0, 1});
  expect_near(y_up[2], {0, 1, 0});
  const glm::mat3 z_up = panorama_axes({0, 0, 1}, 0.0f);
  expect_near(z_up[0], {1, 0, 0});
  expect_near(z_up[1], {0, -1, 0});
  const glm::mat3 turned = panorama_axes({0, 1, 0}, 90.0f);  // to the left
  expect_near(turned[0], {0, 0, -1});
  expect_near(turned[1], {1, 0, 0});
  for (const glm::vec3 up : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(1, 2, -3)}) {
    const glm::mat3 axes = panorama_axes(up, 33.0f);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(glm::dot(axes[i], axes[j]), i == j ? 1.0f : 0.0f, 1e-6f);
    expect_near(axes[2], glm::normalize(up));
    expect_near(glm::cross(axes[0], axes[2]), axes[1]);
  }
  expect_near(panorama_direction(0.5f, 0.5f), {1, 0, 0});
  expect_near(panorama_direction(0.75f, 0.5f), {0, 1, 0});
  expect_near(panorama_direction(0.1f, 0.0f), {0, 0, 1});
  // Between pixels, across the seam and over the poles.
  const Panorama image = panorama_of(400, 200, [](dvec3 d) { return d + 2.0; });
  for (const dvec3& n : normals_all_around())
    EXPECT_LT(glm::distance(dvec3(panorama_radiance(image, glm::vec3(n))), n + 2.0), 0.01);
}

TEST(Environment, RotatesWithItsAxes) {
  const EnvironmentLight light = environment_light(panorama_of(
      128, 64, [](dvec3 d) { return dvec3(1 + d.x * d.y + d.z, 1 + d.y * d.z - d.x, 1 + d.x * d.x - 0.5 * d.y); }));
  const glm::mat3 axes = panorama_axes({0.3f, 1.0f, -0.2f}, 57.0f);
  const AmbientShape world = turned(light.shape, axes);
  for (const dvec3& n : normals_all_around()) {
    const glm::vec3 here = light.shape.at(glm::vec3(n)), there = world.at(axes * glm::vec3(n));
    EXPECT_LT(glm::distance(here, there), 1e-5f);
    EXPECT_GT(glm::length(light.shape.at({0, 0, 1})), 0.1f);
  }
}

// ---- files

class HdriFile : public test::ProgramTest {
 protected:
  Image sky_image() {
    const Panorama sky = reduced_panorama(sky_panorama(), 128, 64);
    Image image(sky.width, sky.height);
    for (int c = 0; c < 3; ++c) {
      Plane& plane = image.add(std::string("color.") + "rgb"[c]);
      for (int y = 0; y < sky.height; ++y)
        for (int x = 0; x < sky.width; ++x) plane.at(x, y) = sky.at(x, y)[c];
    }
    return image;
  }
  std::vector<float> values(const Image& image) {
    std::vector<float> out;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) out.push_back(image.planes[std::size_t(c)].at(x, y));
    return out;
  }
  std::string path(const std::string& name) { return (folder_ / name).string(); }

  void write_hdr(const std::string& name) {
    const Image image = sky_image();
    ASSERT_TRUE(stbi_write_hdr(path(name).c_str(), image.width, image.height, 3, values(image).data()));
  }
  /// Returns an 8-bit image with the same value in all pixels.
  std::vector<std::uint8_t> grey(int width, int height, std::uint8_t value) {
    return std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height) * 3, value);
  }
  const std::string kDraw_ = "tri.obj -o out.png --resolution 40x40 --hdri-file ";
};

TEST_F(HdriFile, ReadsWhatDecodersRead) {
  write_hdr("sky.hdr");
  const auto hdr = read_panorama_in_child_process(path("sky.hdr"));
  ASSERT_TRUE(hdr) << hdr.error().message;
  const auto expected = values(sky_image());
  ASSERT_EQ(hdr->rgb.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); k += 3) {
    const float max = std::max({expected[k], expected[k + 1], expected[k + 2]});
    for (std::size_t c = k; c < k + 3; ++c) EXPECT_NEAR(hdr->rgb[c], expected[c], max / 120.0f);
  }
  // Other formats are sRGB: the value 188 is half of the max light.
  ASSERT_TRUE(stbi_write_jpg(path("grey.jpg").c_str(), 32, 16, 3, grey(32, 16, 188).data(), 95));
  ASSERT_TRUE(stbi_write_tga(path("grey.tga").c_str(), 32, 16, 3, grey(32, 16, 188).data()));
  for (const char* name : {"grey.jpg", "grey.tga"}) {
    const auto grey = read_panorama_in_child_process(path(name));
    ASSERT_TRUE(grey) << grey.error().message;
    for (const float v : grey->rgb) EXPECT_NEAR(v, 0.5029f, 0.01f) << name;
  }
}

TEST_F(HdriFile, ReadsRadianceInAnyOrientation) {
  const std::string pixels[] = {"\x80\x40\x20\x81", "\x10\x20\x30\x84"};  // 1, .5, .25 and 1, 2, 3
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
  const auto read = [&](const std::string& bytes) {
    write("two.hdr", bytes);
    const auto panorama = read_panorama_in_child_process(path("two.hdr"));
    EXPECT_TRUE(panorama) << panorama.error().message;
    return panorama ? panorama->rgb : std::vector<float>();
  };
  const std::vector<float> stored = {1.0f, 0.5f, 0.25f, 1.0f, 2.0f, 3.0f},
                           reversed = {1.0f, 2.0f, 3.0f, 1.0f, 0.5f, 0.25f};
  EXPECT_EQ(read(head + "\n-Y 1 +X 2\n" + pixels[0] + pixels[1]), stored);
  EXPECT_EQ(read(head + "\n-Y 1 -X 2\n" + pixels[0] + pixels[1]), reversed);
  EXPECT_EQ(read(head + "\n-Y 2 +X 1\n" + pixels[0] + pixels[1]), stored);
  EXPECT_EQ(read(head + "\n+Y 2 +X 1\n" + pixels[0] + pixels[1]), reversed);
  EXPECT_EQ(read("#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 1 +X 2\r\n" + pixels[0] + pixels[1]), stored);
  EXPECT_EQ(read(head + "EXPOSURE=2\nEXPOSURE=.5\n\n-Y 1 +X 2\n" + pixels[0] + pixels[1]), stored);
  write("two.hdr", head + "EXPOSURE=1e-30\nEXPOSURE=1e-30\n\n-Y 1 +X 2\n" + pixels[0] + pixels[1]);
  bad(kDraw_ + "two.hdr", 3, {"two.hdr", "exposures"});
}

TEST_F(HdriFile, LightsScenesFromEveryFormat) {
  write_hdr("sky.hdr");
  ASSERT_TRUE(write_image(folder_ / "sky.exr", sky_image(), {.half = true}));
  ASSERT_TRUE(write_image(folder_ / "sky.pfm", sky_image()));
  good(kDraw_ + "sky.hdr");
  const Image by_hdr = image("out.png");
  for (const char* name : {"sky.exr", "sky.pfm"}) {
    good(kDraw_ + name);
    const Image same = image("out.png");
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) ASSERT_NEAR(same.planes[0].at(x, y), by_hdr.planes[0].at(x, y), 0.02f) << name;
  }
  ASSERT_TRUE(stbi_write_jpg(path("grey.jpg").c_str(), 32, 16, 3, grey(32, 16, 188).data(), 95));
  ASSERT_TRUE(stbi_write_png(path("grey.png").c_str(), 32, 16, 3, grey(32, 16, 188).data(), 96));
  good(kDraw_ + "grey.jpg");
  const Image by_jpg = image("out.png");
  good(kDraw_ + "grey.png");
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) ASSERT_NEAR(image("out.png").planes[0].at(x, y), by_jpg.planes[0].at(x, y), 0.01f);
}

TEST_F(HdriFile, UnusableFilesGiveOneSentence) {
  bad(kDraw_ + "none.hdr", 3, {"none.hdr", "does not exist"});
  write("text.hdr", "no picture at all");
  bad(kDraw_ + "text.hdr", 3, {"text.hdr", "is not an image"});
  write("empty.exr", "");
  bad(kDraw_ + "empty.exr", 3, {"empty.exr", "is empty"});
  bad(kDraw_ + ".", 3, {"folder"});
  write_hdr("sky.hdr");
  const std::string whole = test::text_of(folder_ / "sky.hdr");
  for (const std::size_t size : {whole.size() / 2, whole.size() - 1, std::size_t(80), std::size_t(20)}) {
    write("cut.hdr", whole.substr(0, size));
    bad(kDraw_ + "cut.hdr", 3, {"cut.hdr"});
  }
  ASSERT_TRUE(write_image(folder_ / "sky.exr", sky_image()));
  write("cut.exr", test::text_of(folder_ / "sky.exr").substr(0, 2000));
  bad(kDraw_ + "cut.exr", 3, {"cut.exr"});
  write("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 120000\n");
  bad(kDraw_ + "huge.hdr", 3, {"huge.hdr", "60000"});
  write("wide.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 134217728\n");
  bad(kDraw_ + "wide.hdr", 3, {"wide.hdr", "134217728"});
  Image depth(4, 2);
  for (const char* name : {"depth", "ao"}) depth.add(name) = Plane(4, 2, 1.0f);
  ASSERT_TRUE(write_image(folder_ / "depth.exr", depth));
  bad(kDraw_ + "depth.exr", 3, {"depth.exr", "R, G and B"});
  bad(kDraw_ + "crash.hdr", 3, {"does not exist"}, std::string("UMBRAGE_IMPORT=") + test::kFaultyImport);
  write("crash.hdr", whole);
  bad(kDraw_ + "crash.hdr", 3, {"crash.hdr", "its reader crashed"},
      std::string("UMBRAGE_IMPORT=") + test::kFaultyImport);
}

TEST_F(HdriFile, WrongValuesAreUsageErrors) {
  bad_option("--hdri-file sky: --hdri-rotation up", {"--hdri-rotation", "up"});
  bad_option("--hdri-file sky: --hdri-intensity=-1", {"--hdri-intensity", "-1"});
  bad_option("--hdri-file sky: --hdri-intensity nan", {"--hdri-intensity", "nan"});
  bad_option("--hdri-skybox", {"--hdri-skybox", "--hdri-file"});
  bad_option("--hdri-file sky: --hdri-skybox --no-background", {"--hdri-skybox", "--no-background"});
  bad_option("--light-size 91", {"--light-size", "91"});
}

TEST_F(HdriFile, WarnsAboutOddImages) {
  const test::Outcome alone = run("tri.obj -o out.png --resolution 40x40 --hdri-rotation 30");
  EXPECT_EQ(alone.code, 0);
  EXPECT_NE(alone.err.find("--hdri-rotation does nothing"), std::string::npos) << alone.err;
  Image image(30, 10);
  for (const char* name : {"color.r", "color.g", "color.b"}) image.add(name) = Plane(30, 10, 0.0f);
  ASSERT_TRUE(write_image(folder_ / "black.pfm", image));
  test::Outcome outcome = run(kDraw_ + "black.pfm");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("twice as wide"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("all black"), std::string::npos) << outcome.err;
  image.planes[0].at(3, 3) = NAN;
  image.planes[1].at(3, 4) = std::numeric_limits<float>::infinity();
  ASSERT_TRUE(write_image(folder_ / "odd.pfm", image));
  outcome = run(kDraw_ + "odd.pfm");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("2 of its pixels"), std::string::npos) << outcome.err;
  const test::Outcome useless = run("tri.obj -o out.png --resolution 40x40 --look unsharp --hdri-file sky:");
  EXPECT_EQ(useless.code, 0);
  EXPECT_NE(useless.err.find("--hdri-file does nothing"), std::string::npos) << useless.err;
}

// ---- pictures

/// A white sphere, without highlights.
class HdriPicture : public HdriFile {
 protected:
  void SetUp() override {
    HdriFile::SetUp();
    write("white.mtl", "newmtl white\nKd 1 1 1\nKs 0 0 0\n");
    std::string ball = "mtllib white.mtl\nusemtl white\n";
    constexpr int kRings = 24, kParts = 48;
    for (int j = 0; j <= kRings; ++j)
      for (int i = 0; i < kParts; ++i) {
        const double below = kPi * j / kRings, angle = 2.0 * kPi * i / kParts;
        ball += fmt::format("v {:.5f} {:.5f} {:.5f}\n", std::sin(below) * std::cos(angle), std::cos(below),
                            -std::sin(below) * std::sin(angle));
      }
    for (int j = 0; j < kRings; ++j)
      for (int i = 0; i < kParts; ++i) {
        const int a = j * kParts + i + 1, b = j * kParts + (i + 1) % kParts + 1;
        ball += fmt::format("f {} {} {} {}\n", a, a + kParts, b + kParts, b);
      }
    write("ball.obj", ball);
  }
  /// Writes a panorama file from a function that returns the radiance of a direction in the panorama's axes.
  void write_panorama(const std::string& name, const std::function<dvec3(dvec3)>& radiance) {
    const Panorama made = panorama_of(256, 128, radiance);
    Image image(made.width, made.height);
    for (int c = 0; c < 3; ++c) {
      Plane& plane = image.add(std::string("color.") + "rgb"[c]);
      for (int y = 0; y < made.height; ++y)
        for (int x = 0; x < made.width; ++x) plane.at(x, y) = made.at(x, y)[c];
    }
    ASSERT_TRUE(write_image(folder_ / name, image));
  }
};

TEST_F(HdriPicture, AWhiteSurfaceUnderAWhiteSkyIsWhite) {
  write_panorama("white.pfm", [](dvec3) { return dvec3(1.0); });
  for (const char* device : {"cpu", "vulkan"}) {
    const std::string line = fmt::format(
        "ball.obj --look lit --ao none --anti-aliasing 1 --resolution 64x64 --hdri-file white.pfm --passes depth,lit "
        "-o "
        "out.exr --device "
        "{}",
        device);
    const test::Outcome outcome = run(line);
    if (std::string(device) == "vulkan" && outcome.code == 4 && test::may_lack_vulkan()) continue;
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Image planes = image("out.exr");
    int covered = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        if (std::isfinite(planes.plane("depth").at(x, y))) {
          ++covered;
          ASSERT_NEAR(planes.plane("lit.r").at(x, y), 1.0f, 1e-4f);
        }
    EXPECT_GT(covered, 1000);
  }
  // The exposure is for the unscaled image, so half the intensity gives half the light.
  good("ball.obj --look lit --ao none --resolution 64x64 --hdri-file white.pfm --hdri-intensity 0.5 -o out.png");
  EXPECT_NEAR(image("out.png").planes[0].at(32, 32), 0.7354f, 0.01f);  // half of the light, in sRGB
  good("ball.obj --look lit --ao none --resolution 64x64 --hdri-file white.pfm -o out.png");
  EXPECT_GT(image("out.png").planes[0].at(32, 32), 0.99f);
}

TEST_F(HdriPicture, LooksAreExposedForAnyBrightness) {
  // The same image in other units gives the same picture, with the key light and its shadow.
  for (const char* look : {"studio", "lit", "bleeding", "cartoon"}) {
    Image first;
    for (const double gain : {1.0, 300.0}) {
      write_panorama("sun.pfm", [gain](dvec3 d) {
        return gain * (glm::dot(d, direction_at(0, 40)) > std::cos(0.05) ? dvec3(400.0) : dvec3(0.3, 0.4, 0.6));
      });
      good(fmt::format("ball.obj --look {} --resolution 64x64 --hdri-file sun.pfm -o out.png", look));
      const Image picture = image("out.png");
      if (first.planes.empty()) first = picture;
      float max = 0.0f, min = 1.0f;
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          ASSERT_NEAR(picture.planes[1].at(x, y), first.planes[1].at(x, y), 0.012f) << look;
          if (x > 14 && x < 50 && y > 14 && y < 50) {
            max = std::max(max, picture.planes[1].at(x, y));
            min = std::min(min, picture.planes[1].at(x, y));
          }
        }
      EXPECT_GT(max, 0.75f) << look;
      EXPECT_LT(min, 0.75f * max) << look << " shows no form";
    }
  }
}

TEST_F(HdriPicture, LightComesFromItsPositionInTheImage) {
  // A lamp at the image's middle is at +x; turned by 90 degrees it is at -z. Up is the model's up.
  write_panorama("lamp.pfm",
                 [](dvec3 d) { return glm::dot(d, dvec3(1, 0, 0)) > std::cos(0.1) ? dvec3(100.0) : dvec3(0.01); });
  const auto brightest_normal = [&](const std::string& more) {
    // One picture from each side; the largest sum identifies the direction.
    std::vector<double> sums;
    for (const char* from : {"-1,0,0", "1,0,0", "0,-1,0", "0,1,0", "0,0,-1", "0,0,1"}) {
      good(
          fmt::format("ball.obj --look lit --ao none --resolution 32x32 --hdri-file lamp.pfm {} --camera-direction={} "
                      "--passes lit -o out.exr",
                      more, from));
      const Image lit = image("out.exr");
      double sum = 0.0;
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) sum += lit.planes[0].at(x, y);
      sums.push_back(sum);
    }
    return std::max_element(sums.begin(), sums.end()) - sums.begin();
  };
  EXPECT_EQ(brightest_normal(""), 0);                            // a camera at +x sees it
  EXPECT_EQ(brightest_normal("--hdri-rotation 90"), 5);          // at -z
  EXPECT_EQ(brightest_normal("--up=+Z --hdri-rotation 90"), 2);  // at +y
  EXPECT_EQ(brightest_normal("--hdri-rotation=-180"), 1);        // at -x
}

TEST_F(HdriPicture, SkyIsShownOnRequest) {
  write_panorama("half.pfm", [](dvec3 d) { return d.z > 0.0 ? dvec3(0.1, 0.2, 0.8) : dvec3(0.3, 0.1, 0.05); });
  const std::string line =
      "ball.obj --resolution 64x64 --hdri-file half.pfm --camera-direction=-1,0,0 --camera-zoom-factor 0.5 ";
  for (const std::string look :
       {"studio --ground off --set output.gradient=0", "lit", "cartoon", "bleeding --anti-aliasing 2"}) {
    good(line + "--hdri-skybox -o sky.png --look " + look);
    const Image with = image("sky.png");
    EXPECT_GT(with.planes[2].at(3, 3), with.planes[0].at(3, 3) + 0.2f) << look;    // blue above
    EXPECT_GT(with.planes[0].at(3, 60), with.planes[2].at(3, 60) + 0.1f) << look;  // brown below
    good(line + "-o plain.png --look " + look);
    good(line + "-o bare.png --look " + look);
    const Image without = image("plain.png");
    EXPECT_NEAR(without.planes[2].at(3, 3), without.planes[2].at(3, 60), 0.01f) << look;
    // The model is unchanged.
    EXPECT_NEAR(with.planes[1].at(32, 32), without.planes[1].at(32, 32), 0.005f) << look;
  }
  // The image is the background but not the light: then the lights of the model or the look are used.
  good(line + "--look lit --hdri-skybox --hdri-ambient=false -o sky.png");
  good("ball.obj --resolution 64x64 --camera-direction=-1,0,0 --camera-zoom-factor 0.5 --look lit -o own.png");
  EXPECT_NEAR(image("sky.png").planes[1].at(32, 32), image("own.png").planes[1].at(32, 32), 0.005f);
}

TEST_F(HdriPicture, TheGroundOfALowLightHasNoEdge) {
  // The shadow of a setting sun is longer than any ground. Neither the shadow nor the ground may end in a line.
  write_panorama("low.pfm", [](dvec3 d) {
    return glm::dot(d, direction_at(100, 6)) > std::cos(0.06) ? dvec3(200.0) : dvec3(0.2);
  });
  good(
      "ball.obj --quality high --resolution 160x120 --hdri-file low.pfm --camera-zoom-factor 0.25 "
      "--camera-elevation-angle 10 --set ground.border=0 "
      "--passes shadow_catcher -o cover.exr");
  const Image cover = image("cover.exr");
  float max = 0.0f, steepest = 0.0f;
  for (int y = 1; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      // Skip the sphere and the area behind it.
      if (std::abs(x - 80) < 30 && std::abs(y - 60) < 30) continue;
      max = std::max(max, cover.planes[0].at(x, y));
      steepest = std::max(steepest, std::abs(cover.planes[0].at(x, y) - cover.planes[0].at(x, y - 1)));
    }
  EXPECT_GT(max, 0.05f);
  EXPECT_LT(steepest, 0.1f);
}

TEST_F(HdriPicture, TheKeyLightsSizeCanBeSet) {
  // A plate above a plane: the penumbra is as wide as the light is large.
  write("plate.obj",
        "v -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\nf 4 3 2 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\nf 8 7 6 5\n");
  const auto partly_lit = [&](const std::string& size) {
    good("plate.obj --look lit --quality high --anti-aliasing 1 --resolution 160x160 --passes shadow -o shadow.exr " +
         size);
    const Image shadow = image("shadow.exr");
    int count = 0;
    for (int y = 0; y < 160; ++y)
      for (int x = 0; x < 160; ++x) count += shadow.planes[0].at(x, y) > 0.05f && shadow.planes[0].at(x, y) < 0.95f;
    return count;
  };
  const int hard = partly_lit("--light-size 0"), own = partly_lit(""), soft = partly_lit("--light-size 40");
  EXPECT_EQ(hard, 0);
  EXPECT_GT(own, 20);
  EXPECT_GT(soft, 2 * own);
}

TEST_F(HdriPicture, AShadowOfTheSunLeavesNoTraceBesideItsEdge) {
  // The penumbra is narrower than a pixel here: pixels are partly lit only at the edge of the shadow or of an object.
  write("plate.obj",
        "v -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\nf 4 3 2 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\nf 8 7 6 5\n");
  good(
      "plate.obj --look lit --quality high --anti-aliasing 1 --resolution 200x170 --light-size 0.5 "
      "--passes shadow,object_id -o shadow.exr");
  const Image shadow = image("shadow.exr");
  const Plane &plane = shadow.plane("shadow"), &object = shadow.plane("object_id");
  constexpr int kNear = 3;
  int partly_lit = 0, away_from_edge = 0;
  for (int y = kNear; y < plane.height - kNear; ++y)
    for (int x = kNear; x < plane.width - kNear; ++x) {
      const float v = plane.at(x, y);
      if (v == 0.0f || v == 1.0f) continue;
      bool edge = false;
      for (int j = -kNear; j <= kNear; ++j)
        for (int i = -kNear; i <= kNear; ++i)
          edge = edge || std::abs(plane.at(x + i, y + j) - v) > 0.25f || object.at(x + i, y + j) != object.at(x, y);
      ++partly_lit;
      away_from_edge += !edge;
    }
  EXPECT_GT(partly_lit, 50);
  EXPECT_EQ(away_from_edge, 0);
}

TEST_F(HdriPicture, PublicInterfaceGivesTheSamePicture) {
  write_panorama("sun.pfm", [](dvec3 d) {
    return glm::dot(d, direction_at(60, 50)) > std::cos(0.05) ? dvec3(400.0) : dvec3(0.3, 0.4, 0.6);
  });
  good(
      "ball.obj --resolution 48x48 --hdri-file sun.pfm --hdri-skybox --hdri-rotation 30 --hdri-intensity 0.8 -o "
      "out.png --device cpu");
  const Image picture = image("out.png");
  umb::RenderRequest request{.model = path("ball.obj"), .width = 48, .height = 48, .device = "cpu"};
  request.hdri_file = path("sun.pfm");
  request.hdri_skybox = true;
  request.hdri_rotation_deg = 30.0f;
  request.hdri_intensity = 0.8f;
  umb::Picture drawn;
  ASSERT_EQ(render(request, drawn).code, 0);
  for (std::size_t p = 0; p < 48u * 48u; ++p)
    ASSERT_NEAR(drawn.rgba[4 * p + 1], picture.planes[1].at(int(p % 48), int(p / 48)), 0.003f);
  request.hdri_file = path("none.hdr");
  EXPECT_EQ(render(request, drawn).code, 3);
  request.hdri_file = "";
  EXPECT_EQ(render(request, drawn).code, 2);
  request.hdri_skybox = false;
  request.light_size_deg = -1.0f;
  EXPECT_EQ(render(request, drawn).code, 2);
}

}  // namespace
}  // namespace umbrage
