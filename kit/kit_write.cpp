// Writes kits, and translates their shaders with glslc and spirv-cross.
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "io/image_file.h"
#include "kit/kit.h"
#include "system/child_process.h"
#include "system/machine.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

/// Runs a program of the system, which translates `shader`. Errors: kDevice if it is missing or fails.
Result<void> run_translator(const std::string& program, std::vector<std::string> words, const std::string& shader,
                            ShaderLanguage language) {
  pid_t child = 0;
  ChildProgram start{
      .program = program, .words = std::move(words), .files = {{.number = 0}, {.number = 1}, {.number = 2, .from = 2}}};
  int status = -1;
  if (start_child(start, child) != 0)
    return device_error("the language {} needs the program {}, which is missing: install the package {}",
                        language_name(language), program, program);
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    return device_error("{} cannot translate the shader {}", program, shader);
  return {};
}

Result<std::string> content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream) return file_error("{} cannot be read", file.string());
  return text.str();
}

/// Returns the comment at the start of a shader in GLSL.
std::string first_comment(const std::string& shader) {
  const std::size_t begin = shader.find('\n') + 1;
  std::size_t end = begin;
  while (shader.compare(end, 2, "//") == 0) end = shader.find('\n', end) + 1;
  return shader.substr(begin, end - begin);
}

/// Returns a shader in the language of the kit. `stage`: "frag" or "vert".
Result<KitFile> translated(const KitFile& file, const char* stage, ShaderLanguage language, const fs::path& folder) {
  const std::string stem = file.name.substr(0, file.name.rfind('.'));
  const fs::path source = folder / (stem + "." + stage), binary = folder / (stem + ".spv"),
                 out = folder / (stem + ".out");
  if (auto status = write_text(source, file.text); !status) return status.error();
  const std::string stage_word = fmt::format("-fshader-stage={}", stage);
  if (auto status = run_translator(
          "glslc", {stage_word, "--target-env=vulkan1.1", "-o", binary.string(), source.string()}, file.name, language);
      !status)
    return status.error();
  const fs::path* result = &binary;
  if (language != ShaderLanguage::kSpirv) {
    std::vector<std::string> words = {binary.string(), "--output", out.string()};
    if (language == ShaderLanguage::kHlsl) words.insert(words.end(), {"--hlsl", "--shader-model", "50"});
    if (language == ShaderLanguage::kMsl) words.insert(words.end(), {"--msl", "--msl-version", "20000"});
    if (auto status = run_translator("spirv-cross", words, file.name, language); !status) return status.error();
    result = &out;
  }
  auto text = content_of(*result);
  if (!text) return text.error();
  if (language != ShaderLanguage::kSpirv) *text = first_comment(file.text) + *text;
  return KitFile{
      stem + (stage == std::string_view("vert") ? "_vertex" : "") + std::string(language_extension(language)), *text};
}

/// Returns the names of the files of the kit that a folder holds; empty if it holds none.
std::set<std::string> files_of_former_kit(const std::string& folder) {
  std::ifstream stream(fs::path(folder) / "pass.json");
  const auto record = nlohmann::json::parse(stream, nullptr, false);
  std::set<std::string> names;
  if (record.is_object() && record.contains("umbrage") && record.contains("files") && record["files"].is_array())
    for (const auto& name : record["files"])
      if (name.is_string()) names.insert(name.get<std::string>());
  return names;
}

/// Returns all files of a kit.
Result<std::vector<KitFile>> files_of(const Kit& kit) {
  const bool is_gl = is_opengl(kit.language);
  std::vector<KitFile> shaders = kit.shaders;
  shaders.push_back({"linear_depth.frag", linear_depth_shader(kit.language)});
  const KitFile triangle{"screen.vert", triangle_shader(kit.language)};
  std::vector<KitFile> files;
  if (is_gl) {
    files = shaders;
    files.push_back(triangle);
  } else {
    const auto folder = TemporaryFolder::create();
    if (!folder) return folder.error();
    for (const KitFile& shader : shaders) {
      auto file = translated(shader, "frag", kit.language, folder->path());
      if (!file) return file.error();
      files.push_back(std::move(*file));
    }
    auto file = translated(triangle, "vert", kit.language, folder->path());
    if (!file) return file.error();
    files.push_back(std::move(*file));
  }
  if (kit.language == ShaderLanguage::kGlslEs)
    files.push_back({"frame.js", kit_script(kit, files)});
  else
    files.push_back({"frame.h", kit_header(kit)});
  files.push_back({"README.md", kit_readme(kit)});
  std::vector<std::string> names = {"pass.json"};
  for (const KitFile& file : files) names.push_back(file.name);
  files.push_back({"pass.json", kit_json(kit, names)});
  return files;
}

}  // namespace

Result<void> write_kit(const Kit& kit, const std::string& folder) {
  if (folder.empty()) return usage_error("-o names no folder");
  const auto files = files_of(kit);
  if (!files) return files.error();
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    return usage_error("'{}' is a file; -o names the folder for the shaders", folder);
  const std::set<std::string> former = files_of_former_kit(folder);
  std::set<std::string> stale;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!former.count(name))
      return usage_error("the folder '{}' holds other files, such as '{}'; name a new folder", folder, name);
    stale.insert(name);
  }
  fs::create_directories(folder, error);
  if (error) return file_error("the folder '{}' cannot be made ({})", folder, error.message());
  for (auto file = files->rbegin(); file != files->rend(); ++file) {  // pass.json first, which names the others
    if (auto status = write_text(fs::path(folder) / file->name, file->text); !status) return status.error();
    stale.erase(file->name);
  }
  for (const std::string& name : stale) fs::remove(fs::path(folder) / name, error);
  return {};
}

}  // namespace umbrage
