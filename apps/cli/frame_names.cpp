#include "apps/cli/frame_names.h"

#include <charconv>
#include <filesystem>

namespace umbrage::cli {

std::string FrameNames::of(int frame) const { return fmt::format("{}{:0{}}{}", before, frame, digits, after); }

Result<FrameNames> frame_names(const std::string& output) {
  const auto wrong = [&] {
    return usage_error("--output cannot be '{}': it takes one frame number, such as %04d; write %% for a percent sign",
                       output);
  };
  FrameNames names;
  bool numbered = false;
  for (std::size_t at = 0; at < output.size(); ++at) {
    std::string& part = numbered ? names.after : names.before;
    if (output[at] != '%' || output.compare(at, 2, "%%") == 0) {
      part += output[at];
      if (output[at] == '%') ++at;
      continue;
    }
    const std::size_t end = output.find_first_not_of("0123456789", at + 1);
    const std::string width = output.substr(at + 1, end == std::string::npos ? std::string::npos : end - at - 1);
    constexpr int kMaxDigits = 9;
    if (end == std::string::npos || output[end] != 'd' || numbered || (!width.empty() && width[0] != '0'))
      return wrong();
    if (!width.empty() && (std::from_chars(width.data(), width.data() + width.size(), names.digits).ec != std::errc() ||
                           names.digits > kMaxDigits))
      return wrong();
    names.digits = std::max(names.digits, 1);
    numbered = true;
    at = end;
  }
  if (numbered) return names;
  constexpr int kDefaultDigits = 4;
  const std::filesystem::path plain(names.before);
  names.after = plain.extension().string();
  names.before = names.before.substr(0, names.before.size() - names.after.size()) + "_";
  names.digits = kDefaultDigits;
  return names;
}

}  // namespace umbrage::cli
