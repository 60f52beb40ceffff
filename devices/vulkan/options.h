// Options of a compiled kernel: numbers among its constants that it compares with others, to choose what it does. Each
// set of them gets a shader of its own, in which they are known, so that what they leave out is not there: it
// takes no registers, and on lavapipe, which runs both sides of a branch, no time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace umbrage {

/// A whole number, or several in a row, of a shader's block of constants.
struct Option {
  std::size_t offset = 0;  ///< bytes
  int count = 1;
};

/// A place where one is loaded.
struct OptionLoad {
  std::size_t option = 0;  ///< which of KernelOptions::options
  std::size_t word = 0;    ///< where the instruction begins
};

struct KernelOptions {
  std::vector<Option> options;
  std::vector<OptionLoad> loads;
  std::size_t first_function = 0;  ///< word; up to there constants may stand
};

/// Those of a shader that has UMBRAGE_CONSTANTS (kernel/glsl.h): whole numbers that are compared with a constant for
/// equality somewhere.
KernelOptions options_of(std::span<const std::uint32_t> spirv);

/// What they are in a block of constants; nothing where numbers in a row differ.
std::vector<std::optional<std::int32_t>> option_values(const KernelOptions& options, std::span<const std::byte> block);

/// The shader with these values in place of what it loads.
std::vector<std::uint32_t> with_options(std::span<const std::uint32_t> spirv, const KernelOptions& options,
                                        std::span<const std::optional<std::int32_t>> values);

}  // namespace umbrage
