// Meshes from memory: buffers, materials, textures and instances.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

#include "core/color.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "library/scene.h"
#include "library/shared.h"

namespace umbrage {
namespace {

/// A buffer of the caller. `stride`: bytes from one element to the next.
struct Buffer {
  const std::byte* data = nullptr;
  PixelType type = PixelType::kFloat32;
  int channels = 0;
  std::ptrdiff_t stride = 0;

  template <class T>
  T at(std::size_t element, int channel) const {
    T value;
    std::memcpy(&value, data + stride * std::ptrdiff_t(element) + std::ptrdiff_t(sizeof(T)) * channel, sizeof(T));
    return value;
  }
};

Result<void> expect(const Buffer& buffer, const std::string& name, std::initializer_list<PixelType> types, int channels,
                    int max_channels) {
  if (!contains(types, buffer.type)) {
    std::vector<std::string> names;
    for (const PixelType type : types) names.emplace_back(name_of(type));
    return usage_error("the buffer '{}' cannot hold {}: it takes {}", name, name_of(buffer.type), joined_by_or(names));
  }
  if (buffer.channels < channels || buffer.channels > max_channels)
    return usage_error("the buffer '{}' cannot have {} channels: it takes {}{}", name, buffer.channels, channels,
                       max_channels > channels ? fmt::format(" or {}", max_channels) : "");
  return {};
}

constexpr int kMaxComponents = 16;  // of values

/// Copies floats to vectors, one vector for each element.
template <class Vector>
void copy_floats(const Buffer& buffer, std::size_t count, std::vector<Vector>& to) {
  to.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    float* values = reinterpret_cast<float*>(&to[k]);
    for (std::size_t c = 0; c < sizeof(Vector) / sizeof(float); ++c) values[c] = buffer.at<float>(k, int(c));
  }
}

Result<void> set_indices(const Buffer& buffer, SharedMesh& shared) {
  const auto index = [&](std::size_t triangle, int corner) -> std::uint32_t {
    if (buffer.type == PixelType::kUint8) return buffer.at<std::uint8_t>(triangle, corner);
    if (buffer.type == PixelType::kUint16) return buffer.at<std::uint16_t>(triangle, corner);
    return buffer.at<std::uint32_t>(triangle, corner);
  };
  std::vector<std::uint32_t> indices(3 * shared.triangles);
  for (std::size_t k = 0; k < indices.size(); ++k) {
    indices[k] = index(k / 3, int(k % 3));
    if (indices[k] >= shared.vertices)
      return usage_error("triangle {} refers to vertex {}: the mesh has {} vertices", k / 3, indices[k],
                         shared.vertices);
  }
  shared.mesh.indices = std::move(indices);
  return {};
}

void set_colors(const Buffer& buffer, std::size_t count, Mesh& mesh) {
  mesh.colors.resize(count);
  for (std::size_t k = 0; k < mesh.colors.size(); ++k)
    for (int c = 0; c < 3; ++c)
      mesh.colors[k][c] = buffer.type == PixelType::kFloat32 ? buffer.at<float>(k, c)
                          : buffer.type == PixelType::kUint8
                              ? linear_from_srgb(float(buffer.at<std::uint8_t>(k, c)) / 255.0f)
                              : linear_from_srgb(float(buffer.at<std::uint16_t>(k, c)) / 65535.0f);
}

Result<void> set_buffer(const std::string& name, const Buffer& buffer, SharedMesh& shared) {
  constexpr auto kFloat = PixelType::kFloat32;
  Mesh& mesh = shared.mesh;
  const std::size_t count = shared.vertices;
  if (name == "position") {
    if (auto status = expect(buffer, name, {kFloat}, 3, 3); !status) return status;
    copy_floats(buffer, count, mesh.positions);
  } else if (name == "normal") {
    if (auto status = expect(buffer, name, {kFloat}, 3, 3); !status) return status;
    copy_floats(buffer, count, mesh.normals);
    for (glm::vec3& n : mesh.normals) n = unit_or_zero(n);
  } else if (name == "uv") {
    if (auto status = expect(buffer, name, {kFloat}, 2, 2); !status) return status;
    copy_floats(buffer, count, mesh.uvs);
  } else if (name == "radius") {
    if (!mesh.points) return usage_error("the buffer 'radius' is for points: the mesh has triangles");
    if (auto status = expect(buffer, name, {kFloat}, 1, 1); !status) return status;
    std::vector<float> radii;
    copy_floats(buffer, count, radii);
    for (const float r : radii)
      if (!(r > 0.0f) || !std::isfinite(r))
        return usage_error("a point's radius cannot be {}: it takes a finite number above 0", r);
    mesh.radii = std::move(radii);
  } else if (name == "color") {
    if (auto status = expect(buffer, name, {kFloat, PixelType::kUint8, PixelType::kUint16}, 3, 4); !status)
      return status;
    set_colors(buffer, count, mesh);
  } else if (name == "index") {
    if (mesh.points) return usage_error("the buffer 'index' is for triangles: the mesh has none");
    if (auto status = expect(buffer, name, {PixelType::kUint8, PixelType::kUint16, PixelType::kUint32}, 3, 3); !status)
      return status;
    if (auto set = set_indices(buffer, shared); !set) return set;
  } else {
    constexpr std::array<std::string_view, 6> kBuffers = {"position", "normal", "color", "uv", "radius", "index"};
    return usage_error("a mesh has no buffer '{}'{}", name, suggestion(name, kBuffers));
  }
  return {};
}

/// Sets a field of values. Errors: kUsage.
Result<void> set_values(const std::string& name, const Buffer& buffer, bool on_triangles, SharedMesh& shared) {
  if (name.empty()) return usage_error("the name of a mesh's values is empty");
  if (auto status =
          expect(buffer, name, {PixelType::kFloat32, PixelType::kUint8, PixelType::kUint16, PixelType::kUint32}, 1,
                 kMaxComponents);
      !status)
    return status;
  if (on_triangles && shared.mesh.points)
    return usage_error("the values '{}' are of triangles: the mesh has none", name);
  Field field{.name = name, .components = buffer.channels, .on_triangles = on_triangles, .values = {}};
  const std::size_t count = on_triangles ? shared.triangles : shared.vertices;
  field.values.reserve(count * std::size_t(buffer.channels));
  for (std::size_t k = 0; k < count; ++k)
    for (int c = 0; c < buffer.channels; ++c)
      field.values.push_back(buffer.type == PixelType::kFloat32  ? buffer.at<float>(k, c)
                             : buffer.type == PixelType::kUint8  ? float(buffer.at<std::uint8_t>(k, c))
                             : buffer.type == PixelType::kUint16 ? float(buffer.at<std::uint16_t>(k, c))
                                                                 : float(buffer.at<std::uint32_t>(k, c)));
  std::erase_if(shared.mesh.fields, [&](const Field& each) { return each.name == name; });
  shared.mesh.fields.push_back(std::move(field));
  return {};
}

Result<void> set_floats(const std::string& name, std::span<const float> values, SharedMesh& shared) {
  constexpr std::array<std::string_view, 5> kNames = {"albedo", "emission", "specular", "shininess", "alpha_cutoff"};
  const std::size_t count = name == "albedo" || name == "emission" ? 3 : 1;
  if (!contains(kNames, name)) return usage_error("a mesh has no parameter '{}'{}", name, suggestion(name, kNames));
  if (values.size() != count) return usage_error("'{}' of a mesh takes {} numbers, not {}", name, count, values.size());
  for (const float v : values)
    if (!(v >= 0.0f) || !std::isfinite(v))
      return usage_error("'{}' of a mesh cannot be {}: it takes a finite number, 0 or more", name, v);
  Material& material = shared.material;
  if (name == "albedo") {
    material.albedo = {values[0], values[1], values[2]};
    shared.has_albedo = true;
  }
  if (name == "emission") material.emission = {values[0], values[1], values[2]};
  if (name == "specular") material.specular_strength = std::min(values[0], 1.0f);
  if (name == "shininess") material.specular_exponent = values[0];
  if (name == "alpha_cutoff") {
    material.alpha_mask = true;
    material.alpha_cutoff = values[0];
  }
  return {};
}

Result<Texture> texture_of(const std::string& name, const UmbImage& from) {
  const auto image = shared_image("the texture '" + name + "'", from);
  if (!image) return image.error();
  if (!image->data) return usage_error("the texture '{}' has no pixels", name);
  if (image->type != PixelType::kUint8 || image->channels < 3 || image->channels > 4)
    return usage_error("the texture '{}' takes 3 or 4 channels of 8 bits", name);
  Texture texture{.name = name, .width = image->width, .height = image->height, .rgba = {}};
  texture.rgba.reserve(std::size_t(texture.width) * std::size_t(texture.height) * 4);
  for (int y = 0; y < texture.height; ++y)
    for (int x = 0; x < texture.width; ++x)
      for (int c = 0; c < 4; ++c)
        texture.rgba.push_back(c < image->channels ? load<std::uint8_t>(*image, c, x, y) : std::uint8_t(255));
  return texture;
}

/// Checks a buffer of the caller for all vertices or triangles of a mesh. Errors: kUsage.
Result<Buffer> buffer_of(const std::string& name, const void* data, int type, int channels, std::ptrdiff_t stride,
                         const SharedMesh& shared) {
  if (!data) return usage_error("the buffer '{}' is NULL", name);
  const auto known = pixel_type(type);
  if (!known) return known.error();
  const auto fits =
      check_stride(fmt::format("the buffer '{}'", name), stride, std::max(shared.vertices, shared.triangles));
  if (!fits) return fits.error();
  const auto packed = std::ptrdiff_t(size_of(*known)) * channels;
  return Buffer{static_cast<const std::byte*>(data), *known, channels, stride != 0 ? stride : packed};
}

/// Runs `change` on a mesh of a scene.
template <class Change>
UmbError change_mesh(UmbScene scene, int mesh, const char* call, const Change& change) {
  return call_on<SceneObject>(scene, call, Use::kChanges, [&](SceneObject& object) -> Result<void> {
    const auto found = object.mesh(mesh);
    if (!found) return found.error();
    if (Result<void> status = change(**found); !status) return status;
    object.changed();
    return {};
  });
}

}  // namespace
}  // namespace umbrage

