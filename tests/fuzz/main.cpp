// Entry points of libFuzzer. There is one program per reader, named after it, such as umbrage_fuzz_ply. With
// --seeds FOLDER it writes the seeds to that folder instead.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "readers.h"

namespace {

const umbrage::fuzz::Reader* reader = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  for (const umbrage::fuzz::Reader& each : umbrage::fuzz::readers())
    if (each.name == UMBRAGE_FUZZ_READER) reader = &each;
  if (!reader) std::abort();
  if (*argc != 3 || std::string((*argv)[1]) != "--seeds") return 0;
  int number = 0;
  for (const std::string& seed : reader->seeds())
    std::ofstream(std::filesystem::path((*argv)[2]) / ("seed-" + std::to_string(number++)), std::ios::binary) << seed;
  std::exit(number > 0 ? 0 : 1);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  reader->read({reinterpret_cast<const char*>(bytes), size});
  return 0;
}
