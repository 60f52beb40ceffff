#include "apps/cli/info_image.h"

#include <nlohmann/json.hpp>

#include <filesystem>

#include "apps/cli/frame_range.h"
#include "apps/cli/shade_frame.h"
#include "gbuffers/contact_sheet.h"
#include "gbuffers/gbuffer_file.h"
#include "io/image_file.h"
#include "io/layers.h"

namespace umbrage::cli {
namespace {

/// Returns the settings with the command's file in them. Errors: kUsage.
Result<GBufferSettings> settings_of(const CommonOptions& options) {
  GBufferSettings settings = options.request.gbuffer;
  if (options.models.size() > 1)
    return usage_error("info takes one image file, not {}: --depth FILE and others name further ones",
                       options.models.size());
  if (!options.models.empty()) settings.file = options.models[0];
  return settings;
}

/// Returns where a layer is in the contact sheet.
std::string place_text(std::size_t k, int columns) {
  const int at = int(k);
  return fmt::format("row {}, column {}", at / columns + 1, at % columns + 1);
}

}  // namespace

bool has_image(const CommonOptions& options) {
  const GBufferSettings& g = options.request.gbuffer;
  if (options.models.empty()) return !g.depth_file.empty() || !g.position_file.empty();
  const std::string path = path_of(options.models[0]);
  if (has_image_extension(path)) return true;
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) && bool(read_header(path));
}

Result<void> print_image_info(const CommonOptions& options, bool json, const std::string& contact_sheet) {
  auto settings = settings_of(options);
  if (!settings) return settings.error();
  std::string frame_line;
  if (is_sequence(*settings)) {
    const auto files = input_files(*settings);
    if (!files) return files.error();
    const auto sequence = plan_sequence({.frames = "", .shard = "", .overwrite = true}, *files, {});
    if (!sequence) return sequence.error();
    frame_line = fmt::format("frame: {} of {}", sequence->all.front(), frames_text(sequence->all));
    *settings = settings_of_frame(*settings, sequence->all.front());
  }
  auto facts = describe_gbuffer(*settings);
  if (!facts) return facts.error();
  if (!frame_line.empty()) facts->lines.insert(facts->lines.begin(), frame_line);
  ContactSheet sheet;
  if (!contact_sheet.empty()) {
    auto drawn_sheet = draw_contact_sheet(*settings);
    if (!drawn_sheet) return drawn_sheet.error();
    sheet = std::move(*drawn_sheet);
    if (auto written = write_image(contact_sheet, sheet.picture); !written) return written;
  }
  if (json) {
    nlohmann::json records = nlohmann::json::array();
    for (const std::string& layer : facts->layers) records.push_back({{"what", "layer"}, {"name", layer}});
    for (const std::string& line : facts->lines) records.push_back({{"what", "fact"}, {"text", line}});
    for (const std::string& warning : facts->warnings)
      records.push_back({{"what", "warning"}, {"text", with_option_names(warning)}});
    for (std::size_t k = 0; k < sheet.layers.size(); ++k)
      records.push_back({{"what", "contact_sheet"},
                         {"name", sheet.layers[k]},
                         {"row", int(k) / sheet.columns + 1},
                         {"column", int(k) % sheet.columns + 1}});
    fmt::print("{}\n", records.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return {};
  }
  for (const std::string& layer : facts->layers) fmt::print("layer: {}\n", layer);
  for (const std::string& line : facts->lines) fmt::print("{}\n", with_option_names(line));
  for (const std::string& warning : facts->warnings) fmt::print("warning: {}\n", with_option_names(warning));
  for (std::size_t k = 0; k < sheet.layers.size(); ++k)
    fmt::print("contact sheet: {}: {}\n", place_text(k, sheet.columns), sheet.layers[k]);
  return {};
}

}  // namespace umbrage::cli
