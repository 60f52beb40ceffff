// Tests of interrupts at any moment, and of the progress line on a terminal.
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "run_program.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using test::text_of;
using test::Words;
using namespace std::chrono_literals;

class Signals : public test::ProgramTest {
 protected:
  fs::path temporary_;

  void SetUp() override {
    ProgramTest::SetUp();
    temporary_ = root_ / "tmp";
    fs::create_directory(temporary_);
  }

  /// A running program. `alive` is the read end of a pipe that the program and its children hold open.
  struct Running {
    pid_t pid = -1;
    int alive = -1, terminal = -1;
  };

  /// Starts the program in the folder, with its own terminal if requested. `path`: value of PATH; empty: unchanged.
  Running start(const Words& words, const std::string& input = "/dev/null", bool on_terminal = false,
                const std::string& path = "") {
    Running running;
    int ends[2];
    EXPECT_EQ(::pipe(ends), 0);
    int terminal = -1, end = -1;
    winsize size{.ws_row = 24, .ws_col = 60, .ws_xpixel = 0, .ws_ypixel = 0};
    if (on_terminal) {
      EXPECT_EQ(::openpty(&terminal, &end, nullptr, nullptr, &size), 0);
    }
    running.pid = ::fork();
    if (running.pid == 0) {
      const auto into = [](const fs::path& file) { return ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600); };
      ::dup2(::open(input.c_str(), O_RDONLY), STDIN_FILENO);
      ::dup2(into(root_ / "out"), STDOUT_FILENO);
      ::dup2(on_terminal ? end : into(root_ / "err"), STDERR_FILENO);
      ::dup2(ends[1], 9);
      for (const int other : {ends[0], ends[1], terminal, end})
        if (other > 9 || (other > 2 && other < 9)) ::close(other);
      if (::chdir(folder_.c_str()) != 0) ::_exit(1);
      ::setenv("TMPDIR", temporary_.c_str(), 1);
      ::setenv("XDG_CONFIG_HOME", (root_ / "config").c_str(), 1);
      ::setenv("UMBRAGE_DEVICE", "cpu", 1);
      if (!path.empty()) ::setenv("PATH", path.c_str(), 1);
      std::vector<char*> arguments = {const_cast<char*>("umbrage")};
      for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
      arguments.push_back(nullptr);
      ::execv(test::kProgram, arguments.data());
      ::_exit(1);
    }
    ::close(ends[1]);
    if (end >= 0) ::close(end);
    running.alive = ends[0];
    running.terminal = terminal;
    // Wait until the program's signal handlers are installed. Before that, it creates no files.
    wait_for([&] {
      const std::string status = text_of(fmt::format("/proc/{}/status", running.pid));
      const std::size_t caught = status.find("SigCgt:");
      return caught == std::string::npos || (std::stoull(status.substr(caught + 7), nullptr, 16) >> (SIGHUP - 1)) & 1;
    });
    return running;
  }
  Running start(const std::string& line, const std::string& input = "/dev/null") {
    return start(test::words_of(line), input);
  }

  /// Waits until the program and its children have ended. Returns the exit code; -1 if a child is still running.
  int code_of(const Running& running) {
    int status = 0;
    ::waitpid(running.pid, &status, 0);
    pollfd alive{running.alive, POLLIN, 0};
    constexpr int kTimeoutMs = 20'000;
    const bool ended = ::poll(&alive, 1, kTimeoutMs) == 1;
    ::close(running.alive);
    EXPECT_TRUE(ended) << "a child process is still running";
    return ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// Interrupts the program. Expects the exit code, one line of output and no files left.
  void interrupt(const Running& running, const std::set<std::string>& files_before, int signal = SIGINT) {
    ::kill(running.pid, signal);
    EXPECT_EQ(code_of(running), 128 + signal);
    EXPECT_EQ(text_of(root_ / "out"), "");
    EXPECT_EQ(text_of(root_ / "err"), "umbrage: interrupted\n");
    EXPECT_EQ(files(), files_before);
    EXPECT_TRUE(fs::is_empty(temporary_));
  }

  void wait_for(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000 && !condition(); ++i) std::this_thread::sleep_for(10ms);
    EXPECT_TRUE(condition());
  }
};

