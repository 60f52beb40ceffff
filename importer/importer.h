// umbrage-import: its main function, its limits, and the import itself.
#pragma once
#include <filesystem>
#include <functional>

#include "scene/environment.h"
#include "scene/readers/import.h"

namespace umbrage {

/// Does the work of import_scene in the current process: if a reader crashes, the process crashes. `process_ends`: the
/// process will end soon, so the reader's memory is not freed; a scene with points is returned before complete_import,
/// which the receiver of the scene must run. Errors: those of import_scene.
Result<Scene> import_in_process(const std::filesystem::path& file, const ImportSettings& settings,
                                bool process_ends = false);

using ImportFunction = std::function<Result<Scene>(const std::filesystem::path&, const ImportSettings&)>;
using PanoramaFunction = std::function<Result<Panorama>(const std::filesystem::path&)>;

/// Parses the command line that import_in_child_process or read_panorama_in_child_process built, reads the file within
/// the limits of limit_process and sends the result. Does not return.
[[noreturn]] void serve_import(int argc, char** argv, const ImportFunction& import, const PanoramaFunction& panorama);

/// Limits this process to more than any valid model needs: a base amount of processor time and memory, plus an amount
/// per megabyte passed to raise_limits_for. If the time is exceeded, SIGXCPU ends the process, or SIGALRM if it
/// only waits; if the memory is exceeded, allocations fail.
void limit_process();

/// Raises the limits for a file that is about to be read. Does nothing before limit_process.
void raise_limits_for(const std::filesystem::path& file);

/// Raises the limits for bytes that are about to be parsed in addition to those of the files, such as inflated ones.
/// Does nothing before limit_process.
void raise_limits_by(double bytes);

/// Returns whether memory can be limited: not with sanitizers, which reserve terabytes of address space.
bool memory_can_be_limited();

}  // namespace umbrage
