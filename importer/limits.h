// Limits for an importing process: processor time and memory in proportion to the files that it reads.
#pragma once
#include <filesystem>

namespace umbrage {

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
