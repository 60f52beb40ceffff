// Umbrage's C++ interface: a header-only layer over the C interface, umbrage/umbrage.h. C++17 or later. The guide is
// docs/library.md.
//
// The interface has two levels. Device, Scene and Job, in this header, wrap the objects of the C interface, count their
// references, and report errors as exceptions if the build has exceptions. render, shade and FrameRenderer, in
// umbrage/render.hpp, take a request as a plain struct (umbrage/requests.hpp) and return an Outcome; they throw only
// exceptions of a caller's own callback.
//
// A function that returns UmbError throws Error for all codes except UMB_ERROR_NONE. Without exceptions
// (-fno-exceptions) it returns the code, and error() returns the message. An object that could not be created is empty,
// and thread_error() returns the reason. It also returns the error of a call that was refused because another thread
// uses the object. Calls on an empty object, such as one that was moved from, fail with UMB_ERROR_USAGE.
#pragma once
#include <array>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <locale>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "umbrage/detail.hpp"
#include "umbrage/requests.hpp"
#include "umbrage/umbrage.h"

namespace umb {

// ---- Objects ----

namespace detail {
/// Whether T is a number that a parameter accepts; character types are not.
template <class T>
constexpr bool is_number = (std::is_arithmetic_v<T> && !std::is_same_v<T, char> && !std::is_same_v<T, wchar_t> &&
                            !std::is_same_v<T, char16_t> && !std::is_same_v<T, char32_t>) ||
                           (std::is_enum_v<T> && std::is_convertible_v<T, int>);

/// Formats numbers as the command line reads them, independent of the locale.
inline std::string text_of(const float* values, std::size_t count) {
  constexpr int kDigits = 9;  // enough to distinguish any two floats
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(kDigits);
  for (std::size_t k = 0; k < count; ++k) text << (k > 0 ? "," : "") << values[k];
  return text.str();
}

/// Provides `set` for values of all types. Self must have overloads of `assign` for a string, a bool, an int, a float,
/// and a pointer to floats with their number.
template <class Self>
class Parameters {
 public:
  UmbError set(const std::string& name, const std::string& value) { return self().assign(name, value); }
  UmbError set(const std::string& name, std::string_view value) { return self().assign(name, std::string(value)); }
  UmbError set(const std::string& name, const char* value) { return self().assign(name, std::string(value)); }
  UmbError set(const std::string& name, const void* value) = delete;  // otherwise pointers would convert to bool
  UmbError set(const std::string& name, std::nullptr_t value) = delete;
  /// A bool, a floating-point number of any width, or an integer of any width.
  template <class T, std::enable_if_t<is_number<T>, int> = 0>
  UmbError set(const std::string& name, T value) {
    if constexpr (std::is_same_v<T, bool>) {
      return self().assign(name, value);
    } else if constexpr (std::is_floating_point_v<T>) {
      return self().assign(name, float(value));
    } else {
      const auto number = +value;
      bool fits = true;
      if constexpr (std::is_signed_v<decltype(number)>)
        fits = number >= INT_MIN && number <= INT_MAX;
      else
        fits = number <= unsigned(INT_MAX);
      return fits ? self().assign(name, int(number)) : self().assign(name, std::to_string(number));
    }
  }
  /// Several numbers, such as {0, 1, 0}.
  UmbError set(const std::string& name, std::initializer_list<double> values) {
    return set_floats(name, values.begin(), values.size());
  }
  template <class T, std::size_t count, std::enable_if_t<is_number<T>, int> = 0>
  UmbError set(const std::string& name, const T (&values)[count]) {
    return set_floats(name, values, count);
  }
  template <class T, std::size_t count>
  UmbError set(const std::string& name, const std::array<T, count>& values) {
    return set_floats(name, values.data(), count);
  }
  template <class T>
  UmbError set(const std::string& name, const std::vector<T>& values) {
    return set_floats(name, values.data(), values.size());
  }

