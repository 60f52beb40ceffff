// Tests of thumbnails: pictures of many models, and the files by which file managers find the command.
#include <algorithm>

#include "run_program.h"
#include "scene/readers/import.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::text_of;

class ThumbnailsTest : public test::ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    fs::create_directories(folder_ / "models" / "more");
    for (const char* name : {"a.obj", "b c.OBJ", "more/a.obj"})
      fs::copy(folder_ / "tri.obj", folder_ / "models" / name);
    write("models/notes.txt", "no model");
  }
  void expect_size(const std::string& name, int size) {
    SCOPED_TRACE(name);
    const Image picture = image(name);
    EXPECT_EQ(picture.width, size);
    EXPECT_EQ(picture.height, size);
    float min = 1.0f, max = 0.0f;
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        min = std::min(min, picture.planes[1].at(x, y));
        max = std::max(max, picture.planes[1].at(x, y));
      }
    EXPECT_GT(max - min, 0.1f) << "the picture shows nothing";
  }
};

TEST_F(ThumbnailsTest, DrawsEveryModelOfAFolder) {
  const std::set<std::string> before = files();
  good("thumbnails models -o thumbs --device cpu");
  std::set<std::string> added;
  for (const std::string& file : files())
    if (!before.contains(file)) added.insert(fs::path(file).lexically_relative(folder_).string());
  EXPECT_EQ(added, (std::set<std::string>{"thumbs", "thumbs/a.obj.png", "thumbs/b c.OBJ.png", "thumbs/more",
                                          "thumbs/more/a.obj.png"}));
  for (const char* name : {"thumbs/a.obj.png", "thumbs/b c.OBJ.png", "thumbs/more/a.obj.png"}) expect_size(name, 256);
  EXPECT_EQ(text_of(folder_ / "thumbs/a.obj.png"), text_of(folder_ / "thumbs/more/a.obj.png"));
}

TEST_F(ThumbnailsTest, BrokenModelsDoNotStopTheOthers) {
  write("models/empty.stl", "");
  write("models/wrong.ply", "ply\nformat ascii 1.0\nelement vertex many\n");
  const Outcome outcome = run("thumbnails models scene:solids?detail=2000 tri.obj -o thumbs --size 32 --device cpu");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 3) << outcome.err;
  for (const char* text : {"empty.stl", "wrong.ply", "2 of 7 models have no picture"})
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
  for (const char* name : {"a.obj", "b c.OBJ", "more/a.obj", "solids", "tri.obj"})
    expect_size(fmt::format("thumbs/{}.png", name), 32);
  EXPECT_FALSE(fs::exists(folder_ / "thumbs/empty.stl.png"));
}

TEST_F(ThumbnailsTest, OneModelMayNameItsPicture) {
  good("thumbnails tri.obj -o one.png --size 40 --look lit --no-background");
  expect_size("one.png", 40);
  EXPECT_TRUE(image("one.png").find("color.a"));
  good("thumbnails tri.obj -o folder --size 40");
  expect_size("folder/tri.obj.png", 40);
}

TEST_F(ThumbnailsTest, WrongUsageGivesOneSentence) {
  bad("thumbnails models", 2, {"--output"});
  bad("thumbnails models -o thumbs --size 0", 2, {"--size", "0"});
  bad("thumbnails models -o thumbs --look fancy", 2, {"fancy"});
  bad("thumbnails tri.obj models/more models -o thumbs/x", 2, {"a.obj", "would both be written"});
  bad("thumbnails none.obj -o none.png", 3, {"none.obj", "does not exist"});
  bad("thumbnails models -o tri.obj", 3, {"tri.obj"});
  fs::create_directory(folder_ / "bare");
  bad("thumbnails bare -o thumbs", 3, {"bare", "contains no model"});
}

TEST_F(ThumbnailsTest, FileManagersFindTheCommandForEveryFormat) {
  const fs::path share = fs::path(test::kSourceFolder) / "apps/share";
  const std::string entry = text_of(share / "thumbnailers/umbrage.thumbnailer");
  const std::string types = text_of(share / "mime/packages/umbrage.xml");
  // The types of shared-mime-info; the others are in our own file.
  const std::map<std::string, std::string> known = {{"stl", "model/stl"},
                                                    {"gltf", "model/gltf+json"},
                                                    {"glb", "model/gltf-binary"},
                                                    {"3ds", "image/x-3ds"},
                                                    {"3mf", "model/3mf"}};
  for (const std::string& format : import_formats()) {
    std::string type;
    if (const auto found = known.find(format); found != known.end()) {
      type = found->second;
    } else {
      const std::size_t glob = types.find(fmt::format("\"*.{}\"", format));
      ASSERT_NE(glob, std::string::npos) << format;
      const std::size_t start = types.rfind("mime-type type=\"", glob) + std::string("mime-type type=\"").size();
      type = types.substr(start, types.find('"', start) - start);
    }
    EXPECT_NE(entry.find(type + ";"), std::string::npos) << format << ": " << type;
  }
  // Run the entry as a file manager does.
  std::string line = entry.substr(entry.find("Exec=umbrage ") + std::string("Exec=umbrage ").size());
  line.resize(line.find('\n'));
  test::Words words = test::words_of(line);
  for (std::string& word : words)
    word = word == "%i"   ? (folder_ / "models/b c.OBJ").string()
           : word == "%o" ? (root_ / "thumb.png").string()
           : word == "%s" ? "64"
                          : word;
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const auto picture = read_image(root_ / "thumb.png");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width, 64);
}

}  // namespace
}  // namespace umbrage
