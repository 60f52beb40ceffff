// A model of Vulkan's memory dependencies between the commands of a command buffer [Vulkan 2022, 7.1]. It has the
// stages and commands that Umbrage uses.
//
// Kernels access planes through their addresses, which validation layers do not follow. The model assumes that a kernel
// reads and writes all of memory, that a draw reads all of it, and that the host reads all that was copied. It ignores
// dependencies between two copies, whose ranges synchronization validation checks, and those of attachments.
#pragma once
#include <array>
#include <cstring>
#include <functional>
#include <string>
#include <utility>

#include "devices/vulkan/loader.h"

namespace umbrage::test {

/// The commands of one command buffer, in the order in which they are recorded.
class MemoryOrder {
 public:
  /// `report` gets a sentence for each access that is not ordered after an earlier one.
  explicit MemoryOrder(std::function<void(const std::string&)> report) : report_(std::move(report)) {}

  void begin();
  void kernel();
  void draw();
  void copy(bool reads_buffer, bool writes_buffer);
  void barrier(VkPipelineStageFlags from, VkPipelineStageFlags to, VkAccessFlags made_available,
               VkAccessFlags made_visible);
  /// The commands are submitted: when they are done, the host may read what was copied.
  void submit();

 private:
  enum Kind { kKernelReads, kKernelWrites, kVertexReads, kFragmentReads, kCopyReads, kCopyWrites, kHostReads, kKinds };
  /// The last access of a kind, and what barriers have ordered after it.
  struct Access {
    bool pending = false;
    int command = 0;
    VkPipelineStageFlags later_stages = 0;
    bool available = false;              ///< of a write: a barrier has made it available
    std::array<bool, kKinds> visible{};  ///< of a write: to accesses of that kind
  };
  struct Rule;
  static const std::array<Rule, kKinds> kRules;

  void access(Kind kind);

  std::function<void(const std::string&)> report_;
  std::array<Access, kKinds> accesses_;
  int command_ = 0;
};

/// vkGetInstanceProcAddr whose functions check the order of memory accesses in all command buffers, and report what is
/// not in order to memory_order_report(). Only for one queue and command buffers that are submitted once, as umbrage
/// uses them.
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL checked_get(VkInstance instance, const char* name);

/// Receives the reports of checked_get(): fails the running test unless a test replaces it.
std::function<void(const std::string&)>& memory_order_report();

/// Returns `replacement` if `name` is `what`, and stores the real function in `original`; else null.
template <class Original, class Replacement>
PFN_vkVoidFunction replaced(const char* what, const char* name, PFN_vkVoidFunction real, Original& original,
                            Replacement* replacement) {
  if (std::strcmp(name, what) != 0) return nullptr;
  original = reinterpret_cast<Original>(real);
  return reinterpret_cast<PFN_vkVoidFunction>(replacement);
}

}  // namespace umbrage::test