 private:
  Self& self() { return static_cast<Self&>(*this); }
  template <class T>
  UmbError set_floats(const std::string& name, const T* values, std::size_t count) {
    std::vector<float> floats(count);
    for (std::size_t k = 0; k < count; ++k) floats[k] = float(values[k]);
    return self().assign(name, floats.data(), count);
  }
};

/// Returns the strokes of a job's last execution.
inline std::vector<Stroke> strokes_of(UmbJob job) {
  std::vector<Stroke> strokes(umbGetJobStrokeCount(job));
  for (std::size_t k = 0; k < strokes.size(); ++k) {
    UmbStroke from{};
    umbGetJobStroke(job, k, &from);
    strokes[k] = {StrokeKind(from.kind), int(from.object_id), from.closed != 0, {}};
    for (std::size_t p = 0; p < from.point_count; ++p)
      strokes[k].points.push_back({from.points[p].x, from.points[p].y, from.points[p].width});
  }
  return strokes;
}
}  // namespace detail

/// A compute device: "cpu", "vulkan", "vulkan:N" or "auto".
class Device : public detail::Ref<UmbDevice, umbRetainDevice, umbReleaseDevice> {
 public:
  Device() = default;
  explicit Device(const std::string& name, int threads = 0) : Ref(detail::made(umbNewDevice(name.c_str(), threads))) {}
  /// Takes ownership of a reference to a handle of the C interface; a caller that needs a reference of its own
  /// calls umbRetainDevice first. NULL gives an empty object. Scene::adopt and Job::adopt do the same.
  static Device adopt(UmbDevice handle) { return Device(handle, detail::Adopted()); }
  std::string description() const {
    const char* text = umbGetDeviceDescription(get());
    return text ? text : "";
  }
  /// Returns the GPU memory that the device has allocated, in bytes; 0 on the CPU.
  std::uint64_t memory() const { return umbGetDeviceMemory(get()); }
  /// Sets the callback for errors of the device, its scenes and its jobs; nullptr removes it.
  UmbError set_error_callback(UmbErrorCallback callback, void* user = nullptr) {
    return checked(umbSetDeviceErrorCallback(get(), callback, user));
  }
  /// Sets the callback for warnings of the device's scenes and jobs; nullptr removes it.
  UmbError set_log_callback(UmbLogCallback callback, void* user = nullptr) {
    return checked(umbSetDeviceLogCallback(get(), callback, user));
  }
  /// Returns and clears the first error since the last call of this function, including errors of the device's scenes
  /// and jobs.
  Outcome error() {
    return detail::taken([this](const char** message) { return umbGetDeviceError(get(), message); });
  }

