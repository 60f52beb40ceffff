// Drawing: which pictures a page gets for its states, and that they are those of the command line.
#include "apps/view/drawing.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "build_paths.h"
#include "io/image_file.h"
#include "support.h"

namespace umbrage::view {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using ViewState = umbrage::view::View;

constexpr PageId kPage = 1;
constexpr std::chrono::seconds kMaxWait(60);

/// A frame as a page gets it.
struct Received {
  PageId page = 0;
  nlohmann::json header;
  std::string image;
};

/// A page that records what it gets, and acknowledges frames unless a test forbids it.
class Pages {
 public:
  explicit Pages(std::vector<ModelSource> models, bool watch = false) {
    DrawingSettings settings{.models = std::move(models), .given = {}, .device = "cpu", .watch = watch};
    auto started = Drawing::start(std::move(settings),
                                  {.text = [this](PageId, std::string text) { take_text(text); },
                                   .frame = [this](PageId page, std::string bytes) { take_frame(page, bytes); }});
    drawing_ = started->release();
  }
  ~Pages() { delete drawing_; }

  Drawing& drawing() { return *drawing_; }
  /// Waits for the first frame from `first` on that fits. Returns it, or an empty one.
  Received frame(const std::function<bool(const Received&)>& fits, std::size_t first = 0) {
    std::unique_lock lock(mutex_);
    Received found;
    changed_.wait_for(lock, kMaxWait, [&] {
      for (std::size_t k = first; k < frames_.size(); ++k)
        if (fits(frames_[k])) {
          found = frames_[k];
          return true;
        }
      return false;
    });
    return found;
  }
  /// Waits for a text of this type that contains `part`. Returns it, or null.
  nlohmann::json text(const std::string& type, const std::string& part = "") {
    std::unique_lock lock(mutex_);
    nlohmann::json found;
    changed_.wait_for(lock, kMaxWait, [&] {
      for (const nlohmann::json& text : texts_)
        if (text["type"] == type && text.dump().find(part) != std::string::npos) {
          found = text;
          return true;
        }
      return false;
    });
    return found;
  }
  std::vector<Received> frames() {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  std::size_t count() {
    const std::lock_guard lock(mutex_);
    return frames_.size();
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    frames_.clear();
    texts_.clear();
  }
  void forget_texts(const std::string& type) {
    const std::lock_guard lock(mutex_);
    std::erase_if(texts_, [&](const nlohmann::json& text) { return text["type"] == type; });
  }
  bool acknowledges = true;

 private:
  void take_text(const std::string& text) {
    const std::lock_guard lock(mutex_);
    texts_.push_back(nlohmann::json::parse(text));
    changed_.notify_all();
  }
  void take_frame(PageId page, const std::string& bytes) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data(), sizeof size);
    Received frame{page, nlohmann::json::parse(bytes.substr(sizeof size, size)), bytes.substr(sizeof size + size)};
    const std::int64_t number = frame.header["frame"];
    {
      const std::lock_guard lock(mutex_);
      frames_.push_back(std::move(frame));
      changed_.notify_all();
    }
    if (acknowledges) drawing_->acknowledge(page, number);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Received> frames_;
  std::vector<nlohmann::json> texts_;
  Drawing* drawing_ = nullptr;  // owned; it sends until its destructor returns
};

const ModelSource kSolids{"scene:solids?detail=2000", "solids", false};

/// Returns a state of one view.
State state_of(std::int64_t id, bool moving, const ViewOptions& options = {}, const std::string& show = "picture") {
  State state{.id = id, .moving = moving, .width = 160, .height = 96, .model = 0, .views = {}};
  state.views.push_back(ViewState{.options = options, .show = show, .device = ""});
  return state;
}

bool is_exact(const Received& frame) { return !frame.header["moving"] && frame.header["samples"] > 0; }

fs::path temporary(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("umbrage-drawing-{}", ::getpid());
  fs::create_directories(folder);
  return folder / name;
}

/// Writes bytes to a file and reads them as an image.
Image decoded(const std::string& bytes) {
  const fs::path file = temporary("frame.png");
  std::ofstream(file, std::ios::binary) << bytes;
  return *read_image(file);
}

/// Returns the picture that the command line writes with these options.
Image rendered(const std::string& options) {
  const fs::path file = temporary("rendered.png");
  const std::string command = fmt::format("\"{}\" render \"{}\" --device cpu --resolution 160,96 {} -o \"{}\" 2>&1",
                                          test::kProgram, kSolids.file, options, file.string());
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  return *read_image(file);
}

bool is_equal(const Image& a, const Image& b) { return test::first_difference(a, b).empty(); }

struct Same {
  const char* name;
  ViewOptions options;
  std::string show, command;
};

class DrawingAtRest : public testing::TestWithParam<Same> {};

TEST_P(DrawingAtRest, IsThePictureOfTheCommandLine) {
  Pages pages({kSolids});
  pages.drawing().set_state(kPage, state_of(7, false, GetParam().options, GetParam().show));
  const Received frame = pages.frame(is_exact);
  ASSERT_FALSE(frame.image.empty());
  EXPECT_EQ(frame.header["id"], 7);
  EXPECT_EQ(frame.header["format"], "image/png");
  EXPECT_TRUE(is_equal(decoded(frame.image), rendered(GetParam().command)));
}

INSTANTIATE_TEST_SUITE_P(
    Options, DrawingAtRest,
    testing::Values(Same{"defaults", {}, "picture", ""},
                    Same{"camera",
                         {{"look", {"lit"}}, {"camera-position", {"3,2,4"}}, {"camera-focal-point", {"0,0.5,0"}}},
                         "picture",
                         "--look lit --camera-position 3,2,4 --camera-focal-point 0,0.5,0"},
                    Same{"settings",
                         {{"look", {"ao"}}, {"ao", {"bitmask"}}, {"set", {"bitmask.slices=3", "bitmask.steps=5"}}},
                         "picture",
                         "--look ao --ao bitmask --set bitmask.slices=3 --set bitmask.steps=5"},
                    Same{"transparent", {{"no-background", {"true"}}}, "picture", "--no-background"},
                    Same{"depth", {}, "depth", "--passes depth"}, Same{"normal", {}, "normal", "--passes normal"},
                    Same{"reference",
                         {{"look", {"ao"}}, {"set", {"reference.samples=4"}}},
                         "reference",
                         "--look ao --ao reference --set reference.samples=4"}),
    [](const auto& info) { return info.param.name; });

TEST(Drawing, SettingsAloneKeepThePictureExact) {
  Pages pages({kSolids});
  for (int slices = 1; slices <= 3; ++slices) {
    const std::string set = fmt::format("bitmask.slices={}", slices);
    pages.drawing().set_state(kPage, state_of(slices, false, {{"look", {"ao"}}, {"ao", {"bitmask"}}, {"set", {set}}}));
    const Received frame = pages.frame([&](const Received& f) { return is_exact(f) && f.header["id"] == slices; });
    ASSERT_FALSE(frame.image.empty());
    EXPECT_TRUE(is_equal(decoded(frame.image), rendered("--look ao --ao bitmask --set " + set))) << slices;
  }
}

TEST(Drawing, RefinesUntilThePictureIsFinal) {
  Pages pages({kSolids});
  State state = state_of(1, false, {{"look", {"ao"}}});
  state.width = state.height = 32;
  pages.drawing().set_state(kPage, state);
  const Received last = pages.frame([](const Received& f) { return f.header["final"] == true; });
  EXPECT_EQ(last.header["samples"], kMaxRefinedSamples);
  // A picture that does not average is final at once.
  pages.forget();
  state.id = 2;
  state.views[0].show = "depth";
  pages.drawing().set_state(kPage, state);
  EXPECT_TRUE(bool(pages.frame(is_exact).header["final"]));
}

TEST(Drawing, AViewThatGoesOnKeepsItsSamples) {
  Pages pages({kSolids});
  State state = state_of(1, false, {{"look", {"ao"}}});
  pages.drawing().set_state(kPage, state);
  const int before = pages.frame([](const Received& f) { return f.header["samples"] >= 8; }).header["samples"];
  ++state.id;
  state.views.push_back(state.views[0]);
  state.views[0].goes_on = true;
  state.views[1].options["ao-radius"] = {"5%"};
  pages.forget();
  pages.drawing().set_state(kPage, state);
  pages.frame([](const Received& f) { return f.header["final"] == true && f.header["view"] == 0; });
  for (const Received& frame : pages.frames())
    EXPECT_TRUE(frame.header["view"] == 1 || frame.header["samples"] >= before);
}

TEST(Drawing, AViewThatFailedIsTriedAgain) {
  const fs::path later = temporary("later.png");
  Pages pages({kSolids});
  State state = state_of(1, false, {{"look", {"lit"}}, {"hdri-file", {later.string()}}});
  pages.drawing().set_state(kPage, state);
  EXPECT_FALSE(pages.text("error", "later.png").is_null());
  EXPECT_TRUE(write_image(later, rendered("")));
  ++state.id;
  state.views[0].goes_on = true;
  pages.drawing().set_state(kPage, state);
  EXPECT_EQ(pages.frame(is_exact).header["id"], 2);
}

TEST(Drawing, TheReferenceBeginsWithFewRays) {
  Pages pages({kSolids});
  pages.drawing().set_state(kPage, state_of(1, false, {{"look", {"ao"}}}, "reference"));
  const Received last = pages.frame([](const Received& f) { return f.header["final"] == true; });
  EXPECT_EQ(last.header["samples"], kMaxRefinedSamples);
  const std::vector<Received> frames = pages.frames();
  EXPECT_EQ(frames[0].header["samples"], 0) << "a draft";
  EXPECT_LT(frames[0].header["width"], 160);
  EXPECT_EQ(frames[1].header["samples"], 1);
  // Noise shows how many rays a picture has: that of the mean is smaller by a factor of nearly 11.
  const Image first = decoded(frames[1].image), mean = decoded(last.image);
  const Image truth = rendered("--look ao --ao reference --set reference.samples=512 --anti-aliasing 4");
  const auto error = [&](const Image& image) {
    double sum = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) sum += std::abs(image.planes[0].at(x, y) - truth.planes[0].at(x, y));
    return sum;
  };
  EXPECT_GT(error(first), 2.0 * error(mean));
}

