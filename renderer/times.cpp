#include "renderer/times.h"

namespace umbrage {

void StageTimes::done(std::string_view name) {
  const auto now = std::chrono::steady_clock::now();
  const double ms = std::chrono::duration<double, std::milli>(now - last).count();
  last = now;
  for (Stage& stage : stages)
    if (stage.name == name) {
      stage.ms += ms;
      return;
    }
  stages.push_back({std::string(name), ms});
}

double StageTimes::total() const {
  double sum = 0.0;
  for (const Stage& stage : stages) sum += stage.ms;
  return sum;
}

}  // namespace umbrage
