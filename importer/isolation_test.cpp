// Import in a separate process: whatever the reader does, the host continues and receives an error.
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "importer/importer.h"
#include "run_program.h"
#include "scene/readers/import_in_child_process.h"
#include "scene/readers/import_parts.h"
#include "scene/readers/transfer.h"

namespace umbrage::test {
namespace {

const std::string kFaulty = std::string("UMBRAGE_IMPORT=") + test::kFaultyImport;

/// Uses the faulty reader instead of umbrage-import.
class IsolatedImport : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    ::setenv("UMBRAGE_IMPORT", test::kFaultyImport, 1);
  }
  void TearDown() override {
    ::unsetenv("UMBRAGE_IMPORT");
    ProgramTest::TearDown();
  }

  /// Returns a valid model under this name, which selects the fault.
  fs::path model(const std::string& name) {
    write(name, R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,
"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    return folder_ / name;
  }
  void expect_error(const std::string& name, const std::string& text) {
    const Result<Scene> scene = import_scene(model(name));
    ASSERT_FALSE(scene) << name;
    EXPECT_EQ(scene.error().kind, ErrorKind::kFile);
    EXPECT_NE(scene.error().message.find(name + "' "), std::string::npos) << scene.error().message;
    EXPECT_NE(scene.error().message.find(text), std::string::npos) << scene.error().message;
    EXPECT_EQ(scene.error().message.find('\n'), std::string::npos) << scene.error().message;
  }
};

TEST_F(IsolatedImport, SurvivesWhatItsReaderDoes) {
  EXPECT_TRUE(import_scene(model("sound.gltf")));
  expect_error("crash.gltf", "its reader crashed on it (Segmentation fault)");
  expect_error("abort.gltf", "its reader crashed on it (Aborted)");
  expect_error("throw.gltf", "its reader crashed on it (Aborted)");
  expect_error("exit.gltf", "its reader crashed on it");
  expect_error("killed.gltf", "more memory than is available");
  expect_error("liar.gltf", "another version");
}

TEST_F(IsolatedImport, StopsAHangingReader) {
  expect_error("spin.gltf", "stopped after 1 s");
  expect_error("wait.gltf", "stopped after 1 s");
}

TEST_F(IsolatedImport, LimitsTheMemoryOfTheReader) {
  if (!memory_can_be_limited()) GTEST_SKIP() << "a sanitizer has reserved the address space";
  expect_error("hunger.gltf", "needs more memory than is available");
}

TEST_F(IsolatedImport, ProgramReportsOneSentence) {
  for (const std::string name : {"crash.gltf", "abort.gltf", "exit.gltf"}) {
    model(name);
    bad(name + " -o out.png", 3, {name, "its reader crashed"}, kFaulty);
  }
}

TEST_F(IsolatedImport, LeavesNoProcessBehind) {
  // Kill the host while its reader waits. The pipe, which the reader has inherited, closes only if the reader ends,
  // too.
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const std::string file = model("linger.gltf").string(), started = file + ".started";
  const pid_t program = ::fork();
  if (program == 0) {
    ::dup2(pipe_ends[1], 9), ::close(pipe_ends[0]), ::close(pipe_ends[1]);
    ::execl(test::kProgram, "umbrage", file.c_str(), "-o", (file + ".png").c_str(), nullptr);
    ::_exit(1);
  }
  ::close(pipe_ends[1]);
  for (int i = 0; i < 1000 && !fs::exists(started); ++i) ::usleep(10'000);
  EXPECT_TRUE(fs::exists(started));
  ::kill(program, SIGKILL);
  ::waitpid(program, nullptr, 0);
  pollfd reader{pipe_ends[0], POLLIN, 0};
  constexpr int kTimeoutMs = 10'000;  // much less than the reader waits
  EXPECT_EQ(::poll(&reader, 1, kTimeoutMs), 1);
  ::close(pipe_ends[0]);
}

TEST_F(IsolatedImport, StopsItsReaderOnRequest) {
  const fs::path file = model("linger.gltf");
  const fs::path started = file.string() + ".started";
  std::chrono::steady_clock::time_point ended;
  const Result<Scene> scene = import_scene(file, {}, [&](double) {
    ended = std::chrono::steady_clock::now();
    return !fs::exists(started);
  });
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::kInterrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - ended, std::chrono::milliseconds(300));
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child is left";
}

TEST_F(IsolatedImport, WorksInAnyProgram) {
  // The host ignores its children, has closed its standard input, and imports in several threads.
  ::signal(SIGCHLD, SIG_IGN);
  const int input = ::dup(STDIN_FILENO);
  ::close(STDIN_FILENO);
  EXPECT_TRUE(import_scene(model("sound.gltf")));
  expect_error("crash.gltf", "its reader crashed on it");
  ::dup2(input, STDIN_FILENO);
  ::close(input);
  ::signal(SIGCHLD, SIG_DFL);
  std::atomic<int> good = 0, bad = 0;
  std::vector<std::thread> threads;
  const fs::path sound = model("sound.gltf"), crash = model("crash.gltf");
  for (int i = 0; i < 6; ++i) threads.emplace_back([&, i] { (import_scene(i % 2 ? sound : crash) ? good : bad) += 1; });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, 3);
  EXPECT_EQ(bad, 3);
}

