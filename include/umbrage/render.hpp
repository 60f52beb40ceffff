// The functions render, shade and save and the class FrameRenderer. umbrage/umbrage.hpp includes this header.
#pragma once
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "umbrage/requests.hpp"
#include "umbrage/umbrage.hpp"

namespace umb {

namespace detail {

/// A sequence of calls of the C interface that ends at the first one that fails.
class Calls {
 public:
  Outcome outcome;
  bool fine() const { return outcome.code == 0; }

  /// Records the result of a call that creates an object.
  template <class Handle>
  void made(Handle handle) {
    if (!handle && fine()) note(told_without_code(UMB_ERROR_INTERNAL, umbGetError));
  }
  void alone(UmbError code) { note(code, umbGetError); }
  void scene(UmbScene scene, UmbError code) {
    note(code, [scene](const char** message) { return umbGetSceneError(scene, message); });
  }
  void job(UmbJob job, UmbError code) {
    note(code, [job](const char** message) { return umbGetJobError(job, message); });
  }

 private:
  template <class Take>
  void note(UmbError code, const Take& take) {
    if (code != UMB_ERROR_NONE) note(outcome_of(code, take));
  }
  /// Keeps the warnings.
  void note(Outcome error) {
    outcome.code = error.code;
    outcome.message = std::move(error.message);
  }
};

inline void note_warning(void* user, const char* message) {
  static_cast<std::vector<std::string>*>(user)->push_back(message);
}

/// Sets the parameters of a job from the members of a request.
class Setter {
 public:
  Setter(UmbJob job, Calls& calls) : job_(job), calls_(calls) {}
  void operator()(const char* name, const std::string& value) {
    if (!value.empty() && calls_.fine()) calls_.job(job_, umbSetJobString(job_, name, value.c_str()));
  }
  void operator()(const char* name, int value) {
    if (calls_.fine()) calls_.job(job_, umbSetJobInt(job_, name, value));
  }
  void operator()(const char* name, bool value) {
    if (calls_.fine()) calls_.job(job_, umbSetJobBool(job_, name, value));
  }
  void operator()(const char* name, float value) {
    if (calls_.fine()) calls_.job(job_, umbSetJobFloat(job_, name, value));
  }
  template <std::size_t count>
  void operator()(const char* name, const std::array<float, count>& values) {
    if (calls_.fine()) calls_.job(job_, umbSetJobFloats(job_, name, values.data(), int(count)));
  }
  template <std::size_t count>
  void operator()(const char* name, const std::array<double, count>& values) {
    if (calls_.fine()) calls_.job(job_, umbSetJobDoubles(job_, name, values.data(), int(count)));
  }
  template <class T>
  void operator()(const char* name, const std::optional<T>& value) {
    if (value) (*this)(name, *value);
  }
  /// Sets an effect parameter from "effect.parameter=value".
  void assign(const std::string& text) {
    if (!calls_.fine()) return;
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      calls_.outcome = {int(UMB_ERROR_USAGE),
                        "'" + text + "' is not a setting: write effect.parameter=value, such as unsharp.kernel=40",
                        {}};
      return;
    }
    (*this)(text.substr(0, equals).c_str(), text.substr(equals + 1));
  }

