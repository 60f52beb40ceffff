// Adds up the planes that a frame has while a program runs on it.
#include <algorithm>
#include <set>
#include <utility>

#include "core/lists.h"
#include "effects/effects.h"
#include "program/program.h"

namespace umbrage {
namespace {

/// The planes of a frame, and of the one of reduced resolution that is made from it.
class Frames {
 public:
  explicit Frames(std::span<const std::string> given) {
    for (const std::string& name : given) stored_.emplace(name, 1);
    count();
  }

  void write(const std::string& name, int reduced) {
    stored_.emplace(name, reduced);
    count();
  }
  /// Neutral planes of one value share one plane.
  void read(const std::string& name, int reduced) {
    if (!has(name, reduced) && neutral_value(name)) neutral_.emplace(name, reduced);
    count();
  }
  bool has(const std::string& name, int reduced) const { return stored_.contains({name, reduced}); }
  /// Releases the planes for which `is_unread(name, reduced)`.
  template <class IsUnread>
  void release(const IsUnread& is_unread) {
    for (auto* planes : {&stored_, &neutral_})
      std::erase_if(*planes, [&](const auto& each) { return is_unread(each.first, each.second); });
    count();
  }
  LivePlanes live() const { return {max_, now_}; }

 private:
  void count() {
    std::set<std::pair<float, int>> constants;
    for (const auto& [name, reduced] : neutral_) constants.emplace(*neutral_value(name), reduced);
    now_ = 0.0;
    for (const auto& [name, reduced] : stored_) now_ += 1.0 / double(reduced * reduced);
    for (const auto& [value, reduced] : constants) now_ += 1.0 / double(reduced * reduced);
    max_ = std::max(max_, now_);
  }

  std::set<std::pair<std::string, int>> stored_, neutral_;  // name, downsampling factor
  double now_ = 0.0, max_ = 0.0;
};

bool uses(const Dispatch& dispatch, std::string_view name) {
  return contains(dispatch.inputs, name) || contains(dispatch.outputs, name);
}

/// Runs the dispatches of an operation. `is_last(name)`: whether nothing uses a plane of the first layer after it.
template <class IsLast>
void run_dispatches(const LookRun& run, const Operation& operation, const PictureInfo& info, const IsLast& is_last,
                    Frames& frames) {
  const auto dispatches = dispatches_in_order(*operation.effect, params_of_operation(run, operation, 0.0f),
                                              layer_info(info, operation.layer), operation.pixels);
  const auto exists = [&](std::string_view name) { return layer_of_plane(name) <= int(info.more_layers.size()); };
  for (std::size_t k = 0; k < dispatches.size(); ++k) {
    const Dispatch& dispatch = *dispatches[k].first;
    for (const std::string_view name : dispatch.inputs)
      frames.read(layer_plane(operation.layer, name), operation.reduced);
    for (const std::string_view name : dispatch.outputs)
      if (exists(name)) frames.write(layer_plane(operation.layer, name), operation.reduced);
    if (operation.reduced > 1 || operation.layer > 0) continue;
    frames.release([&](const std::string& name, int reduced) {
      return reduced == 1 && uses(dispatch, name) && is_last(name) &&
             std::none_of(dispatches.begin() + long(k) + 1, dispatches.end(),
                          [&](const auto& later) { return uses(*later.first, name); });
    });
  }
}

}  // namespace

LivePlanes live_planes(const LookRun& run, const PictureInfo& info, std::span<const std::string> given) {
  const Program program = compile(run, 1 + int(info.more_layers.size()), &info);
  Frames frames(given);
  for (std::size_t k = 0; k < program.operations.size(); ++k) {
    const Operation& operation = program.operations[k];
    const auto is_last = [&](const std::string& name) {
      return run.kept && std::any_of(program.planes.begin(), program.planes.end(), [&](const ProgramPlane& plane) {
               return plane.name == name && plane.reduced == 1 && !plane.kept && plane.last_user == int(k);
             });
    };
    if (operation.kind == OperationKind::kRun) {
      run_dispatches(run, operation, info, is_last, frames);
    } else if (operation.kind != OperationKind::kMeter) {
      const std::vector<std::string> writes = program.names_of(operation.writes);
      for (const std::string& name : writes)
        if (operation.kind != OperationKind::kReduce || frames.has(name, 1))
          frames.write(name, operation.kind == OperationKind::kReduce ? operation.reduced : 1);
    }
    const auto is_needed = [&](const std::string& name) {
      const std::string_view on_first = name_on_first_layer(name);
      const auto same = [&](const std::string& other) { return name_on_first_layer(other) == on_first; };
      return std::any_of(run.kept->begin(), run.kept->end(), same) ||
             std::any_of(program.planes.begin(), program.planes.end(), [&](const ProgramPlane& plane) {
               return plane.reduced == 1 && plane.last_user > int(k) && same(plane.name);
             });
    };
    frames.release([&](const std::string& name, int reduced) {
      return reduced > 1 ? operation.kind == OperationKind::kPlace : run.kept && !is_needed(name);
    });
  }
  return frames.live();
}

}  // namespace umbrage
