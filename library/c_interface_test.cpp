// Tests of the C interface: functions that the C++ layer does not use, and invalid calls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "io/image_file.h"
#include "umbrage/umbrage.h"

namespace umbrage {
namespace {

/// Objects that are released by the destructor.
struct Objects {
  UmbDevice device = umbNewDevice("cpu", 2);
  UmbScene scene = umbNewScene(device);
  UmbJob job = nullptr;
  ~Objects() {
    umbReleaseJob(job);
    umbReleaseScene(scene);
    umbReleaseDevice(device);
  }
};

std::string job_error(UmbJob job) {
  const char* message = nullptr;
  umbGetJobError(job, &message);
  return message;
}

std::string scene_error(UmbScene scene) {
  const char* message = nullptr;
  umbGetSceneError(scene, &message);
  return message;
}

std::vector<float> output(UmbJob job, const char* name) {
  UmbImage image{};
  EXPECT_EQ(umbGetJobOutput(job, name, &image), UMB_ERROR_NONE) << job_error(job);
  if (!image.data) return {};
  EXPECT_EQ(image.type, UMB_TYPE_FLOAT32);
  const auto* values = static_cast<const float*>(image.data);
  return {values, values + std::size_t(image.width) * std::size_t(image.height) * std::size_t(image.channels)};
}

void request_output(UmbJob job, const char* name) {
  const UmbImage own{};
  EXPECT_EQ(umbSetJobOutput(job, name, &own), UMB_ERROR_NONE) << job_error(job);
}

UmbImage floats(float* data, int width, int height, int channels = 1) {
  return {data, UMB_TYPE_FLOAT32, width, height, channels, 0, 0, 0};
}

/// Creates a render job of 48 x 36 pixels.
void make_render_job(Objects& o, const char* look = "ao") {
  o.job = umbNewRenderJob(o.device, o.scene);
  umbSetJobString(o.job, "look", look);
  umbSetJobInt(o.job, "width", 48);
  umbSetJobInt(o.job, "height", 36);
}

/// A box about the origin, by its 8 corners.
constexpr float kCorners[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                  {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
constexpr std::uint16_t kTriangles[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                             {3, 7, 6}, {3, 6, 2}, {0, 4, 7}, {0, 7, 3}, {1, 2, 6}, {1, 6, 5}};

int add_box(UmbScene scene) {
  const int mesh = umbAddMesh(scene, "box", 8, 12);
  EXPECT_EQ(umbSetMeshBuffer(scene, mesh, "position", kCorners, UMB_TYPE_FLOAT32, 3, 0), UMB_ERROR_NONE);
  EXPECT_EQ(umbSetMeshBuffer(scene, mesh, "index", kTriangles, UMB_TYPE_UINT16, 3, 0), UMB_ERROR_NONE);
  return mesh;
}

TEST(CInterface, EffectsRunOnKeptCaptures) {
  Objects o;
  ASSERT_EQ(umbLoadModel(o.scene, "scene:solids?detail=2000"), UMB_ERROR_NONE);
  make_render_job(o, "studio");
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  umbSetJobInt(o.job, "anti_aliasing", 1);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  const auto captures = umbGetJobCounter(o.job, "captures_made");
  const auto before = output(o.job, "color");
  umbSetJobFloat(o.job, "output.exposure", 1.0f);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE);
  EXPECT_NE(output(o.job, "color"), before);
  umbSetJobFloat(o.job, "output.exposure", 0.0f);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE);
  EXPECT_EQ(output(o.job, "color"), before);
  EXPECT_EQ(umbGetJobCounter(o.job, "captures_made"), captures);
  EXPECT_EQ(umbGetJobCounter(o.job, "hierarchies_built"), 1);
  umbSetJobFloat(o.job, "camera.azimuth_deg", 30.0f);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE);
  EXPECT_EQ(umbGetJobCounter(o.job, "captures_made"), captures + 1);
  EXPECT_EQ(umbGetJobCounter(o.job, "hierarchies_built"), 1);
  // A new job draws the same picture.
  const auto kept = output(o.job, "color");
  umbReleaseJob(o.job);
  make_render_job(o, "studio");
  umbSetJobInt(o.job, "anti_aliasing", 1);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE);
  umbSetJobFloat(o.job, "camera.azimuth_deg", 30.0f);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE);
  EXPECT_EQ(output(o.job, "color"), kept);
}

TEST(CInterface, JobsOfOneDeviceMayAlternate) {
  Objects a, b;
  ASSERT_EQ(umbLoadModel(a.scene, "scene:solids?detail=2000"), UMB_ERROR_NONE);
  add_box(b.scene);
  make_render_job(a);
  b.job = umbNewRenderJob(a.device, b.scene);
  umbSetJobInt(b.job, "width", 20);
  ASSERT_EQ(umbExecuteJob(a.job), UMB_ERROR_NONE);
  const auto first = output(a.job, "color");
  ASSERT_EQ(umbExecuteJob(b.job), UMB_ERROR_NONE) << job_error(b.job);
  ASSERT_EQ(umbExecuteJob(a.job), UMB_ERROR_NONE);
  EXPECT_EQ(output(a.job, "color"), first);
}

