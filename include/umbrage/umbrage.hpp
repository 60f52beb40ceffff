// Umbrage's C++ interface: a thin layer over the C interface, umbrage/umbrage.h, in this header alone. C++17 or later.
// docs/library.md is its guide.
//
// It has two storeys. Device, Scene and Job, here, are the C interface's objects, with references that count
// themselves, and errors as exceptions where the build has those. render, shade and FrameRenderer, in
// umbrage/render.hpp, take a request as a plain struct (umbrage/requests.hpp) and return an Outcome; they throw only
// what a caller's own callback throws.
//
// A function that returns UmbError throws Error in place of all but UMB_ERROR_NONE. Without exceptions
// (-fno-exceptions) it returns the code, and error() has the sentence; an object that could not be made is empty, and
// thread_error() has the reason, as it has of a call that came while another thread was at work on the object. Calls of
// an empty object, such as one that was moved from, are UMB_ERROR_USAGE.
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
/// Of parameters: numbers, but no characters, which are neither numbers nor strings.
template <class T>
constexpr bool is_number = (std::is_arithmetic_v<T> && !std::is_same_v<T, char> && !std::is_same_v<T, wchar_t> &&
                            !std::is_same_v<T, char16_t> && !std::is_same_v<T, char32_t>) ||
                           (std::is_enum_v<T> && std::is_convertible_v<T, int>);

/// Numbers as the command line takes them, in any locale.
inline std::string text_of(const float* values, std::size_t count) {
  constexpr int kDigits = 9;  // that tell any two floats apart
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(kDigits);
  for (std::size_t k = 0; k < count; ++k) text << (k > 0 ? "," : "") << values[k];
  return text.str();
}

/// `set` for values of all types. Self has assign for text, bool, int, float, and floats with their number.
template <class Self>
class Parameters {
 public:
  UmbError set(const std::string& name, const std::string& value) { return self().assign(name, value); }
  UmbError set(const std::string& name, std::string_view value) { return self().assign(name, std::string(value)); }
  UmbError set(const std::string& name, const char* value) { return self().assign(name, std::string(value)); }
  UmbError set(const std::string& name, const void* value) = delete;  // else it would be a bool
  UmbError set(const std::string& name, std::nullptr_t value) = delete;
  /// A bool, a float of any width, or a whole number of any width.
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

/// The lines of a job's last execution.
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

/// What computes: "cpu", "vulkan", "vulkan:N" or "auto".
class Device : public detail::Ref<UmbDevice, umbRetainDevice, umbReleaseDevice> {
 public:
  Device() = default;
  explicit Device(const std::string& name, int threads = 0) : Ref(detail::made(umbNewDevice(name.c_str(), threads))) {}
  /// Of a handle of the C interface, whose reference it takes over: umbRetainDevice first where the caller keeps one.
  /// NULL: an empty one. So do Scene::adopt and Job::adopt.
  static Device adopt(UmbDevice handle) { return Device(handle, detail::Adopted()); }
  std::string description() const {
    const char* text = umbGetDeviceDescription(get());
    return text ? text : "";
  }
  /// Bytes of GPU memory that it holds; 0 on the CPU.
  std::uint64_t memory() const { return umbGetDeviceMemory(get()); }
  /// Hears of each error of the device, its scenes and its jobs; nullptr: nobody does.
  UmbError set_error_callback(UmbErrorCallback callback, void* user = nullptr) {
    return checked(umbSetDeviceErrorCallback(get(), callback, user));
  }
  /// Hears of each warning of its scenes and jobs.
  UmbError set_log_callback(UmbLogCallback callback, void* user = nullptr) {
    return checked(umbSetDeviceLogCallback(get(), callback, user));
  }
  /// The first error since somebody asked, of its scenes and jobs, too; then there is none.
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
  /// Takes over a reference.
  static Scene adopt(UmbScene handle) { return Scene(handle, detail::Adopted()); }
  // set(name, value), of detail::Parameters: how what follows is added.
  /// As if it had never been set.
  UmbError reset(const std::string& name) { return checked(umbSetSceneParameter(get(), name.c_str(), nullptr)); }
  UmbError load(const std::string& model) {
    return checked(progresses_.run(get(), [&](UmbScene scene) { return umbLoadModel(scene, model.c_str()); }));
  }
  /// Tells how far it is. What `progress` throws comes out.
  UmbError load(const std::string& model, const Progress& progress) {
    if (!progress) return load(model);
    detail::Watch watch(progress);
    const UmbError code =
        progresses_.run(get(), watch, [&](UmbScene scene) { return umbLoadModel(scene, model.c_str()); });
    if (watch.has_thrown()) umbGetSceneError(get(), nullptr);
    watch.rethrow();
    return checked(code);
  }
  /// The number of the new mesh; below 0, without exceptions: an error.
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
  UmbError set_floats(int mesh, const char* name, const std::vector<float>& values) {
    return checked(umbSetMeshFloats(get(), mesh, name, values.data(), int(values.size())));
  }
  /// "albedo" or "emission": 3 or 4 channels of 8 bits, which are copied.
  UmbError set_texture(int mesh, const char* name, const UmbImage& image) {
    return checked(umbSetMeshTexture(get(), mesh, name, &image));
  }
  /// A place of the mesh: the upper three rows of a matrix, row by row.
  UmbError add_instance(int mesh, const std::array<float, 12>& world_from_mesh) {
    return checked(umbAddMeshInstance(get(), mesh, world_from_mesh.data()));
  }
  /// The box that holds the scene.
  UmbError bounds(std::array<float, 3>& lower, std::array<float, 3>& upper) const {
    return checked(umbGetSceneBounds(get(), lower.data(), upper.data()));
  }
  /// Cameras that the scene's files hold.
  int camera_count() const { return umbGetSceneCameraCount(get()); }
  /// For calls without a Progress. It stays after calls with one.
  UmbError set_progress_callback(UmbProgressCallback callback, void* user = nullptr) {
    return checked(progresses_.set(get(), callback, user));
  }
  /// The first error since somebody asked; then there is none.
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

/// One picture that is made again and again.
class Job : public detail::Ref<UmbJob, umbRetainJob, umbReleaseJob>, public detail::Parameters<Job> {
 public:
  Job() = default;
  /// Renders a scene.
  Job(const Device& device, const Scene& scene)
      : Job(detail::made(umbNewRenderJob(device.get(), scene.get())), detail::Adopted()) {}
  /// Shades images.
  explicit Job(const Device& device) : Job(detail::made(umbNewShadeJob(device.get())), detail::Adopted()) {}
  /// Takes over a reference.
  static Job adopt(UmbJob handle) { return Job(handle, detail::Adopted()); }