 private:
  UmbJob job_;
  Calls& calls_;
};

/// Sets the parameters that render and shade requests have in common.
template <class Request>
void set_common(const Request& r, Setter& set) {
  set("look", r.look);
  set("occlusion", r.occlusion);
  set("occlusion_radius", r.occlusion_radius);
  set("occlusion_scale", r.occlusion_scale);
  set("quality", r.quality);
  set("background", r.background);
  set("transparent", r.transparent);
  set("strokes", r.strokes);
  set("shadow_strength", r.shadow_strength);
  set("occlusion_strength", r.occlusion_strength);
  set("exposure", r.exposure);
  set("contrast", r.contrast);
  set("style", r.style);
  for (const std::string& setting : r.settings) set.assign(setting);
}

inline void set_camera(const CameraRequest& camera, Setter& set) {
  set("camera.index", camera.index);
  set("camera.position", camera.position);
  set("camera.focal_point", camera.focal_point);
  set("camera.view_up", camera.view_up);
  set("camera.direction", camera.direction);
  set("camera.view_angle_deg", camera.view_angle_deg);
  set("camera.azimuth_deg", camera.azimuth_deg);
  set("camera.elevation_deg", camera.elevation_deg);
  set("camera.orbit", camera.orbit);
  set("camera.zoom", camera.zoom);
  set("camera.orthographic", camera.orthographic);
}

inline void set_all(const RenderRequest& r, Setter& set) {
  set_common(r, set);
  set("width", r.width);
  set("height", r.height);
  set_camera(r.camera, set);
  set("anti_aliasing", r.anti_aliasing);
  set("ground", r.ground);
  set("hdri_file", r.hdri_file);
  set("hdri_ambient", r.hdri_ambient);
  set("hdri_skybox", r.hdri_skybox);
  set("hdri_rotation_deg", r.hdri_rotation_deg);
  set("hdri_intensity", r.hdri_intensity);
  set("light_size_deg", r.light_size_deg);
  set("light_direction", r.light_direction);
  set("color_by", r.color_by);
  set("color_component", r.color_component);
  set("color_map", r.color_map);
  set("color_range", r.color_range);
  set("color_scale", r.color_scale);
  set("color_bands", r.color_bands);
  set("missing_color", r.missing_color);
  set("sections", r.sections);
  set("explode", r.explode);
  set("key", r.key);
  set("fill", r.fill);
  set("rim", r.rim);
  set("material", r.material);
  set("color", r.color);
  set("layers", r.layers);
  set("extra_views", r.extra_views);
  set("guard_band", r.guard_band);
}

inline void set_all(const ShadeRequest& r, Setter& set) {
  constexpr const char* kKinds[] = {"planar", "distance", "window", "reversed", "disparity", "height", "auto"};
  set_common(r, set);
  set("depth_kind", std::string(kKinds[int(r.depth_kind)]));
  set("near_plane", r.near_plane);
  if (r.far_plane < std::numeric_limits<float>::infinity()) set("far_plane", r.far_plane);
  set("orthographic", r.orthographic);
  set("scene_radius", r.scene_radius);
  if (r.files.empty()) {
    set("view_from_normal", r.view_from_normal);
    const std::array<float, 4> window = {r.left, r.right, r.bottom, r.top};
    if (window != std::array<float, 4>{}) set("window", window);
  }
  set("file", r.files.file);
  set("depth_file", r.files.depth_file);
  set("normal_file", r.files.normal_file);
  set("albedo_file", r.files.albedo_file);
  set("beauty_file", r.files.beauty_file);
  set("position_file", r.files.position_file);
  set("id_file", r.files.id_file);
  set("fov_deg", r.files.fov_deg);
  for (const auto& [name, value] : r.files.parameters) set(name.c_str(), value);
  std::string effects;
  for (const std::string& effect : r.effects) effects += (effects.empty() ? "" : ",") + effect;
  set("effects", effects);
}

inline void set_scene(const RenderRequest& r, UmbScene scene, Calls& calls) {
  const auto set = [&](const char* name, const std::string& value) {
    if (!value.empty() && calls.fine()) calls.scene(scene, umbSetSceneParameter(scene, name, value.c_str()));
  };
  if (r.up) set("up", text_of(r.up->data(), 3));
  if (r.scene_index) set("scene_index", std::to_string(*r.scene_index));
  if (r.animation_index) set("animation_index", std::to_string(*r.animation_index));
  if (r.animation_time) set("animation_time", text_of(&*r.animation_time, 1));
  set("lights", r.lights);
  if (r.crease_angle_deg) set("crease_angle_deg", text_of(&*r.crease_angle_deg, 1));
  set("point_size", r.point_size);
  set("color_by", r.color_by);
  set("point_sprites", r.point_sprites);
}

/// Returns, for each id, its index in the ascending list of distinct ids: floats cannot represent all 32-bit ids.
inline std::vector<float> places_of(const std::vector<std::uint32_t>& ids) {
  std::vector<std::uint32_t> known;
  for (const std::uint32_t id : ids)
    if (known.empty() || known.back() != id) known.push_back(id);  // neighbouring pixels mostly show one object
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::vector<float> places;
  places.reserve(ids.size());
  for (const std::uint32_t id : ids)
    places.push_back(float(std::lower_bound(known.begin(), known.end(), id) - known.begin()));
  return places;
}

/// Copies the outputs of a job to a picture.
inline void take(UmbJob job, bool strokes, Picture& picture) {
  Picture made;
  for (int k = 0; const char* name = umbGetJobOutputName(job, k); ++k) {
    UmbImage image{};
    umbGetJobOutput(job, name, &image);
    made.width = image.width;
    made.height = image.height;
    const std::size_t count = std::size_t(image.width) * std::size_t(image.height) * std::size_t(image.channels);
    if (image.type == UMB_TYPE_UINT32) {
      const auto* ids = static_cast<const std::uint32_t*>(image.data);
      Pixels pass{name, image.channels, {}, {ids, ids + count}};
      pass.values = places_of(pass.ids);
      made.passes.push_back(std::move(pass));
      continue;
    }
    const auto* values = static_cast<const float*>(image.data);
    if (std::string(name) == "color")
      made.rgba.assign(values, values + count);
    else
      made.passes.push_back({name, image.channels, {values, values + count}, {}});
  }
  if (strokes) made.strokes = strokes_of(job);
  if (strokes) umbGetJobStrokeColor(job, made.stroke_color.data(), &made.stroke_opacity);
  UmbView view{};
  if (umbGetJobView(job, &view) == UMB_ERROR_NONE) {
    PictureView& of_picture = made.view.emplace();
    std::copy(std::begin(view.view_from_world), std::end(view.view_from_world), of_picture.view_from_world.begin());
    of_picture.left = view.left;
    of_picture.right = view.right;
    of_picture.bottom = view.bottom;
    of_picture.top = view.top;
    of_picture.orthographic = view.orthographic != 0;
  }
  for (int k = 0; const char* fact = umbGetJobFact(job, k); ++k) made.facts.emplace_back(fact);
  picture = std::move(made);
}

inline void want(UmbJob job, const std::string& pass, Calls& calls) {
  const UmbImage own{};
  if (calls.fine()) calls.job(job, umbSetJobOutput(job, pass.c_str(), &own));
}

}  // namespace detail

