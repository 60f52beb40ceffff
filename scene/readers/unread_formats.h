// Formats that people have and Umbrage does not read, with the way to one that it reads.
#pragma once
#include <string>
#include <string_view>

namespace umbrage {

/// Returns what a format is and how to convert it, as "a CAD format that is not read; ..."; empty for formats that are
/// not known. `format`: as import_format returns it.
std::string conversion_advice(std::string_view format);

}  // namespace umbrage
