// Everything of ours that reads what others write, as functions of bytes: for fuzzers and for a short test.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace umbrage::fuzz {

/// Reads any bytes as one kind of file or text. Aborts where what comes out breaks its promise: an index beyond its
/// list, an error that is not one line.
struct Reader {
  std::string_view name;
  void (*read)(std::string_view bytes);
  std::vector<std::string> (*seeds)();  ///< small and sound
  bool by_others;  ///< a library reads, which may crash; the program does not (import_in_child_process)
};

std::span<const Reader> readers();

}  // namespace umbrage::fuzz