  // set(name, value), of detail::Parameters: a parameter.
  /// As if it had never been set; without a name: all of them.
  UmbError reset(const std::string& name) { return checked(umbResetJobParameter(get(), name.c_str())); }
  UmbError reset() { return checked(umbResetJobParameter(get(), nullptr)); }

  UmbError set_image(const char* name, const UmbImage& image) { return checked(umbSetJobImage(get(), name, &image)); }
  UmbError remove_image(const char* name) { return checked(umbSetJobImage(get(), name, nullptr)); }
  /// Where a pass is to be written; without an image: to the library's memory.
  UmbError set_output(const char* name, const UmbImage& image = {}) {
    return checked(umbSetJobOutput(get(), name, &image));
  }
  UmbError remove_output(const char* name) { return checked(umbSetJobOutput(get(), name, nullptr)); }

  /// Whether the parameters are right, as far as can be said without scene or images.
  UmbError check() const { return checked(umbCheckJob(get())); }
  /// Does what comes before the first picture.
  UmbError prepare() { return checked(progresses_.run(get(), umbPrepareJob)); }
  UmbError execute() { return checked(progresses_.run(get(), umbExecuteJob)); }
  /// Tells how far it is. What `progress` throws comes out, and the job may go on.
  UmbError prepare(const Progress& progress) { return watched(progress, umbPrepareJob); }
  UmbError execute(const Progress& progress) { return watched(progress, umbExecuteJob); }
  /// For calls without a Progress. It stays after calls with one.
  UmbError set_progress_callback(UmbProgressCallback callback, void* user = nullptr) {
    return checked(progresses_.set(get(), callback, user));
  }

  /// What the last execution has made.
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
  std::vector<Stroke> strokes() const { return detail::strokes_of(get()); }
  UmbError stroke_color(std::array<float, 3>& rgb, float& opacity) const {
    return checked(umbGetJobStrokeColor(get(), rgb.data(), &opacity));
  }
  /// Of all executions: see umbGetJobCounter. -1: there is no such counter.
  std::int64_t counter(const char* name) const { return umbGetJobCounter(get(), name); }
  /// The first error since somebody asked; then there is none.
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

/// Images in the caller's memory, packed.
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

// ---- Without an object ----

/// The last error of this thread that belongs to no object; then there is none.
inline Outcome thread_error() { return detail::taken(umbGetError); }

/// Writes images, each a pass by its name: see umbWriteImages.
inline UmbError write_images(const std::string& file, const std::vector<std::pair<std::string, UmbImage>>& images,
                             const SaveRequest& request = {}) {
  std::vector<const char*> names;
  std::vector<UmbImage> all;
  for (const auto& [name, image] : images) names.push_back(name.c_str()), all.push_back(image);
  return detail::check_with(
      umbWriteImages(file.c_str(), names.data(), all.data(), int(all.size()), request.bits, request.half), umbGetError);
}

/// A name, and one line about it.
struct ListEntry {
  std::string name{}, summary{};
};

/// What there is: looks, effects, devices, ...
inline std::vector<ListEntry> list_of(UmbList of) {
  std::vector<ListEntry> all;
  const char *name = "", *summary = "";
  UmbError code = UMB_ERROR_NONE;
  while ((code = umbGetListEntry(of, int(all.size()), &name, &summary)) == UMB_ERROR_NONE)
    all.push_back({name, summary});
  if (all.empty()) detail::check_with(code, umbGetError);
  return all;
}

/// The parameters of "render", "shade", "scene" or an effect. Their texts live as long as the library.
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

/// How many channels a pass has; 0: there is none of that name.
inline int pass_channels(const std::string& pass) { return umbGetPassChannels(pass.c_str()); }

}  // namespace umb

#include "umbrage/render.hpp"