 private:
  Device(UmbDevice handle, detail::Adopted) : Ref(handle) {}
  UmbError checked(UmbError code) const { return detail::check(code, get(), umbGetDeviceError); }
};

/// Meshes, materials and lights.
class Scene : public detail::Ref<UmbScene, umbRetainScene, umbReleaseScene>, public detail::Parameters<Scene> {
 public:
  Scene() = default;
  explicit Scene(const Device& device) : Scene(detail::made(umbNewScene(device.get())), detail::Adopted()) {}
  /// Takes ownership of a reference: see Device::adopt.
  static Scene adopt(UmbScene handle) { return Scene(handle, detail::Adopted()); }
  // set(name, value), from detail::Parameters, sets a parameter for models and meshes that are added later.
  /// Restores the default of a parameter.
  UmbError reset(const std::string& name) { return checked(umbSetSceneParameter(get(), name.c_str(), nullptr)); }
  UmbError load(const std::string& model) {
    return checked(progresses_.run(get(), [&](UmbScene scene) { return umbLoadModel(scene, model.c_str()); }));
  }
  /// Loads a model and reports progress. Exceptions of `progress` are passed on to the caller.
  UmbError load(const std::string& model, const Progress& progress) {
    if (!progress) return load(model);
    detail::Watch watch(progress);
    const UmbError code =
        progresses_.run(get(), watch, [&](UmbScene scene) { return umbLoadModel(scene, model.c_str()); });
    if (watch.has_thrown()) umbGetSceneError(get(), nullptr);
    watch.rethrow();
    return checked(code);
  }
  /// Adds a mesh and returns its number; a negative value is an error (without exceptions).
  int add_mesh(const std::string& name, std::size_t vertices, std::size_t triangles) {
    const int mesh = umbAddMesh(get(), name.c_str(), vertices, triangles);
    if (mesh < 0)
      detail::fail([this] {
        return detail::told_without_code(UMB_ERROR_INTERNAL,
                                         [this](const char** message) { return umbGetSceneError(get(), message); });
      });
    return mesh;
  }
  UmbError set_buffer(int mesh, const char* name, const void* data, UmbType type, int channels,
                      std::ptrdiff_t stride = 0) {
    return checked(umbSetMeshBuffer(get(), mesh, name, data, type, channels, stride));
  }
  /// Copies values to the mesh, one per vertex or per triangle: see umbSetMeshValues.
  UmbError set_values(int mesh, const char* name, bool of_triangles, const void* data, UmbType type, int components = 1,
                      std::ptrdiff_t stride = 0) {
    return checked(umbSetMeshValues(get(), mesh, name, of_triangles, data, type, components, stride));
  }
  UmbError set_floats(int mesh, const char* name, const std::vector<float>& values) {
    return checked(umbSetMeshFloats(get(), mesh, name, values.data(), int(values.size())));
  }
  /// Copies a texture to the mesh. `name`: "albedo" or "emission". `image`: 8 bits, 3 or 4 channels.
  UmbError set_texture(int mesh, const char* name, const UmbImage& image) {
    return checked(umbSetMeshTexture(get(), mesh, name, &image));
  }
  /// Adds an instance of the mesh. `world_from_mesh`: the upper three rows of a matrix, row by row.
  UmbError add_instance(int mesh, const std::array<float, 12>& world_from_mesh) {
    return checked(umbAddMeshInstance(get(), mesh, world_from_mesh.data()));
  }
  /// Returns the axis-aligned bounding box of the scene.
  UmbError bounds(std::array<double, 3>& lower, std::array<double, 3>& upper) const {
    return checked(umbGetSceneBounds(get(), lower.data(), upper.data()));
  }
  /// Returns the number of cameras that "camera.index" can select.
  int camera_count() const { return umbGetSceneCameraCount(get()); }
  /// Sets the progress callback of calls that are given no Progress. It stays set after calls that are given one.
  UmbError set_progress_callback(UmbProgressCallback callback, void* user = nullptr) {
    return checked(progresses_.set(get(), callback, user));
  }
  /// Returns and clears the first error since the last call of this function.
  Outcome error() {
    return detail::taken([this](const char** message) { return umbGetSceneError(get(), message); });
  }

 private:
  friend class detail::Parameters<Scene>;
  Scene(UmbScene handle, detail::Adopted) : Ref(handle), progresses_(handle) {}
  UmbError checked(UmbError code) const { return detail::check(code, get(), umbGetSceneError); }
  UmbError assign(const std::string& name, const std::string& value) {
    return checked(umbSetSceneParameter(get(), name.c_str(), value.c_str()));
  }
  UmbError assign(const std::string& name, bool value) { return assign(name, std::string(value ? "true" : "false")); }
  UmbError assign(const std::string& name, int value) { return assign(name, std::to_string(value)); }
  UmbError assign(const std::string& name, float value) { return assign(name, &value, 1); }
  UmbError assign(const std::string& name, const float* values, std::size_t count) {
    return assign(name, detail::text_of(values, count));
  }

  detail::Progresses<UmbScene, umbSetSceneProgressCallback> progresses_;
};

/// A job that makes pictures: one each time it is executed.
class Job : public detail::Ref<UmbJob, umbRetainJob, umbReleaseJob>, public detail::Parameters<Job> {
 public:
  Job() = default;
  /// Creates a job that renders a scene.
  Job(const Device& device, const Scene& scene)
      : Job(detail::made(umbNewRenderJob(device.get(), scene.get())), detail::Adopted()) {}
  /// Creates a job that shades a G-buffer.
  explicit Job(const Device& device) : Job(detail::made(umbNewShadeJob(device.get())), detail::Adopted()) {}
  /// Takes ownership of a reference: see Device::adopt.
  static Job adopt(UmbJob handle) { return Job(handle, detail::Adopted()); }