TEST(CInterface, MeshesFromMemoryEqualThoseOfAFile) {
  const std::string file = testing::TempDir() + "umbrage_box.off";
  std::FILE* out = std::fopen(file.c_str(), "w");
  std::fprintf(out, "OFF\n8 12 0\n");
  for (const auto& p : kCorners) std::fprintf(out, "%g %g %g\n", double(p[0]), double(p[1]), double(p[2]));
  for (const auto& t : kTriangles) std::fprintf(out, "3 %d %d %d\n", t[0], t[1], t[2]);
  std::fclose(out);
  Objects read, made;
  ASSERT_EQ(umbLoadModel(read.scene, file.c_str()), UMB_ERROR_NONE) << scene_error(read.scene);
  add_box(made.scene);
  for (Objects* o : {&read, &made}) {
    make_render_job(*o);
    for (const char* pass : {"color", "depth", "normal"}) request_output(o->job, pass);
    ASSERT_EQ(umbExecuteJob(o->job), UMB_ERROR_NONE) << job_error(o->job);
  }
  for (const char* pass : {"color", "depth", "normal"})
    EXPECT_EQ(output(read.job, pass), output(made.job, pass)) << pass;
  std::remove(file.c_str());
}

TEST(CInterface, MeshColorsAreNotMultipliedByTheDefaultGrey) {
  constexpr float kClay[3] = {0.5f, 0.3f, 0.2f}, kWhite[3] = {1, 1, 1}, kHalf[3] = {0.5f, 0.5f, 0.5f};
  float colors[8][3];
  for (auto& color : colors) std::copy(kClay, kClay + 3, color);
  const auto drawn = [&](bool colored, const float* albedo) {
    Objects o;
    const int mesh = add_box(o.scene);
    if (colored) {
      EXPECT_EQ(umbSetMeshBuffer(o.scene, mesh, "color", colors, UMB_TYPE_FLOAT32, 3, 0), UMB_ERROR_NONE);
    }
    if (albedo) {
      EXPECT_EQ(umbSetMeshFloats(o.scene, mesh, "albedo", albedo, 3), UMB_ERROR_NONE);
    }
    make_render_job(o, "lit");
    request_output(o.job, "albedo");
    EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
    return output(o.job, "albedo");
  };
  const auto clay = drawn(false, kClay);
  const auto difference = [&](const std::vector<float>& other) {  // not 0, since interpolation rounds
    float max = 0.0f;
    for (std::size_t k = 0; k < clay.size(); ++k) max = std::max(max, std::abs(other[k] - clay[k]));
    return max;
  };
  EXPECT_LT(difference(drawn(true, nullptr)), 1e-6f);
  EXPECT_LT(difference(drawn(true, kWhite)), 1e-6f);
  EXPECT_NEAR(difference(drawn(true, kHalf)), 0.25f, 1e-6f);
}

TEST(CInterface, EachInstanceIsAnObject) {
  Objects o;
  const int mesh = add_box(o.scene);
  const float places[2][12] = {{1, 0, 0, -2, 0, 1, 0, 0, 0, 0, 1, 0}, {-1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0}};
  for (const auto& place : places) ASSERT_EQ(umbAddMeshInstance(o.scene, mesh, place), UMB_ERROR_NONE);
  double lower[3], upper[3];
  ASSERT_EQ(umbGetSceneBounds(o.scene, lower, upper), UMB_ERROR_NONE);
  EXPECT_FLOAT_EQ(lower[0], -3.0f);
  EXPECT_FLOAT_EQ(upper[0], 3.0f);
  make_render_job(o);
  std::vector<std::uint8_t> ids(48 * 36);
  UmbImage image{ids.data(), UMB_TYPE_UINT8, 48, 36, 1, 0, 0, 0};
  ASSERT_EQ(umbSetJobOutput(o.job, "object_id", &image), UMB_ERROR_NONE);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  for (const int id : {0, 1, 255}) EXPECT_GT(std::count(ids.begin(), ids.end(), id), 20) << id;
}

TEST(CInterface, OutputsComeInEveryTypeAndLayout) {
  Objects o;
  add_box(o.scene);
  make_render_job(o);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE);
  const auto color = output(o.job, "color");
  std::vector<std::uint8_t> bytes(48 * 36 * 3);
  std::vector<std::uint16_t> words(48 * 36 * 4), halves(48 * 36 * 4);
  std::vector<float> planes(48 * 36 * 4);
  const auto expect = [&](const UmbImage& image, const auto& at, double tolerance) {
    ASSERT_EQ(umbSetJobOutput(o.job, "color", &image), UMB_ERROR_NONE) << job_error(o.job);
    ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
    for (int y = 0; y < 36; ++y)
      for (int x = 0; x < 48; ++x)
        for (int c = 0; c < image.channels; ++c)
          ASSERT_NEAR(at(x, y, c), color[std::size_t(4 * (48 * y + x) + c)], tolerance) << x << ' ' << y << ' ' << c;
  };
  expect(
      {bytes.data(), UMB_TYPE_UINT8, 48, 36, 3, 0, 0, 0},
      [&](int x, int y, int c) { return bytes[std::size_t(3 * (48 * y + x) + c)] / 255.0; }, 0.5 / 255 + 1e-6);
  expect(
      {words.data(), UMB_TYPE_UINT16, 48, 36, 4, 0, 0, 0},
      [&](int x, int y, int c) { return words[std::size_t(4 * (48 * y + x) + c)] / 65535.0; }, 1e-5);
  // Planar, bottom row first.
  expect(
      {planes.data() + 48 * 35, UMB_TYPE_FLOAT32, 48, 36, 4, 48 * 36 * 4, 4, -48 * 4},
      [&](int x, int y, int c) { return planes[std::size_t(48 * 36 * c + 48 * (35 - y) + x)]; }, 0.0);
  UmbImage half{halves.data(), UMB_TYPE_FLOAT16, 48, 36, 4, 0, 0, 0};
  ASSERT_EQ(umbSetJobOutput(o.job, "color", &half), UMB_ERROR_NONE);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE);
  EXPECT_EQ(halves[3], 0x3c00) << "alpha 1";
}

