// Files that pages upload, and the private folder that holds them and saved pictures. A drop is what a user dropped on
// a page at once, and its files share a folder, so that a model finds its textures.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "core/result.h"
#include "system/machine.h"

namespace umbrage::view {

/// Limits in bytes of all files of one drop and of all drops, and the number of all files.
struct UploadLimits {
  std::int64_t drop = std::int64_t(1) << 30;
  std::int64_t total = std::int64_t(4) << 30;
  int files = 10000;
};

/// Returns the name under which a file is stored: the last component of a path. Errors: kUsage for none, `.`, `..`,
/// control characters, or more than 255 bytes.
Result<std::string> upload_name(std::string_view path);

/// The uploaded files of a program. All functions may be called by several threads.
class Uploads {
 public:
  enum class Failure { kInvalid, kTooLarge, kExists, kBroken };
  struct Refusal {
    Failure failure;
    std::string sentence;
  };
  /// Fills a buffer; returns the number of bytes, <= 0 at the end or after an error.
  using Read = std::function<long(char* buffer, std::size_t size)>;

  Uploads(std::filesystem::path folder, UploadLimits limits) : folder_(std::move(folder)), limits_(limits) {}

  /// Stores a file of `size` bytes. `drop`: 1 to 32 of a-z and 0-9. Sets `file` to "DROP/NAME", or returns why not;
  /// then nothing is stored. Refuses before it reads if the size exceeds a limit.
  std::optional<Refusal> add(std::string_view drop, std::string_view name, std::int64_t size, const Read& read,
                             std::string& file);

  /// Returns the path of a complete file "DROP/NAME". Errors: kFile.
  Result<std::filesystem::path> path_of(const std::string& file) const;

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::optional<Refusal> reserve(const std::string& drop, const std::string& file, std::int64_t size);
  void give_back(const std::string& drop, const std::string& file, std::int64_t size);

  std::filesystem::path folder_;
  UploadLimits limits_;
  mutable std::mutex mutex_;
  std::unordered_map<std::string, std::int64_t> drops_;  ///< bytes of each drop
  std::unordered_map<std::string, bool> files_;          ///< whether a file is complete
  std::int64_t total_ = 0;
};

}  // namespace umbrage::view
