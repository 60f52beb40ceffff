// All readers of external files and texts as functions of bytes, for fuzzers and for a short test.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage::fuzz {

/// Reads any bytes as one kind of file or text. Aborts if the result violates a guarantee: an index out of range, or an
/// error message that is not one line.
struct Reader {
  std::string_view name;
  void (*read)(std::string_view bytes);
  std::vector<std::string> (*seeds)();  ///< small valid files
  bool by_library;  ///< a third-party library reads it and may crash, in its own process (import_in_child_process)
};

std::span<const Reader> readers();

}  // namespace umbrage::fuzz
