// Import in a separate process, so that a reader that crashes, hangs or exhausts memory does not affect the host.
#pragma once
#include "core/progress.h"
#include "scene/environment.h"
#include "scene/readers/import.h"

namespace umbrage {

/// File descriptors of the program umbrage-import: the file that receives the scene, and a pipe that receives one byte
/// when the scene is complete. If the process ends without writing that byte, it has crashed.
inline constexpr int kImportResult = 3, kImportDone = 4;

/// Runs umbrage-import, or umbrage-import-cad, on a file. Safe to call from several threads and in any host: processes
/// are started only by posix_spawn, and signal handlers are not changed. Errors: kFile: the reader's error, or that it
/// crashed or was stopped, or that the program is missing; kInterrupted, after the program has ended.
Result<Scene> import_in_child_process(const std::filesystem::path& file, const ImportSettings& settings,
                                      Poll* poll = nullptr);

/// Command-line values for an index and an angle of ImportSettings that are not set.
inline constexpr int kNoIndex = -1;
inline constexpr float kNoAngle = -1.0f;
/// What precedes the name of a field of ImportSettings that is set.
inline constexpr char kFieldMark = '=';

/// Command-line option of umbrage-import: the next argument is a file for read_panorama.
inline constexpr const char* kPanoramaOption = "--panorama";

/// Runs read_panorama (scene/readers/texture_file.h) in a separate process, since the decoders are third-party code.
/// Errors: as import_in_child_process.
Result<Panorama> read_panorama_in_child_process(const std::filesystem::path& file, Poll* poll = nullptr);

/// Returns the path of the program that reads a format: of umbrage-import-cad for those of CAD, else of umbrage-import.
/// It is the value of the environment variable UMBRAGE_IMPORT_CAD or UMBRAGE_IMPORT, if set; else as find_helper.
std::filesystem::path import_program(const std::string& format = "");

}  // namespace umbrage