TEST(Drawing, BothViewsAreRefined) {
  Pages pages({kSolids});
  State state = state_of(1, false, {{"look", {"ao"}}});
  state.views.push_back(state.views[0]);
  state.views[1].options["ao-radius"] = {"5%"};
  pages.drawing().set_state(kPage, state);
  const auto ends = [&](int view) {
    return pages.frame([=](const Received& f) { return f.header["final"] == true && f.header["view"] == view; });
  };
  EXPECT_FALSE(ends(0).image.empty());
  EXPECT_FALSE(ends(1).image.empty());
  int samples[2] = {0, 0}, other_at_first_end = -1;
  for (const Received& frame : pages.frames()) {
    const int view = frame.header["view"], now = frame.header["samples"];
    EXPECT_GE(now, samples[view]) << "a picture of fewer samples";
    samples[view] = now;
    if (frame.header["final"] == true && other_at_first_end < 0) other_at_first_end = samples[1 - view];
  }
  EXPECT_GT(other_at_first_end, 1) << "one view was refined to its end before the other";
}

TEST(Drawing, LongPicturesTellTheirProgress) {
  Pages pages({kSolids});
  State state = state_of(5, false, {{"look", {"ao"}}, {"set", {"reference.samples=1024"}}}, "reference");
  state.width = state.height = 256;
  pages.drawing().set_state(kPage, state);
  const nlohmann::json status = pages.text("status", "drawing");
  ASSERT_FALSE(status.is_null());
  EXPECT_EQ(status["id"], 5);
  EXPECT_GT(status["progress"], 0.0);
  EXPECT_LT(status["progress"], 1.0);
  pages.forget();
  ASSERT_FALSE(pages.frame(is_exact).image.empty());
  EXPECT_FALSE(pages.text("status", R"("text":"")").is_null()) << "cleared";
}

