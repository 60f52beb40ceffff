// Umbrage's C++ interface: a thin layer over the C interface, umbrage/umbrage.h, in this header alone. C++17 or later.
// docs/library.md is its guide.
//
// It has two storeys. Device, Scene and Job, here, are the C interface's objects, with references that count
// themselves, and errors as exceptions where the build has those. render, shade and FrameRenderer, in
// umbrage/render.hpp, take a request as a plain struct (umbrage/requests.hpp) and return an Outcome; they throw only
// what a caller's own callback throws.
#pragma once
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "umbrage/umbrage.h"

namespace umb {

// ---- Objects ----

/// An error of the C interface as an exception.
class Error : public std::runtime_error {
 public:
  Error(UmbError code_, const std::string& message) : std::runtime_error(message), code(code_) {}
  UmbError code;
};

namespace detail {
/// Throws an object's error; without exceptions the code is returned, and the sentence stays with the object.
template <class Handle>
UmbError check(UmbError code, Handle handle, UmbError (*take)(Handle, const char**)) {
#ifdef __cpp_exceptions
  if (code == UMB_ERROR_NONE) return code;
  const char* message = "";
  take(handle, &message);
  throw Error(code, message);
#else
  (void)handle, (void)take;
  return code;
#endif
}

/// The handle of a new object. Throws where it is null.
template <class Handle>
Handle made(Handle handle) {
#ifdef __cpp_exceptions
  if (!handle) {
    const char* message = "";
    const UmbError code = umbGetError(&message);
    throw Error(code, message);
  }
#endif
  return handle;
}

/// A handle that counts its references.
template <class Handle, void (*retain)(Handle), void (*release)(Handle)>
class Ref {
 public:
  Ref() = default;
  explicit Ref(Handle handle) : handle_(handle) {}
  Ref(const Ref& other) : handle_(other.handle_) { retain(handle_); }
  Ref(Ref&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  Ref& operator=(Ref other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Ref() { release(handle_); }
  /// For calls of the C interface.
  Handle get() const { return handle_; }
  explicit operator bool() const { return handle_ != nullptr; }

 private:
  Handle handle_ = nullptr;
};
}  // namespace detail

/// What computes: "cpu", "vulkan", "vulkan:N" or "auto".
class Device : public detail::Ref<UmbDevice, umbRetainDevice, umbReleaseDevice> {
 public:
  Device() = default;
  explicit Device(const std::string& name, int threads = 0) : Ref(detail::made(umbNewDevice(name.c_str(), threads))) {}
  std::string description() const {
    const char* text = umbGetDeviceDescription(get());
    return text ? text : "";
  }
};

/// Meshes, materials and lights.
class Scene : public detail::Ref<UmbScene, umbRetainScene, umbReleaseScene> {
 public:
  Scene() = default;
  explicit Scene(const Device& device) : Ref(detail::made(umbNewScene(device.get()))) {}
  UmbError set(const char* name, const std::string& value) {
    return check(umbSetSceneParameter(get(), name, value.c_str()));
  }
  UmbError load(const std::string& model) { return check(umbLoadModel(get(), model.c_str())); }
  /// The number of the new mesh.
  int add_mesh(const std::string& name, std::size_t vertices, std::size_t triangles) {
    const int mesh = umbAddMesh(get(), name.c_str(), vertices, triangles);
    if (mesh < 0) check(UMB_ERROR_USAGE);
    return mesh;
  }
  UmbError set_buffer(int mesh, const char* name, const void* data, UmbType type, int channels,
                      std::ptrdiff_t stride = 0) {
    return check(umbSetMeshBuffer(get(), mesh, name, data, type, channels, stride));
  }
  UmbError set_floats(int mesh, const char* name, const std::vector<float>& values) {
    return check(umbSetMeshFloats(get(), mesh, name, values.data(), int(values.size())));
  }

 private:
  UmbError check(UmbError code) const { return detail::check(code, get(), umbGetSceneError); }
};

/// One picture that is made again and again.
class Job : public detail::Ref<UmbJob, umbRetainJob, umbReleaseJob> {
 public:
  Job() = default;
  /// Renders a scene.
  Job(const Device& device, const Scene& scene) : Ref(detail::made(umbNewRenderJob(device.get(), scene.get()))) {}
  /// Shades images.
  explicit Job(const Device& device) : Ref(detail::made(umbNewShadeJob(device.get()))) {}

  UmbError set(const char* name, const char* value) { return check(umbSetJobString(get(), name, value)); }
  UmbError set(const char* name, const std::string& value) { return set(name, value.c_str()); }
  UmbError set(const char* name, const void* value) = delete;  // else it would be a bool
  UmbError set(const char* name, bool value) { return check(umbSetJobBool(get(), name, value)); }
  UmbError set(const char* name, int value) { return check(umbSetJobInt(get(), name, value)); }
  UmbError set(const char* name, float value) { return check(umbSetJobFloat(get(), name, value)); }
  UmbError set(const char* name, double value) { return set(name, float(value)); }
  template <std::size_t count>
  UmbError set(const char* name, const std::array<float, count>& values) {
    return check(umbSetJobFloats(get(), name, values.data(), int(count)));
  }
  UmbError set_image(const char* name, const UmbImage& image) { return check(umbSetJobImage(get(), name, &image)); }
  UmbError set_output(const char* name, const UmbImage& image = {}) {
    return check(umbSetJobOutput(get(), name, &image));
  }
  UmbError execute() { return check(umbExecuteJob(get())); }
  UmbImage output(const char* name) const {
    UmbImage image{};
    check(umbGetJobOutput(get(), name, &image));
    return image;
  }

 private:
  UmbError check(UmbError code) const { return detail::check(code, get(), umbGetJobError); }
};

/// An image of floats, packed.
inline UmbImage image_of(float* data, int width, int height, int channels = 1) {
  return {data, UMB_TYPE_FLOAT32, width, height, channels, 0, 0, 0};
}

}  // namespace umb

#include "umbrage/render.hpp"
