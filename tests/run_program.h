// Runs the program as users do, in a temporary folder, and checks its files, output and exit code.
#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "build_paths.h"
#include "io/image_file.h"

namespace umbrage::test {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

inline std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

inline std::string quoted(const std::string& word) {
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Splits a line into words at spaces.
inline Words words_of(const std::string& line) {
  Words words;
  std::istringstream stream(line);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

struct Outcome {
  int code = -1;
  std::string out, err;
};

/// A temporary folder in which the program runs, with a small model, tri.obj.
class ProgramTest : public testing::Test {
 protected:
  fs::path root_, folder_;

  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "umbrage-cli-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
    folder_ = root_ / "work";
    fs::create_directory(folder_);
    write("tri.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  }
  void TearDown() override {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }

  void write(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) names.insert(entry.path().string());
    return names;
  }

  /// Runs the program. `before`: environment assignments that precede it on the command line.
  Outcome run(const Words& words, const std::string& before = "") {
    std::string line = fmt::format(
        "cd {} && env -u UMBRAGE_DEVICE -u UMBRAGE_NUM_THREADS -u UMBRAGE_VERBOSE "
        "XDG_CONFIG_HOME={} {} {}",
        quoted(folder_.string()), quoted((root_ / "config").string()), before, quoted(test::kProgram));
    for (const std::string& word : words) line += " " + quoted(word);
    const fs::path out = root_ / "out", err = root_ / "err";
    line += fmt::format(" >{} 2>{} </dev/null", quoted(out.string()), quoted(err.string()));
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
  }
  Outcome run(const std::string& line, const std::string& before = "") { return run(words_of(line), before); }

  /// Runs the program and expects success and an empty stderr.
  Outcome good(const std::string& line, const std::string& before = "") {
    const Outcome outcome = run(line, before);
    EXPECT_EQ(outcome.code, 0) << line << ": " << outcome.err;
    EXPECT_EQ(outcome.err, "") << line;
    return outcome;
  }

  /// Runs the program and expects failure: this exit code, one line with all these texts, and no new file.
  void bad(const Words& words, int code, const Words& texts, const std::string& before = "") {
    std::string line;
    for (const std::string& word : words) line += " " + quoted(word);
    SCOPED_TRACE(before + line);
    const auto files_before = files();
    const Outcome outcome = run(words, before);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err.rfind("umbrage: ", 0), 0u) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.err.back(), '\n') << outcome.err;
    for (const std::string& text : texts) EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
    EXPECT_EQ(files(), files_before);
  }
  void bad(const std::string& line, int code, const Words& texts, const std::string& before = "") {
    bad(words_of(line), code, texts, before);
  }
  /// Expects the failure of `umbrage tri.obj -o out.png` with these additional words, with exit code 2.
  void bad_option(const std::string& more, const Words& texts) { bad("tri.obj -o out.png " + more, 2, texts); }

  Image image(const std::string& name) {
    const auto read = read_image(folder_ / name);
    EXPECT_TRUE(read) << (read ? "" : read.error().message);
    return read ? *read : Image();
  }
};

}  // namespace umbrage::test