TEST(CInterface, InputsComeInEveryTypeAndLayout) {
  Objects o;
  constexpr int kWidth = 21, kHeight = 13;
  std::vector<float> depth(kWidth * kHeight), normal(3 * kWidth * kHeight), albedo(3 * kWidth * kHeight);
  std::vector<std::uint8_t> bytes(4 * kWidth * kHeight);
  for (int k = 0; k < kWidth * kHeight; ++k) {
    depth[std::size_t(k)] = 2.0f + 0.05f * float(k % kWidth % 7);
    normal[std::size_t(3 * k + 2)] = 1.0f;
    for (int c = 0; c < 3; ++c) {
      bytes[std::size_t(4 * k + c)] = std::uint8_t(50 * c + k % 100);
      albedo[std::size_t(3 * k + c)] = float(50 * c + k % 100) / 255.0f;
    }
  }
  const auto shaded = [&](const UmbImage& colors) {
    umbReleaseJob(o.job);
    o.job = umbNewShadeJob(o.device);
    const UmbImage depths = floats(depth.data(), kWidth, kHeight), normals = floats(normal.data(), kWidth, kHeight, 3);
    EXPECT_EQ(umbSetJobImage(o.job, "depth", &depths), UMB_ERROR_NONE);
    EXPECT_EQ(umbSetJobImage(o.job, "normal", &normals), UMB_ERROR_NONE);
    EXPECT_EQ(umbSetJobImage(o.job, "albedo", &colors), UMB_ERROR_NONE) << job_error(o.job);
    EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
    return output(o.job, "color");
  };
  const auto expected = shaded(floats(albedo.data(), kWidth, kHeight, 3));
  EXPECT_EQ(shaded({bytes.data(), UMB_TYPE_UINT8, kWidth, kHeight, 4, 0, 0, 0}), expected);
  // Rows from the bottom up, with a gap between them.
  std::vector<std::uint8_t> gaps((4 * kWidth + 3) * kHeight);
  for (int y = 0; y < kHeight; ++y)
    std::memcpy(&gaps[std::size_t((kHeight - 1 - y) * (4 * kWidth + 3))], &bytes[std::size_t(4 * kWidth * y)],
                4 * kWidth);
  EXPECT_EQ(shaded({&gaps[std::size_t((kHeight - 1) * (4 * kWidth + 3))], UMB_TYPE_UINT8, kWidth, kHeight, 3, 1, 4,
                    -(4 * kWidth + 3)}),
            expected);
}

/// The G-buffer of a sphere in front of a wall, as an engine provides it.
struct EngineGBuffer {
  int width, height;
  std::vector<float> depth, normal, albedo;  // planar

  EngineGBuffer(int w, int h) : width(w), height(h), depth(count()), normal(3 * count()), albedo(3 * count(), 0.6f) {
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const std::size_t k = std::size_t(w * y + x);
        const float a = (float(x) - 0.5f * float(w)) / float(h), b = (0.5f * float(h) - float(y)) / float(h);
        const float square = 0.09f - a * a - b * b, out = square > 0.0f ? std::sqrt(square) : 0.0f;
        depth[k] = 3.0f - out;
        const float length = std::sqrt(a * a + b * b + square);
        normal[k] = out > 0.0f ? a / length : 0.0f;
        normal[count() + k] = out > 0.0f ? b / length : 0.0f;
        normal[2 * count() + k] = out > 0.0f ? out / length : 1.0f;
      }
  }
  std::size_t count() const { return std::size_t(width) * std::size_t(height); }
  UmbImage image(std::vector<float>& values, int channels) const {
    const auto plane = std::ptrdiff_t(count() * sizeof(float));
    return {values.data(), UMB_TYPE_FLOAT32, width, height, channels, plane, sizeof(float), 0};
  }
  void set(UmbJob job) {
    const UmbImage images[3] = {image(depth, 1), image(normal, 3), image(albedo, 3)};
    EXPECT_EQ(umbSetJobImage(job, "depth", &images[0]), UMB_ERROR_NONE);
    EXPECT_EQ(umbSetJobImage(job, "normal", &images[1]), UMB_ERROR_NONE);
    EXPECT_EQ(umbSetJobImage(job, "albedo", &images[2]), UMB_ERROR_NONE);
  }
};

