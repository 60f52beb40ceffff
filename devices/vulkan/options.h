// Options of a compiled kernel: integers among its constants that it compares with fixed values, to choose between
// branches. Each set of values gets its own shader, in which they are constants, so that unused branches are removed:
// they take no registers, and on lavapipe, which runs both sides of a branch, no time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace umbrage {

inline constexpr std::size_t kSpirvHeaderWords = 5;  ///< words of a SPIR-V module before its first instruction

/// An integer, or an array of them, in a shader's block of constants.
struct KernelOption {
  std::size_t offset = 0;  ///< bytes
  int count = 1;           ///< number of elements
};

/// An instruction that loads an option.
struct OptionLoad {
  std::size_t option = 0;  ///< index in KernelOptions::options
  std::size_t word = 0;    ///< first word of the instruction
};

struct KernelOptions {
  std::vector<KernelOption> options;
  std::vector<OptionLoad> loads;
  std::size_t first_function = 0;  ///< word index; constants may be inserted before it
};

/// Returns the options of a shader with UMBRAGE_CONSTANTS (kernel/glsl.h): integers that it compares with a constant
/// for equality.
KernelOptions options_of(std::span<const std::uint32_t> spirv);

/// Returns the values of the options in a block of constants; nullopt if the elements of an array differ.
std::vector<std::optional<std::int32_t>> option_values(const KernelOptions& options, std::span<const std::byte> block);

/// Returns the shader with these values in place of the loads; options whose value is nullopt are still loaded.
std::vector<std::uint32_t> with_options(std::span<const std::uint32_t> spirv, const KernelOptions& options,
                                        std::span<const std::optional<std::int32_t>> values);

}  // namespace umbrage
