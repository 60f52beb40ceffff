#include "apps/view/save.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "renderer/options.h"
#include "system/child_process.h"

namespace umbrage::view {
namespace {

namespace fs = std::filesystem;

/// How often a child process is looked at, ms.
constexpr std::chrono::milliseconds kLook(20);
/// The time in which a cancelled program removes its unfinished file.
constexpr std::chrono::seconds kGrace(3);

bool is_flag(const Option& option) { return std::holds_alternative<FieldOf<bool>>(option.where); }

const char* type_of(std::string_view format) {
  if (format == "png") return "image/png";
  if (format == "jpg") return "image/jpeg";
  if (format == "webp") return "image/webp";
  if (format == "svg") return "image/svg+xml";
  return "image/x-exr";
}

/// The output for errors of a child process, in memory.
struct Errors {
  int file = ::memfd_create("errors", MFD_CLOEXEC);
  Errors() = default;
  Errors(const Errors&) = delete;
  ~Errors() {
    if (file >= 0) ::close(file);
  }

  /// Returns the last line without "umbrage: ", a sentence in any case.
  std::string sentence() const {
    constexpr std::size_t kMaxBytes = 65536;
    std::string text(kMaxBytes, '\0');
    const ssize_t size = ::pread(file, text.data(), text.size(), 0);
    text.resize(std::size_t(std::max<ssize_t>(size, 0)));
    while (text.ends_with('\n')) text.pop_back();
    text.erase(0, text.rfind('\n') + 1);
    constexpr std::string_view kStart = "umbrage: ";
    if (text.starts_with(kStart)) text.erase(0, kStart.size());
    return text.empty() ? "the picture cannot be drawn" : text;
  }
};

/// Runs a program until it ends or is not wanted. Returns whether it succeeded; otherwise `error` is set.
bool run(const ChildProgram& program, const std::function<bool()>& is_wanted, const Errors& errors,
         std::string& error) {
  pid_t child = 0;
  if (const int failed = start_child(program, child); failed != 0) {
    error = fmt::format("the program cannot be started: {}", std::strerror(failed));
    return false;
  }
  int status = 0;
  bool wanted = true;
  std::chrono::steady_clock::time_point last_moment;
  for (;;) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child || (ended < 0 && errno != EINTR)) break;
    const auto now = std::chrono::steady_clock::now();
    if (wanted && !is_wanted()) {
      wanted = false;
      last_moment = now + kGrace;
      ::kill(child, SIGTERM);
    }
    if (!wanted && now > last_moment) ::kill(child, SIGKILL);
    std::this_thread::sleep_for(kLook);
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && wanted) return true;
  error = !wanted             ? "saving was cancelled"
          : WIFEXITED(status) ? errors.sentence()
                              : fmt::format("drawing the picture ended by signal {}", WTERMSIG(status));
  return false;
}

}  // namespace

Result<std::vector<std::string>> save_words(const SaveSubject& subject, const Save& save) {
  const unsigned command = subject.is_gbuffer ? kShade : kRender;
  std::vector<std::string> words = {subject.is_gbuffer ? "shade" : "render"};
  words.insert(words.end(), subject.words.begin(), subject.words.end());
  words.insert(words.end(), {"--config", "none"});
  for (const auto& [name, values] : save.options) {
    if (name == "resolution") continue;  // the size of the picture to save replaces it
    const Option* option = find_option(name, command);
    const bool is_of_picture = option && !std::holds_alternative<std::monostate>(option->where);
    if (!is_of_picture) return usage_error("--{} is not an option of a picture to save", name);
    for (const std::string& value : values) {
      if (!is_flag(*option))
        words.push_back(fmt::format("--{}={}", name, value));
      else if (value == "true")
        words.push_back("--" + name);
      else if (value != "false")
        return usage_error("--{} cannot be '{}': it is a flag, true or false", name, value);
    }
  }
  if (!subject.is_gbuffer) words.push_back(fmt::format("--resolution={},{}", save.width, save.height));
  return words;
}

HttpAnswer save_picture(const SaveSubject& subject, const Save& save, const fs::path& folder,
                        const std::function<bool()>& is_wanted, const fs::path& program) {
  const auto words = save_words(subject, save);
  if (!words) return error_answer(400, words.error().message);
  static std::atomic<int> last_number = 0;
  // A drop has no `-` in its name, so that no file of a drop can be in the way.
  const fs::path file = folder / fmt::format("saved-{}.{}", ++last_number, save.format);
  const Errors errors;
  ChildProgram child{.program = program.string(), .words = *words};
  child.words.insert(child.words.end(), {"-o", file.string()});
  child.files = {{STDIN_FILENO, -1}, {STDOUT_FILENO, -1}, {STDERR_FILENO, errors.file}};
  std::string error;
  std::error_code code;
  if (!run(child, is_wanted, errors, error)) {
    fs::remove(file, code);
    return error_answer(400, error);
  }
  return {.type = type_of(save.format), .file = file, .attachment = subject.stem + "." + save.format};
}

}  // namespace umbrage::view
