// Runs umbrage-import or umbrage-import-cad in a child process; importer/common/serve_import.cpp is the code in the
// child. The child is spawned instead of forked: after fork alone, the child of a program with threads may not even
// allocate memory, and copying the page tables of a large program costs more than starting a small one
// (docs/reliability.md).
#include "scene/readers/import_in_child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "scene/readers/content.h"
#include "scene/readers/transfer.h"
#include "system/child_process.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

/// A program that reads models.
struct ImportProgram {
  const char *name, *variable;  ///< variable: the environment variable of its path
  const char* what_to_install;
};

const ImportProgram& program_for(const std::string& format) {
  static constexpr ImportProgram kAll{"umbrage-import", "UMBRAGE_IMPORT", "it"},
      kCad{"umbrage-import-cad", "UMBRAGE_IMPORT_CAD", "the package umbrage-import-cad"};
  return is_cad(format) ? kCad : kAll;
}

/// Moves a descriptor to a number that is not one of the child's, so that the child's dup2 calls do not close it.
Descriptor moved_to_free_number(int number) {
  constexpr int kFirstFree = 10;
  const Descriptor low(number);
  Descriptor moved(number < 0 ? -1 : ::fcntl(number, F_DUPFD_CLOEXEC, kFirstFree));
  if (moved.file() < 0 && errno == EINVAL) errno = EMFILE;  // no more than kFirstFree files may be open (ulimit -n)
  return moved;
}

/// How a child process ended.
struct ChildExit {
  int status = 0;        ///< status of wait4
  double seconds = 0.0;  ///< processor time, or elapsed time if SIGALRM ended it
  bool known = false;    ///< false if the host ignores its children (SIGCHLD)
};

ChildExit wait_for(pid_t child, std::chrono::steady_clock::time_point started) {
  ChildExit ended;
  rusage used{};
  pid_t waited = 0;
  do waited = ::wait4(child, &ended.status, 0, &used);
  while (waited < 0 && errno == EINTR);
  ended.known = waited == child;
  for (const timeval& time : {used.ru_utime, used.ru_stime})
    ended.seconds += double(time.tv_sec) + 1e-6 * double(time.tv_usec);
  if (WIFSIGNALED(ended.status) && WTERMSIG(ended.status) == SIGALRM)
    ended.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return ended;
}

/// Returns the error for a process that ended without a result.
Error error_of_child(const fs::path& file, const ChildExit& ended) {
  const int signal = ended.known && WIFSIGNALED(ended.status) ? WTERMSIG(ended.status) : 0;
  if (signal == SIGXCPU || signal == SIGALRM)
    return file_error("'{}' is damaged or too complex; its reader was stopped after {:.0f} s", file.string(),
                      ended.seconds);
  if (signal == SIGKILL)
    return file_error("'{}' is damaged or needs more memory than is available; the system ended its reader",
                      file.string());
  return file_error("'{}' is damaged; its reader crashed on it{}", file.string(),
                    signal ? fmt::format(" ({})", ::strsignal(signal)) : "");
}

}  // namespace

fs::path import_program(const std::string& format) {
  const ImportProgram& program = program_for(format);
  if (const char* configured = std::getenv(program.variable); configured && *configured) return configured;
  return find_helper(program.name);
}

namespace {

/// Waits for the byte that marks a complete result, or for the end of the pipe, and calls the poll meanwhile. Returns 1
/// if the byte has arrived.
ssize_t wait_for_byte(int pipe, Poll* poll) {
  while (poll) {
    pollfd ready{.fd = pipe, .events = POLLIN, .revents = 0};
    if (::poll(&ready, 1, int(kMonitorInterval.count())) != 0 && errno != EINTR) break;
    if (ready.revents != 0) break;
    if (poll->ask(0.0)) return 0;
  }
  char byte = 0;
  ssize_t byte_count = 0;
  do byte_count = ::read(pipe, &byte, 1);
  while (byte_count < 0 && errno == EINTR);
  return byte_count;
}

/// Runs the program for a format with these arguments, which name the file, and receives its result.
template <class T>
Result<T> read_in_child_process(const fs::path& file, const std::string& format, const std::vector<std::string>& words,
                                std::optional<Result<T>> (*receive)(int), Poll* poll) {
  const fs::path program = import_program(format);
  if (const ImportProgram& wanted = program_for(format); program.empty())
    return file_error("'{}' cannot be read: the program {} is missing; install {}, or set {} to its path",
                      file.string(), wanted.name, wanted.what_to_install, wanted.variable);
  Descriptor result = moved_to_free_number(::memfd_create("umbrage-scene", MFD_CLOEXEC));
  int pipe_ends[2] = {-1, -1};
  Descriptor reported, done;
  if (::pipe2(pipe_ends, O_CLOEXEC) == 0)
    reported = moved_to_free_number(pipe_ends[0]), done = moved_to_free_number(pipe_ends[1]);
  if (result.file() < 0 || reported.file() < 0 || done.file() < 0)
    return file_error("'{}' cannot be read: {}", file.string(), std::strerror(errno));
  const auto started = std::chrono::steady_clock::now();
  // The child's standard output and error are discarded: users get the returned error instead.
  const ChildProgram reader{.program = fs::absolute(program),  // absolute, so that PATH is not searched
                            .words = words,
                            .files = {{STDIN_FILENO},
                                      {STDOUT_FILENO},
                                      {STDERR_FILENO},
                                      {kImportResult, result.file()},
                                      {kImportDone, done.file()}}};
  pid_t child = 0;
  if (const int failed = start_child(reader, child))
    return file_error("'{}' cannot be read: the program '{}' does not start ({})", file.string(), program.string(),
                      std::strerror(failed));
  done.close();  // now only the child can write to the pipe, so the pipe closes when the child exits
  const ssize_t byte_count = wait_for_byte(reported.file(), poll);
  if (poll && poll->ended()) {
    ::kill(child, SIGKILL);
    wait_for(child, started);
    return interrupted();
  }
  std::optional<Result<T>> received;
  if (byte_count == 1) received = receive(result.file());
  const ChildExit ended = wait_for(child, started);
  if (received) return std::move(*received);
  if (byte_count == 1)
    return file_error("'{}' cannot be read: '{}' has another version than this program", file.string(),
                      program.string());
  return error_of_child(file, ended);
}

}  // namespace

Result<Scene> import_in_child_process(const fs::path& file, const ImportSettings& settings, Poll* poll) {
  const auto number = [](float v) { return fmt::format("{}", v); };
  const auto index = [](const std::optional<int>& v) { return fmt::format("{}", v.value_or(kNoIndex)); };
  return read_in_child_process<Scene>(
      file, format_of_file(file),
      {file.string(), number(settings.crease_angle_deg.value_or(kNoAngle)), number(settings.up.x),
       number(settings.up.y), number(settings.up.z), index(settings.scene_index), index(settings.animation_index),
       number(settings.animation_time), settings.file_lights ? "1" : "0",
       settings.field ? kFieldMark + *settings.field : "", fmt::format("{}", settings.picture_px),
       fmt::format("{}", settings.fitted_px)},
      receive_import, poll);
}

Result<Panorama> read_panorama_in_child_process(const fs::path& file, Poll* poll) {
  return read_in_child_process<Panorama>(file, "", {kPanoramaOption, file.string()}, receive_panorama, poll);
}

}  // namespace umbrage
