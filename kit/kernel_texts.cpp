#include "kit/kernel_texts.h"

#include "core/check.h"

namespace umbrage {
#define UMBRAGE_KERNEL(name) void run_scalar_##name(const KernelFrame&, const Tile&);
#include "kit/kernel_declarations.inc"

namespace {

const KernelText kKernels[] = {
#include "kit/kernel_rows.inc"
};

struct File {
  std::string_view name, text;
};
const File kFiles[] = {
#include "kit/file_rows.inc"
};

}  // namespace

const KernelText& kernel_text(const Kernel& kernel) {
  for (const KernelText& row : kKernels)
    if (row.scalar == kernel.scalar) return row;
  fail_check("a kernel without a text");
}

std::string_view source_text(std::string_view file) {
  for (const File& row : kFiles)
    if (row.name == file) return row.text;
  return {};
}

}  // namespace umbrage
