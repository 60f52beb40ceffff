// What a process that imports may use: processor time and memory in proportion to the files that it reads.
#pragma once
#include <filesystem>

namespace umbrage {

/// Limits this process from here on to what no sound model needs: some processor time and memory at once, and more for
/// each megabyte that allow_for names. It is ended by SIGXCPU, or by SIGALRM where it only waits; memory is refused.
void limit_process();

/// Allows for a file that is about to be read. Does nothing before limit_process.
void allow_for(const std::filesystem::path& file);

/// Whether memory can be limited: not where a sanitizer has reserved terabytes.
bool memory_can_be_limited();

}  // namespace umbrage
