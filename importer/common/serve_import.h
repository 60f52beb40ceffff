// The main function of the programs that read models for the host that starts them, and their limits.
#pragma once
#include <filesystem>
#include <functional>

#include "core/result.h"
#include "scene/environment.h"
#include "scene/readers/import.h"

namespace umbrage {

using ImportFunction = std::function<Result<Scene>(const std::filesystem::path&, const ImportSettings&)>;
using PanoramaFunction = std::function<Result<Panorama>(const std::filesystem::path&)>;

/// Limits of a process that reads models. OBJ, 3DS and glTF take 0.01 to 0.1 s per megabyte and at most 20 bytes of
/// memory per byte (docs/reliability.md); these allow for slow machines and for highly compressed textures or buffers.
struct ImportLimits {
  double base_seconds = 8.0, seconds_per_megabyte = 2.0;  ///< of processor time
  double base_memory = 1.5e9, memory_per_byte = 200.0;    ///< of address space, bytes
};

/// Parses the command line that import_in_child_process or read_panorama_in_child_process built, reads the file within
/// the limits and sends the result. Without a function for panoramas they are refused. Does not return.
[[noreturn]] void serve_import(int argc, char** argv, const ImportFunction& import, const PanoramaFunction& panorama,
                               const ImportLimits& limits = {});

/// Limits this process to more than any valid model needs: a base amount of processor time and memory, plus an amount
/// per megabyte passed to raise_limits_for. If the time is exceeded, SIGXCPU ends the process, or SIGALRM if it
/// only waits; if the memory is exceeded, allocations fail.
void limit_process(const ImportLimits& limits = {});

/// Raises the limits for a file that is about to be read. Does nothing before limit_process.
void raise_limits_for(const std::filesystem::path& file);

/// Raises the limits for bytes that are about to be parsed in addition to those of the files, such as inflated ones.
/// Does nothing before limit_process.
void raise_limits_by(double bytes);

/// Returns whether memory can be limited: not with sanitizers, which reserve terabytes of address space.
bool memory_can_be_limited();

}  // namespace umbrage