TEST(Drawing, PicksThePointOfTheSurface) {
  Pages pages({kSolids});
  std::int64_t id = 0;
  const auto pick = [&](const glm::dvec3& eye, const glm::dvec3& focus, bool orthographic, double x, double y) {
    const auto text = [](const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
    State state = state_of(++id, false,
                           {{"camera-position", {text(eye)}},
                            {"camera-focal-point", {text(focus)}},
                            {"camera-view-up", {"0,1,0"}},
                            {"camera-view-angle", {"30"}},
                            {"camera-orthographic", {orthographic ? "true" : "false"}}});
    state.width = 1000;
    state.height = 600;
    pages.drawing().set_state(kPage, state);
    pages.drawing().pick(kPage, {.id = id, .x = x, .y = y});
    const nlohmann::json point = pages.text("pick");
    pages.forget_texts("pick");
    return point["point"];
  };
  const auto vector_of = [](const nlohmann::json& v) { return glm::dvec3(v.at(0), v.at(1), v.at(2)); };
  const glm::dvec3 eye(3.0, 2.0, 4.0), focus(0.0, 0.4, 0.0);
  const nlohmann::json found = pick(eye, focus, false, 0.4, 0.55);
  const double max = 0.01 * pages.text("model")["radius"].get<double>();
  ASSERT_TRUE(found.is_array());
  const glm::dvec3 point = vector_of(found);
  const glm::dvec3 forward = glm::normalize(focus - eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, {0.0, 1.0, 0.0})), up = glm::cross(right, forward);
  const double half = std::tan(glm::radians(15.0));
  const glm::dvec3 ray = glm::normalize(forward + half * (0.4 * 2 - 1) * (1000.0 / 600.0) * right + half * -0.1 * up);
  EXPECT_LT(glm::length(glm::cross(point - eye, ray)), max) << "beside the ray";
  // Nearer cameras that look at the point see it in the middle, at their own depth.
  const glm::dvec3 nearer = point + 0.3 * (eye - point);
  EXPECT_LT(glm::length(vector_of(pick(nearer, point, false, 0.5, 0.5)) - point), max);
  EXPECT_LT(glm::length(vector_of(pick(nearer, point, true, 0.5, 0.5)) - point), max);
  EXPECT_TRUE(pick(eye, focus, false, 0.5, 0.0).is_null()) << "the sky";
}

