// All readers of external files and texts, as functions that take bytes, for fuzzers and a short test.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage::fuzz {

/// A reader of one kind of file or text. `read` takes any bytes. It aborts if the result violates a guarantee: an index
/// out of range, or an error message that is not one line.
struct Reader {
  std::string_view name;
  void (*read)(std::string_view bytes);
  std::vector<std::string> (*seeds)();  ///< small valid files
  bool is_third_party;  ///< parsed by a third-party library, which may crash: umbrage runs it in a child process
};

std::span<const Reader> readers();

}  // namespace umbrage::fuzz
