#include "kernel/isa.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>

#include "hwy/highway.h"

namespace umbrage {
namespace {

struct Isa {
  std::string_view name;
  std::int64_t target;  ///< Highway's HWY_* constant; lower for wider targets
};

#if HWY_ARCH_X86
constexpr Isa kIsas[] = {{"avx512", HWY_AVX3}, {"avx2", HWY_AVX2}, {"sse4", HWY_SSE4}, {"scalar", HWY_SCALAR}};
#else
constexpr Isa kIsas[] = {{"neon", HWY_NEON}, {"scalar", HWY_SCALAR}};
#endif

const Isa* find(std::string_view name) {
  const Isa* found = std::find_if(std::begin(kIsas), std::end(kIsas), [&](const Isa& isa) { return isa.name == name; });
  return found == std::end(kIsas) ? nullptr : found;
}

/// The instruction sets of the process, determined once.
struct Machine {
  std::vector<std::string_view> usable;
  std::string_view bound;  ///< the instruction set of UMBRAGE_ISA, or else the widest
  std::string wrong;       ///< the value of UMBRAGE_ISA if the CPU does not support it

  Machine() {
    // If only one target is compiled, the CPU is not queried: Highway reports NEON only with AES, which kernels do not
    // need.
    constexpr bool kOneTarget = ((HWY_TARGETS) & ((HWY_TARGETS)-1)) == 0;
    const std::int64_t targets = kOneTarget ? (HWY_TARGETS) : hwy::SupportedTargets() & (HWY_TARGETS);
    for (const Isa& isa : kIsas)
      if (isa.target == HWY_SCALAR || (targets & isa.target)) usable.push_back(isa.name);
    bound = usable.front();
    const char* requested = std::getenv("UMBRAGE_ISA");
    if (!requested || *requested == '\0') return;
    if (const auto usable_isa = std::find(usable.begin(), usable.end(), requested); usable_isa != usable.end())
      bound = *usable_isa;
    else
      wrong = requested;
  }
};

std::atomic<const Isa*> in_use{nullptr};
std::atomic<bool> chosen{false};  ///< whether choose_isa has been called with a name

/// Makes Highway dispatch to one target. Its setting affects all code in the process that shares the library, so it is
/// changed only if a limit is requested. Highway names this function "ForTest" but has no other one that can be undone.
void dispatch_to(const Isa& isa) {
  hwy::SetSupportedTargetsForTest(isa.target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  in_use = &isa;
}

const Machine& machine() {
  static const Machine one = [] {
    Machine found;
    if (found.bound == found.usable.front())
      in_use = find(found.bound);
    else
      dispatch_to(*find(found.bound));
    return found;
  }();
  return one;
}

}  // namespace

const std::vector<std::string_view>& known_isas() {
  static const std::vector<std::string_view> names = {"avx512", "avx2", "sse4", "neon", "scalar"};
  return names;
}

const std::vector<std::string_view>& usable_isas() { return machine().usable; }

std::string_view isa_in_use() {
  machine();
  return in_use.load()->name;
}

bool choose_isa(std::string_view name) {
  const auto& usable = usable_isas();
  const bool named = !name.empty();
  if (!named) name = machine().bound;
  if (std::find(usable.begin(), usable.end(), name) == usable.end()) return false;
  dispatch_to(*find(name));
  chosen = chosen || named;
  return true;
}

std::string_view unusable_isa_setting() { return chosen ? std::string_view() : machine().wrong; }

}  // namespace umbrage
