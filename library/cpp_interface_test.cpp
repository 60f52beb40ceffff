// Tests of all members of umb::Device, Scene and Job, the C++ layer over the C interface.
#include "umbrage/umbrage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <locale>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

constexpr int kWidth = 24, kHeight = 16;

/// A square of two units in the plane z = 0, seen from +z.
int add_square(umb::Scene& scene) {
  constexpr float kPosition[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  constexpr float kUv[] = {0, 0, 1, 0, 1, 1, 0, 1};
  constexpr std::uint8_t kIndex[] = {0, 1, 2, 0, 2, 3};
  const int mesh = scene.add_mesh("square", 4, 2);
  scene.set_buffer(mesh, "position", kPosition, UMB_TYPE_FLOAT32, 3);
  scene.set_buffer(mesh, "uv", kUv, UMB_TYPE_FLOAT32, 2);
  scene.set_buffer(mesh, "index", kIndex, UMB_TYPE_UINT8, 3);
  return mesh;
}

void set_view(umb::Job& job) {
  job.set("look", "ao");
  job.set("width", kWidth);
  job.set("height", kHeight);
  job.set("camera.position", {0, 0, 5});
  job.set("camera.focal_point", {0, 0, 0});
}

/// Returns the central pixel of a pass of the last execution.
std::vector<float> central_pixel(const umb::Job& job, const char* name) {
  const UmbImage image = job.output(name);
  const float* values = static_cast<const float*>(image.data) +
                        std::ptrdiff_t(image.height / 2 * image.width + image.width / 2) * image.channels;
  return {values, values + image.channels};
}

/// Returns whether the call throws an Error with the code, and with a message that contains the text.
template <class Call>
testing::AssertionResult throws_error(const Call& call, UmbError code, const std::string& text) {
  try {
    call();
  } catch (const umb::Error& error) {
    if (error.code == code && std::string(error.what()).find(text) != std::string::npos)
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << error.code << ": " << error.what();
  }
  return testing::AssertionFailure() << "nothing was thrown";
}

template <class T, class = void>
struct CanSet : std::false_type {};
template <class T>
struct CanSet<T, std::void_t<decltype(std::declval<umb::Job&>().set("width", std::declval<T>()))>> : std::true_type {};

static_assert(!CanSet<const float*>::value, "a pointer is no bool");
static_assert(!CanSet<std::nullptr_t>::value && !CanSet<char>::value);
static_assert(CanSet<unsigned>::value && CanSet<const char*>::value && CanSet<std::filesystem::path>::value);

enum Plain { kThree = 3 };

/// A scene with a square, and a job that renders it.
struct Square {
  umb::Device device{"cpu", 1};
  umb::Scene scene{device};
  umb::Job job{device, scene};
  int mesh = add_square(scene);
  Square() { set_view(job); }
  /// Draws the albedo. Returns that of the central pixel.
  std::vector<float> drawn_albedo() {
    job.set_output("albedo");
    job.execute();
    return central_pixel(job, "albedo");
  }
};

TEST(CppInterface, NumbersOfAllTypes) {
  const umb::Device device("cpu", 1);
  umb::Scene scene(device);
  scene.load("scene:solids?detail=1000");
  umb::Job job(device, scene);
  const auto width = [&](auto value) {
    job.reset();
    job.set("look", "ao");
    job.set("height", 8);
    job.set("width", value);
    job.set_output("depth");
    job.execute();
    return job.output("depth").width;
  };
  EXPECT_EQ(width(std::int8_t(3)), 3);
  EXPECT_EQ(width(std::uint8_t(3)), 3);
  EXPECT_EQ(width(short(3)), 3);
  EXPECT_EQ(width(std::uint16_t(3)), 3);
  EXPECT_EQ(width(3), 3);
  EXPECT_EQ(width(3u), 3);
  EXPECT_EQ(width(3l), 3);
  EXPECT_EQ(width(3ul), 3);
  EXPECT_EQ(width(3ll), 3);
  EXPECT_EQ(width(std::size_t(3)), 3);
  EXPECT_EQ(width(kThree), 3);
  EXPECT_EQ(width(3.0f), 3);
  EXPECT_EQ(width(3.0), 3);
  EXPECT_EQ(width(3.0l), 3);
  // Integers that do not fit an int are refused, not truncated.
  for (const auto& call : {std::function<void()>([&] { job.set("layers", (std::uint64_t(1) << 32) + 1); }),
                           std::function<void()>([&] { job.set("layers", (std::int64_t(-1) << 32) + 1); }),
                           std::function<void()>([&] { job.set("layers", 4294967295u); })})
    EXPECT_TRUE(throws_error(call, UMB_ERROR_USAGE, "1 to 16"));
  EXPECT_TRUE(throws_error([&] { job.set("transparent", 1u); }, UMB_ERROR_USAGE, "true or false"));
  EXPECT_TRUE(throws_error([&] { job.set("width", true); }, UMB_ERROR_USAGE, "width"));
}

TEST(CppInterface, SeveralNumbersAndText) {
  Square square;
  auto& [device, scene, job, mesh] = square;
  job.set_output("depth");
  const float x = 0.0f;
  const double z = 9.0;
  const float three[3] = {0, 0, 3};
  const auto depth = [&](const auto& position) {
    job.set("camera.position", position);
    job.execute();
    return central_pixel(job, "depth")[0];
  };
  EXPECT_FLOAT_EQ(depth(std::array<float, 3>{0, 0, 7}), 7.0f);
  EXPECT_FLOAT_EQ(depth(std::array<double, 3>{0, 0, 6}), 6.0f);
  EXPECT_FLOAT_EQ(depth(std::vector<float>{0, 0, 5}), 5.0f);
  EXPECT_FLOAT_EQ(depth(std::vector<int>{0, 0, 4}), 4.0f);
  EXPECT_FLOAT_EQ(depth(three), 3.0f);
  EXPECT_FLOAT_EQ(depth("0,0,5"), 5.0f);
  EXPECT_FLOAT_EQ(depth(std::string("0,0,6")), 6.0f);
  EXPECT_FLOAT_EQ(depth(std::string_view("0,0,7,8").substr(0, 5)), 7.0f);
  job.set("camera.position", {x, 0.0f, z});
  job.execute();
  EXPECT_FLOAT_EQ(central_pixel(job, "depth")[0], 9.0f);
  EXPECT_TRUE(throws_error([&] { job.set("camera.position", std::vector<float>()); }, UMB_ERROR_USAGE, "no values"));
}

TEST(CppInterface, ParametersOfScenes) {
  const umb::Device device("cpu", 1);
  umb::Scene scene(device);
  std::array<double, 3> lower{}, upper{};
  EXPECT_TRUE(throws_error([&] { scene.bounds(lower, upper); }, UMB_ERROR_USAGE, "empty"));
  scene.set("up", {0, 0, 1});
  scene.set("crease_angle_deg", 30u);
  scene.set("crease_angle_deg", 30.5);
  scene.set("point_size", "5%");
  scene.set("point_sprites", std::string_view("disc"));
  scene.reset("point_size");
  EXPECT_TRUE(throws_error([&] { scene.set("crease_angle_deg", 200); }, UMB_ERROR_USAGE, "crease_angle_deg"));
  EXPECT_TRUE(throws_error([&] { scene.set("point_sprites", true); }, UMB_ERROR_USAGE, "point_sprites"));
  EXPECT_TRUE(throws_error([&] { scene.set("uq", "+Z"); }, UMB_ERROR_USAGE, "'uq'"));
  EXPECT_TRUE(throws_error([&] { scene.load("missing.obj"); }, UMB_ERROR_FILE, "missing.obj"));
  EXPECT_TRUE(throws_error([&] { scene.add_mesh("none", 0, 0); }, UMB_ERROR_USAGE, "0 vertices"));
  EXPECT_TRUE(throws_error([&] { scene.add_mesh("many", 3, std::size_t(1) << 31); }, UMB_ERROR_USAGE,
                           "at most 2147483647 triangles"));
  const int mesh = scene.add_mesh("triangle", 3, 1);
  const std::int32_t numbers[9] = {};
  EXPECT_TRUE(throws_error([&] { scene.set_buffer(mesh, "position", numbers, UMB_TYPE_UINT32, 3); }, UMB_ERROR_USAGE,
                           "cannot hold 32-bit integers: it takes 32-bit floats"));
  EXPECT_TRUE(throws_error([&] { scene.set_buffer(mesh, "color", numbers, UMB_TYPE_UINT32, 3); }, UMB_ERROR_USAGE,
                           "it takes 32-bit floats, 8-bit integers or 16-bit integers"));
  EXPECT_EQ(scene.camera_count(), 0);
}

TEST(CppInterface, NumbersDoNotDependOnTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const float values[] = {0.5f, -12345.25f, 1e-7f};
  EXPECT_EQ(umb::detail::text_of(values, 3), "0.5,-12345.25,1.00000001e-07");
  std::locale::global(before);
}

TEST(CppInterface, InstancesAndBounds) {
  const umb::Device device("cpu", 1);
  umb::Scene scene(device);
  const int mesh = add_square(scene);
  std::array<double, 3> lower{}, upper{};
  scene.bounds(lower, upper);
  EXPECT_EQ(lower, (std::array<double, 3>{-1, -1, 0}));
  scene.add_instance(mesh, {1, 0, 0, -4, 0, 1, 0, 0, 0, 0, 1, 2});
  scene.add_instance(mesh, {1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, -2});
  scene.bounds(lower, upper);
  EXPECT_EQ(lower, (std::array<double, 3>{-5, -1, -2}));
  EXPECT_EQ(upper, (std::array<double, 3>{5, 1, 2}));
  EXPECT_TRUE(throws_error([&] { scene.add_instance(mesh + 1, {}); }, UMB_ERROR_USAGE, "no mesh 1"));
}

TEST(CppInterface, MaterialsAndTextures) {
  Square square;
  umb::Scene& scene = square.scene;
  scene.set_floats(square.mesh, "albedo", {0.5f, 0.25f, 1.0f});
  EXPECT_EQ(square.drawn_albedo(), (std::vector<float>{0.5f, 0.25f, 1.0f}));
  std::array<std::uint8_t, 4> green = {0, 255, 0, 255};
  scene.set_texture(square.mesh, "albedo", umb::image_of(green.data(), 1, 1, 4));
  EXPECT_EQ(square.drawn_albedo(), (std::vector<float>{0.0f, 0.25f, 0.0f}));
  std::array<std::uint16_t, 4> deep{};
  EXPECT_TRUE(throws_error([&] { scene.set_texture(square.mesh, "albedo", umb::image_of(deep.data(), 1, 1, 4)); },
                           UMB_ERROR_USAGE, "8 bits"));
}

TEST(CppInterface, IntegerColorsOfVerticesAreSrgb) {
  Square square;
  const auto albedo_of = [&](const auto* color, UmbType type) {
    square.scene.set_buffer(square.mesh, "color", color, type, 3);
    return square.drawn_albedo();
  };
  // 0.2 in sRGB is 0.03310 in linear light, 0.6 is 0.31855.
  const std::vector<float> linear = {0.03310f, 0.31855f, 1.0f};
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint16_t> words;
  std::vector<float> floats;
  for (int vertex = 0; vertex < 4; ++vertex) {
    bytes.insert(bytes.end(), {51, 153, 255});
    words.insert(words.end(), {13107, 39321, 65535});
    floats.insert(floats.end(), linear.begin(), linear.end());
  }
  for (const auto& albedo : {albedo_of(bytes.data(), UMB_TYPE_UINT8), albedo_of(words.data(), UMB_TYPE_UINT16),
                             albedo_of(floats.data(), UMB_TYPE_FLOAT32)})
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(albedo.at(c), linear[c], 1e-4f) << c;
}

TEST(CppInterface, CountersCountReuse) {
  Square square;
  auto& [device, scene, job, mesh] = square;
  job.set("anti_aliasing", 1);
  EXPECT_EQ(job.counter("hierarchies_built"), 0);
  job.prepare();
  EXPECT_EQ(job.counter("hierarchies_built"), 1);
  EXPECT_EQ(job.counter("captures_made"), 0);
  job.execute();
  job.execute();
  EXPECT_EQ(job.counter("hierarchies_built"), 1);
  EXPECT_EQ(job.counter("captures_made"), 1);
  EXPECT_EQ(job.counter("nothing"), -1);
  EXPECT_EQ(device.memory(), 0u);
}

TEST(CppInterface, ChecksResetsAndOutputs) {
  Square square;
  auto& [device, scene, job, mesh] = square;
  job.set("look", "aoo");
  EXPECT_TRUE(throws_error([&] { job.check(); }, UMB_ERROR_USAGE, "'ao'"));
  job.reset("look");
  job.check();
  job.set_output("depth");
  job.set_output("normal");
  job.execute();
  EXPECT_EQ(job.output_names(), (std::vector<std::string>{"depth", "normal"}));
  job.remove_output("depth");
  job.execute();
  EXPECT_EQ(job.output_names(), (std::vector<std::string>{"normal"}));
  EXPECT_TRUE(throws_error([&] { job.output("depth"); }, UMB_ERROR_USAGE, "no 'depth'"));
  job.reset();
  job.set("width", 8u);
  job.set("height", 8u);
  job.execute();
  EXPECT_EQ(job.output("normal").width, 8);
}

TEST(CppInterface, Strokes) {
  Square square;
  auto& [device, scene, job, mesh] = square;
  EXPECT_TRUE(job.strokes().empty());
  job.set("look", "cartoon");
  job.set("strokes", true);
  job.execute();
  const std::vector<umb::Stroke> strokes = job.strokes();
  ASSERT_FALSE(strokes.empty());
  EXPECT_EQ(strokes[0].kind, umb::StrokeKind::kOutline);
  EXPECT_GE(strokes[0].points.size(), 4u);
  std::array<float, 3> rgb = {-1, -1, -1};
  float opacity = -1.0f;
  job.stroke_color(rgb, opacity);
  EXPECT_GE(rgb[0], 0.0f);
  EXPECT_GT(opacity, 0.0f);
}

TEST(CppInterface, ImagesCanBeSetAndRemoved) {
  umb::Job job{umb::Device("cpu", 1)};
  std::vector<float> depth(kWidth * kHeight, 2.0f), ao(depth.size(), -1.0f);
  std::vector<std::uint32_t> ids(depth.size(), 7);
  job.set("effects", "bitmask");
  job.set_image("depth", umb::image_of(depth.data(), kWidth, kHeight));
  job.set_image("object_id", umb::image_of(ids.data(), kWidth, kHeight));
  job.set_output("ao", umb::image_of(ao.data(), kWidth, kHeight));
  job.execute();
  EXPECT_GT(ao[0], 0.5f);
  job.remove_image("object_id");
  job.execute();
  job.remove_output("ao");
  job.remove_image("depth");
  EXPECT_TRUE(throws_error([&] { job.execute(); }, UMB_ERROR_USAGE, "depth"));
}

TEST(CppInterface, ProgressIsReportedAndMayThrow) {
  const umb::Device device("cpu", 1);
  umb::Scene scene(device);
  struct CustomException {};
  const auto throws = [](double) -> bool { throw CustomException(); };
  EXPECT_THROW(scene.load("scene:solids?detail=1000", throws), CustomException);
  EXPECT_EQ(scene.error().code, UMB_ERROR_NONE) << "it has been reported already";
  double last = -1.0;
  const auto rises = [&](double done) {
    EXPECT_GE(done, last);
    last = done;
    return true;
  };
  scene.load("scene:solids?detail=1000", rises);
  EXPECT_GE(last, 0.0);
  umb::Job job(device, scene);
  job.set("width", 64);
  job.set("height", 64);
  last = -1.0;
  job.prepare([](double) { return true; });
  job.execute(rises);
  EXPECT_GT(last, 0.5);
  job.set("camera.azimuth_deg", 10);
  EXPECT_TRUE(throws_error([&] { job.execute([](double) { return false; }); }, UMB_ERROR_CANCELLED, ""));
  EXPECT_THROW(job.execute(throws), CustomException);
  EXPECT_EQ(job.error().code, UMB_ERROR_NONE);
  job.execute();
  const auto count = [](void* user, double) { return ++*static_cast<int*>(user), true; };
  int calls = 0;
  job.set("camera.azimuth_deg", 20);
  job.set_progress_callback(count, &calls);
  job.execute();
  EXPECT_GT(calls, 0);
  scene.set_progress_callback(count, &calls);
  calls = 0;
  scene.load("scene:solids?detail=1000");
  EXPECT_GT(calls, 0);
}

TEST(CppInterface, CallbacksOfDevices) {
  umb::Device device("cpu", 1);
  std::vector<std::string> reported;
  device.set_error_callback(
      [](void* user, UmbError, const char* message) {
        static_cast<std::vector<std::string>*>(user)->push_back(message);
      },
      &reported);
  umb::Scene scene(device);
  EXPECT_TRUE(throws_error([&] { scene.load("scene:solid"); }, UMB_ERROR_USAGE, "solids"));
  ASSERT_EQ(reported.size(), 1u);
  EXPECT_NE(reported[0].find("solids"), std::string::npos);
  EXPECT_EQ(device.error().code, UMB_ERROR_USAGE);
  EXPECT_EQ(device.error().code, UMB_ERROR_NONE);
  device.set_error_callback(nullptr);
}

TEST(CppInterface, WarningsAreReported) {
  const auto folder = std::filesystem::temp_directory_path() / "umbrage_cpp_interface";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "bare.obj") << "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  umb::Device device("cpu", 1);
  int warnings = 0;
  device.set_log_callback([](void* user, const char*) { ++*static_cast<int*>(user); }, &warnings);
  umb::Scene scene(device);
  scene.load((folder / "bare.obj").string());
  EXPECT_GT(warnings, 0);
  device.set_log_callback(nullptr);
  std::filesystem::remove_all(folder);
}