TEST_F(IsolatedImport, NeedsItsProgram) {
  ::setenv("UMBRAGE_IMPORT", "/nowhere/umbrage-import", 1);
  expect_error("sound.gltf", "'/nowhere/umbrage-import' does not start");
  EXPECT_TRUE(import_scene(folder_ / "tri.obj")) << "our own reader needs no other program";
  ::setenv("UMBRAGE_IMPORT", "/bin/true", 1);
  expect_error("sound.gltf", "its reader crashed on it");
  ::unsetenv("UMBRAGE_IMPORT");
  EXPECT_EQ(import_program().filename(), "umbrage-import");
  EXPECT_TRUE(import_scene(model("sound.gltf")));
}

/// An open file in memory, without a name.
struct Memory {
  int file = ::memfd_create("test", 0);
  ~Memory() { ::close(file); }
  std::string bytes() const {
    std::string text(std::size_t(::lseek(file, 0, SEEK_END)), '\0');
    EXPECT_EQ(::pread(file, text.data(), text.size(), 0), ssize_t(text.size()));
    return text;
  }
  void fill(std::string_view text) const {
    ASSERT_EQ(::ftruncate(file, 0), 0);
    ASSERT_EQ(::pwrite(file, text.data(), text.size(), 0), ssize_t(text.size()));
  }
};

Scene small_scene() {
  Scene scene;
  scene.name = "a scene";
  scene.textures.push_back({"wood", 2, 1, {1, 2, 3, 4, 5, 6, 7, 8}});
  scene.materials.push_back({.name = "m", .albedo = glm::vec3(0.25f), .texture = 0, .alpha_mask = true});
  Mesh mesh{.name = "plate", .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}, .object = 7};
  mesh.normals.assign(3, glm::vec3(0, 0, 1));
  scene.meshes.push_back(mesh);
  scene.lights.push_back({.kind = LightKind::kPoint, .position = {1, 2, 3}, .reach = 4.0f});
  scene.views.push_back({.eye = {9, 8, 7}});
  scene.warnings = {"", "a warning"};
  scene.bounds_max = {1, 1, 0};
  return scene;
}

/// Expects that all indices and lists of a scene fit, unless it is an error.
void expect_consistent(const Result<Scene>& scene) {
  if (!scene) return;
  for (const Material& material : scene->materials)
    for (const int texture :
         {material.texture, material.emission_texture, material.surface_texture, material.normal_texture})
      EXPECT_TRUE(texture == kNoTexture || std::size_t(texture) < scene->textures.size());
  for (const Mesh& mesh : scene->meshes) {
    EXPECT_LT(std::size_t(mesh.material), scene->materials.size());
    EXPECT_EQ(mesh.indices.size() % 3, 0u);
    for (const std::size_t size :
         {mesh.normals.size(), mesh.uvs.size(), mesh.colors.size(), mesh.radii.size(), mesh.bends.size()})
      EXPECT_TRUE(size == 0 || size == mesh.positions.size());
    for (const Field& field : mesh.fields)
      EXPECT_EQ(field.values.size(), mesh.positions.size() * std::size_t(field.components));
    for (const std::uint32_t index : mesh.indices) EXPECT_LT(index, mesh.positions.size());
  }
}

