#include "gbuffers/unused_settings.h"

#include <fmt/format.h>

namespace umbrage {

std::vector<std::string> unused_settings(const GBufferSettings& settings, const DepthConvention& depth) {
  const GBufferSettings initial;
  const DepthMeaning meaning = depth.model.meaning;
  const bool is_buffer =
      !depth.from_position && (meaning == DepthMeaning::kWindow || meaning == DepthMeaning::kReversed);
  struct Setting {
    const char* field;
    bool is_set, is_used;
    const char* why;
  };
  const char* no_buffer = "the depth is not that of a depth buffer; try `depth_kind` window";
  const Setting all[] = {
      {"near_plane", settings.near_plane != initial.near_plane, is_buffer, no_buffer},
      {"far_plane", settings.far_plane != initial.far_plane, is_buffer, no_buffer},
      {"cell_size", settings.cell_size.has_value(), meaning == DepthMeaning::kHeight,
       "the depth is no elevation; try `depth_kind` height"},
      {"depth_range", !settings.depth_range.empty(), !depth.from_position, "the depth is that of the positions"}};
  std::vector<std::string> sentences;
  for (const Setting& setting : all)
    if (setting.is_set && !setting.is_used)
      sentences.push_back(fmt::format("`{}` does nothing: {}", setting.field, setting.why));
  return sentences;
}

}  // namespace umbrage