TEST(CppInterface, EmptyAndMovedFromObjectsAreHarmless) {
  umb::Device device("cpu", 1);
  umb::Scene scene(device);
  add_square(scene);
  umb::Job job(device, scene);
  const umb::Job moved = std::move(job);
  const umb::Scene other = std::move(scene);
  const umb::Device gone = std::move(device);
  EXPECT_TRUE(moved && other && gone);
  EXPECT_FALSE(job || scene || device);
  const auto is_null = [](const auto& call) { return throws_error(call, UMB_ERROR_USAGE, "NULL"); };
  EXPECT_TRUE(is_null([&] { job.set("width", 3); }));
  EXPECT_TRUE(is_null([&] { job.execute(); }));
  EXPECT_TRUE(is_null([&] { job.execute([](double) { return true; }); }));
  EXPECT_TRUE(is_null([&] { job.check(); }));
  EXPECT_TRUE(is_null([&] { job.reset(); }));
  EXPECT_TRUE(is_null([&] { job.output("color"); }));
  EXPECT_TRUE(is_null([&] { job.set_output("color"); }));
  EXPECT_TRUE(job.output_names().empty());
  EXPECT_TRUE(job.strokes().empty());
  EXPECT_EQ(job.counter("captures_made"), -1);
  EXPECT_TRUE(is_null([&] { scene.load("scene:solids"); }));
  EXPECT_TRUE(is_null([&] { scene.add_mesh("", 3, 1); }));
  EXPECT_TRUE(is_null([&] { scene.add_instance(0, {}); }));
  EXPECT_EQ(scene.camera_count(), 0);
  EXPECT_EQ(device.description(), "");
  EXPECT_EQ(device.memory(), 0u);
  EXPECT_TRUE(is_null([&] { device.set_log_callback(nullptr); }));
  EXPECT_TRUE(is_null([&] { umb::Scene{umb::Device()}; }));
  EXPECT_TRUE(is_null([&] { umb::Job(gone, umb::Scene()); }));
  // Copies are counted references, also of empty objects and after self-assignment.
  umb::Job copy = job;
  copy = moved;
  copy = static_cast<const umb::Job&>(copy);
  umb::Job& same = copy;
  copy = std::move(same);
  copy.set("width", kWidth);
  copy.set("height", kHeight);
  copy.execute();
  job = std::move(copy);
  EXPECT_EQ(job.output("color").width, kWidth);
}

