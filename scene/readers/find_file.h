// Finding the files that a model names: paths in models are often valid only on the machine that wrote them.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

namespace umbrage {

/// Returns the regular file that a model in `folder` names: at this path, else ignoring case, else at the longest end
/// of the path that exists beside the model: "C:\work\maps\a.png" may be maps/a.png or a.png.
std::optional<std::filesystem::path> find_file(const std::filesystem::path& folder, std::string name);

}  // namespace umbrage