/// Draws several frames of one model. The model is read and prepared once; each frame reuses the memory of the previous
/// one. Not thread-safe.
class FrameRenderer {
 public:
  /// Reads and prepares the model. Errors: as for render. On failure a model opened before stays open.
  Outcome open(const RenderRequest& request) {
    auto state = std::make_unique<State>(request.progress);
    detail::Calls calls;
    state->device = Device_(umbNewDevice(request.device.c_str(), request.threads));
    calls.made(state->device.get());
    if (!calls.fine()) return calls.outcome;
    const UmbDevice device = state->device.get();
    umbSetDeviceLogCallback(device, detail::note_warning, &calls.outcome.warnings);
    state->scene = Scene_(umbNewScene(device));
    calls.made(state->scene.get());
    const UmbScene scene = state->scene.get();
    detail::set_scene(request, scene, calls);
    if (calls.fine())
      calls.scene(scene, umbSetSceneProgressCallback(scene, state->watch.callback_before(), &state->watch));
    state->job = Job_(umbNewRenderJob(device, scene));
    calls.made(state->job.get());
    const UmbJob job = state->job.get();
    detail::Setter set(job, calls);
    detail::set_all(request, set);
    detail::want(job, "color", calls);
    for (const std::string& pass : request.passes) {
      if (pass == "color") continue;
      detail::want(job, pass, calls);
    }
    if (calls.fine()) calls.job(job, umbCheckJob(job));
    std::vector<std::string> models = {request.model};
    models.insert(models.end(), request.more_models.begin(), request.more_models.end());
    for (const std::string& model : models)
      if (calls.fine()) calls.scene(scene, umbLoadModel(scene, model.c_str()));
    if (calls.fine()) calls.job(job, umbSetJobProgressCallback(job, state->watch.callback(), &state->watch));
    if (calls.fine()) calls.job(job, umbPrepareJob(job));
    umbSetDeviceLogCallback(device, nullptr, nullptr);
    state->watch.rethrow();
    state->request = request;
    if (calls.fine()) state_ = std::move(state);
    return calls.outcome;
  }

