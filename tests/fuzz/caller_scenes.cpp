// Calls on scenes.
#include <algorithm>
#include <cstring>

#include "caller.h"

namespace umbrage::fuzz {

void Caller::load_model(UmbScene scene) {
  const Text model = choose_.one_in(3)     ? any_odd(choose_)
                     : choose_.one_in(200) ? Text(choose_.one_of(words().scenes))  // some take a second
                                           : Text("scene:solids?detail=1000");
  trace("umbLoadModel", model.shown());
  begin_progress();
  done(umbLoadModel(scene, model.get()), Kind::kScene, scene, "umbLoadModel");
}

void Caller::add_mesh(SceneState& state, UmbScene scene) {
  static const std::vector<std::size_t> kCounts = {3, 1, 0, SIZE_MAX, SIZE_MAX / 12 + 1, (1ull << 31) - 1};
  const std::size_t vertices = choose_.one_in(5) ? choose_.one_of(kCounts) : 8;
  const std::size_t triangles = choose_.one_in(3) ? choose_.one_of(kCounts) : 12;
  const Text name = any_odd(choose_);
  trace("umbAddMesh", name.shown() + " " + std::to_string(vertices) + " " + std::to_string(triangles));
  const int number = umbAddMesh(scene, name.get(), vertices, triangles);
  if (number < 0)
    done(UMB_ERROR_USAGE, Kind::kScene, scene, "umbAddMesh");
  else
    state.meshes.resize(std::max(state.meshes.size(), std::size_t(number) + 1), {vertices, triangles});
  if (number < 0 || vertices != 8 || triangles > 12 || choose_.one_in(6)) return;
  std::vector<float> positions(3 * vertices);
  for (std::size_t k = 0; k < positions.size(); ++k)
    positions[k] = choose_.one_in(40) ? any_number(choose_) : float(k * 7 % 11) - 5.0f;
  std::vector<std::uint16_t> corners(3 * triangles);
  for (std::uint16_t& corner : corners) corner = std::uint16_t(choose_.below(8));
  umbSetMeshBuffer(scene, number, "position", positions.data(), UMB_TYPE_FLOAT32, 3, 0);
  if (triangles > 0) umbSetMeshBuffer(scene, number, "index", corners.data(), UMB_TYPE_UINT16, 3, 0);
  umbGetSceneError(scene, nullptr);
}

void Caller::set_mesh_floats(UmbScene scene) {
  static const std::vector<const char*> kNames = {"albedo", "specular", "shininess", "emission", "alpha_cutoff"};
  const int count = choose_.one_in(8) ? -1 : 1 + 2 * int(choose_.below(2));
  std::vector<float> values(std::size_t(std::max(count, 0)));
  for (float& value : values) value = any_number(choose_);
  const Text name = choose_.one_in(9) ? any_odd(choose_) : Text(choose_.one_of(kNames));
  trace("umbSetMeshFloats", name.shown());
  done(umbSetMeshFloats(scene, any_mesh(), name.get(), choose_.one_in(9) ? nullptr : values.data(), count),
       Kind::kScene, scene, "umbSetMeshFloats");
}

void Caller::change_scene() {
  SceneState& state = pick(scenes_);
  const UmbScene scene = handle_of(state.ref);
  switch (choose_.below(6)) {
    case 0:
      return load_model(scene);
    case 1: {
      static const std::vector<const char*> kNames = {
          "up",          "crease_angle_deg", "point_size",     "point_sprites",
          "scene_index", "animation_index",  "animation_time", "lights"};
      static const std::vector<std::string> kValues = {"+Z", "0,0,0", "1,2,nan", "30", "5%", "discs", "spheres", "0"};
      const Text name = choose_.one_in(6) ? any_odd(choose_) : Text(choose_.one_of(kNames));
      const Text value = choose_.one_in(6) ? any_odd(choose_) : Text(choose_.one_of(kValues));
      trace("umbSetSceneParameter", name.shown() + " " + value.shown());
      done(umbSetSceneParameter(scene, name.get(), value.get()), Kind::kScene, scene, "umbSetSceneParameter");
      return;
    }
    case 2:
      return set_mesh_floats(scene);
    case 3: {
      std::vector<float> place(12);
      for (std::size_t k = 0; k < place.size(); ++k)
        place[k] = choose_.one_in(6) ? any_number(choose_) : k % 5 == 0 ? 1.0f : 0.0f;
      trace("umbAddMeshInstance");
      done(umbAddMeshInstance(scene, any_mesh(), choose_.one_in(12) ? nullptr : place.data()), Kind::kScene, scene,
           "umbAddMeshInstance");
      return;
    }
    default:
      return add_mesh(state, scene);
  }
}

void Caller::set_mesh_buffer() {
  static const std::vector<std::string> kNames = {"position", "index", "position", "index", "normal",
                                                  "color",    "uv",    "radius",   "none"};
  constexpr std::size_t kMax = 100;  // elements; meshes may have more
  SceneState& state = pick(scenes_);
  const UmbScene scene = handle_of(state.ref);
  std::string name = choose_.one_of(kNames);
  const int mesh =
      state.meshes.empty() || choose_.one_in(16) ? any_mesh() : int(choose_.below(unsigned(state.meshes.size())));
  int type = name == "index" ? UMB_TYPE_UINT8 + int(choose_.below(3)) : int(UMB_TYPE_FLOAT32);
  int channels = name == "uv" ? 2 : name == "radius" ? 1 : 3;
  if (name == "color" && choose_.below(2)) type = UMB_TYPE_UINT8 + int(choose_.below(2));
  if (choose_.one_in(10)) type = int(choose_.below(7));
  if (choose_.one_in(10)) channels = choose_.below(2) ? any_int() : 4;
  std::size_t count = 8;
  if (mesh >= 0 && std::size_t(mesh) < state.meshes.size()) {
    const auto [vertices, triangles] = state.meshes[std::size_t(mesh)];
    if (name == "radius" && triangles > 0 && choose_.below(4)) name = "normal", channels = 3;
    count = name == "index" ? triangles : vertices;
  }
  if (count > kMax) return;
  const auto size = std::ptrdiff_t(bytes_of(type) * std::size_t(std::clamp(channels, 1, 4)));
  const std::vector<std::ptrdiff_t> strides = {0, 0, size, size + 1, size + 4, -size, -size - 3};
  const std::ptrdiff_t stride = choose_.one_of(strides), step = stride != 0 ? stride : size;
  const std::ptrdiff_t reach = step * (std::ptrdiff_t(count) - 1);
  Block block(count == 0 ? 0 : std::size_t(std::abs(reach) + size), choose_.below(4));
  std::byte* const first = block.data() + (count > 0 && reach < 0 ? -reach : 0);
  const bool odd = choose_.one_in(3);
  for (std::size_t k = 0; k < count; ++k)
    for (std::ptrdiff_t c = 0; c < std::clamp(channels, 1, 4); ++c) {
      std::byte* const at = first + step * std::ptrdiff_t(k) + std::ptrdiff_t(bytes_of(type)) * c;
      const float number = odd ? any_number(choose_) : float((k * 5 + std::size_t(c) * 3) % 7) - 2.5f;
      const std::uint32_t whole = odd ? choose_.below(9) : std::uint32_t((k + std::size_t(c) * 3) % 8);
      if (type == UMB_TYPE_FLOAT32)
        std::memcpy(at, &number, sizeof number);
      else
        std::memcpy(at, &whole, bytes_of(type));
    }
  trace("umbSetMeshBuffer", name + " of " + std::to_string(mesh));
  const std::uint64_t before = hash_of(block);
  done(umbSetMeshBuffer(scene, mesh, name.c_str(), choose_.one_in(16) ? nullptr : first, UmbType(type), channels,
                        stride),
       Kind::kScene, scene, "umbSetMeshBuffer");
  demand(hash_of(block) == before, "umbSetMeshBuffer wrote to the buffer");
}

void Caller::set_mesh_texture() {
  const UmbScene scene = any_scene();
  const int type = choose_.one_in(6) ? int(choose_.below(7)) : int(UMB_TYPE_UINT8);
  const int channels = choose_.one_in(6) ? 1 + int(choose_.below(5)) : 3 + int(choose_.below(2));
  const bool sound = type >= UMB_TYPE_FLOAT32 && type <= UMB_TYPE_UINT32;
  Pixels texture = valid_image(choose_, sound ? type : int(UMB_TYPE_UINT8), 1 + int(choose_.below(9)),
                               1 + int(choose_.below(9)), channels);
  texture.image.type = type;
  if (choose_.one_in(10)) texture.image.data = nullptr;
  if (choose_.one_in(12)) texture.image.width = std::min(any_int(), 0);
  if (choose_.one_in(12)) texture.image.channels = 0;
  const char* name = choose_.one_in(12) ? nullptr : choose_.below(2) ? "albedo" : "emission";
  trace("umbSetMeshTexture", name ? name : "NULL");
  done(umbSetMeshTexture(scene, any_mesh(), name, choose_.one_in(16) ? nullptr : &texture.image), Kind::kScene, scene,
       "umbSetMeshTexture");
}

}  // namespace umbrage::fuzz