TEST(Drawing, StormsOfStatesAreAnsweredByTheLast) {
  Pages pages({kSolids});
  pages.drawing().set_state(kPage, state_of(1, true));
  ASSERT_FALSE(pages.frame([](const Received& f) { return f.header["id"] == 1; }).image.empty());
  constexpr int kStates = 1000;
  const long before = pages.drawing().drawn();
  for (int id = 2; id <= kStates; ++id)
    pages.drawing().set_state(kPage, state_of(id, true, {{"camera-azimuth-angle", {fmt::format("{}", id % 360)}}}));
  const Received last = pages.frame([&](const Received& f) { return f.header["id"] == kStates; });
  EXPECT_FALSE(last.image.empty());
  EXPECT_LT(pages.drawing().drawn() - before, kStates / 4);
}

TEST(Drawing, AtMostTwoFramesAreUnacknowledged) {
  Pages pages({kSolids});
  pages.acknowledges = false;
  for (int id = 1; id <= 3; ++id) {
    pages.drawing().set_state(kPage, state_of(id, true));
    if (id <= 2) pages.frame([&](const Received& f) { return f.header["id"] == id; });
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(pages.count(), kMaxUnacknowledged);
  pages.drawing().acknowledge(kPage, 1);
  EXPECT_FALSE(pages.frame([](const Received& f) { return f.header["id"] == 3; }).image.empty());
}

TEST(Drawing, ANewerStateEndsAPictureAtRest) {
  Pages pages({kSolids});
  State slow = state_of(1, false, {{"quality", {"ultra"}}, {"anti-aliasing", {"256"}}});
  slow.width = slow.height = 1024;
  pages.drawing().set_state(kPage, slow);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto begin = Clock::now();
  pages.drawing().set_state(kPage, state_of(2, true));
  ASSERT_FALSE(pages.frame([](const Received& f) { return f.header["id"] == 2; }).image.empty());
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(5));  // the slow picture takes minutes
}