  /// Draws one picture with the passes of the request, and reports progress. A model without lights is lit by lights
  /// that are placed relative to the camera of the first frame. Errors: code 2 for an invalid camera, 4 if memory runs
  /// out or the device is lost, 130. On failure the picture is unchanged, and other frames can be drawn.
  Outcome draw(const FrameCamera& camera, Picture& picture) {
    if (!state_)
      return {int(UMB_ERROR_USAGE), "FrameRenderer::draw: no model is open: call FrameRenderer::open first", {}};
    detail::Calls calls;
    umbSetDeviceLogCallback(state_->device.get(), detail::note_warning, &calls.outcome.warnings);
    place(camera, calls);
    const UmbJob job = state_->job.get();
    if (calls.fine()) calls.job(job, umbExecuteJob(job));
    umbSetDeviceLogCallback(state_->device.get(), nullptr, nullptr);
    state_->watch.rethrow();
    if (calls.fine()) detail::take(job, state_->request.strokes, picture);
    return calls.outcome;
  }

  /// Returns a description such as "vulkan:0: NVIDIA ..."; empty if nothing is open.
  std::string device() const { return state_ ? umbGetDeviceDescription(state_->device.get()) : std::string(); }
  /// Returns the GPU memory that the device has allocated, in bytes; 0 on the CPU.
  unsigned long long device_bytes() const { return state_ ? umbGetDeviceMemory(state_->device.get()) : 0; }

 private:
  using Device_ = detail::Ref<UmbDevice, umbRetainDevice, umbReleaseDevice>;
  using Scene_ = detail::Ref<UmbScene, umbRetainScene, umbReleaseScene>;
  using Job_ = detail::Ref<UmbJob, umbRetainJob, umbReleaseJob>;

  struct State {
    explicit State(const Progress& progress) : watch(progress) {}
    detail::Watch watch;
    RenderRequest request;
    Device_ device;
    Scene_ scene;
    Job_ job;
  };

  /// Sets the camera of the frame, or of the request. All other parameters stay as they were set, so that nothing has
  /// to be read again.
  void place(const FrameCamera& camera, detail::Calls& calls) {
    const UmbJob job = state_->job.get();
    for (const char* name : {"camera.index", "camera.position", "camera.focal_point", "camera.view_up",
                             "camera.direction", "camera.view_angle_deg", "camera.azimuth_deg", "camera.elevation_deg",
                             "camera.orbit", "camera.zoom", "camera.orthographic"})
      if (calls.fine()) calls.job(job, umbResetJobParameter(job, name));
    detail::Setter set(job, calls);
    if (!camera.placed) return detail::set_camera(state_->request.camera, set);
    CameraRequest placed;
    placed.position = {camera.eye[0], camera.eye[1], camera.eye[2]};
    placed.focal_point = {camera.target[0], camera.target[1], camera.target[2]};
    placed.view_up = {camera.up[0], camera.up[1], camera.up[2]};
    placed.view_angle_deg = camera.angle_deg;
    detail::set_camera(placed, set);
  }

  std::unique_ptr<State> state_;
};

