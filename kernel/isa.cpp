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
  std::int64_t target;  ///< Highway's number; lower for wider targets
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
  std::string_view bound;  ///< the widest, or that of UMBRAGE_ISA
  std::string wrong;       ///< the value of UMBRAGE_ISA if the CPU lacks it

  Machine() {
    // A single target is dispatched to without querying the CPU; Highway's NEON requires AES, which no kernel needs.
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
std::atomic<bool> chosen{false};  ///< by choose_isa

/// Highway's switch affects everything in the process that shares its library, so it stays untouched unless a bound is
/// requested. Highway calls it "for test", and has no other that can be undone.
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

std::string_view wrong_isa_setting() { return chosen ? std::string_view() : machine().wrong; }

}  // namespace umbrage