TEST_F(Signals, EndTheReaderOfAModel) {
  ::setenv("UMBRAGE_IMPORT", test::kFaultyImport, 1);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    write("linger.gltf", "{}");
    const Running running = start("linger.gltf -o out.png");
    wait_for([&] { return fs::exists(folder_ / "linger.gltf.started"); });
    interrupt(running, files(), signal);
    fs::remove(folder_ / "linger.gltf.started");
  }
  ::unsetenv("UMBRAGE_IMPORT");
}

TEST_F(Signals, RemoveTheCopyOfStandardInput) {
  const auto before = files();
  // Interrupts the program while it waits for the pipe, to copy standard input.
  ASSERT_EQ(::mkfifo((root_ / "pipe").c_str(), 0600), 0);
  const int pipe_end = ::open((root_ / "pipe").c_str(), O_RDWR);
  const Running copying = start("- -o out.png", (root_ / "pipe").string());
  std::this_thread::sleep_for(200ms);
  interrupt(copying, before);
  ::close(pipe_end);
  // Interrupts the program while it reads or draws the copy. A large one, since a small one is read in no time.
  std::string large = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 300'000; ++i) large += "f 1 2 3\n";
  std::ofstream(root_ / "large.obj") << large;
  const Running drawing =
      start("- -o out.png --resolution 4000x4000 --ao reference --input-format obj", (root_ / "large.obj").string());
  wait_for([&] { return !fs::is_empty(temporary_) || ::kill(drawing.pid, 0) != 0; });
  interrupt(drawing, before);
}

TEST_F(Signals, LeaveNothingOfAPictureOrAComparison) {
  const auto before = files();
  for (const char* line : {"scene:solids -o out.png --resolution 4000x4000 --quality ultra",
                           "scene:solids -o out.png --ao reference --set reference.samples=4096 --resolution 2000x2000",
                           "compare scene:solids -o report --samples 4096", "tune scene:solids --samples 4096",
                           "figures --paper bleeding -o figures --runs 1000"})
    for (const auto delay : {30ms, 300ms}) {
      SCOPED_TRACE(line);
      const Running running = start(line);
      std::this_thread::sleep_for(delay);
      interrupt(running, before);
    }
}

TEST_F(Signals, LeaveWholeFramesOfATurntable) {
  for (int k = 0; k < 8; ++k) {
    const Running running = start("scene:solids?detail=2000 -o t.png --turntable 2000 --look ao --resolution 160x120");
    wait_for([&] { return fs::exists(folder_ / "t_0002.png"); });
    std::this_thread::sleep_for(k * 3ms);
    ::kill(running.pid, SIGINT);
    EXPECT_EQ(code_of(running), 130);
    for (const auto& entry : fs::directory_iterator(folder_)) {
      const fs::path file = entry.path();
      if (file.filename() == "tri.obj" || file.extension() == ".frames") continue;
      EXPECT_EQ(file.extension(), ".png") << file;
      EXPECT_TRUE(read_image(file)) << file;
      fs::remove(file);
    }
  }
}

TEST_F(Signals, EndFfmpeg) {
  const fs::path bin = root_ / "bin";
  fs::create_directory(bin);
  // This ffmpeg ignores signals and writes its file until its input ends.
  std::ofstream(bin / "ffmpeg") << "#!/bin/sh\nfor last; do :; done\ntrap '' INT TERM HUP\nexec cat >\"$last\"\n";
  ::chmod((bin / "ffmpeg").c_str(), 0755);
  const auto before = files();
  for (const auto delay : {0ms, 100ms}) {
    const Running running =
        start(test::words_of("scene:solids?detail=2000 -o t.mp4 --turntable 100000 --look ao --resolution 160x120"),
              "/dev/null", false, bin.string() + ":/usr/bin:/bin");
    wait_for([&] { return files() != before; });
    std::this_thread::sleep_for(delay);
    interrupt(running, before);
  }
}

