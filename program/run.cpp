// Runs a program on a frame.
#include <algorithm>
#include <set>

#include "core/check.h"
#include "core/lists.h"
#include "program/program.h"

namespace umbrage {
namespace {

/// A program while it runs.
class Runner {
 public:
  Runner(const LookRun& run, const Program& program, Device& device, Frame& frame)
      : run_(run), program_(program), device_(device), frame_(frame) {}

  Result<LookDone> run() {
    for (index_ = 0; index_ < program_.operations.size(); ++index_) {
      const Operation& operation = program_.operations[index_];
      const auto state = run_operation(operation);
      if (!state) return state.error();
      static_cast<RunState&>(done_) = *state;
      if (!state->finished) return done_;
      if (!operation.done.empty()) run_.after(operation.done);
      release_unread();
    }
    return done_;
  }

 private:
  Result<RunState> run_operation(const Operation& operation) {
    switch (operation.kind) {
      case OperationKind::kRun:
        return run_effect(operation);
      case OperationKind::kExternal: {
        if (!run_.run_external_effect)
          fail_check(
              fmt::format("LookRun::run_external_effect is not set; effect '{}' requires it", operation.effect->name));
        const auto status = run_.run_external_effect(
            *operation.effect, params_of(*run_.settings, operation.effect->name), frame_of(operation));
        return status ? Result<RunState>(RunState()) : status.error();
      }
      case OperationKind::kReduce: {
        std::vector<std::string> names = program_.names_of(operation.reads);
        std::erase_if(names, [](const std::string& name) { return layer_of_plane(name) > 0; });
        auto small = device_.reduced(frame_, operation.reduced, names);
        if (!small) return small.error();
        small_ = std::move(*small);
        return RunState();
      }
      case OperationKind::kPlace: {
        const auto status = device_.add_planes_of(*small_, program_.names_of(operation.reads), frame_);
        small_.reset();
        return status ? Result<RunState>(RunState()) : status.error();
      }
      case OperationKind::kMeter:
        return meter(operation);
    }
    fail_check("an operation of no kind");
  }

  Frame& frame_of(const Operation& operation) { return operation.reduced > 1 ? *small_ : frame_; }

  Result<RunState> run_effect(const Operation& operation) {
    EffectRun settings{.layer = operation.layer, .pixels = operation.pixels};
    if (run_.kept && operation.reduced == 1 && operation.layer == 0) settings.last_used = program_.last_used(index_);
    return device_.run(*operation.effect, params_of_operation(run_, operation, done_.stops), frame_of(operation),
                       settings, run_.monitor);
  }

  Result<RunState> meter(const Operation& operation) {
    std::optional<float> stops = run_.stops;
    if (!stops && operation.exposure == Exposure::kLights) stops = stops_from_lights(frame_.info);
    if (!stops) {
      const auto metered = run_.meter(device_, frame_);
      if (!metered) return metered.error();
      stops = *metered;
    }
    if (!stops) return RunState{.finished = false};
    done_.stops = *stops;
    return RunState();
  }

  /// Releases the planes that are read neither by later operations nor after the run.
  void release_unread() {
    if (!run_.kept) return;
    const auto needed = program_.needed_after(index_, *run_.kept);
    std::vector<std::string> unread = device_.plane_names(frame_);
    std::erase_if(unread, [&](const std::string& name) { return needed.contains(name_on_first_layer(name)); });
    device_.release(frame_, unread);
  }

  const LookRun& run_;
  const Program& program_;
  Device& device_;
  Frame& frame_;
  std::optional<Frame> small_;  // of reduced resolution
  std::size_t index_ = 0;       // of the current operation
  LookDone done_;
};

}  // namespace

Result<LookDone> run_look(const LookRun& run, Device& device, Frame& frame) {
  const Program program = compile(run, 1 + int(frame.info.more_layers.size()), &frame.info);
  return Runner(run, program, device, frame).run();
}

}  // namespace umbrage