TEST(CInterface, PlanesAreReadInPlace) {
  Objects o;
  EngineGBuffer gbuffer(64, 40);
  o.job = umbNewShadeJob(o.device);
  gbuffer.set(o.job);
  for (int k = 0; k < 2; ++k) {
    ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
    EXPECT_EQ(umbGetJobCounter(o.job, "planes_copied"), 0);
  }
  // A pixel with a negative depth, which means no surface, makes the library copy the plane.
  std::vector<float> all = gbuffer.depth;
  const UmbImage image = gbuffer.image(all, 1);
  all[0] = -1.0f;
  ASSERT_EQ(umbSetJobImage(o.job, "depth", &image), UMB_ERROR_NONE);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  EXPECT_EQ(all[0], -1.0f);
  EXPECT_EQ(umbGetJobCounter(o.job, "planes_copied"), 1);
}

/// Compares packed planes with interleaved pixels, which are copied. At widths that are multiples of 256 the library's
/// own planes have padded rows.
TEST(CInterface, ShadingDoesNotDependOnTheLayoutOfPlanes) {
  for (const int width : {16, 64, 250, 256, 496, 512, 768, 1024}) {
    SCOPED_TRACE(width);
    Objects o;
    EngineGBuffer gbuffer(width, 9);
    const EngineGBuffer before = gbuffer;
    std::vector<float> normals(3 * gbuffer.count()), albedos(3 * gbuffer.count());
    for (std::size_t k = 0; k < gbuffer.count(); ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        normals[3 * k + c] = gbuffer.normal[c * gbuffer.count() + k];
        albedos[3 * k + c] = gbuffer.albedo[c * gbuffer.count() + k];
      }
    const auto shaded = [&](const char* look, bool interleaved) {
      umbReleaseJob(o.job);
      o.job = umbNewShadeJob(o.device);
      gbuffer.set(o.job);
      if (interleaved) {
        const UmbImage normal = floats(normals.data(), width, 9, 3), albedo = floats(albedos.data(), width, 9, 3);
        umbSetJobImage(o.job, "normal", &normal);
        umbSetJobImage(o.job, "albedo", &albedo);
      }
      for (const char* pass : {"color", "depth"}) request_output(o.job, pass);
      umbSetJobString(o.job, "look", look);
      EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
      EXPECT_EQ(output(o.job, "depth"), before.depth);
      return output(o.job, "color");
    };
    for (const char* look : {"studio", "lit", "ao", "cartoon"})
      EXPECT_EQ(shaded(look, false), shaded(look, true)) << look;
    EXPECT_EQ(gbuffer.depth, before.depth);
    EXPECT_EQ(gbuffer.normal, before.normal);
    EXPECT_EQ(gbuffer.albedo, before.albedo);
  }
}

TEST(CInterface, ReferencesAreCounted) {
  UmbDevice device = umbNewDevice("cpu", 1);
  UmbScene scene = umbNewScene(device);
  UmbJob job = umbNewRenderJob(device, scene);
  umbReleaseDevice(device);
  umbReleaseScene(scene);  // the job retains them
  umbRetainJob(job);
  umbReleaseJob(job);
  EXPECT_EQ(umbSetJobInt(job, "width", 8), UMB_ERROR_NONE);
  umbReleaseJob(job);
  EXPECT_EQ(umbSetJobInt(job, "width", 8), UMB_ERROR_USAGE);
  const char* message = nullptr;
  EXPECT_EQ(umbGetError(&message), UMB_ERROR_USAGE);
  EXPECT_NE(std::string(message).find("umbSetJobInt"), std::string::npos) << message;
  umbReleaseJob(job);  // does nothing
  umbReleaseJob(nullptr);
  EXPECT_EQ(umbGetDeviceDescription(device), nullptr);
  EXPECT_EQ(umbExecuteJob(reinterpret_cast<UmbJob>(&message)), UMB_ERROR_USAGE);
  EXPECT_EQ(umbNewRenderJob(nullptr, nullptr), nullptr);
  EXPECT_EQ(umbGetError(nullptr), UMB_ERROR_USAGE);
  EXPECT_EQ(umbNewDevice("gpu", 0), nullptr);
  EXPECT_EQ(umbGetError(&message), UMB_ERROR_USAGE);
  EXPECT_EQ(umbNewDevice("cpu", -3), nullptr);
  EXPECT_EQ(umbGetError(&message), UMB_ERROR_USAGE);
  EXPECT_EQ(umbGetError(&message), UMB_ERROR_NONE);
}

struct Reports {
  std::vector<std::string> errors, warnings;
};

TEST(CInterface, ErrorsAreReportedToCallbacks) {
  Objects o;
  Reports reported;
  const auto on_error = [](void* user, UmbError code, const char* message) {
    EXPECT_EQ(code, UMB_ERROR_USAGE);
    static_cast<Reports*>(user)->errors.emplace_back(message);
  };
  umbSetDeviceErrorCallback(o.device, on_error, &reported);
  make_render_job(o);
  EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_USAGE);
  EXPECT_EQ(umbSetJobInt(o.job, "widht", 3), UMB_ERROR_USAGE);
  ASSERT_EQ(reported.errors.size(), 2u);
  EXPECT_NE(reported.errors[0].find("the scene is empty"), std::string::npos) << reported.errors[0];
  EXPECT_NE(reported.errors[1].find("did you mean 'width'"), std::string::npos) << reported.errors[1];
  EXPECT_EQ(job_error(o.job), reported.errors[0]) << "the first";
  EXPECT_EQ(job_error(o.job), "");
}