/// Renders one picture. Errors: code 2 for invalid names and values, reported before the model is read; 3 for the
/// model; 4 for the device, also if its memory runs out; 130. On failure the picture is unchanged.
inline Outcome render(const RenderRequest& request, Picture& picture) {
  FrameRenderer renderer;
  Outcome opened = renderer.open(request);
  if (opened.code != 0) return opened;
  Outcome drawn = renderer.draw({}, picture);
  drawn.warnings.insert(drawn.warnings.begin(), opened.warnings.begin(), opened.warnings.end());
  return drawn;
}

/// Shades the G-buffer of another renderer, from arrays or from files. With `effects` the picture has colour only if
/// one of them is "output". Errors: code 2 for invalid names, values and arrays, including an effect whose input plane
/// is missing and a look whose occlusion is "reference", which needs the model; 3 for files; 4 for the device; 130. On
/// failure the picture is unchanged.
inline Outcome shade(const ShadeRequest& request, Picture& picture) {
  detail::Calls calls;
  detail::Watch watch(request.progress);
  const detail::Ref<UmbDevice, umbRetainDevice, umbReleaseDevice> device(
      umbNewDevice(request.device.c_str(), request.threads));
  calls.made(device.get());
  if (!calls.fine()) return calls.outcome;
  umbSetDeviceLogCallback(device.get(), detail::note_warning, &calls.outcome.warnings);
  const detail::Ref<UmbJob, umbRetainJob, umbReleaseJob> made(umbNewShadeJob(device.get()));
  const UmbJob job = made.get();
  calls.made(job);
  detail::Setter set(job, calls);
  detail::set_all(request, set);
  if (calls.fine()) calls.job(job, umbSetJobProgressCallback(job, watch.callback(), &watch));
  const auto refuse = [&](const std::string& message) {
    if (calls.fine()) calls.outcome = {int(UMB_ERROR_USAGE), message, {}};
  };
  if (request.files.empty() && (request.width < 1 || request.height < 1))
    refuse("`width` and `height` cannot be " + std::to_string(request.width) + " and " +
           std::to_string(request.height) + ": they take integers above 0");
  for (const PixelArray& array : request.arrays) {
    const auto same = [&](const PixelArray& other) { return other.name == array.name; };
    if (array.values && array.ids) refuse("the array '" + array.name + "' has both values and ids");
    if (std::count_if(request.arrays.begin(), request.arrays.end(), same) > 1)
      refuse("there are two arrays '" + array.name + "'");
    if (!calls.fine()) break;
    // 0 channels: as many as the pass has.
    const bool ids = array.ids != nullptr;
    const void* data = ids ? static_cast<const void*>(array.ids) : array.values;
    const std::ptrdiff_t size = sizeof(float);
    UmbImage image{const_cast<void*>(data),
                   ids ? UMB_TYPE_UINT32 : UMB_TYPE_FLOAT32,
                   request.width,
                   request.height,
                   0,
                   array.channel_stride * size,
                   array.pixel_stride * size,
                   array.row_stride * size};
    calls.job(job, umbSetJobImage(job, array.name.c_str(), &image));
  }
  const bool color = request.effects.empty() ||
                     std::find(request.effects.begin(), request.effects.end(), "output") != request.effects.end();
  if (!request.passes.empty() || request.effects.empty()) {
    if (color) detail::want(job, "color", calls);
    for (const std::string& pass : request.passes)
      if (pass != "color") detail::want(job, pass, calls);
  }
  if (calls.fine()) calls.job(job, umbExecuteJob(job));
  watch.rethrow();
  if (calls.fine()) detail::take(job, request.strokes, picture);
  umbSetDeviceLogCallback(device.get(), nullptr, nullptr);
  return calls.outcome;
}

