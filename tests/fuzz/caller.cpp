#include "caller.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>

namespace umbrage::fuzz {

void on_error(void*, UmbError code, const char* message) {
  if (current) current->receive_error(code, message);
}
void on_warning(void*, const char* message) {
  if (current) current->receive_warning(message);
}
bool on_progress(void*, double fraction) { return !current || current->receive_progress(fraction); }

void Caller::receive_error(UmbError code, const char* message) {
  demand(code != UMB_ERROR_NONE && message && *message, "an error callback without an error");
  if (choose_.one_in(8)) call_nested();
}

void Caller::receive_warning(const char* message) {
  demand(message && *message, "a log callback without a message");
  if (choose_.one_in(8)) call_nested();
}

bool Caller::receive_progress(double fraction) {
  demand(!cancelled_, "a call goes on after its callback returned false");
  demand(fraction >= progress_ && fraction <= 1.0, "progress falls or leaves its range");
  progress_ = fraction;
  if (choose_.one_in(8)) call_nested();
  cancelled_ = Clock::now() - start_ > kCancelAfter || choose_.one_in(12);
  return !cancelled_;
}

void Caller::call_nested() {
  if (depth_ >= kMaxDepth) return;
  const auto saved = std::make_tuple(progress_, cancelled_, start_);
  called_back_ = true;
  ++depth_;
  call();
  --depth_;
  std::tie(progress_, cancelled_, start_) = saved;
}

bool Caller::is_shared(const void* handle) const {
  return shared_ && (handle == shared_->device || handle == shared_->scene ||
                     std::count(shared_->jobs.begin(), shared_->jobs.end(), handle) > 0);
}

UmbError Caller::done(UmbError code, Kind kind, const void* handle, const char* call) {
  if (code == UMB_ERROR_NONE) return code;
  ++counts.failed;
  if (code == UMB_ERROR_CANCELLED) ++counts.cancelled;
  if (is_shared(handle)) return code;  // another thread may query the error first, and invalidate the message
  const char* message = nullptr;
  UmbError stored = UMB_ERROR_NONE;
  const auto raw = const_cast<void*>(handle);
  if (kind == Kind::kNone) stored = umbGetError(&message);
  if (kind == Kind::kDevice) stored = umbGetDeviceError(static_cast<UmbDevice>(raw), &message);
  if (kind == Kind::kScene) stored = umbGetSceneError(static_cast<UmbScene>(raw), &message);
  if (kind == Kind::kJob) stored = umbGetJobError(static_cast<UmbJob>(raw), &message);
  if (stored == UMB_ERROR_NONE) stored = umbGetError(&message);  // the object is busy
  const std::string message_start = std::string(call) + " returned " + std::to_string(int(code));
  demand(code == UMB_ERROR_USAGE || code == UMB_ERROR_FILE || code == UMB_ERROR_DEVICE || code == UMB_ERROR_CANCELLED,
         message_start + ": " + (message ? message : ""));
  if (called_back_) return code;  // the callback may have queried the error
  demand(stored != UMB_ERROR_NONE && message && *message, message_start + " and keeps no error");
  const bool stores_code = kind != Kind::kNone && std::string_view(call) != "umbAddMesh";
  demand(stored == code || !stores_code, message_start + " and keeps the error " + std::to_string(int(stored)));
  if (traces_) std::fprintf(stderr, "%*s  -> %d %.150s\n", 2 * depth_, "", int(code), message);
  return code;
}

int Caller::any_int() {
  static const std::vector<int> kOdd = {-1, 0, 2147483647, -2147483647 - 1, 65536, 16385};
  return choose_.one_in(5) ? choose_.one_of(kOdd) : 1 + int(choose_.below(32));
}

void Caller::call() {
  if (shared_ && choose_.below(2)) return call_shared();
  switch (choose_.below(24)) {
    case 0:
      if (choose_.one_in(3)) {
        static const std::vector<const char*> kNames = {"cpu", "gpu", "", "vulkan:99", "cpu:1"};
        new_device(choose_.one_of(kNames), int(choose_.below(4)) - 1);
      }
      return;
    case 1:
      if (choose_.one_in(3)) return new_scene(choose_.below(unsigned(devices_.size())));
      return new_job(choose_.below(2) != 0);
    case 2:
      return retain_or_release();
    case 3:
      return set_callbacks();
    case 4:
      return query_objects();
    case 5:
    case 6:
      return change_scene();
    case 7:
    case 8:
      return set_mesh_buffer();
    case 9:
      return set_mesh_texture();
    case 10:
    case 11:
    case 12:
    case 13:
      return set_parameter();
    case 14:
    case 15:
      return set_image();
    case 16:
    case 17:
      return set_output();
    case 18:
      return query_job();
    case 19:
      return choose_.one_in(4) ? write_files() : query_lists();
    default:
      return execute(pick(jobs_));
  }
}

// ---- Objects ----

void Caller::new_device(const char* name, int threads) {
  trace("umbNewDevice", name);
  const UmbDevice device = umbNewDevice(name, threads);
  if (!device) done(UMB_ERROR_USAGE, Kind::kNone, nullptr, "umbNewDevice");
  if (device) devices_.push_back({device, 1});
}

void Caller::new_scene(std::size_t number) {
  const UmbDevice device = handle_of(devices_[number]);
  trace("umbNewScene");
  const UmbScene scene = umbNewScene(device);
  if (!scene) done(UMB_ERROR_USAGE, Kind::kNone, nullptr, "umbNewScene");
  scenes_.push_back({{scene, scene ? 1 : 0}, {}});
}

void Caller::new_job(bool renders) {
  const UmbDevice device = any_device();
  const UmbScene scene = any_scene();
  trace(renders ? "umbNewRenderJob" : "umbNewShadeJob");
  const UmbJob handle = renders ? umbNewRenderJob(device, scene) : umbNewShadeJob(device);
  if (!handle) done(UMB_ERROR_USAGE, Kind::kNone, nullptr, "umbNewRenderJob");
  JobState& job = jobs_.emplace_back();
  job.ref = {handle, handle ? 1 : 0};
  job.renders = renders;
  if (!handle) return;
  umbSetJobProgressCallback(handle, on_progress, nullptr);
  if (renders) {
    umbSetJobInt(handle, "width", job.width);
    umbSetJobInt(handle, "height", job.height);
    if (scene && choose_.below(2)) {
      trace("umbLoadModel", "scene:solids");
      begin_progress();
      umbLoadModel(scene, "scene:solids?detail=1000");
      umbGetSceneError(scene, nullptr);
    }
    return;
  }
  job.width = 16 + int(choose_.below(3)) * 8;
  Pixels depth = depth_image(choose_, job.width, job.height);
  if (umbSetJobImage(handle, "depth", &depth.image) == UMB_ERROR_NONE) job.inputs["depth"] = depth;
}

void Caller::retain_or_release() {
  const bool retains = choose_.below(3) != 0;
  trace(retains ? "umbRetain" : "umbRelease");
  if (choose_.one_in(5)) {  // use handles to which these calls hold no reference
    if (retains) {
      umbRetainJob(nullptr);
      umbRetainScene(reinterpret_cast<UmbScene>(any_job()));
    } else {
      umbReleaseDevice(nullptr);
      umbReleaseJob(reinterpret_cast<UmbJob>(this));
    }
    return;
  }
  const auto change = [&](auto& ref, auto retain, auto release) {
    if (retains) {
      retain(ref.handle);
      ref.references += ref.references > 0 ? 1 : 0;
    } else {
      release(ref.handle);
      ref.references = std::max(0, ref.references - 1);
    }
  };
  switch (choose_.below(4)) {
    case 0:
      return change(pick(devices_), umbRetainDevice, umbReleaseDevice);
    case 1:
      return change(pick(scenes_).ref, umbRetainScene, umbReleaseScene);
    default:
      JobState& job = pick(jobs_);
      change(job.ref, umbRetainJob, umbReleaseJob);
      if (job.ref.references > 0) return;
      retired_images_.push_back(std::move(job.inputs));
      retired_images_.push_back(std::move(job.outputs));
      job.inputs.clear();
      job.outputs.clear();
  }
}

void Caller::set_callbacks() {
  trace("umbSet...Callback");
  const bool enabled = !choose_.one_in(3);
  const UmbDevice device = any_device();
  const UmbScene scene = any_scene();
  const UmbJob job = any_job();
  done(umbSetDeviceErrorCallback(device, enabled ? on_error : nullptr, this), Kind::kDevice, device, "error callback");
  done(umbSetDeviceLogCallback(device, enabled ? on_warning : nullptr, this), Kind::kDevice, device, "log callback");
  done(umbSetSceneProgressCallback(scene, enabled ? on_progress : nullptr, this), Kind::kScene, scene,
       "scene's callback");
  done(umbSetJobProgressCallback(job, enabled ? on_progress : nullptr, this), Kind::kJob, job, "job's callback");
}

void Caller::query_objects() {
  trace("umbGetDeviceDescription and so on");
  const UmbDevice device = any_device();
  if (const char* text = umbGetDeviceDescription(device)) demand(*text, "a device without a description");
  umbGetDeviceMemory(device);
  umbGetDeviceError(device, nullptr);
  demand(umbGetVersion() == UMB_VERSION, "the version");
  const UmbScene scene = any_scene();
  demand(umbGetSceneCameraCount(scene) >= 0, "a count of cameras below 0");
  double box[6] = {};
  const UmbError code = umbGetSceneBounds(scene, choose_.one_in(9) ? nullptr : box, box + 3);
  if (done(code, Kind::kScene, scene, "umbGetSceneBounds") == UMB_ERROR_NONE)
    for (int k = 0; k < 3; ++k)
      demand(std::isfinite(box[k]) && std::isfinite(box[3 + k]) && box[k] <= box[3 + k],
             "a box that is not finite or has its min above its max");
}

}  // namespace umbrage::fuzz
