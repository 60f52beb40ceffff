// Models compressed by gzip, as bunny.obj.gz: inflation by zlib, which is used only in gzip.cpp.
#pragma once
#include <string>
#include <string_view>

#include "core/progress.h"
#include "core/result.h"

namespace umbrage {

/// Returns how much memory, in bytes, programs may take without swapping: of the machine as the kernel estimates it,
/// and at most the limit of the container. Infinite if it is not known.
double available_memory();

/// Returns whether bytes begin as a gzip file does. No model format begins so.
bool is_gzip(std::string_view bytes);

/// Returns the content of a gzip file, of one or several members. `file`: its name in errors. Errors: kFile if it is
/// damaged or cut short, and if the content is more than 64 MB and 100 times as large as the file, which only files
/// made to exhaust memory are, or more than half of `memory`; kInterrupted.
Result<std::string> inflated(std::string_view bytes, const std::string& file, Poll* poll = nullptr,
                             double memory = available_memory());

/// Returns the size of that content. Has the same errors, and takes no memory.
Result<std::size_t> inflated_size(std::string_view bytes, const std::string& file, double memory = available_memory());

/// Returns the first bytes of a gzip file's content, at most `count`, of the first bytes of the file; fewer if they are
/// damaged.
std::string inflated_start(std::string_view bytes, std::size_t count);

/// Returns `size` bytes that zlib has compressed, as in binary FBX files; fewer if `bytes` are damaged.
std::string inflated_to(std::string_view bytes, std::size_t size);

}  // namespace umbrage
