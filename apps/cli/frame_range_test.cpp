// Tests of frame ranges, shards and the names of numbered files.
#include "apps/cli/frame_range.h"

#include <cstdlib>
#include <map>
#include <set>

#include "apps/cli/frame_names.h"
#include "file_folder.h"

namespace umbrage::cli {
namespace {

using Frames = std::vector<int>;

TEST(FrameRange, ListsAndSteps) {
  const std::pair<const char*, Frames> cases[] = {
      {"7", {7}},
      {"1-4", {1, 2, 3, 4}},
      {"1-10x4", {1, 5, 9}},
      {"5-9,1,3", {1, 3, 5, 6, 7, 8, 9}},
      {"2,1-3,3", {1, 2, 3}},
      {"-2-1", {-2, -1, 0, 1}},
      {"999999999", {999999999}},
  };
  for (const auto& [text, frames] : cases) {
    const auto parsed = parse_frames(text);
    ASSERT_TRUE(parsed) << text << ": " << parsed.error().message;
    EXPECT_EQ(*parsed, frames) << text;
  }
  EXPECT_EQ(parse_frames("1-1000000")->size(), 1000000u);
}

TEST(FrameRange, RefusesWhatIsNoRange) {
  for (const char* text : {"", ",", "1,", "a", "1-", "3-2", "1-5x0", "1-5x-1", "1-5x", "1 - 5", "1.5", "1-5,x",
                           "1-1000001", "1-999999,2000000-2000002", "1000000000", "99999999999999"}) {
    const auto parsed = parse_frames(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().kind, ErrorKind::kUsage);
    EXPECT_NE(parsed.error().message.find(fmt::format("'{}'", text)), std::string::npos) << parsed.error().message;
  }
}

TEST(FrameRange, TextsJoinNeighbours) {
  EXPECT_EQ(frames_text(Frames{}), "");
  EXPECT_EQ(frames_text(Frames{4}), "4");
  EXPECT_EQ(frames_text(Frames{1, 2, 3, 7, 9, 10}), "1-3, 7, 9-10");
  Frames odd;
  for (int frame = 1; frame < 200; frame += 2) odd.push_back(frame);
  EXPECT_TRUE(frames_text(odd).ends_with("39 and 80 more")) << frames_text(odd);
}

TEST(FrameRange, ShardsPartitionTheFrames) {
  Frames frames;
  for (int frame = 10; frame < 58; ++frame) frames.push_back(frame);
  for (const int count : {1, 5, 6, 48, 60}) {
    std::multiset<int> made;
    for (int shard = 1; shard <= count; ++shard) {
      const auto parsed = parse_shard(fmt::format("{}/{}", shard, count));
      ASSERT_TRUE(parsed) << parsed.error().message;
      const Frames own = parsed->of(frames);
      made.insert(own.begin(), own.end());
      EXPECT_LE(own.size(), std::size_t(48 / count + 1));
      EXPECT_GE(own.size(), std::size_t(48 / count));
    }
    EXPECT_TRUE(std::equal(made.begin(), made.end(), frames.begin(), frames.end())) << count;
  }
  EXPECT_EQ(parse_shard("2/6")->of(frames), (Frames{18, 19, 20, 21, 22, 23, 24, 25}));
  for (const char* text : {"", "0/6", "7/6", "1", "1/0", "-1/6", "1/6x", "a/b", "1/", "/6", "Slurm"})
    EXPECT_FALSE(parse_shard(text)) << text;
}

/// Sets the variables of a Slurm array; those without a value are removed.
void set_array(const std::map<std::string, std::string>& values) {
  for (const char* name : {"ID", "MIN", "MAX", "STEP", "COUNT"}) {
    const std::string variable = std::string("SLURM_ARRAY_TASK_") + name;
    const auto value = values.find(name);
    if (value == values.end())
      ::unsetenv(variable.c_str());
    else
      ::setenv(variable.c_str(), value->second.c_str(), 1);
  }
}

TEST(FrameRange, ReadsTheTaskOfASlurmArray) {
  const auto shard = [](const std::map<std::string, std::string>& values) {
    set_array(values);
    auto parsed = parse_shard("slurm");
    set_array({});
    return parsed;
  };
  const auto from_zero = shard({{"ID", "3"}, {"MIN", "0"}, {"MAX", "5"}, {"STEP", "1"}, {"COUNT", "6"}});
  ASSERT_TRUE(from_zero);
  EXPECT_EQ(from_zero->index, 3);
  EXPECT_EQ(from_zero->count, 6);
  const auto stepped = shard({{"ID", "18"}, {"MIN", "10"}, {"MAX", "18"}, {"STEP", "4"}, {"COUNT", "3"}});
  ASSERT_TRUE(stepped);
  EXPECT_EQ(stepped->index, 2);
  EXPECT_EQ(stepped->count, 3);
  EXPECT_FALSE(shard({}));
  EXPECT_FALSE(shard({{"ID", "3"}}));
  EXPECT_FALSE(shard({{"ID", "7"}, {"MIN", "0"}, {"MAX", "5"}}));
  EXPECT_FALSE(shard({{"ID", "x"}, {"MIN", "0"}, {"MAX", "5"}}));
  const auto with_gaps = shard({{"ID", "4"}, {"MIN", "1"}, {"MAX", "7"}, {"STEP", "1"}, {"COUNT", "3"}});
  ASSERT_FALSE(with_gaps);
  EXPECT_NE(with_gaps.error().message.find("without gaps"), std::string::npos);
}

TEST(FrameNamesOf, NumbersHaveTwoNotations) {
  for (const char* name : {"a/shot.####.exr", "a/shot.%04d.exr", "a/shot.$F4.exr"}) {
    EXPECT_TRUE(has_frame_number(name)) << name;
    const auto names = frame_names(name, "--output");
    ASSERT_TRUE(names);
    EXPECT_EQ(names->of(7), "a/shot.0007.exr");
    EXPECT_EQ(names->of(12345), "a/shot.12345.exr");
  }
  EXPECT_EQ(frame_names("x#.png", "")->of(12), "x12.png");
  EXPECT_EQ(frame_names("x%%#.png", "")->of(1), "x%1.png");
  for (const char* name :
       {"shot.exr", "100%.exr", "a%%d.exr", "%s.exr", "%4d.exr", "shot.##########.exr", "a$Fox.exr", "a$F44.exr"})
    EXPECT_FALSE(has_frame_number(name)) << name;
  EXPECT_FALSE(frame_names("##.##.exr", "--output"));
}

struct FrameNamesFolder : test::FileFolder {};

TEST_F(FrameNamesFolder, FindsItsFiles) {
  for (const char* name : {"s.0009.exr", "s.0010.exr", "s.10000.exr", "s.011.exr", "s.0012.png", "s.00x3.exr", "s..exr",
                           "t.0001.exr", "s.0013.exr.part-1-0"})
    write(name, "");
  EXPECT_EQ(frame_names((folder / "s.####.exr").string(), "")->existing(), (Frames{9, 10, 10000}));
  EXPECT_EQ(frame_names((folder / "s.%d.exr").string(), "")->existing(), (Frames{10000}));
  EXPECT_TRUE(frame_names((folder / "nothere" / "s.####.exr").string(), "")->existing().empty());
}

}  // namespace
}  // namespace umbrage::cli