/// Writes a picture to a file, completely or not at all. The extension selects the format: .png, .webp, .jpg and .pfm
/// (no alpha), .exr (with the passes and the camera), or .svg (strokes only). Colours are written as they are, but
/// those of .exr are scene-linear and premultiplied: the pass "beauty", or else, with a warning, `rgba` without its
/// sRGB encoding, whose tone curve remains. Alpha is omitted if all pixels are opaque. Errors: code 2 for a picture of
/// the wrong size or an unknown extension, 3 for a file that cannot be written.
inline Outcome save(const Picture& picture, const std::string& file, const SaveRequest& request = {}) {
  detail::Calls calls;
  const std::size_t pixels = std::size_t(picture.width) * std::size_t(picture.height);
  const auto wrong = [&](const std::string& name, std::size_t count) {
    calls.outcome = {int(UMB_ERROR_USAGE),
                     name + " of a picture of " + std::to_string(picture.width) + " x " +
                         std::to_string(picture.height) + " pixels cannot have " + std::to_string(count) + " values",
                     {}};
    return calls.outcome;
  };
  const auto ends_with = [&](const char* small, const char* large) {
    return file.size() > 4 && (file.substr(file.size() - 4) == small || file.substr(file.size() - 4) == large);
  };
  if (ends_with(".svg", ".SVG")) {
    std::vector<UmbStroke> strokes;
    std::vector<std::vector<UmbStrokePoint>> points;
    for (const Stroke& stroke : picture.strokes) {
      std::vector<UmbStrokePoint>& all = points.emplace_back();
      for (const StrokePoint& p : stroke.points) all.push_back({p.x, p.y, p.width});
      strokes.push_back(
          {all.data(), all.size(), std::int32_t(stroke.kind), std::uint32_t(stroke.object), stroke.closed});
    }
    calls.alone(umbWriteStrokes(file.c_str(), picture.width, picture.height, strokes.data(), strokes.size(),
                                picture.stroke_color.data(), picture.stroke_opacity));
    return calls.outcome;
  }
  std::vector<const char*> names;
  std::vector<UmbImage> images;
  const auto add = [&](const char* name, const void* data, UmbType type, int channels) {
    names.push_back(name);
    images.push_back({const_cast<void*>(data), type, picture.width, picture.height, channels, 0, 0, 0});
  };
  if (!picture.rgba.empty()) {
    if (picture.rgba.size() != 4 * pixels) return wrong("color", picture.rgba.size());
    add("color", picture.rgba.data(), UMB_TYPE_FLOAT32, 4);
  }
  const bool is_exr = ends_with(".exr", ".EXR"), holds_passes = picture.rgba.empty() || is_exr;
  const auto is_beauty = [](const Pixels& pass) { return pass.name == "beauty"; };
  if (is_exr && !picture.rgba.empty() && std::none_of(picture.passes.begin(), picture.passes.end(), is_beauty))
    calls.outcome.warnings.push_back("'" + file +
                                     "' holds display values without their sRGB encoding: request the pass "
                                     "\"beauty\" for scene-linear light");
  for (const Pixels& pass : picture.passes) {
    if (!holds_passes) break;
    const std::size_t count = pass.ids.empty() ? pass.values.size() : pass.ids.size();
    if (pass.channels < 1 || count != pixels * std::size_t(pass.channels)) return wrong(pass.name, count);
    if (pass.ids.empty())
      add(pass.name.c_str(), pass.values.data(), UMB_TYPE_FLOAT32, pass.channels);
    else
      add(pass.name.c_str(), pass.ids.data(), UMB_TYPE_UINT32, 1);
  }
  UmbView view{};
  if (picture.view) {
    std::copy(picture.view->view_from_world.begin(), picture.view->view_from_world.end(), view.view_from_world);
    view.left = picture.view->left;
    view.right = picture.view->right;
    view.bottom = picture.view->bottom;
    view.top = picture.view->top;
    view.orthographic = picture.view->orthographic;
  }
  calls.alone(umbWriteImagesOfView(file.c_str(), names.data(), images.data(), int(images.size()), request.bits,
                                   request.half, picture.view ? &view : nullptr));
  return calls.outcome;
}

/// Returns the version of the library, such as "0.2.0".
inline std::string version() {
  const int v = umbGetVersion();
  return std::to_string(v / 10000) + "." + std::to_string(v / 100 % 100) + "." + std::to_string(v % 100);
}

}  // namespace umb
