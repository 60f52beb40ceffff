// Finding the files that a model names: paths in models are often valid only on the machine that wrote them.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

namespace umbrage {

/// Finds the files of one model. Lists each folder once.
class FileFinder {
 public:
  explicit FileFinder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Does the work of find_file.
  std::optional<std::filesystem::path> find(std::string name);

 private:
  using Entries = std::unordered_map<std::string, std::string>;  ///< names by their lower case

  std::optional<std::filesystem::path> find_ignoring_case(const std::filesystem::path& folder,
                                                          const std::filesystem::path& relative);
  const Entries& entries_of(const std::filesystem::path& folder);

  std::filesystem::path folder_;
  std::map<std::string, Entries> entries_;  ///< by folder
};

/// Returns the regular file that a model in `folder` names: at this path, else ignoring case, else at the longest end
/// of the path that exists beside the model: "C:\work\maps\a.png" may be maps/a.png or a.png.
std::optional<std::filesystem::path> find_file(const std::filesystem::path& folder, std::string name);

}  // namespace umbrage