TEST(CInterface, ParametersTakeOnlyTheirTypes) {
  Objects o;
  make_render_job(o);
  const auto refused = [&](UmbError code, const char* text) {
    EXPECT_EQ(code, UMB_ERROR_USAGE) << text;
    const std::string message = job_error(o.job);
    EXPECT_NE(message.find(text), std::string::npos) << message;
  };
  const float numbers[3] = {0, 1, 0}, odd[3] = {NAN, 0, 1}, none[3] = {0, 0, 0};
  EXPECT_EQ(umbSetJobFloats(o.job, "camera.view_up", numbers, 3), UMB_ERROR_NONE) << job_error(o.job);
  EXPECT_EQ(umbSetJobString(o.job, "camera.position", "1,2,3"), UMB_ERROR_NONE);
  EXPECT_EQ(umbSetJobBool(o.job, "camera.orthographic", true), UMB_ERROR_NONE);
  EXPECT_EQ(umbSetJobFloat(o.job, "occlusion_radius", 0.5f), UMB_ERROR_NONE);
  EXPECT_EQ(umbSetJobString(o.job, "occlusion_radius", "5%"), UMB_ERROR_NONE);
  EXPECT_EQ(umbSetJobString(o.job, "width", "40"), UMB_ERROR_NONE) << job_error(o.job);
  EXPECT_EQ(umbSetJobString(o.job, "height", "30"), UMB_ERROR_NONE) << job_error(o.job);
  EXPECT_EQ(umbSetJobFloat(o.job, "guard_band", 2.5f), UMB_ERROR_NONE) << job_error(o.job);
  EXPECT_EQ(umbSetJobString(o.job, "bitmask.radius", "15%"), UMB_ERROR_NONE);
  EXPECT_EQ(umbSetJobInt(o.job, "bitmask.slices", 4), UMB_ERROR_NONE);
  EXPECT_EQ(umbSetJobBool(o.job, "box.ao", false), UMB_ERROR_NONE) << job_error(o.job);
  EXPECT_EQ(umbCheckJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  refused(umbSetJobFloat(o.job, "look", 1.0f), "`look` takes a string");
  refused(umbSetJobFloat(o.job, "width", 1e9f), "`width`");
  refused(umbSetJobString(o.job, "width", "-3"), "`width`");
  refused(umbSetJobBool(o.job, "width", true), "`width` cannot be true");
  refused(umbSetJobInt(o.job, "layers", 99), "1 to 16");
  refused(umbSetJobFloat(o.job, "layers", 1.5f), "an integer");
  refused(umbSetJobInt(o.job, "camera.orthographic", 2), "true or false");
  refused(umbSetJobFloats(o.job, "camera.view_up", odd, 3), "camera.view_up");
  refused(umbSetJobFloats(o.job, "camera.view_up", none, 3), "camera.view_up");
  refused(umbSetJobFloats(o.job, "camera.view_up", numbers, 2), "camera.view_up");
  refused(umbSetJobFloats(o.job, "camera.view_up", nullptr, 3), "no values");
  refused(umbSetJobString(o.job, "bitmask.slices", "x"), "bitmask.slices");
  refused(umbSetJobString(o.job, "bitmask.slyces", "4"), "did you mean");
  refused(umbSetJobString(o.job, "depth_kind", "planar"), "depth_kind");
  refused(umbSetJobString(o.job, nullptr, "planar"), "there is no parameter");
  refused(umbSetJobFloat(o.job, "camera.zom", 2.0f), "did you mean 'camera.zoom'");
  umbSetJobString(o.job, "look", "stodio");
  refused(umbCheckJob(o.job), "did you mean 'studio'");
  EXPECT_EQ(umbResetJobParameter(o.job, "look"), UMB_ERROR_NONE);
  EXPECT_EQ(umbCheckJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
}

TEST(CInterface, InvalidImagesAreErrors) {
  Objects o;
  o.job = umbNewShadeJob(o.device);
  std::vector<float> depth(64, 2.0f), out(64 * 5);
  const auto refused = [&](UmbError code, const char* text) {
    EXPECT_EQ(code, UMB_ERROR_USAGE) << text;
    const std::string message = job_error(o.job);
    EXPECT_NE(message.find(text), std::string::npos) << message;
  };
  const auto with = [&](auto change) {
    UmbImage image = floats(depth.data(), 8, 8);
    change(image);
    return umbSetJobImage(o.job, "depth", &image);
  };
  refused(umbExecuteJob(o.job), "'depth'");
  refused(with([](UmbImage& i) { i.data = nullptr; }), "no values");
  refused(with([](UmbImage& i) { i.type = 9; }), "no type 9");
  refused(with([](UmbImage& i) { i.width = 0; }), "0 x 8");
  refused(with([](UmbImage& i) { i.height = -5; }), "8 x -5");
  refused(with([](UmbImage& i) { i.width = 1 << 30; }), "16384");
  refused(with([](UmbImage& i) { i.row_stride = PTRDIFF_MAX; }), "stride");
  ASSERT_EQ(with([](UmbImage&) {}), UMB_ERROR_NONE);
  UmbImage image = floats(depth.data(), 8, 8);
  refused(umbSetJobImage(o.job, "dept", &image), "did you mean 'depth'");
  refused(umbSetJobImage(o.job, nullptr, &image), "no effect");
  image.type = UMB_TYPE_UINT32;
  ASSERT_EQ(umbSetJobImage(o.job, "ao", &image), UMB_ERROR_NONE);
  refused(umbExecuteJob(o.job), "only ids can");
  ASSERT_EQ(umbSetJobImage(o.job, "ao", nullptr), UMB_ERROR_NONE);
  UmbImage color = floats(out.data(), 8, 8, 4), ao = floats(out.data() + 10, 8, 8);
  ASSERT_EQ(umbSetJobOutput(o.job, "color", &color), UMB_ERROR_NONE);
  refused(umbSetJobOutput(o.job, "ao", &ao), "share memory");
  ao = floats(out.data() + 300, 8, 8);  // begins after the colour, and its rows run back into it
  ao.row_stride = -8 * std::ptrdiff_t(sizeof(float));
  refused(umbSetJobOutput(o.job, "ao", &ao), "share memory");
  color.width = 7;
  ASSERT_EQ(umbSetJobOutput(o.job, "color", &color), UMB_ERROR_NONE);
  refused(umbExecuteJob(o.job), "7 x 8");
  color = floats(out.data(), 8, 8, 2);
  ASSERT_EQ(umbSetJobOutput(o.job, "color", &color), UMB_ERROR_NONE);
  refused(umbExecuteJob(o.job), "2 channels");
  const UmbImage in_place = floats(depth.data(), 8, 8);
  ASSERT_EQ(umbSetJobOutput(o.job, "color", nullptr), UMB_ERROR_NONE);
  ASSERT_EQ(umbSetJobOutput(o.job, "ao", &in_place), UMB_ERROR_NONE);
  refused(umbExecuteJob(o.job), "shares memory with the image 'depth'");
  ASSERT_EQ(umbSetJobOutput(o.job, "ao", nullptr), UMB_ERROR_NONE);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  UmbImage made{};
  refused(umbGetJobOutput(o.job, "ao", &made), "produced no 'ao'");
}

TEST(CInterface, InvalidMeshesAreErrors) {
  Objects o;
  const auto refused = [&](UmbError code, const char* text) {
    EXPECT_EQ(code, UMB_ERROR_USAGE) << text;
    const std::string message = scene_error(o.scene);
    EXPECT_NE(message.find(text), std::string::npos) << message;
  };
  EXPECT_LT(umbAddMesh(o.scene, "none", 0, 1), 0);
  EXPECT_LT(umbAddMesh(o.scene, "huge", std::size_t(1) << 40, 1), 0);
  scene_error(o.scene);
  const int mesh = umbAddMesh(o.scene, "box", 8, 12);
  double lower[3], upper[3];
  refused(umbGetSceneBounds(o.scene, lower, upper), "lacks its positions");
  refused(umbSetMeshBuffer(o.scene, mesh, "position", nullptr, UMB_TYPE_FLOAT32, 3, 0), "NULL");
  refused(umbSetMeshBuffer(o.scene, mesh, "position", kCorners, UMB_TYPE_UINT8, 3, 0), "8-bit integers");
  refused(umbSetMeshBuffer(o.scene, mesh, "position", kCorners, UMB_TYPE_FLOAT32, 2, 0), "2 channels");
  for (const std::ptrdiff_t stride : {PTRDIFF_MAX, PTRDIFF_MIN, std::ptrdiff_t(1) << 41})
    refused(umbSetMeshBuffer(o.scene, mesh, "position", kCorners, UMB_TYPE_FLOAT32, 3, stride), "stride");
  refused(umbSetMeshBuffer(o.scene, mesh, "position\x1b\xff", kCorners, UMB_TYPE_FLOAT32, 3, 0),
          "no buffer 'position \xef\xbf\xbd'");
  refused(umbSetMeshBuffer(o.scene, mesh, "positions", kCorners, UMB_TYPE_FLOAT32, 3, 0), "no buffer 'positions'");
  refused(umbSetMeshBuffer(o.scene, 7, "position", kCorners, UMB_TYPE_FLOAT32, 3, 0), "no mesh 7");
  const std::uint8_t beyond[36] = {0, 1, 8};
  refused(umbSetMeshBuffer(o.scene, mesh, "index", beyond, UMB_TYPE_UINT8, 3, 0), "vertex 8");
  const float bad[3] = {-1, 0, 0};
  refused(umbSetMeshFloats(o.scene, mesh, "albedo", bad, 3), "albedo");
  refused(umbSetMeshFloats(o.scene, mesh, "albedo", bad, 1), "3 numbers");
  refused(umbSetMeshFloats(o.scene, mesh, "colour", bad, 1), "no parameter 'colour'");
  const float values[12] = {};
  refused(umbSetMeshValues(o.scene, mesh, "p", false, nullptr, UMB_TYPE_FLOAT32, 1, 0), "NULL");
  refused(umbSetMeshValues(o.scene, mesh, "", false, values, UMB_TYPE_FLOAT32, 1, 0), "empty");
  refused(umbSetMeshValues(o.scene, mesh, "p", false, values, UMB_TYPE_FLOAT16, 1, 0), "16-bit floats");
  refused(umbSetMeshValues(o.scene, mesh, "p", false, values, UMB_TYPE_FLOAT32, 0, 0), "0 channels");
  refused(umbSetMeshValues(o.scene, mesh, "p", true, values, UMB_TYPE_FLOAT32, 17, 0), "17 channels");
  refused(umbSetMeshValues(o.scene, umbAddMesh(o.scene, "cloud", 2, 0), "p", true, values, UMB_TYPE_FLOAT32, 1, 0),
          "the mesh has none");
  EXPECT_EQ(umbSetMeshValues(o.scene, mesh, "p", true, values, UMB_TYPE_FLOAT32, 1, 0), UMB_ERROR_NONE);
  refused(umbSetSceneParameter(o.scene, "down", "+Y"), "no parameter 'down'");
  refused(umbSetSceneParameter(o.scene, "up", "sideways"), "`up`");
  EXPECT_EQ(umbLoadModel(o.scene, "missing.obj"), UMB_ERROR_FILE);
}

TEST(CInterface, ListsEntriesAndParameters) {
  const char *name = nullptr, *summary = nullptr;
  int looks = 0;
  bool studio = false;
  for (; umbGetListEntry(UMB_LIST_LOOKS, looks, &name, &summary) == UMB_ERROR_NONE; ++looks)
    studio = studio || std::string(name) == "studio";
  EXPECT_TRUE(studio);
  EXPECT_EQ(umbGetError(nullptr), UMB_ERROR_NONE);
  UmbParameter parameter{};
  EXPECT_EQ(umbGetParameter("render", 0, &parameter), UMB_ERROR_USAGE) << "without its size";
  EXPECT_EQ(umbGetError(nullptr), UMB_ERROR_USAGE);
  parameter.size = sizeof parameter;
  for (const char* owner : {"render", "shade", "scene", "bitmask"}) {
    int count = 0;
    for (; umbGetParameter(owner, count, &parameter) == UMB_ERROR_NONE; ++count) {
      EXPECT_NE(std::string(parameter.type), "") << owner << ' ' << parameter.name;
      EXPECT_TRUE(std::string(parameter.help) != "") << parameter.name;
    }
    EXPECT_GT(count, 4) << owner;
    EXPECT_EQ(umbGetError(nullptr), UMB_ERROR_NONE);
  }
  EXPECT_EQ(umbGetPassChannels("depth"), 1);
  EXPECT_EQ(umbGetPassChannels("normal"), 3);
  EXPECT_EQ(umbGetPassChannels("color"), 4);
  EXPECT_EQ(umbGetPassChannels("nothing"), 0);
  EXPECT_EQ(umbGetPassChannels(nullptr), 0);
  // Listed choices can be set.
  Objects o;
  make_render_job(o);
  for (int k = 0; umbGetParameter("render", k, &parameter) == UMB_ERROR_NONE; ++k) {
    const std::string choices = parameter.choices;
    if (choices.empty()) continue;
    EXPECT_EQ(umbSetJobString(o.job, parameter.name, choices.substr(0, choices.find(' ')).c_str()), UMB_ERROR_NONE)
        << parameter.name;
    if (std::string(parameter.name) == "look") {
      EXPECT_EQ(std::string(parameter.type), "choice");
    }
    if (std::string(parameter.name) == "camera.azimuth_deg") {
      EXPECT_EQ(std::string(parameter.unit), "deg");
    }
  }
}

TEST(CInterface, WarnsOnceOfSettingsWithoutEffect) {
  Objects o;
  Reports reported;
  umbSetDeviceLogCallback(
      o.device, [](void* user, const char* message) { static_cast<Reports*>(user)->warnings.emplace_back(message); },
      &reported);
  add_box(o.scene);
  make_render_job(o);
  umbSetJobFloat(o.job, "outline.width", 3.0f);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  ASSERT_EQ(reported.warnings.size(), 1u);
  EXPECT_NE(reported.warnings[0].find("outline.width=3 does nothing: the look ao has no outline"), std::string::npos)
      << reported.warnings[0];
  umbSetJobString(o.job, "look", "cartoon");
  EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  EXPECT_EQ(reported.warnings.size(), 1u);
}

TEST(CInterface, SinglePictureFilesTakeOneImage) {
  std::vector<float> color(4 * 6, 0.5f), depth(6, 2.0f);
  const UmbImage images[2] = {floats(color.data(), 3, 2, 4), floats(depth.data(), 3, 2)};
  const char* const names[2] = {"color", "depth"};
  const std::string file = testing::TempDir() + "umbrage_two.png";
  EXPECT_EQ(umbWriteImages(file.c_str(), names, images, 2, 8, false), UMB_ERROR_USAGE);
  const char* message = "";
  umbGetError(&message);
  EXPECT_NE(std::string(message).find("write 2 images to a .exr file"), std::string::npos) << message;
  EXPECT_EQ(std::fopen(file.c_str(), "r"), nullptr);
  const std::string exr = testing::TempDir() + "umbrage_two.exr";
  EXPECT_EQ(umbWriteImages(exr.c_str(), names, images, 2, 8, false), UMB_ERROR_NONE);
  std::remove(exr.c_str());
  const UmbImage ids{depth.data(), UMB_TYPE_UINT32, 3, 2, 1, 0, 0, 0};
  EXPECT_EQ(umbWriteImages(exr.c_str(), names + 1, &ids, 1, 8, false), UMB_ERROR_USAGE);
  EXPECT_EQ(umbGetError(nullptr), UMB_ERROR_USAGE);
}

TEST(CInterface, FilesStoreTheView) {
  std::vector<float> beauty = {4.0f, 0.5f, 0.25f, 0.5f};
  const UmbImage images[2] = {floats(beauty.data(), 1, 1, 4), floats(beauty.data(), 1, 1, 4)};
  const char* const names[2] = {"color", "beauty"};
  const std::string file = testing::TempDir() + "umbrage_view.exr";
  UmbView view{{1, 0, 0, 2, 0, 1, 0, 3, 0, 0, 1, -5}, -0.5f, 0.5f, -0.25f, 0.25f, 0};
  EXPECT_EQ(umbWriteImagesOfView(file.c_str(), names, images, 2, 8, false, &view), UMB_ERROR_NONE);
  const auto read = read_image(file);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->plane("color.r").at(0, 0), 4.0f) << "beauty as it is, in place of color";
  EXPECT_EQ(read->names.size(), 4u);
  const auto camera = read_camera(file);
  ASSERT_TRUE(camera && *camera);
  EXPECT_FLOAT_EQ((*camera)->view_from_world[3][1], 3.0f);
  EXPECT_FLOAT_EQ((*camera)->top, 0.25f);
  std::remove(file.c_str());
  view.right = view.left;
  EXPECT_EQ(umbWriteImagesOfView(file.c_str(), names, images, 2, 8, false, &view), UMB_ERROR_USAGE);
  Objects o;
  add_box(o.scene);
  make_render_job(o);
  EXPECT_EQ(umbGetJobView(o.job, &view), UMB_ERROR_USAGE);
  EXPECT_EQ(umbGetJobView(o.job, nullptr), UMB_ERROR_USAGE);
  EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  EXPECT_EQ(umbGetJobView(o.job, &view), UMB_ERROR_NONE);
  EXPECT_GT(view.right, view.left);
}

TEST(CInterface, WarnsOfTrianglesLeftOut) {
  Objects o;
  Reports reported;
  umbSetDeviceLogCallback(
      o.device, [](void* user, const char* message) { static_cast<Reports*>(user)->warnings.emplace_back(message); },
      &reported);
  const int mesh = add_box(o.scene);
  float corners[8][3];
  std::memcpy(corners, kCorners, sizeof corners);
  corners[0][0] = NAN;
  ASSERT_EQ(umbSetMeshBuffer(o.scene, mesh, "position", corners, UMB_TYPE_FLOAT32, 3, 0), UMB_ERROR_NONE);
  make_render_job(o);
  ASSERT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
  ASSERT_EQ(reported.warnings.size(), 1u);
  EXPECT_NE(reported.warnings[0].find("6 triangles of the mesh 'box' are left out"), std::string::npos)
      << reported.warnings[0];
  for (auto& corner : corners) corner[0] = NAN;
  ASSERT_EQ(umbSetMeshBuffer(o.scene, mesh, "position", corners, UMB_TYPE_FLOAT32, 3, 0), UMB_ERROR_NONE);
  EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_USAGE);
  EXPECT_NE(job_error(o.job).find("nothing to draw"), std::string::npos);
}

TEST(CInterface, ShadingNeedsADepth) {
  Objects o;
  o.job = umbNewShadeJob(o.device);
  std::vector<float> albedo(3 * 6, 0.5f), ao(6);
  const UmbImage image = floats(albedo.data(), 3, 2, 3), output = floats(ao.data(), 3, 2);
  umbSetJobImage(o.job, "albedo", &image);
  umbSetJobOutput(o.job, "ao", &output);
  EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_USAGE);
  EXPECT_NE(job_error(o.job).find("needs an image 'depth'"), std::string::npos);
}

TEST(CInterface, ACancelledJobMayExecuteAgain) {
  Objects o;
  ASSERT_EQ(umbLoadModel(o.scene, "scene:solids?detail=2000"), UMB_ERROR_NONE);
  make_render_job(o);
  umbSetJobProgressCallback(
      o.job, [](void*, double) { return false; }, nullptr);
  EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_CANCELLED);
  umbSetJobProgressCallback(o.job, nullptr, nullptr);
  EXPECT_EQ(umbExecuteJob(o.job), UMB_ERROR_NONE) << job_error(o.job);
}

}  // namespace
}  // namespace umbrage
