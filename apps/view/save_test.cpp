#include "apps/view/save.h"

#include <signal.h>
#include <sys/wait.h>

#include "apps/view/uploads.h"
#include "run_program.h"

namespace umbrage::view {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::text_of;

const auto kWanted = [] { return true; };

class ViewSave : public test::ProgramTest {
 protected:
  SaveSubject subject() const { return {.words = {(folder_ / "tri.obj").string()}, .stem = "tri"}; }
  Save request(const std::string& format) const {
    return {.options = {{"camera-azimuth-angle", {"30"}},
                        {"set", {"bitmask.slices=2", "bitmask.steps=4"}},
                        {"camera-orthographic", {"true"}},
                        {"no-background", {"false"}},
                        {"camera-position", {"-1,2,3"}},
                        {"resolution", {"8,8"}}},
            .format = format,
            .width = 40,
            .height = 30};
  }
};

TEST_F(ViewSave, WritesTheFileOfTheCommandLine) {
  for (const std::string format : {"png", "exr", "svg", "jpg", "webp"}) {
    const HttpAnswer answer = save_picture(subject(), request(format), folder_, kWanted, test::kProgram);
    ASSERT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.attachment, "tri." + format);
    const std::string expected = "expected." + format;
    const test::Outcome outcome =
        run("tri.obj --camera-azimuth-angle 30 --set bitmask.slices=2 --set bitmask.steps=4 --camera-orthographic "
            "--camera-position=-1,2,3 --resolution 40,30 -o " +
            expected);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_GT(fs::file_size(answer.file), 50u);
    EXPECT_TRUE(text_of(answer.file) == text_of(folder_ / expected)) << format;
  }
}

TEST_F(ViewSave, ErrorsAreThoseOfTheProgram) {
  const auto before = files();
  Save wrong = request("png");
  wrong.options["look"] = {"stdio"};
  const HttpAnswer answer = save_picture(subject(), wrong, folder_, kWanted, test::kProgram);
  EXPECT_EQ(answer.status, 400);
  EXPECT_NE(answer.body.find("no look 'stdio'"), std::string::npos) << answer.body;
  EXPECT_EQ(answer.body.find("\\n"), std::string::npos) << answer.body;
  EXPECT_NE(save_picture(subject(), request("png"), folder_, kWanted, folder_ / "none").body.find("cannot be started"),
            std::string::npos);
  EXPECT_EQ(files(), before);
}

TEST_F(ViewSave, OptionsThatWriteFilesAreRefused) {
  for (const char* name : {"output", "o", "svg", "config", "turntable", "no-such-option", ""}) {
    Save save = request("png");
    save.options[name] = {"x"};
    const auto words = save_words(subject(), save);
    ASSERT_FALSE(words) << name;
    EXPECT_NE(words.error().message.find(std::string("--") + name), std::string::npos);
  }
  Save save = request("png");
  save.options["camera-orthographic"] = {"1"};
  EXPECT_FALSE(save_words(subject(), save));
  const auto words = save_words({.words = {"frame.exr"}, .is_gbuffer = true}, {.format = "png"});
  ASSERT_TRUE(words);
  EXPECT_EQ(*words, (std::vector<std::string>{"shade", "frame.exr", "--config", "none"}));
}

TEST_F(ViewSave, EndsWhenItIsNotWanted) {
  const fs::path program = folder_ / "slow";
  write("slow", "#!/bin/sh\necho $$ >" + (folder_ / "pid").string() + "\nexec sleep 60\n");
  fs::permissions(program, fs::perms::owner_all);
  const auto started = std::chrono::steady_clock::now();
  const HttpAnswer answer = save_picture(
      subject(), request("png"), folder_, [&] { return text_of(folder_ / "pid").empty(); }, program);
  EXPECT_LT(std::chrono::steady_clock::now() - started, 20s);
  EXPECT_NE(answer.body.find("cancelled"), std::string::npos) << answer.body;
  EXPECT_EQ(::kill(std::stoi(text_of(folder_ / "pid")), 0), -1);
}

TEST_F(ViewSave, ACancelledProgramMayRemoveItsFiles) {
  const fs::path program = folder_ / "tidy";
  write("tidy", "#!/bin/sh\ntrap 'rm " + (folder_ / "part").string() + "; exit 1' TERM\ntouch " +
                    (folder_ / "part").string() + "\nwhile :; do sleep 0.1; done\n");
  fs::permissions(program, fs::perms::owner_all);
  save_picture(
      subject(), request("png"), folder_, [&] { return !fs::exists(folder_ / "part"); }, program);
  EXPECT_FALSE(fs::exists(folder_ / "part"));
}

TEST(ViewTemporary, TheFolderIsPrivateAndRemoved) {
  fs::path path;
  {
    const auto folder = TemporaryFolder::create();
    ASSERT_TRUE(folder);
    path = folder->path();
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    fs::create_directories(path / "a");
    fs::create_directory_symlink("/usr", path / "a" / "link");
    std::ofstream(path / "a" / "model.obj") << "v";
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_TRUE(fs::exists("/usr/bin"));
}

}  // namespace
}  // namespace umbrage::view
