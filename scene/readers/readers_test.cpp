// A short version of the fuzz tests: every reader reads its seeds complete, truncated and with random changes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "core/lists.h"
#include "fuzz/readers.h"
#include "scene/readers/import.h"

namespace umbrage::fuzz {
namespace {

namespace fs = std::filesystem;

std::string changed(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::size_t(random()) % std::max<std::size_t>(1, n); };
  for (std::size_t i = 0, times = 1 + below(4); i < times && !bytes.empty(); ++i) {
    const std::size_t at = below(bytes.size());
    switch (below(5)) {
      case 0:
        bytes[at] = char(random());
        break;
      case 1:
        bytes[at] = char(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.erase(at, 1 + below(8));
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(16)));
        break;
      case 4:
        bytes.replace(at, std::min<std::size_t>(4, bytes.size() - at), below(2) ? "\xff\xff\xff\xff" : "9999");
        break;
    }
  }
  return bytes;
}

/// Returns the reader's name for the name of a test, which may contain only letters and digits.
std::string test_name(const testing::TestParamInfo<Reader>& info) {
  std::string name(info.param.name);
  std::erase(name, '-');
  return name;
}

class Readers : public testing::TestWithParam<Reader> {};

TEST_P(Readers, TakeAnyBytes) {
  const Reader& reader = GetParam();
  const auto seeds = reader.seeds();
  ASSERT_FALSE(seeds.empty());
  reader.read("");
  std::mt19937 random(1);
  for (const std::string& seed : seeds) {
    ASSERT_FALSE(seed.empty());
    reader.read(seed);
    // Third-party readers may crash. They are tested below, in a separate process.
    if (reader.is_third_party) continue;
    constexpr std::size_t kCuts = 100;
    for (std::size_t i = 0; i < kCuts; ++i) reader.read(std::string_view(seed).substr(0, seed.size() * i / kCuts));
    constexpr int kChanges = 400;
    for (int i = 0; i < kChanges; ++i) reader.read(changed(seed, random));
  }
}

INSTANTIATE_TEST_SUITE_P(All, Readers, testing::ValuesIn(readers().begin(), readers().end()), test_name);

TEST(ThirdPartyReaders, NeverCrashTheProgram) {
  std::string name = (fs::temp_directory_path() / "umbrage-readers-XXXXXX").string();
  ASSERT_NE(::mkdtemp(name.data()), nullptr);
  const fs::path folder = name;
  std::mt19937 random(2);
  int valid_count = 0;
  for (const Reader& reader : readers()) {
    const auto& formats = import_formats();
    if (!reader.is_third_party || !contains(formats, reader.name)) continue;
    const fs::path file = folder / ("model." + std::string(reader.name));
    for (const std::string& seed : reader.seeds()) {
      std::ofstream(file, std::ios::binary) << seed;
      valid_count += bool(import_scene(file));
      constexpr int kChanges = 6;
      for (int i = 0; i < kChanges; ++i) {
        std::ofstream(file, std::ios::binary) << changed(seed, random);
        const Result<Scene> scene = import_scene(file);
        if (scene) continue;
        EXPECT_EQ(scene.error().kind, ErrorKind::kFile) << scene.error().message;
      }
    }
  }
  EXPECT_GE(valid_count, 6) << "all seeds are valid except a glTF file whose buffer is missing";
  fs::remove_all(folder);
}

}  // namespace
}  // namespace umbrage::fuzz
