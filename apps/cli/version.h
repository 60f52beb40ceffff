// The text of umbrage --version.
#pragma once
#include <string>

namespace umbrage::cli {

/// Returns the version, the commit that was built, and the instruction sets and devices that this machine has, each in
/// a line that ends with a line feed.
std::string version_text();

}  // namespace umbrage::cli
