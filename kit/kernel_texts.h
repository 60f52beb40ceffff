// The sources of the kernels, which the build puts into the program.
#pragma once
#include <string_view>

#include "core/effect.h"

namespace umbrage {

/// One kernel: where its text is and what it is compiled with (cmake/kernels.cmake).
struct KernelText {
  CpuKernel scalar = nullptr;  ///< identifies it
  std::string_view name;       ///< "denoise_ao_across"
  std::string_view entry;      ///< "denoise", of denoise_pixel()
  std::string_view file;       ///< "effects/denoise/denoise.kernel.h"
  std::string_view header;     ///< "effects/denoise/denoise.h"
  std::string_view constants;  ///< "DenoiseConstants"
  std::string_view macros;     ///< "ALONG_ROWS=1 LIGHT=0", separated by spaces
};

/// Returns the row of a kernel. Throws InternalError if it has none.
const KernelText& kernel_text(const Kernel& kernel);

/// Returns the content of a source file, such as "kernel/common.kernel.h"; empty if the program does not have it.
std::string_view source_text(std::string_view file);

}  // namespace umbrage
