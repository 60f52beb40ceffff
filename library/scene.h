// SceneObject: a scene of the C interface, to which models and meshes from memory are added.
#pragma once
#include <glm/mat4x4.hpp>
#include <memory>
#include <string>
#include <vector>

#include "library/device.h"
#include "renderer/options.h"
#include "scene/finish.h"
#include "scene/readers/import.h"
#include "scene/scene.h"

namespace umbrage {

/// A mesh from memory. Buffers that the caller has not set are empty; the counts alone use no memory.
struct SharedMesh {
  std::size_t vertices = 0, triangles = 0;
  ImportSettings settings;  ///< the settings at the time of umbAddMesh
  Mesh mesh;
  Material material;
  bool has_albedo = false;   ///< whether the caller set an albedo
  Texture albedo, emission;  ///< without pixels: no texture
  std::vector<glm::mat4> instances;
  bool is_removed = false;  ///< its number is not reused

  bool is_whole() const { return !mesh.positions.empty() && (mesh.points || !mesh.indices.empty()); }
};

class SceneObject final : public Object {
 public:
  explicit SceneObject(std::shared_ptr<DeviceObject> device) : device_(std::move(device)) {}

  /// Returns a finished copy of the models and all complete meshes, to which a picture may add objects. Appends
  /// warnings about parts of meshes that were left out. Errors: kUsage for an empty scene.
  Result<Scene> copied(std::vector<std::string>& warnings) const;
  /// Returns the lower and upper corner of the bounding box of such a copy, in the coordinates of the models' files.
  /// Errors: as for copied.
  Result<std::pair<glm::dvec3, glm::dvec3>> bounds() const;
  /// Returns a number that changes with each change of the scene.
  long version() const { return version_; }

  Result<void> set_parameter(const std::string& name, const char* value);
  Result<void> load(const std::string& model);
  Result<int> add_mesh(const std::string& name, std::size_t vertices, std::size_t triangles);
  Result<SharedMesh*> mesh(int index);
  Result<void> remove_mesh(int index);
  void changed() { ++version_; }
  int camera_count() const {
    return int(!models_.cameras.empty() ? models_.cameras.size() : meshes_.empty() ? models_.views.size() : 0);
  }

  ProgressMonitor progress;

 protected:
  Object* reporting_device() override { return device_.get(); }

 private:
  Error empty_scene_error() const;

  std::shared_ptr<DeviceObject> device_;
  Request request_;  // parameters for models and meshes added later
  Scene models_;
  bool has_models_ = false;
  std::vector<SharedMesh> meshes_;
  long version_ = 0;
};

/// Sets a caller's callback for the progress of a scene or a job; null removes it.
template <class T>
UmbError set_progress(const void* handle, const char* call, UmbProgressCallback callback, void* user) {
  return call_on<T>(handle, call, Use::kChanges, [&](T& object) -> Result<void> {
    object.progress = {};
    if (callback) object.progress = [callback, user](double done) { return callback(user, done); };
    return {};
  });
}

}  // namespace umbrage