TEST(Drawing, PagesShareTheDevice) {
  Pages pages({kSolids});
  pages.drawing().set_state(1, state_of(1, false));
  ASSERT_FALSE(pages.frame(is_exact).image.empty());  // page 1 is refined from here on
  for (int id = 1; id <= 5; ++id) {
    pages.drawing().set_state(2, state_of(id, true));
    EXPECT_FALSE(pages.frame([&](const Received& f) { return f.page == 2 && f.header["id"] == id; }).image.empty());
  }
  const std::size_t count = pages.count();
  EXPECT_FALSE(pages.frame([](const Received& f) { return f.page == 1; }, count).image.empty()) << "goes on";
}

TEST(Drawing, OtherModelsAreDrawnWhileOneIsRead) {
  // The text is read for longer than a small scene is drawn.
  const fs::path slow = temporary("slow.asc");
  {
    std::ofstream text(slow);
    text << "ncols 2000\nnrows 2000\ncellsize 1\n";
    for (int y = 0; y < 2000; ++y) {
      std::string row;
      for (int x = 0; x < 2000; ++x) row += char('1' + (x * x / 900 + y) % 7), row += ".0625 ";
      text << row;
    }
  }
  Pages pages({{slow.string(), "slow", true}, kSolids});
  pages.drawing().set_state(1, state_of(1, false));
  ASSERT_FALSE(pages.text("status", "reading slow").is_null());
  State other = state_of(2, false);
  other.model = 1;
  pages.drawing().set_state(2, other);
  EXPECT_FALSE(pages.frame([](const Received& f) { return f.page == 2 && is_exact(f); }).header.is_null());
  for (const Received& frame : pages.frames()) EXPECT_EQ(frame.page, 2) << "the model was read before the other one";
  EXPECT_FALSE(pages.frame([](const Received& f) { return f.page == 1; }).header.is_null());
}

TEST(Drawing, ErrorsNameOptions) {
  Pages pages({kSolids, {"/nowhere/model.obj", "model.obj", false}});
  pages.drawing().set_state(kPage, state_of(3, false, {{"look", {"nothing"}}}));
  const nlohmann::json error = pages.text("error");
  EXPECT_EQ(error["id"], 3);
  EXPECT_NE(error["message"].get<std::string>().find("look"), std::string::npos) << error;
  pages.drawing().set_state(kPage, state_of(4, false, {{"ao-radius", {"-3"}}}));
  EXPECT_FALSE(pages.text("error", "--ao-radius").is_null());
  pages.drawing().set_state(kPage, state_of(5, false, {{"loook", {"ao"}}}));
  EXPECT_FALSE(pages.text("error", "--loook").is_null());
  State missing = state_of(6, false);
  missing.model = 1;
  pages.drawing().set_state(kPage, missing);
  EXPECT_FALSE(pages.text("error", "/nowhere/model.obj").is_null());
  // Other states are drawn after errors, also with a device that there is not.
  State odd = state_of(7, false);
  odd.views[0].device = "vulkan:99";
  pages.drawing().set_state(kPage, odd);
  EXPECT_FALSE(pages.text("error", "vulkan:99").is_null());
  EXPECT_FALSE(pages.frame([](const Received& f) { return f.header["id"] == 7; }).image.empty());
}