  // set(name, value), from detail::Parameters, sets a parameter.
  /// Restores the default of a parameter; without a name: of all parameters.
  UmbError reset(const std::string& name) { return checked(umbResetJobParameter(get(), name.c_str())); }
  UmbError reset() { return checked(umbResetJobParameter(get(), nullptr)); }

  UmbError set_image(const char* name, const UmbImage& image) { return checked(umbSetJobImage(get(), name, &image)); }
  UmbError remove_image(const char* name) { return checked(umbSetJobImage(get(), name, nullptr)); }
  /// Requests a pass, and sets the image that it is written to; without an image, the library allocates memory.
  UmbError set_output(const char* name, const UmbImage& image = {}) {
    return checked(umbSetJobOutput(get(), name, &image));
  }
  UmbError remove_output(const char* name) { return checked(umbSetJobOutput(get(), name, nullptr)); }

  /// Checks the parameters as far as possible without the scene and the images.
  UmbError check() const { return checked(umbCheckJob(get())); }
  /// Does the work that precedes the first picture: see umbPrepareJob.
  UmbError prepare() { return checked(progresses_.run(get(), umbPrepareJob)); }
  UmbError execute() { return checked(progresses_.run(get(), umbExecuteJob)); }
  /// As above, with reports of progress. Exceptions of `progress` are passed on to the caller, and the job can be
  /// executed again.
  UmbError prepare(const Progress& progress) { return watched(progress, umbPrepareJob); }
  UmbError execute(const Progress& progress) { return watched(progress, umbExecuteJob); }
  /// Sets the progress callback of calls that are given no Progress. It stays set after calls that are given one.
  UmbError set_progress_callback(UmbProgressCallback callback, void* user = nullptr) {
    return checked(progresses_.set(get(), callback, user));
  }

  /// Returns an output of the last execution.
  UmbImage output(const char* name) const {
    UmbImage image{};
    checked(umbGetJobOutput(get(), name, &image));
    return image;
  }
  std::vector<std::string> output_names() const {
    std::vector<std::string> names;
    while (const char* name = umbGetJobOutputName(get(), int(names.size()))) names.push_back(name);
    return names;
  }
  /// What is known about the files of a shade job, after prepare or execute: see umbGetJobFact.
  std::vector<std::string> facts() const {
    std::vector<std::string> texts;
    while (const char* text = umbGetJobFact(get(), int(texts.size()))) texts.push_back(text);
    return texts;
  }
  /// The layers of these files: see umbGetJobFileLayer.
  std::vector<std::string> file_layers() const {
    std::vector<std::string> texts;
    while (const char* text = umbGetJobFileLayer(get(), int(texts.size()))) texts.push_back(text);
    return texts;
  }
  std::vector<Stroke> strokes() const { return detail::strokes_of(get()); }
  UmbError stroke_color(std::array<float, 3>& rgb, float& opacity) const {
    return checked(umbGetJobStrokeColor(get(), rgb.data(), &opacity));
  }
  UmbError view(UmbView& view) const { return checked(umbGetJobView(get(), &view)); }
  /// Returns a counter, summed over all executions: see umbGetJobCounter; -1 for an unknown name.
  std::int64_t counter(const char* name) const { return umbGetJobCounter(get(), name); }
  /// Returns and clears the first error since the last call of this function.
  Outcome error() {
    return detail::taken([this](const char** message) { return umbGetJobError(get(), message); });
  }

