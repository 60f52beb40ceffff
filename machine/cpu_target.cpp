#include "machine/cpu_target.h"

#include "hwy/highway.h"

namespace umbrage {
namespace {

std::vector<std::int64_t> runnable_targets() {
  std::vector<std::int64_t> targets;
  hwy::SetSupportedTargetsForTest(0);
  const std::int64_t can = hwy::SupportedTargets() & (HWY_TARGETS);
  for (std::int64_t bit = 1; bit != 0 && bit <= (std::int64_t(1) << 62); bit = bit << 1)
    if (can & bit) targets.push_back(bit);  // Highway numbers better targets lower
  return targets;
}

std::int64_t chosen = 0;  // 0: the best

void apply() {
  hwy::SetSupportedTargetsForTest(chosen);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace

std::string simd_target_name() {
  const auto all = runnable_targets();
  apply();
  return hwy::TargetName(chosen ? chosen : all.front());
}

std::vector<std::string> simd_target_names() {
  std::vector<std::string> names;
  for (std::int64_t target : runnable_targets()) names.emplace_back(hwy::TargetName(target));
  apply();
  return names;
}

bool choose_simd_target(const std::string& name) {
  std::int64_t found = 0;
  for (std::int64_t target : runnable_targets())
    if (name == hwy::TargetName(target)) found = target;
  const bool known = name.empty() || found != 0;
  if (known) chosen = found;
  apply();
  return known;
}

}  // namespace umbrage
