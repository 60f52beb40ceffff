#include "apps/view/save.h"

#include <signal.h>
#include <sys/wait.h>

#include <thread>

#include "apps/view/temporary.h"
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
    const HttpAnswer answer = save_picture(subject(), request(format), folder_, kWanted, UMBRAGE_PROGRAM);
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
  const HttpAnswer answer = save_picture(subject(), wrong, folder_, kWanted, UMBRAGE_PROGRAM);
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

TEST(ViewTemporary, ASignalHandlerRemovesEverything) {
  const pid_t child = ::fork();
  if (child == 0) ::execl("/bin/sleep", "sleep", "60", nullptr);
  const ListedChild listed(child);
  const auto folder = TemporaryFolder::create();
  ASSERT_TRUE(folder);
  fs::create_directories(folder->path() / "a");
  for (const char* name : {"saved.png", "a/model.obj", "a/wood.png"}) std::ofstream(folder->path() / name) << name;
  fs::create_directory_symlink("/usr", folder->path() / "a" / "link");
  for (int i = 0; i < 500; ++i) std::ofstream(folder->path() / "a" / std::to_string(i)) << i;
  abandon_view();
  EXPECT_FALSE(fs::exists(folder->path()));
  EXPECT_TRUE(fs::exists("/usr/bin"));
  EXPECT_EQ(::kill(child, 0), -1);
}

}  // namespace
}  // namespace umbrage::view