 private:
  friend class detail::Parameters<Job>;
  Job(UmbJob handle, detail::Adopted) : Ref(handle), progresses_(handle) {}
  UmbError checked(UmbError code) const { return detail::check(code, get(), umbGetJobError); }
  UmbError assign(const std::string& name, const std::string& value) {
    return checked(umbSetJobString(get(), name.c_str(), value.c_str()));
  }
  UmbError assign(const std::string& name, bool value) { return checked(umbSetJobBool(get(), name.c_str(), value)); }
  UmbError assign(const std::string& name, int value) { return checked(umbSetJobInt(get(), name.c_str(), value)); }
  UmbError assign(const std::string& name, float value) { return checked(umbSetJobFloat(get(), name.c_str(), value)); }
  UmbError assign(const std::string& name, const float* values, std::size_t count) {
    return checked(umbSetJobFloats(get(), name.c_str(), values, int(count)));
  }
  UmbError assign(const std::string& name, const double* values, std::size_t count) {
    return checked(umbSetJobDoubles(get(), name.c_str(), values, int(count)));
  }
  UmbError watched(const Progress& progress, UmbError (*work)(UmbJob)) {
    if (!progress) return checked(progresses_.run(get(), work));
    detail::Watch watch(progress);
    const UmbError code = progresses_.run(get(), watch, work);
    if (watch.has_thrown()) umbGetJobError(get(), nullptr);
    watch.rethrow();
    return checked(code);
  }

  detail::Progresses<UmbJob, umbSetJobProgressCallback> progresses_;
};

/// Describes a packed image in the caller's memory.
inline UmbImage image_of(float* data, int width, int height, int channels = 1) {
  return {data, UMB_TYPE_FLOAT32, width, height, channels, 0, 0, 0};
}
inline UmbImage image_of(std::uint8_t* data, int width, int height, int channels = 1) {
  return {data, UMB_TYPE_UINT8, width, height, channels, 0, 0, 0};
}
inline UmbImage image_of(std::uint16_t* data, int width, int height, int channels = 1) {
  return {data, UMB_TYPE_UINT16, width, height, channels, 0, 0, 0};
}
inline UmbImage image_of(std::uint32_t* data, int width, int height, int channels = 1) {
  return {data, UMB_TYPE_UINT32, width, height, channels, 0, 0, 0};
}

// ---- Functions without an object ----

/// Returns and clears the last error of this thread that belongs to no object.
inline Outcome thread_error() { return detail::taken(umbGetError); }

/// Writes images to a file, each with the name of its pass: see umbWriteImagesOfView.
inline UmbError write_images(const std::string& file, const std::vector<std::pair<std::string, UmbImage>>& images,
                             const SaveRequest& request = {}, const UmbView* view = nullptr) {
  std::vector<const char*> names;
  std::vector<UmbImage> all;
  for (const auto& [name, image] : images) names.push_back(name.c_str()), all.push_back(image);
  return detail::check_with(
      umbWriteImagesOfView(file.c_str(), names.data(), all.data(), int(all.size()), request.bits, request.half, view),
      umbGetError);
}

/// A name and a summary of one line.
struct ListEntry {
  std::string name{}, summary{};
};

/// Returns the entries of a list: looks, effects, devices, ...
inline std::vector<ListEntry> list_of(UmbList of) {
  std::vector<ListEntry> all;
  const char *name = "", *summary = "";
  UmbError code = UMB_ERROR_NONE;
  while ((code = umbGetListEntry(of, int(all.size()), &name, &summary)) == UMB_ERROR_NONE)
    all.push_back({name, summary});
  if (all.empty()) detail::check_with(code, umbGetError);
  return all;
}

/// Returns the parameters of "render", "shade", "scene" or an effect. Their strings are valid as long as the library is
/// loaded.
inline std::vector<UmbParameter> parameters_of(const std::string& owner) {
  std::vector<UmbParameter> all;
  UmbParameter parameter{};
  parameter.size = sizeof parameter;
  UmbError code = UMB_ERROR_NONE;
  while ((code = umbGetParameter(owner.c_str(), int(all.size()), &parameter)) == UMB_ERROR_NONE)
    all.push_back(parameter);
  if (all.empty()) detail::check_with(code, umbGetError);
  return all;
}

/// Returns the number of channels of a pass; 0 for an unknown name.
inline int pass_channels(const std::string& pass) { return umbGetPassChannels(pass.c_str()); }

}  // namespace umb

#include "umbrage/render.hpp"