TEST(Drawing, TheFirstCameraShowsWhatTheDefaultShows) {
  Pages pages({kSolids});
  pages.drawing().set_state(kPage, state_of(1, false, {{"look", {"lit"}}}));
  const nlohmann::json model = pages.text("model");
  ASSERT_TRUE(model.contains("camera"));
  EXPECT_EQ(model["version"], 1);
  const Received first = pages.frame(is_exact);
  ViewOptions options{{"look", {"lit"}}};
  for (const auto& [name, value] : model["camera"].items()) options[name] = {value.get<std::string>()};
  pages.drawing().set_state(kPage, state_of(2, false, options));
  const Received second = pages.frame([](const Received& f) { return is_exact(f) && f.header["id"] == 2; });
  const Image a = decoded(first.image), b = decoded(second.image);
  double sum = 0.0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) sum += std::abs(a.planes[0].at(x, y) - b.planes[0].at(x, y));
  constexpr double kMaxMean = 0.02;  // edges move by fractions of a pixel; another view differs by a multiple
  EXPECT_LT(sum / (a.width * a.height), kMaxMean);
}

TEST(Drawing, ErrorMapsConverge) {
  Pages pages({kSolids});
  State state = state_of(1, false, {{"look", {"ao"}}, {"ao", {"bitmask"}}}, "error");
  state.width = state.height = 48;
  pages.drawing().set_state(kPage, state);
  const Received last = pages.frame([](const Received& f) { return f.header["final"] == true; });
  ASSERT_FALSE(last.image.empty());
  EXPECT_EQ(last.header["samples"], kMaxReferenceRuns);
  const double rmse = last.header["error"]["rmse"];
  EXPECT_GT(rmse, 0.0);
  EXPECT_LT(rmse, 0.3);
  EXPECT_LE(std::abs(last.header["error"]["mean"].get<double>()), rmse);
}

TEST(Drawing, ChangedFilesAreReadAgain) {
  const fs::path file = temporary("changed.ply");
  const auto write = [&](const std::string& text) { std::ofstream(file, std::ios::binary) << text; };
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face ";
  const std::string list = "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  write(head + "1" + list + "3 0 1 2\n");
  Pages pages({{file.string(), "changed.ply", false}}, true);
  pages.drawing().set_state(kPage, state_of(1, false));
  EXPECT_NE(pages.text("model")["summary"].get<std::string>().find("1 triangle"), std::string::npos);
  ASSERT_FALSE(pages.frame(is_exact).image.empty());
  pages.forget();
  write("ply\nnonsense");
  EXPECT_FALSE(pages.text("error", "changed.ply").is_null());
  pages.forget();
  write(head + "2" + list + "3 0 1 2\n3 0 1 3\n");
  const nlohmann::json model = pages.text("model");
  EXPECT_EQ(model["version"], 2);
  EXPECT_NE(model["summary"].get<std::string>().find("2 triangles"), std::string::npos) << model;
}

/// Returns the resident memory of this process, bytes.
long resident_bytes() {
  std::ifstream file("/proc/self/statm");
  long size = 0, resident = 0;
  file >> size >> resident;
  return resident * ::sysconf(_SC_PAGESIZE);
}

TEST(DrawingMemory, FramesDoNotAddUp) {
  Pages pages({kSolids});
  std::int64_t id = 0;
  const auto draw = [&](int frames) {
    for (int k = 0; k < frames; ++k) {
      ++id;
      State state = state_of(id, true, {{"camera-azimuth-angle", {fmt::format("{}", id % 360)}}});
      pages.drawing().set_state(kPage, state);
      pages.frame([&](const Received& f) { return f.header["id"] == id; });
      pages.forget();
    }
  };
  constexpr int kFirst = 100, kMore = 400;
  constexpr long kMaxGrowth = 24L << 20;  // bytes; a frame of this size has 4 MB of planes
  draw(kFirst);
  const long before = resident_bytes();
  draw(kMore);
  EXPECT_LT(resident_bytes() - before, kMaxGrowth);
}

}  // namespace
}  // namespace umbrage::view
