// Tests of sequences: several frames at once, failures, finished frames, shards.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <thread>

#include "run_program.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::Outcome;
using test::text_of;

const std::string kSolids = "scene:solids?detail=2000 --device cpu --resolution 64x48 ";

class SequenceTest : public test::ProgramTest {
 protected:
  /// Renders frames 0 to count - 1 of shot.####.exr.
  void make_inputs(int count) {
    good(fmt::format("{} --passes depth,normal,albedo -o shot.####.exr --turntable {}", kSolids, count));
  }
  /// Shades a range of shot.####.exr to NAME.####.png.
  Outcome shade(const std::string& frames, const std::string& name, const std::string& more = "") {
    return run(
        fmt::format("shade shot.####.exr -o {}.####.png --device cpu --steady 0 --frames {} {}", name, frames, more));
  }
  std::string picture(const std::string& name, int frame) const {
    return text_of(folder_ / fmt::format("{}.{:04}.png", name, frame));
  }
  fs::path input(int frame) const { return folder_ / fmt::format("shot.{:04}.exr", frame); }
  int lines_of(const std::string& text) const { return int(std::count(text.begin(), text.end(), '\n')); }
  bool has_temporary_files() const {
    const auto names = files();
    return std::any_of(names.begin(), names.end(),
                       [](const std::string& name) { return name.find(".part-") != std::string::npos; });
  }
};

TEST_F(SequenceTest, FramesTakeTheRadiusOfTheFirst) {
  make_inputs(5);
  const Outcome outcome = shade("0-4", "out");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  good("shade shot.0000.exr -o alone0.png --device cpu");
  good("shade shot.0002.exr -o alone2.png --device cpu");
  EXPECT_EQ(picture("out", 0), text_of(folder_ / "alone0.png"));
  EXPECT_NE(picture("out", 2), text_of(folder_ / "alone2.png")) << "the radius of frame 2 alone is another";
  for (int frame = 0; frame < 5; ++frame) EXPECT_EQ(image(fmt::format("out.{:04}.png", frame)).width, 64);
  // Another range has another first frame.
  EXPECT_EQ(shade("2", "two").code, 0);
  EXPECT_EQ(picture("two", 2), text_of(folder_ / "alone2.png"));
  // Without --frames: all files of the name.
  good("shade shot.%04d.exr -o all.%04d.png --device cpu --steady 0");
  for (int frame = 0; frame < 5; ++frame) EXPECT_EQ(picture("all", frame), picture("out", frame));
}

// The depth of 8-bit disparity is relative to the range of a frame: if each frame had its own, an object that enters
// would move all others.
TEST_F(SequenceTest, DepthMeansTheSameInAllFrames) {
  for (int frame = 0; frame < 2; ++frame) {
    Image grey(64, 48);
    Plane& plane = grey.add("grey") = Plane(64, 48);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        plane.at(x, y) = frame == 1 && x < 16 && y > 20 ? 1.0f : float(40 + y + x % 2) / 255.0f;
    ASSERT_TRUE(write_image(folder_ / fmt::format("depth.{:04}.png", frame), grey));
  }
  EXPECT_EQ(
      run("shade depth.####.png --depth-kind disparity -o out.####.exr --passes depth --device cpu --repair off").code,
      0);
  const Image before = image("out.0000.exr"), after = image("out.0001.exr");
  const Plane &a = before.plane("depth"), &b = after.plane("depth");
  for (int y = 2; y < 46; ++y)
    for (int x = 24; x < 60; ++x) EXPECT_EQ(a.at(x, y), b.at(x, y)) << x << ' ' << y;
  EXPECT_LT(b.at(8, 30), a.at(8, 30));
}

