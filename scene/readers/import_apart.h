// Import in a process of its own, so that a reader that crashes, never ends or eats memory takes nothing along.
#pragma once
#include "core/progress.h"
#include "scene/environment.h"
#include "scene/readers/import.h"

namespace umbrage {

/// The file descriptors that the program umbrage-import is given: where the scene goes, and a pipe into which it puts
/// one byte when the scene is there. When it ends without, it has crashed.
inline constexpr int kImportResult = 3, kImportDone = 4;

/// Runs umbrage-import on a file. For several threads at once, in any program: nothing is forked but by posix_spawn, no
/// signal handler is touched. Errors: kFile; those of the reader, one sentence where it crashed or was stopped, and one
/// where the program umbrage-import is not there; kInterrupted, after which umbrage-import has ended.
Result<Scene> import_apart(const std::filesystem::path& file, const ImportSettings& settings, Poll* poll = nullptr);

/// What umbrage-import is told where the file's own scene is wanted.
inline constexpr int kNoSceneIndex = -1;

/// The word after which umbrage-import is named a file that read_panorama is to read.
inline constexpr const char* kReadPanorama = "--panorama";

/// The same for read_panorama of scene/readers/texture_file.h: the decoders are not ours.
Result<Panorama> read_panorama_apart(const std::filesystem::path& file, Poll* poll = nullptr);

/// Where umbrage-import is: as the environment's UMBRAGE_IMPORT says, else beside the program or library that holds
/// this function or in its ../libexec/umbrage, else where it was to be installed. Empty where it is in none of these.
std::filesystem::path import_program();

}  // namespace umbrage
