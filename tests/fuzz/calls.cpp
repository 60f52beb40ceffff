#include "calls.h"

#include <thread>

#include "caller.h"

namespace umbrage::fuzz {
namespace {

/// Returns bytes that are different for each thread.
std::string mixed(std::string_view bytes, unsigned number) {
  std::string all(bytes);
  unsigned state = number + 1;
  for (char& byte : all) {
    state = state * 1664525u + 1013904223u;
    byte = char(std::uint8_t(byte) ^ std::uint8_t(state >> 24));
  }
  return all;
}

}  // namespace

CallCounts& CallCounts::operator+=(const CallCounts& other) {
  calls += other.calls;
  failed += other.failed;
  executed += other.executed;
  cancelled += other.cancelled;
  return *this;
}

CallCounts make_calls(std::string_view bytes) {
  Caller caller(bytes);
  caller.run();
  return caller.counts;
}

CallCounts make_calls_in_threads(std::string_view bytes, int threads) {
  words();
  constexpr int kSharedJobs = 2;
  Shared shared{umbNewDevice("cpu", 2), nullptr, {}};
  shared.scene = umbNewScene(shared.device);
  umbLoadModel(shared.scene, "scene:solids?detail=1000");
  umbSetDeviceErrorCallback(shared.device, on_error, nullptr);
  umbSetSceneProgressCallback(shared.scene, on_progress, nullptr);
  std::vector<float> depth(24 * 24, 2.0f);
  const UmbImage image{depth.data(), UMB_TYPE_FLOAT32, 24, 24, 1, 0, 0, 0};
  for (int k = 0; k < kSharedJobs; ++k) {
    const UmbJob job = k % 2 ? umbNewShadeJob(shared.device) : umbNewRenderJob(shared.device, shared.scene);
    umbSetJobProgressCallback(job, on_progress, nullptr);
    if (k % 2) umbSetJobImage(job, "depth", &image);
    umbSetJobInt(job, "width", 24);
    umbSetJobInt(job, "height", 24);
    shared.jobs.push_back(job);
  }
  std::vector<CallCounts> counts(static_cast<std::size_t>(threads));
  std::vector<std::thread> all;
  for (int k = 0; k < threads; ++k)
    all.emplace_back([&, k] {
      const std::string own = mixed(bytes, unsigned(k));
      Caller caller(own, &shared);
      caller.run();
      counts[std::size_t(k)] = caller.counts;
    });
  for (std::thread& thread : all) thread.join();
  for (const UmbJob job : shared.jobs) umbReleaseJob(job);
  umbReleaseScene(shared.scene);
  umbReleaseDevice(shared.device);
  CallCounts sum;
  for (const CallCounts& count : counts) sum += count;
  return sum;
}

void Caller::call_shared() {
  const UmbJob job = choose_.one_of(shared_->jobs);
  const UmbScene scene = shared_->scene;
  trace("a call on what threads share");
  switch (choose_.below(12)) {
    case 0:
      umbRetainJob(job);
      umbRetainScene(scene);
      umbRetainDevice(shared_->device);
      umbReleaseJob(job);
      umbReleaseScene(scene);
      umbReleaseDevice(shared_->device);
      return;
    case 1:
      done(umbSetJobInt(job, choose_.below(2) ? "width" : "height", 8 + int(choose_.below(24))), Kind::kJob, job,
           "umbSetJobInt");
      return;
    case 2: {
      const ListedParameter& parameter = choose_.one_of(words().parameters);
      if (parameter.name == "width" || parameter.name == "height") return;
      done(umbSetJobString(job, parameter.name.c_str(), value_of(choose_, parameter).c_str()), Kind::kJob, job,
           "umbSetJobString");
      return;
    }
    case 3: {
      const UmbImage own{};
      done(umbSetJobOutput(job, any_pass(choose_).get(), choose_.below(3) ? &own : nullptr), Kind::kJob, job,
           "umbSetJobOutput");
      return;
    }
    case 4:
      if (choose_.one_in(6)) return load_model(scene);
      umbGetSceneCameraCount(scene);
      umbSetSceneProgressCallback(scene, on_progress, nullptr);
      return;
    case 5: {
      double box[6];
      done(umbGetSceneBounds(scene, box, box + 3), Kind::kScene, scene, "umbGetSceneBounds");
      return;
    }
    case 6:
      done(umbResetJobParameter(job, choose_.below(2) ? nullptr : "look"), Kind::kJob, job, "umbResetJobParameter");
      umbSetJobInt(job, "width", 24);
      umbSetJobInt(job, "height", 24);
      return;
    case 7: {
      done(umbCheckJob(job), Kind::kJob, job, "umbCheckJob");
      umbGetJobCounter(job, "captures_made");
      umbGetJobOutputName(job, 0);
      umbGetJobStrokeCount(job);
      UmbImage image{};
      umbGetJobOutput(job, "color", &image);
      return;
    }
    case 8:
      umbSetDeviceErrorCallback(shared_->device, choose_.below(2) ? on_error : nullptr, nullptr);
      umbGetDeviceMemory(shared_->device);
      demand(umbGetDeviceDescription(shared_->device), "a device without a description");
      return;
    default: {
      begin_progress();
      const UmbError code = choose_.one_in(6) ? umbPrepareJob(job) : umbExecuteJob(job);
      if (code == UMB_ERROR_NONE) ++counts.executed;
      done(code, Kind::kJob, job, "umbExecuteJob");
    }
  }
}

}  // namespace umbrage::fuzz
