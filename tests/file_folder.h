// A fixture for tests that write files.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <system_error>

namespace umbrage::test {

/// A separate folder for each test.
struct FileFolder : testing::Test {
  std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) /
      ("umbrage_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
       std::to_string(std::random_device{}()));
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
};

}  // namespace umbrage::test
