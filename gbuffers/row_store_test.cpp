// RowStore: the same rows from memory and from a scratch file, which leaves nothing in its folder.
#include "gbuffers/row_store.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

namespace umbrage {
namespace {
namespace fs = std::filesystem;

constexpr double kNone = 0.0, kMuch = 1e9;  // bytes of memory

float value(int plane, int x, int y) { return float(plane * 1000000 + y * 1000 + x); }

Image rows_of(int width, int first, int count) {
  Image image(width, count);
  for (const char* name : {"Z", "N.x"}) image.add(name) = Plane(width, count);
  for (int p = 0; p < 2; ++p)
    for (int y = 0; y < count; ++y)
      for (int x = 0; x < width; ++x) image.planes[std::size_t(p)].at(x, y) = value(p, x, first + y);
  return image;
}

class EmptyFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / "row_store_test";
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

using RowStoreFiles = EmptyFolder;

TEST_F(RowStoreFiles, GiveTheSameRowsFromMemoryAndFile) {
  constexpr int kWidth = 37, kHeight = 50;
  for (const double memory : {kNone, kMuch}) {
    auto store = RowStore::create(kWidth, kHeight, {"Z", "N.x"}, memory, folder_.string());
    ASSERT_TRUE(store);
    EXPECT_EQ(store->is_in_memory(), memory == kMuch);
    EXPECT_EQ(store->whole() != nullptr, memory == kMuch);
    for (const auto& [first, count] : {std::pair{20, 30}, {0, 13}, {13, 7}})
      ASSERT_TRUE(store->write(rows_of(kWidth, first, count), first));
    for (const Rows& rows : {Rows{0, 50}, Rows{12, 14}, Rows{49, 50}, Rows{7, 7}}) {
      const auto read = store->read(rows);
      ASSERT_TRUE(read);
      ASSERT_EQ(read->names, (std::vector<std::string>{"Z", "N.x"}));
      ASSERT_EQ(read->height, rows.count());
      for (int p = 0; p < 2; ++p)
        for (int y = 0; y < read->height; ++y)
          for (int x = 0; x < kWidth; ++x)
            ASSERT_EQ(read->planes[std::size_t(p)].at(x, y), value(p, x, rows.begin + y)) << p << ' ' << x << ' ' << y;
    }
  }
}

TEST_F(RowStoreFiles, HaveNoName) {
  auto store = RowStore::create(64, 64, {"Z", "N.x"}, kNone, folder_.string());
  ASSERT_TRUE(store);
  ASSERT_TRUE(store->write(rows_of(64, 0, 64), 0));
  EXPECT_TRUE(fs::is_empty(folder_));
}

// Blocks are smaller than these rows, and four threads read at once.
TEST_F(RowStoreFiles, AreReadByThreads) {
  constexpr int kWidth = 70001, kHeight = 40;
  auto store = RowStore::create(kWidth, kHeight, {"Z", "N.x"}, kNone, folder_.string());
  ASSERT_TRUE(store);
  ASSERT_TRUE(store->write(rows_of(kWidth, 0, kHeight), 0));
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int repeat = 0; repeat < 3; ++repeat) {
        const auto read = store->read({t * 5, kHeight - t});
        for (int y = 0; read && y < read->height; y += 3)
          for (int x = 0; x < kWidth; x += 17)
            wrong[std::size_t(t)] += read->planes[1].at(x, y) != value(1, x, t * 5 + y);
        wrong[std::size_t(t)] += !read;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

TEST_F(RowStoreFiles, NameFolderAndCauseOfFailures) {
  const auto missing = RowStore::create(8, 8, {"Z"}, kNone, (folder_ / "none").string());
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::kFile);
  EXPECT_NE(missing.error().message.find("none' cannot be created: No such file"), std::string::npos)
      << missing.error().message;
  // No file system has an exabyte.
  const auto large = RowStore::create(1 << 30, 1 << 30, {"Z"}, kNone, folder_.string());
  if (large) GTEST_SKIP() << "the file system reserves no space";
  EXPECT_EQ(large.error().kind, ErrorKind::kFile);
  EXPECT_NE(large.error().message.find("cannot be created"), std::string::npos) << large.error().message;
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace umbrage
