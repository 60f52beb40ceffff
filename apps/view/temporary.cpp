#include "apps/view/temporary.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>

namespace umbrage::view {
namespace {

namespace fs = std::filesystem;

// Paths and processes for a signal handler. A path is complete before its slot is used, and the slots of processes are
// lock-free. If all slots are taken, signals leave a folder or a process behind.
constexpr int kMaxFolders = 8, kMaxChildren = 64;
constexpr std::size_t kMaxPathLength = 4096;
struct FolderSlot {
  std::atomic<int> state = 0;  ///< 0: free, 1: being filled, 2: in use
  char path[kMaxPathLength] = {};
};
constexpr int kFree = 0, kFilling = 1, kUsed = 2;
FolderSlot folders[kMaxFolders];
std::atomic<pid_t> children[kMaxChildren];
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<pid_t>::is_always_lock_free);

void list_folder(const std::string& path) {
  for (FolderSlot& slot : folders) {
    int free = kFree;
    if (path.size() >= kMaxPathLength || !slot.state.compare_exchange_strong(free, kFilling)) continue;
    std::strcpy(slot.path, path.c_str());
    slot.state = kUsed;
    return;
  }
}

void unlist_folder(const std::string& path) {
  for (FolderSlot& slot : folders)
    if (slot.state == kUsed && path == slot.path) slot.state = kFree;
}

/// The fixed start of an entry that getdents64 returns; its name follows.
struct Entry {
  ino64_t inode;
  off64_t next;
  unsigned short length;
  unsigned char type;
};
constexpr std::size_t kNameOffset = offsetof(Entry, type) + 1;

/// Removes what a folder holds: files, and folders down to `depth` levels. Async-signal-safe, unlike opendir.
void remove_contents(int folder, int depth) {
  alignas(Entry) char entries[4096];
  for (;;) {
    const long size = ::syscall(SYS_getdents64, folder, entries, sizeof entries);
    if (size <= 0) return;
    for (long at = 0; at < size;) {
      Entry entry;
      std::memcpy(&entry, entries + at, kNameOffset);
      const char* name = entries + at + kNameOffset;
      at += entry.length;
      if (std::strcmp(name, ".") == 0 || std::strcmp(name, "..") == 0 || ::unlinkat(folder, name, 0) == 0) continue;
      const int inner = depth > 0 ? ::openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC) : -1;
      if (inner < 0) continue;
      remove_contents(inner, depth - 1);
      ::close(inner);
      ::unlinkat(folder, name, AT_REMOVEDIR);
    }
  }
}

void remove_folder(const char* path) {
  const int folder = ::open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (folder < 0) return;
  remove_contents(folder, 1);
  ::close(folder);
  ::rmdir(path);
}

}  // namespace

Result<TemporaryFolder> TemporaryFolder::create() {
  std::error_code code;
  const fs::path place = fs::temp_directory_path(code);
  std::string path = (place / "umbrage-view-XXXXXX").string();
  if (code || !::mkdtemp(path.data()))  // mkdtemp lets only the owner in
    return file_error("the temporary folder for uploads cannot be created in '{}'", place.string());
  list_folder(path);
  return TemporaryFolder(path);
}

TemporaryFolder::~TemporaryFolder() {
  if (path_.empty()) return;
  remove_folder(path_.c_str());
  unlist_folder(path_.string());
}

ListedChild::ListedChild(pid_t child) {
  for (int slot = 0; slot < kMaxChildren && slot_ < 0; ++slot) {
    pid_t free = 0;
    if (children[slot].compare_exchange_strong(free, child)) slot_ = slot;
  }
}

ListedChild::~ListedChild() {
  if (slot_ >= 0) children[slot_] = 0;
}

void abandon_view() {
  // First end the processes, which could otherwise create files again.
  for (std::atomic<pid_t>& child : children)
    if (const pid_t pid = child; pid > 0) {
      ::kill(pid, SIGKILL);
      while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) continue;
    }
  for (FolderSlot& slot : folders)
    if (slot.state == kUsed) remove_folder(slot.path);
}

}  // namespace umbrage::view