// ---- Progress line ----

/// The final content of a terminal's line, and whether `text` was ever on it.
struct Shown {
  std::string line;
  bool seen = false;
};
Shown shown(const std::string& written, const std::string& text) {
  Shown shown;
  std::size_t column = 0;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const char c = written[i];
    if (c == '\r') {
      column = 0;
    } else if (c == '\n') {
      shown.line.clear();
      column = 0;
    } else if (c == '\033' && written.compare(i, 3, "\033[K") == 0) {
      shown.line.resize(std::min(shown.line.size(), column));
      i += 2;
    } else {
      shown.line.resize(std::max(shown.line.size(), column + 1), ' ');
      shown.line[column++] = c;
    }
    shown.seen = shown.seen || shown.line.find(text) != std::string::npos;
  }
  shown.line.erase(shown.line.find_last_not_of(' ') + 1);
  return shown;
}

/// Reads a terminal until `text` appears or the other end is closed. Returns all that was read.
std::string read_terminal(int terminal, const std::string& text) {
  std::string written;
  char bytes[4096];
  pollfd input{terminal, POLLIN, 0};
  constexpr int kTimeoutMs = 60'000;
  while (text.empty() || written.find(text) == std::string::npos) {
    if (::poll(&input, 1, kTimeoutMs) != 1) break;
    const ssize_t count = ::read(terminal, bytes, sizeof bytes);
    if (count <= 0) break;  // EIO if the other end is closed
    written.append(bytes, std::size_t(count));
  }
  return written;
}

TEST_F(Signals, ProgressIsWipedAtTheEnd) {
  const std::string line = "scene:solids?detail=2000 -o t.png --turntable 400 --look ao --resolution 200x150";
  const auto begun = std::chrono::steady_clock::now();
  const Running running = start(test::words_of(line), "/dev/null", true);
  const std::string written = read_terminal(running.terminal, "");
  EXPECT_EQ(code_of(running), 0);
  ::close(running.terminal);
  const Shown end = shown(written, "drawing, ");
  EXPECT_EQ(end.line, "") << written;
  EXPECT_EQ(written.find('\n'), std::string::npos) << written;
  if (std::chrono::steady_clock::now() - begun > 3s) {
    EXPECT_TRUE(end.seen) << written;
  }
  EXPECT_EQ(fs::file_size(root_ / "out"), 0u);
}

TEST_F(Signals, ProgressSaysWhatIsLeftAndFitsTheTerminal) {
  for (const char* line :
       {"scene:solids -o out.png --ao reference --set reference.samples=4096 --resolution 1000x800",
        "scene:solids -o out.png --anti-aliasing 256 --resolution 1000x800",
        "compare scene:solids?detail=2000 -o report --samples 2048", "tune scene:solids?detail=2000 --samples 1024"}) {
    SCOPED_TRACE(line);
    const Running running = start(test::words_of(line), "/dev/null", true);
    std::string written = read_terminal(running.terminal, " left");
    EXPECT_NE(written.find(" %, "), std::string::npos) << written;
    ::kill(running.pid, SIGINT);
    written += read_terminal(running.terminal, "");
    EXPECT_EQ(code_of(running), 130);
    ::close(running.terminal);
    EXPECT_TRUE(written.ends_with("umbrage: interrupted\r\n")) << written;
    // The progress line is wiped before the last line, and no line is wider than the terminal.
    const std::string before = written.substr(0, written.rfind("umbrage: interrupted"));
    EXPECT_EQ(shown(before, "").line, "") << written;
    EXPECT_EQ(before.find('\n'), std::string::npos) << written;
    std::size_t widest = 0;
    for (std::size_t at = 0; at < before.size();) {
      const std::size_t end = std::min(before.find('\r', at), before.size());
      widest = std::max(widest, end - at);
      at = end + 1;
    }
    EXPECT_LT(widest, 60u);
  }
}

}  // namespace
}  // namespace umbrage