TEST(CppInterface, WithoutAnObject) {
  EXPECT_GT(umb::list_of(UMB_LIST_LOOKS).size(), 3u);
  EXPECT_FALSE(umb::list_of(UMB_LIST_EFFECTS)[0].summary.empty());
  EXPECT_TRUE(throws_error([] { umb::list_of(UmbList(99)); }, UMB_ERROR_USAGE, "99"));
  const std::vector<UmbParameter> parameters = umb::parameters_of("bitmask");
  EXPECT_TRUE(std::any_of(parameters.begin(), parameters.end(),
                          [](const UmbParameter& p) { return std::string_view(p.name) == "bitmask.radius"; }));
  EXPECT_TRUE(throws_error([] { umb::parameters_of("bitmusk"); }, UMB_ERROR_USAGE, "bitmusk"));
  EXPECT_EQ(umb::pass_channels("normal"), 3);
  EXPECT_EQ(umb::pass_channels("norml"), 0);
  EXPECT_EQ(umb::thread_error().code, UMB_ERROR_NONE);
  EXPECT_TRUE(throws_error([] { umb::Device("gpu"); }, UMB_ERROR_USAGE, "gpu"));
  const auto file = std::filesystem::temp_directory_path() / "umbrage_cpp_interface.png";
  std::vector<float> gray(12, 0.5f);
  umb::write_images(file.string(), {{"color", umb::image_of(gray.data(), 2, 2, 3)}});
  EXPECT_TRUE(std::filesystem::exists(file));
  std::filesystem::remove(file);
  EXPECT_TRUE(throws_error(
      [&] {
        umb::write_images("picture.gif", {{"color", umb::image_of(gray.data(), 2, 2, 3)}});
      },
      UMB_ERROR_USAGE, "gif"));
}

}  // namespace
