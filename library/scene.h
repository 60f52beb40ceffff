// SceneObject: a scene of the C interface, as models and meshes from memory are added to it.
#pragma once
#include <glm/mat4x4.hpp>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "library/device.h"
#include "renderer/options.h"
#include "scene/finish.h"
#include "scene/readers/import.h"
#include "scene/scene.h"

namespace umbrage {

/// A mesh from memory, as its buffers are set. Lists that nobody has set are empty: numbers alone take no memory.
struct SharedMesh {
  std::size_t vertices = 0, triangles = 0;
  ImportSettings settings;  ///< as they were when it was added
  Mesh mesh;
  Material material;
  bool has_albedo = false;   ///< that the caller set
  Texture albedo, emission;  ///< without pixels: none
  std::vector<glm::mat4> instances;
  bool is_removed = false;  ///< its number stays

  bool is_whole() const { return !mesh.positions.empty() && (mesh.points || !mesh.indices.empty()); }
};

class SceneObject final : public Object {
 public:
  explicit SceneObject(std::shared_ptr<DeviceObject> device) : device_(std::move(device)) {}

  /// The models and all meshes that are whole, finished. A copy: what a picture adds to it is that picture's.
  /// Adds warnings of what was left out of meshes. Errors: kUsage for an empty scene.
  Result<Scene> copied(std::vector<std::string>& warnings) const;
  /// The box of that. Errors: the same.
  Result<SceneBox> bounds() const;
  /// Changes with each change.
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
  DeviceObject* teller() override { return device_.get(); }

 private:
  Error nothing_there() const;

  std::shared_ptr<DeviceObject> device_;
  Request request_;  // how what follows is read
  Scene models_;
  bool has_models_ = false;
  std::vector<SharedMesh> meshes_;
  long version_ = 0;
};

/// Has a caller's callback told of the progress of a scene or a job; null: nobody.
template <class T>
UmbError set_progress(const void* handle, const char* call, UmbProgressCallback callback, void* user) {
  return call_on<T>(handle, call, Use::kChanges, [&](T& object) -> Result<void> {
    object.progress = {};
    if (callback) object.progress = [callback, user](double done) { return callback(user, done); };
    return {};
  });
}

}  // namespace umbrage
