// Runs the program on every file of some folders and counts the results: umbrage_torture FOLDER... Model files are
// passed to umbrage itself; all others are read as images in a child process. Prints a line for each file that crashed
// or took more than 10 s or 2 GB, and a table by folder. The exit code is 1 if there was such a file.
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include "core/lists.h"
#include "core/lowercase.h"
#include "io/image_file.h"
#include "scene/readers/import.h"

namespace {

namespace fs = std::filesystem;

constexpr double kMaxSeconds = 10.0, kMaxMegabytes = 2000.0;

struct Counts {
  int tried = 0, refused = 0, read = 0, crashed = 0;
  double seconds = 0.0, megabytes = 0.0;  ///< max of one file
};

bool is_model(const fs::path& file) {
  const std::string extension = umbrage::lowercase(file.extension().string());
  return !extension.empty() && umbrage::contains(umbrage::import_formats(), extension.substr(1));
}

/// Handles a file in the child process. The limit of processor time ends the process if it does not end by itself.
[[noreturn]] void run(const fs::path& file, const fs::path& output) {
  const rlimit max{rlim_t(4 * kMaxSeconds), RLIM_INFINITY}, no_core{0, 0};
  ::setrlimit(RLIMIT_CPU, &max);
  ::setrlimit(RLIMIT_CORE, &no_core);
  const int null_device = ::open("/dev/null", O_RDWR);
  for (const int standard : {0, 1, 2}) ::dup2(null_device, standard);
  if (is_model(file)) {
    ::execl(UMBRAGE_PROGRAM, "umbrage", file.c_str(), "-o", output.c_str(), "--resolution", "128,128", nullptr);
    std::_Exit(1);
  }
  std::_Exit(umbrage::read_image(file) ? 0 : 3);
}

void try_file(const fs::path& file, const fs::path& output, Counts& counts) {
  std::error_code ignored;
  fs::remove(output, ignored);
  const pid_t child = ::fork();
  if (child == 0) run(file, output);
  int status = 0;
  rusage used{};
  ::wait4(child, &status, 0, &used);
  const double seconds = double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                         1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec),
               megabytes = double(used.ru_maxrss) / 1e3;
  ++counts.tried;
  counts.seconds = std::max(counts.seconds, seconds);
  counts.megabytes = std::max(counts.megabytes, megabytes);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  const bool is_consistent = !is_model(file) || fs::exists(output, ignored) == (code == 0);
  if ((code != 0 && code != 3) || !is_consistent || seconds > kMaxSeconds || megabytes > kMaxMegabytes) {
    ++counts.crashed;
    std::printf("%s: exit code %d, %.1f s, %.0f MB%s\n", file.c_str(), code, seconds, megabytes,
                is_consistent ? "" : ", and its picture is not as its exit code says");
  } else {
    ++(code == 0 ? counts.read : counts.refused);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "umbrage_torture: name folders of files to try\n");
    return 2;
  }
  std::string folder = (fs::temp_directory_path() / "umbrage-torture-XXXXXX").string();
  if (!::mkdtemp(folder.data())) return 1;
  std::map<std::string, Counts> by_folder;
  for (int i = 1; i < argc; ++i) {
    std::error_code error;
    for (fs::recursive_directory_iterator entry(argv[i], error), end; !error && entry != end; entry.increment(error)) {
      if (!entry->is_regular_file()) continue;
      const std::string name = fs::relative(entry->path().parent_path(), fs::path(argv[i]).parent_path()).string();
      try_file(entry->path(), fs::path(folder) / "out.png", by_folder[name]);
    }
    if (error) std::fprintf(stderr, "umbrage_torture: %s: %s\n", argv[i], error.message().c_str());
  }
  fs::remove_all(folder);
  std::printf(
      "| folder | tried | refused | read | crashed | most time | most memory |\n|---|---|---|---|---|---|---|\n");
  Counts total;
  const auto row = [](const std::string& name, const Counts& c) {
    std::printf("| %s | %d | %d | %d | %d | %.1f s | %.0f MB |\n", name.c_str(), c.tried, c.refused, c.read, c.crashed,
                c.seconds, c.megabytes);
  };
  for (const auto& [name, counts] : by_folder) {
    row(name, counts);
    total.tried += counts.tried, total.refused += counts.refused, total.read += counts.read,
        total.crashed += counts.crashed;
    total.seconds = std::max(total.seconds, counts.seconds),
    total.megabytes = std::max(total.megabytes, counts.megabytes);
  }
  row("all", total);
  return total.tried > 0 && total.crashed == 0 ? 0 : 1;
}
