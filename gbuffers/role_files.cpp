// The files of a G-buffer's settings, and what each is for.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "gbuffers/roles.h"

namespace umbrage {
namespace {

/// Splits "FILE:LAYER" at its last colon, unless the whole is the name of a file.
void split_layer(const std::string& text, RoleFile& file) {
  std::error_code ignored;
  const std::size_t colon = text.rfind(':');
  file.path = text;
  if (colon == std::string::npos || colon == 0 || std::filesystem::exists(text, ignored)) return;
  if (!std::filesystem::exists(text.substr(0, colon), ignored)) return;
  file.path = text.substr(0, colon);
  file.layer = text.substr(colon + 1);
}

}  // namespace

std::vector<std::string> component_files(const std::string& text) {
  const std::size_t first = text.find(','), second = first == std::string::npos ? first : text.find(',', first + 1);
  std::error_code ignored;
  if (second == std::string::npos || std::filesystem::exists(text, ignored)) return {text};
  std::vector<std::string> files = {text.substr(0, first), text.substr(first + 1, second - first - 1),
                                    text.substr(second + 1)};
  const bool are_images =
      std::all_of(files.begin(), files.end(), [](const std::string& file) { return has_image_extension(file); });
  return are_images ? files : std::vector{text};
}

std::vector<RoleFile> role_files(const GBufferSettings& settings) {
  std::vector<RoleFile> files;
  const auto add = [&](std::string_view field, const std::string& text, Role role, bool all_roles) {
    const std::vector<std::string> words = all_roles ? std::vector{text} : component_files(text);
    for (const std::string& word : words) {
      if (word.empty()) continue;
      files.push_back({role, all_roles, {}, {}, words.size() > 1, field});
      split_layer(word, files.back());
    }
  };
  add("file", settings.file, Role::kDepth, true);
  add("depth_file", settings.depth_file, Role::kDepth, false);
  add("normal_file", settings.normal_file, Role::kNormal, false);
  add("albedo_file", settings.albedo_file, Role::kAlbedo, false);
  add("beauty_file", settings.beauty_file, Role::kBeauty, false);
  add("position_file", settings.position_file, Role::kPosition, false);
  add("id_file", settings.id_file, Role::kObjectId, false);
  add("motion_file", settings.motion_file, Role::kMotion, false);
  return files;
}

}  // namespace umbrage