TEST(Transfer, KeepsEveryField) {
  // Data that is written, read and written again is bitwise identical.
  Memory first, second;
  ASSERT_TRUE(send_import(first.file, small_scene()));
  const auto scene = receive_import(first.file);
  ASSERT_TRUE(scene && *scene);
  EXPECT_EQ((*scene)->meshes.at(0).positions.at(1), glm::vec3(1, 0, 0));
  EXPECT_EQ((*scene)->lights.at(0).reach, 4.0f);
  EXPECT_EQ((*scene)->warnings.at(1), "a warning");
  ASSERT_TRUE(send_import(second.file, *scene));
  EXPECT_EQ(first.bytes(), second.bytes());
  Memory third;
  ASSERT_TRUE(send_import(third.file, usage_error("a sentence")));
  const auto error = receive_import(third.file);
  ASSERT_TRUE(error && !*error);
  EXPECT_EQ(error->error().kind, ErrorKind::kUsage);
  EXPECT_EQ(error->error().message, "a sentence");
}

TEST(Transfer, RejectsIncompleteOrInconsistentData) {
  Memory whole, changed;
  ASSERT_TRUE(send_import(whole.file, small_scene()));
  const std::string bytes = whole.bytes();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    changed.fill(bytes.substr(0, size));
    EXPECT_FALSE(receive_import(changed.file)) << size << " of " << bytes.size();
  }
  // Change any byte: the data must be rejected or be consistent once it is complete.
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string other = bytes;
    other[i] = char(other[i] ^ 0xff);
    changed.fill(other);
    auto read = receive_import(changed.file);
    if (read) expect_consistent(complete_import(std::move(*read), "a.glb", {}));
  }
  const auto completed_after = [&](auto change) {
    Scene scene = small_scene();
    change(scene);
    Memory file;
    EXPECT_TRUE(send_import(file.file, scene));
    auto read = receive_import(file.file);
    if (!read) return Result<Scene>(usage_error("rejected"));
    Result<Scene> completed = complete_import(std::move(*read), "a.glb", {});
    expect_consistent(completed);
    return completed;
  };
  EXPECT_TRUE(completed_after([](Scene&) {}));
  Scene broken = small_scene();
  broken.textures[0].width = 1000;
  Memory without_texels;
  ASSERT_TRUE(send_import(without_texels.file, broken));
  EXPECT_FALSE(receive_import(without_texels.file));
  EXPECT_TRUE(completed_after([](Scene& s) {
    Mesh& mesh = s.meshes[0];  // with a vertex that no triangle has
    mesh.positions.emplace_back(5.0f);
    mesh.normals.emplace_back(0.0f, 0.0f, 1.0f);
    mesh.radii.assign(4, 1.0f);
    mesh.bends.assign(4, glm::vec3(1.0f));
  }));
  EXPECT_FALSE(completed_after([](Scene& s) { s.meshes[0].indices[1] = 3; })) << "no triangle is left";
  EXPECT_EQ(completed_after([](Scene& s) { s.meshes[0].normals.pop_back(); })->meshes.at(0).normals.size(), 3u);
  EXPECT_EQ(completed_after([](Scene& s) { s.meshes[0].uvs.resize(1); })->meshes.at(0).uvs.size(), 0u);
  EXPECT_EQ(completed_after([](Scene& s) { s.meshes[0].material = 1; })->meshes.at(0).material, 0);
  EXPECT_EQ(completed_after([](Scene& s) { s.materials[0].texture = 1; })->materials.at(0).texture, kNoTexture);
}

}  // namespace
}  // namespace umbrage::test