using namespace umbrage;  // the functions below are C's

UmbError umbSetMeshBuffer(UmbScene scene, int mesh, const char* name, const void* data, UmbType type, int channels,
                          ptrdiff_t stride) {
  return change_mesh(scene, mesh, "umbSetMeshBuffer", [&](SharedMesh& shared) -> Result<void> {
    const auto buffer = buffer_of(text_of(name), data, type, channels, stride, shared);
    return buffer ? set_buffer(text_of(name), *buffer, shared) : buffer.error();
  });
}

UmbError umbSetMeshValues(UmbScene scene, int mesh, const char* name, bool of_triangles, const void* data, UmbType type,
                          int components, ptrdiff_t stride) {
  return change_mesh(scene, mesh, "umbSetMeshValues", [&](SharedMesh& shared) -> Result<void> {
    const auto buffer = buffer_of(text_of(name), data, type, components, stride, shared);
    return buffer ? set_values(text_of(name), *buffer, of_triangles, shared) : buffer.error();
  });
}

UmbError umbSetMeshFloats(UmbScene scene, int mesh, const char* name, const float* values, int count) {
  return change_mesh(scene, mesh, "umbSetMeshFloats", [&](SharedMesh& shared) -> Result<void> {
    if (!values || count < 0) return usage_error("'{}' of a mesh has no values", text_of(name));
    return set_floats(text_of(name), {values, std::size_t(count)}, shared);
  });
}

