#include <fmt/format.h>

#include <string_view>

#include "apps/cli/commands.h"
#include "commit.inc"
#include "core/version.h"
#include "devices/vulkan/vulkan_device.h"
#include "kernel/isa.h"
#include "renderer/options.h"

namespace umbrage::cli {

std::string version_text() {
  std::string isas;
  for (const std::string_view isa : usable_isas())
    isas += fmt::format("{}{}{}", isas.empty() ? "" : ", ", isa, isa == isa_in_use() ? " (in use)" : "");
  std::string devices = "cpu";
  if (const auto gpus = vulkan_gpus()) {
    for (const VulkanGpu& gpu : *gpus) devices += fmt::format("; {}, {}", gpu.name, gpu.summary);
  } else {
    devices += fmt::format("; no vulkan: {}", with_option_names(gpus.error().message));
  }
  return fmt::format("umbrage {}\ncommit {}\ninstruction sets {}\ndevices {}\n", project_version(), kCommit, isas,
                     devices);
}

}  // namespace umbrage::cli