TEST_F(SequenceTest, AFailureDoesNotStopTheOthers) {
  make_inputs(8);
  fs::resize_file(input(3), 3000);
  fs::remove(input(5));
  const Outcome outcome = shade("0-9", "out");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("umbrage: frame 3: 'shot.0003.exr'"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("no input: 5, 8-9\n"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("4 of 10 frames have no picture: 3, 5, 8-9\n"), std::string::npos) << outcome.err;
  EXPECT_EQ(lines_of(outcome.err), 3) << outcome.err;
  for (const int frame : {0, 1, 2, 4, 6, 7}) EXPECT_EQ(image(fmt::format("out.{:04}.png", frame)).width, 64);
  for (const int frame : {3, 5, 8, 9}) EXPECT_EQ(picture("out", frame), "") << frame;
  EXPECT_FALSE(has_temporary_files());
}

TEST_F(SequenceTest, FinishedFramesAreKept) {
  make_inputs(4);
  EXPECT_EQ(shade("0-3", "out").code, 0);
  const std::string second = picture("out", 2);
  std::string marked = picture("out", 1);  // of the same size, so that it counts as finished
  marked.back() ^= 1;
  write("out.0001.png", marked);
  fs::remove(folder_ / "out.0002.png");
  const Outcome again = shade("0-3", "out");
  EXPECT_EQ(again.code, 0);
  EXPECT_EQ(again.err, "umbrage: 3 of 4 frames are there already; --overwrite makes them again\n");
  EXPECT_EQ(picture("out", 1), marked);
  EXPECT_EQ(picture("out", 2), second) << "the first frame sets the radius, though it is finished";
  // A frame whose input is newer is made again.
  fs::last_write_time(input(1), fs::last_write_time(folder_ / "out.0001.png") + 1s);
  EXPECT_EQ(shade("0-3", "out").code, 0);
  EXPECT_NE(picture("out", 1), marked);
  write("out.0001.png", marked);
  EXPECT_EQ(shade("0-3", "out", "--overwrite").err, "");
  EXPECT_NE(picture("out", 1), marked);
}

TEST_F(SequenceTest, FramesOfOtherOptionsAndCutFramesAreMadeAgain) {
  make_inputs(3);
  EXPECT_EQ(shade("0-2", "out").code, 0);
  const std::string first = picture("out", 1);
  const auto line = [](int frames) {
    return fmt::format("umbrage: {} {} there, but cut off or drawn by other options, and made again\n", frames,
                       frames == 1 ? "frame is" : "frames are");
  };
  const std::string other = "--set output.exposure=1";
  EXPECT_EQ(shade("0-2", "out", other).err, line(3));
  EXPECT_NE(picture("out", 1), first);
  EXPECT_EQ(shade("0-2", "out", other + " --threads 1").err,
            "umbrage: 3 of 3 frames are there already; --overwrite makes them again\n");
  EXPECT_EQ(shade("0-2", "out").err, line(3));
  EXPECT_EQ(picture("out", 1), first);
  write("out.0001.png", first.substr(0, first.size() / 2));
  EXPECT_EQ(shade("0-2", "out").err,
            "umbrage: 2 of 3 frames are there already; --overwrite makes them again\n" + line(1));
  EXPECT_EQ(picture("out", 1), first);
}

TEST_F(SequenceTest, ShardsEqualOneProcess) {
  make_inputs(7);
  for (const bool is_first_broken : {false, true}) {
    if (is_first_broken) fs::resize_file(input(0), 100);
    const std::string serial = is_first_broken ? "b" : "a", parts = serial + "x";
    EXPECT_EQ(shade("0-6", serial).code, is_first_broken ? 3 : 0);
    for (int shard = 1; shard <= 3; ++shard) {
      const Outcome outcome = shade("0-6", parts, fmt::format("--shard {}/3 --threads {}", shard, shard));
      EXPECT_EQ(outcome.code, is_first_broken && shard == 1 ? 3 : 0) << outcome.err;
      EXPECT_EQ(outcome.err.empty(), outcome.code == 0) << "a frame of another shard is not reported";
    }
    for (int frame = 0; frame < 7; ++frame) {
      EXPECT_EQ(picture(parts, frame), picture(serial, frame)) << frame;
      EXPECT_EQ(picture(serial, frame).empty(), is_first_broken && frame == 0);
    }
  }
  const std::string task =
      "SLURM_ARRAY_TASK_ID=1 SLURM_ARRAY_TASK_MIN=1 SLURM_ARRAY_TASK_MAX=2 SLURM_ARRAY_TASK_COUNT=2";
  good("shade shot.####.exr -o s.####.png --device cpu --steady 0 --frames 1-4 --shard slurm", task);
  EXPECT_TRUE(fs::exists(folder_ / "s.0001.png") && fs::exists(folder_ / "s.0002.png"));
  EXPECT_FALSE(fs::exists(folder_ / "s.0003.png") || fs::exists(folder_ / "s.0004.png"));
}

TEST_F(SequenceTest, SeparateFilesHaveNumbersToo) {
  good(kSolids + "--passes depth -o d.####.pfm --turntable 3");
  good("shade --depth d.####.pfm -o out.####.png --device cpu");
  for (int frame = 0; frame < 3; ++frame) EXPECT_EQ(image(fmt::format("out.{:04}.png", frame)).width, 64);
  good("shade d.0000.pfm -o one.png --device cpu");
  EXPECT_EQ(picture("out", 0), text_of(folder_ / "one.png"));
}

TEST_F(SequenceTest, AnInterruptedRunLeavesWholeFrames) {
  constexpr int kFrames = 24;
  make_inputs(kFrames);
  ASSERT_EQ(shade("0-23", "serial").code, 0);
  const pid_t child = ::fork();
  if (child == 0) {
    static_cast<void>(::chdir(folder_.c_str()));
    static_cast<void>(std::freopen("/dev/null", "w", stderr));
    ::execl(test::kProgram, test::kProgram, "shade", "shot.####.exr", "-o", "out.####.png", "--device", "cpu", nullptr);
    ::_exit(127);
  }
  ASSERT_GT(child, 0);
  while (!fs::exists(folder_ / "out.0003.png") && ::waitpid(child, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(1ms);
  ::kill(child, SIGTERM);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child) << "the run ended too early";
  EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : -1, 128 + SIGTERM);
  EXPECT_FALSE(has_temporary_files());
  EXPECT_EQ(shade("0-23", "out").code, 0);
  for (int frame = 0; frame < kFrames; ++frame) EXPECT_EQ(picture("out", frame), picture("serial", frame)) << frame;
}

TEST_F(SequenceTest, RefusesRangesWithoutFiles) {
  make_inputs(3);
  bad("shade shot.####.exr -o out.####.png --frames 100-120", 3, {"'shot.####.exr'", "100-120", "frames 0-2"});
  bad("shade sho.####.exr -o out.####.png --frames 0-2", 3,
      {"'sho.####.exr'", "did you mean 'shot.####.exr'", "shot.0000.exr to shot.0002.exr"});
  const std::string two = "shade shot.####.exr --normal other.####.exr -o out.####.png ";
  fs::copy_file(input(0), folder_ / "other.0007.exr");
  bad(two, 3, {"'other.####.exr'", "a frame of 0-2", "frames 7"});
  bad(two + "--frames 0-9", 3, {"no frame of 0-9 has all its files"});
  bad("shade shot.####.pfm -o out.####.png", 3, {"'shot.####.pfm'", "no .pfm file"});
  bad("shade no/shot.####.exr -o out.####.png", 3, {"'no/shot.####.exr'", "folder 'no'"});
  bad("shade shot.####.exr -o out.####.png --frames 5-1", 2, {"--frames", "5-1", "1-240x2"});
  bad("shade shot.####.exr -o out.####.png --shard 0/2", 2, {"--shard", "0/2", "2/6"});
  bad("shade shot.####.exr -o out.####.png --shard slurm", 2, {"SLURM_ARRAY_TASK_ID", "--array"});
  bad("shade shot.####.exr -o -", 2, {"-o -", "out.####.png"});
  bad("shade shot.####.exr -o out.##.##.png", 2, {"out.##.##.png", "one frame number"});
  bad("shade shot.####.exr -o no/out.####.png", 3, {"'no'", "create"});
  bad("shade shot.####.exr -o no/out.####.png --frames 1-2", 3, {"no/out.0001.png"});
  bad("shade shot.0000.exr -o out.####.png", 2, {"out.####.png", "frame number"});
  bad("shade shot.0000.exr -o out.png --frames 0-2", 2, {"--frames", "shot.####.exr"});
  good("shade shot.0000.exr -o out.png --overwrite --device cpu");
  for (const char* more : {"", " --overwrite", " --frames 0-2"})
    bad(fmt::format("shade shot.####.exr -o shot.####.exr{}", more), 2, {"'shot.0000.exr'", "input"});
  bad("shade shot.####.exr -o out.####.png --passes foo", 2, {"'foo'", "depth"});
}

TEST_F(SequenceTest, NamesFilesOfOtherDigitsAndGaps) {
  make_inputs(4);
  for (const char* name : {"shot.##.exr", "shot.%06d.exr", "shot.$F3.exr"})
    bad(fmt::format("shade {} -o out.####.png", name), 3, {"'shot.####.exr', frames 0-3"});
  fs::remove(input(2));
  for (const char* command : {"shade shot.####.exr -o out.####.png --device cpu", "info shot.####.exr"}) {
    const Outcome gap = run(command);
    EXPECT_EQ(gap.code, 0);
    EXPECT_NE((gap.err + gap.out).find("'shot.####.exr' has no file of the frames 2"), std::string::npos) << gap.err;
  }
  fs::remove(input(1));
  fs::remove(input(3));
  fs::copy_file(input(0), folder_ / "shot.7.exr");
  const Outcome mixed = run("shade shot.####.exr -o out.####.png --device cpu --overwrite");
  EXPECT_NE(mixed.err.find("'shot.#.exr', are left out"), std::string::npos) << mixed.err;
}

TEST_F(SequenceTest, TurntablesAreSequencesToo) {
  const std::string line = kSolids + "--look ao --turntable 5 ";
  good(line + "-o whole.##.png");
  for (int shard = 1; shard <= 2; ++shard) good(line + fmt::format("-o part.%02d.png --shard {}/2", shard));
  for (int frame = 0; frame < 5; ++frame)
    EXPECT_EQ(text_of(folder_ / fmt::format("part.{:02}.png", frame)),
              text_of(folder_ / fmt::format("whole.{:02}.png", frame)));
  std::string marked = text_of(folder_ / "part.01.png");  // of the same size, so that it counts as finished
  marked.back() ^= 1;
  write("part.01.png", marked);
  fs::remove(folder_ / "part.04.png");
  EXPECT_EQ(run(line + "-o part.##.png").err,
            "umbrage: 4 of 5 frames are there already; --overwrite makes them again\n");
  EXPECT_EQ(text_of(folder_ / "part.01.png"), marked);
  EXPECT_EQ(text_of(folder_ / "part.04.png"), text_of(folder_ / "whole.04.png"));
  EXPECT_EQ(run(line + "-o part.##.png").err,
            "umbrage: 5 of 5 frames are there already; --overwrite makes them again\n");
  good(line + "-o part.##.png --overwrite");
  EXPECT_EQ(text_of(folder_ / "part.01.png"), text_of(folder_ / "whole.01.png"));
  for (const char* option : {"--shard 1/2", "--overwrite"}) {
    bad(fmt::format("tri.obj -o out.png {}", option), 2, {"--turntable"});
    bad(fmt::format("tri.obj -o out.mp4 --turntable 4 {}", option), 2, {"numbered pictures"});
  }
}

TEST_F(SequenceTest, ShardsOfATurntableHaveOneExposure) {
  // One side of the cube is emissive: metered by its own view, the frame that shows it would be darker.
  write("cube.mtl", "newmtl side\nKd 0.2 0.2 0.2\nnewmtl back\nKd 0.2 0.2 0.2\nKe 3 3 3\n");
  write("cube.obj",
        "mtllib cube.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n"
        "usemtl side\nf 4 3 7 8\nf 3 2 6 7\nf 1 4 8 5\nf 5 6 7 8\nusemtl back\nf 2 1 5 6\n");
  const std::string line =
      "cube.obj --device cpu --resolution 48x36 --ao none --camera-position 0,9,4 --camera-focal-point 0,1,0 ";
  good(line + "-o whole.##.png --turntable 2");
  good(line + "-o part.##.png --turntable 2 --shard 2/2");
  EXPECT_FALSE(fs::exists(folder_ / "part.00.png"));
  EXPECT_EQ(text_of(folder_ / "part.01.png"), text_of(folder_ / "whole.01.png"));
  good(line + "-o first.png");
  EXPECT_EQ(text_of(folder_ / "whole.00.png"), text_of(folder_ / "first.png"));
}

}  // namespace
}  // namespace umbrage