UmbError umbSetMeshTexture(UmbScene scene, int mesh, const char* name, const UmbImage* image) {
  return change_mesh(scene, mesh, "umbSetMeshTexture", [&](SharedMesh& shared) -> Result<void> {
    const std::string which = text_of(name);
    if (which != "albedo" && which != "emission")
      return usage_error("a mesh has no texture '{}': it has albedo and emission", which);
    if (!image) return usage_error("the texture '{}' is NULL", which);
    auto texture = texture_of(which, *image);
    if (!texture) return texture.error();
    (which == "albedo" ? shared.albedo : shared.emission) = std::move(*texture);
    return {};
  });
}

UmbError umbAddMeshInstance(UmbScene scene, int mesh, const float world_from_mesh[12]) {
  return change_mesh(scene, mesh, "umbAddMeshInstance", [&](SharedMesh& shared) -> Result<void> {
    if (!world_from_mesh) return usage_error("the matrix of an instance is NULL");
    glm::mat4 matrix(1.0f);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) {
        const float value = world_from_mesh[4 * row + column];
        if (!std::isfinite(value)) return usage_error("the matrix of an instance has a value that is not finite");
        matrix[column][row] = value;
      }
    shared.instances.push_back(matrix);
    return {};
  });
}

UmbError umbRemoveMesh(UmbScene scene, int mesh) {
  return call_on<SceneObject>(scene, "umbRemoveMesh", Use::kChanges,
                              [&](SceneObject& object) { return object.remove_mesh(mesh); });
}
