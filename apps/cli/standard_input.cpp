#include "apps/cli/standard_input.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <random>
#include <utility>

#include "core/lists.h"
#include "core/suggest.h"
#include "scene/readers/content.h"
#include "scene/readers/gzip.h"
#include "system/machine.h"

namespace umbrage::cli {
namespace {

namespace fs = std::filesystem;

// Paths of the folder and file that remove_standard_input_copy removes; empty: none.
constexpr std::size_t kMaxPathLength = 4096;
char copy_folder[kMaxPathLength], copy_file[kMaxPathLength];

/// Replaces the name of the temporary file in a message by "standard input".
Error name_standard_input(Error error) {
  const std::string name = fmt::format("'{}'", copy_file);
  if (const auto at = error.message.find(name); at != std::string::npos)
    error.message.replace(at, name.size(), "standard input");
  return error;
}

/// Returns the bytes of standard input. `what`: of what, for an error.
Result<std::string> read_standard_input(std::string_view what) {
  if (::isatty(STDIN_FILENO)) return usage_error("- reads {} from standard input, which is a terminal", what);
  std::string bytes;
  constexpr std::size_t kStep = 1 << 20;
  while (!std::feof(stdin)) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kStep);
    const std::size_t count = std::fread(bytes.data() + before, 1, kStep, stdin);
    bytes.resize(before + count);
    if (std::ferror(stdin)) return file_error("standard input cannot be read");
  }
  if (bytes.empty()) return file_error("standard input is empty");
  return bytes;
}

/// Writes a copy of standard input to a temporary file and returns its path.
Result<fs::path> store_copy(const std::string& bytes, const std::string& extension) {
  const auto temporary = temporary_folder();
  if (!temporary) return temporary.error();
  std::random_device random;
  const std::string folder = (*temporary / fmt::format("umbrage-{:08x}{:08x}", random(), random())).string();
  const std::string file = folder + "/stdin." + extension;
  const auto not_copied = [&](int cause) {
    return file_error("standard input cannot be copied to '{}': {}", folder, std::strerror(cause));
  };
  if (file.size() >= kMaxPathLength) return not_copied(ENAMETOOLONG);
  // Store the paths before the folder and file exist, so that the signal handler can always remove both. The first byte
  // of a path is written last, since the handler ignores a path whose first byte is zero.
  for (const auto& [stored, name] : {std::pair(copy_folder, &folder), {copy_file, &file}}) {
    std::strcpy(stored + 1, name->c_str() + 1);
    std::atomic_signal_fence(std::memory_order_seq_cst);
    stored[0] = name->front();
  }
  constexpr mode_t kOwnerOnly = 0700;
  if (::mkdir(folder.c_str(), kOwnerOnly) != 0) {
    const int cause = errno;
    copy_file[0] = copy_folder[0] = '\0';
    return not_copied(cause);
  }
  std::FILE* stream = std::fopen(file.c_str(), "wbx");
  const bool written = stream && std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size();
  const int cause = errno;
  if (!stream || std::fclose(stream) != 0 || !written) return not_copied(stream && written ? errno : cause);
  return fs::path(file);
}

/// Copies a model on standard input to a temporary file and returns its path.
Result<fs::path> copy_standard_input(const std::string& format) {
  const auto bytes = read_standard_input("a model");
  if (!bytes) return bytes.error();
  const std::string start = is_gzip(*bytes) ? inflated_start(*bytes, kContentBytes) : std::string();
  const bool is_whole = start.empty() || start.size() < kContentBytes;
  const std::string_view content = start.empty() ? *bytes : start;
  const std::string extension = format.empty() ? format_of_content(content, is_whole ? content.size() : 0) : format;
  if (extension.empty()) return file_error("standard input has an unknown format; name it with --input-format");
  return store_copy(*bytes, extension);
}

struct RemoveCopyAtEnd {
  ~RemoveCopyAtEnd() { remove_standard_input_copy(); }
};

}  // namespace

void remove_standard_input_copy() {
  if (copy_file[0]) ::unlink(copy_file);
  if (copy_folder[0]) ::rmdir(copy_folder);
  copy_file[0] = copy_folder[0] = '\0';
}

Result<void> check_standard_input(const std::vector<std::string>& models, const std::string& format) {
  const auto& formats = import_formats();
  if (!format.empty() && !contains(formats, format))
    return field_error("--input-format", format, "{} cannot be '{}'{}", suggestion(format, formats));
  const auto count = std::count(models.begin(), models.end(), "-");
  if (count > 1) return usage_error("- stands for standard input, which can be read once");
  if (count == 0 && !format.empty())
    return field_error("--input-format", format, "{} applies to a model on standard input only: name the model -");
  return {};
}

Result<Scene> load_models(const std::vector<std::string>& models, const std::string& format,
                          const ImportSettings& settings) {
  if (auto status = check_standard_input(models, format); !status) return status.error();
  if (!contains(models, "-")) return load_scenes(models, settings);
  const RemoveCopyAtEnd remove_copy;
  const auto file = copy_standard_input(format);
  if (!file) return file.error();
  std::vector<std::string> files = models;
  std::replace(files.begin(), files.end(), std::string("-"), file->string());
  auto scene = load_scenes(files, settings);
  if (!scene) return name_standard_input(scene.error());
  return scene;
}

Result<void> with_image_on_standard_input(const std::function<Result<void>(const std::string& file)>& work) {
  const RemoveCopyAtEnd remove_copy;
  const auto bytes = read_standard_input("an image");
  if (!bytes) return bytes.error();
  const auto file = store_copy(*bytes, "image");
  if (!file) return file.error();
  auto status = work(file->string());
  return status ? status : Result<void>(name_standard_input(status.error()));
}

std::function<Result<Scene>(const std::string&, const ImportSettings&)> loader_of(const CommonOptions& o) {
  return [format = o.input_format](const std::string& model, const ImportSettings& settings) {
    return load_models({model}, model == "-" ? format : "", settings);
  };
}

}  // namespace umbrage::cli
