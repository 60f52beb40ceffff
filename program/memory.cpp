// Adds up the planes that a frame has while a program runs on it.
#include <algorithm>
#include <set>
#include <utility>

#include "core/lists.h"
#include "effects/effects.h"
#include "program/program.h"

namespace umbrage {

LivePlanes live_planes(const LookRun& run, const PictureInfo& info, std::span<const std::string> given) {
  const int layers = 1 + int(info.more_layers.size());
  const Program program = compile(run, layers, &info);
  std::set<std::pair<std::string, int>> live;  // name, downsampling factor
  std::set<float> constants;                   // values of neutral planes, one each
  for (const std::string& name : given) live.emplace(name, 1);
  const auto count = [&] {
    double sum = double(constants.size());
    for (const auto& [name, reduced] : live) sum += 1.0 / double(reduced * reduced);
    return sum;
  };
  LivePlanes planes{.max = count()};
  for (std::size_t k = 0; k < program.operations.size(); ++k) {
    const Operation& operation = program.operations[k];
    const bool reduces = operation.kind == OperationKind::kReduce;
    for (std::size_t j = 0; j < operation.writes.size(); ++j) {
      const ProgramPlane& plane = program.planes[std::size_t(operation.writes[j])];
      if (layer_of_plane(plane.name) < layers && (!reduces || live.contains({plane.name, 1})))
        live.emplace(plane.name, plane.reduced);
    }
    for (const int id : operation.reads) {
      const ProgramPlane& plane = program.planes[std::size_t(id)];
      const auto value = neutral_value(plane.name);
      if (value && operation.effect && !live.contains({plane.name, plane.reduced})) constants.insert(*value);
    }
    planes.max = std::max(planes.max, count());
    std::erase_if(live, [&](const auto& each) {
      if (each.second > 1) return operation.kind == OperationKind::kPlace;
      if (!run.kept) return false;
      const auto is_needed = [&](const ProgramPlane& plane) {
        return plane.reduced == 1 && name_on_first_layer(plane.name) == name_on_first_layer(each.first) &&
               (plane.kept || plane.last_user > int(k));
      };
      const auto is_kept = [&](const std::string& name) {
        return name_on_first_layer(name) == name_on_first_layer(each.first);
      };
      return std::none_of(program.planes.begin(), program.planes.end(), is_needed) &&
             std::none_of(run.kept->begin(), run.kept->end(), is_kept);
    });
  }
  planes.at_end = count();
  return planes;
}

}  // namespace umbrage
