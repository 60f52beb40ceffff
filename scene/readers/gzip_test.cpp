// Content of gzip files is bounded by the memory that is available.
#include "scene/readers/gzip.h"

#include <gtest/gtest.h>

#include <random>

#include "archives.h"
#include "system/machine.h"

namespace umbrage::test {
namespace {

TEST(Gzip, ContentTakesAtMostHalfOfTheMemory) {
  const std::string content(5000, 'x'), bytes = gzip_of(content);
  const Result<std::string> read = inflated(bytes, "a.obj.gz", nullptr, 10000.0);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, content);
  const Result<std::size_t> size = inflated_size(bytes, "a.obj.gz", 10000.0);
  ASSERT_TRUE(size) << size.error().message;
  EXPECT_EQ(*size, content.size());
  const auto expect_refused = [](const auto& result) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::kFile);
    EXPECT_NE(result.error().message.find("more than half of the memory"), std::string::npos) << result.error().message;
  };
  expect_refused(inflated(bytes, "a.obj.gz", nullptr, 9990.0));
  expect_refused(inflated_size(bytes, "a.obj.gz", 9990.0));
}

TEST(Gzip, SizeIsThatOfAllMembers) {
  const std::string large(std::size_t(20) << 20, 'y');
  EXPECT_EQ(*inflated_size(gzip_of("abc") + gzip_of(large) + gzip_of(""), "a.gz"), large.size() + 3);
  EXPECT_EQ(inflated(gzip_of("abc") + gzip_of(large), "a.gz")->substr(0, 4), "abcy");
}

TEST(Gzip, LargeFilesAreMeasuredBeforeMemoryIsTaken) {
  // Of two megabytes, most of them random.
  std::mt19937 random(1);
  std::string content(std::size_t(9) << 20, 'y');
  for (std::size_t k = 0; k < std::size_t(2) << 20; ++k) content[k] = char(random());
  const std::string bytes = gzip_of(content);
  const auto read = inflated(bytes, "a.obj.gz");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(*read == content);
  EXPECT_LT(read->capacity(), content.size() + (std::size_t(9) << 20)) << "it was copied as it grew";
}

TEST(Memory, IsKnown) {
  EXPECT_GT(available_memory(), 1e6);
  EXPECT_LT(available_memory(), 1e15);
}

}  // namespace
}  // namespace umbrage::test
