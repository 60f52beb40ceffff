#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "importer/fbx_parts.h"
#include "scene/readers/polygon.h"
#include "scene/readers/positions.h"
#include "scene/readers/vertex_colors.h"

namespace umbrage {
namespace {

constexpr std::size_t kNoElement = std::size_t(-1);

std::size_t element_of(double index) {
  return index >= 0.0 && index <= double(UINT32_MAX) ? std::size_t(index) : kNoElement;
}

/// Vectors that a geometry gives to vertices, corners, polygons or all of these.
struct Layer {
  const std::vector<double>* values = nullptr;
  const std::vector<double>* indices = nullptr;  ///< into `values`; null: these are in order
  std::string_view by;                           ///< what has a value
  std::size_t width = 3;                         ///< of an element

  /// Returns the number of the element of a corner; kNoElement if there is none.
  std::size_t element(std::size_t vertex, std::size_t corner, std::size_t polygon) const {
    std::size_t at = by == "ByPolygonVertex" ? corner : by == "ByPolygon" ? polygon : by == "AllSame" ? 0 : vertex;
    if (indices) {
      if (at >= indices->size()) return kNoElement;
      at = element_of((*indices)[at]);
    }
    return values && at < values->size() / width ? at : kNoElement;
  }
  glm::vec3 at(std::size_t vertex, std::size_t corner, std::size_t polygon) const {
    const std::size_t found = element(vertex, corner, polygon);
    glm::vec3 vector(0.0f);
    for (std::size_t k = 0; found != kNoElement && k < std::min<std::size_t>(width, 3); ++k)
      vector[int(k)] = float((*values)[found * width + k]);
    return vector;
  }
};

/// Returns the first layer of a kind; without values if there is none. `values`, `indices`: names of its arrays.
Layer layer_of(const FbxRecord& geometry, std::string_view name, std::string_view values, std::string_view indices,
               std::size_t width) {
  const FbxRecord& record = geometry[name];
  Layer layer{.by = record["MappingInformationType"].text(), .width = width};
  if (!record[values].array.empty() && layer.by != "ByEdge") layer.values = &record[values].array;
  if (!record[indices].array.empty() && record["ReferenceInformationType"].text() != "Direct")
    layer.indices = &record[indices].array;
  return layer;
}

std::vector<glm::dvec3> vectors_of(const std::vector<double>& numbers) {
  std::vector<glm::dvec3> vectors(numbers.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
  return vectors;
}

/// Displacements of a geometry's vertices and their normals by its shape keys.
struct Shapes {
  std::vector<glm::dvec3> moves, turns;
  bool moves_any = false, turns_any = false;

  void add(const FbxRecord& shape, double weight) {
    const std::vector<double>& indices = shape["Indexes"].array;
    const std::vector<glm::dvec3> moved = vectors_of(shape["Vertices"].array),
                                  turned = vectors_of(shape["Normals"].array);
    for (std::size_t k = 0; k < indices.size(); ++k) {
      if (!(indices[k] >= 0.0 && indices[k] < double(moves.size()))) continue;
      const auto vertex = std::size_t(indices[k]);
      if (k < moved.size()) moves[vertex] += weight * moved[k];
      if (k < turned.size()) turns[vertex] += weight * turned[k];
      moves_any = moves_any || (k < moved.size() && moved[k] != glm::dvec3(0.0));
      turns_any = turns_any || (k < turned.size() && turned[k] != glm::dvec3(0.0));
    }
  }
};

Shapes shapes_of(const FbxObject& geometry, std::size_t vertices) {
  constexpr double kAll = 100.0;  // percent
  Shapes shapes;
  for (const FbxObject* deformer : geometry.parts("Deformer")) {
    for (const FbxObject* channel : deformer->parts("Deformer")) {
      const std::vector<FbxObject*> targets = channel->parts("Geometry");
      const double percent = channel->number("DeformPercent", (*channel->record)["DeformPercent"].number(0, 0.0));
      if (channel->subtype != "BlendShapeChannel" || targets.empty() || percent == 0.0) continue;
      shapes.moves.resize(vertices), shapes.turns.resize(vertices);
      const std::vector<double>& full = (*channel->record)["FullWeights"].array;
      const auto full_at = [&](std::size_t k) {
        return k < full.size() && full[k] != 0.0 ? full[k] : kAll * double(k + 1) / double(targets.size());
      };
      std::size_t k = 0;
      while (k + 1 < targets.size() && percent > full_at(k)) ++k;
      const double from = k > 0 ? full_at(k - 1) : 0.0, to = full_at(k);
      const double weight = to != from ? (percent - from) / (to - from) : 1.0;
      shapes.add(*targets[k]->record, weight);
      if (k > 0) shapes.add(*targets[k - 1]->record, 1.0 - weight);
    }
  }
  return shapes;
}

glm::dmat4 matrix_of(const std::vector<double>& numbers) {
  glm::dmat4 matrix;
  for (int k = 0; k < 16; ++k) matrix[k / 4][k % 4] = numbers[std::size_t(k)];
  return matrix;
}

/// Returns the transforms of the vertices to world space by the geometry's skins; empty if it has none.
std::vector<BlendedTransform> transforms_of_skins(const FbxPlace& place, std::size_t vertices,
                                                  std::set<std::string>& warnings) {
  constexpr std::size_t kMatrix = 16;
  std::vector<BlendedTransform> transforms;
  for (const FbxObject* skin : place.geometry.parts("Deformer")) {
    if ((*skin->record)["SkinningType"].text() == "DualQuaternion")
      warnings.insert("skins that blend by dual quaternions are drawn with linear blending");
    for (const FbxObject* cluster : skin->parts("Deformer")) {
      const FbxRecord& record = *cluster->record;
      const std::vector<double>&indices = record["Indexes"].array, &weights = record["Weights"].array,
            &link = record["TransformLink"].array, &bind = record["Transform"].array;
      if (cluster->subtype != "Cluster" || link.size() != kMatrix) continue;
      const std::vector<FbxObject*> joints = cluster->parts("Model");
      const auto joint = joints.empty() ? place.worlds.end() : place.worlds.find(joints[0]);
      const glm::dmat4 world_from_joint = joint == place.worlds.end() ? matrix_of(link) : joint->second;
      const glm::dmat4 transform =
          world_from_joint * (bind.size() == kMatrix ? matrix_of(bind) * place.node_from_geometry
                                                     : glm::inverse(matrix_of(link)) * place.world_from_geometry);
      transforms.resize(vertices);
      for (std::size_t k = 0; k < std::min(indices.size(), weights.size()); ++k)
        if (indices[k] >= 0.0 && indices[k] < double(vertices))
          transforms[std::size_t(indices[k])].add(weights[k], transform);
    }
  }
  return transforms;
}

/// A mesh of one material, with the number in the file of each vertex.
struct Part {
  Mesh mesh;
  std::vector<std::uint32_t> vertex_of;
};

/// Splits the polygons of a geometry into the triangles of parts, by material.
class Builder {
 public:
  Builder(const FbxPlace& place, const std::vector<glm::vec3>& positions, const Shapes& shapes)
      : place_(place), record_(*place.geometry.record), positions_(positions), shapes_(shapes) {
    if (shapes.moves_any && !shapes.turns_any) normals_.values = nullptr;  // those of the moved faces
  }

  std::map<int, Part> parts() {
    const std::vector<double>& corners = record_["PolygonVertexIndex"].array;
    std::vector<std::uint32_t> polygon;
    for (std::size_t i = 0, first = 0, number = 0; i < corners.size(); ++i) {
      const double index = corners[i] < 0.0 ? -corners[i] - 1.0 : corners[i];
      polygon.push_back(index <= double(UINT32_MAX) ? std::uint32_t(index) : UINT32_MAX);
      if (corners[i] >= 0.0) continue;
      if (polygon.size() > 2 && !is_hole(number)) add(polygon, first, number);
      polygon.clear();
      first = i + 1;
      ++number;
    }
    return std::move(parts_);
  }

 private:
  bool is_hole(std::size_t polygon) const { return polygon < holes_.size() && holes_[polygon] != 0.0; }

  void add(const std::vector<std::uint32_t>& polygon, std::size_t first_corner, std::size_t number) {
    const std::size_t at = materials_.element(polygon[0], first_corner, number);
    const std::size_t slot = at == kNoElement ? 0 : element_of(std::max((*materials_.values)[at], 0.0));
    const int material = slot < place_.materials.size() ? place_.materials[slot] : place_.default_material;
    auto& [mesh, vertex_of] = parts_[material];
    mesh.material = material;
    const auto base = std::uint32_t(vertex_of.size());
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const std::uint32_t vertex = polygon[k];
      const std::size_t corner = first_corner + k;
      const bool is_known = vertex < positions_.size();
      vertex_of.push_back(is_known ? vertex : 0);
      mesh.positions.push_back(is_known ? positions_[vertex] : glm::vec3(NAN));
      if (normals_.values) {
        glm::vec3 normal = normals_.at(vertex, corner, number);
        if (shapes_.turns_any && is_known) normal += glm::vec3(shapes_.turns[vertex]);
        mesh.normals.push_back(normal);
      }
      if (uvs_.values) mesh.uvs.emplace_back(uvs_.at(vertex, corner, number));
      if (colors_.values) mesh.colors.push_back(linear_color(colors_.at(vertex, corner, number)));
    }
    for (const std::uint32_t corner : splitter_.split(polygon, positions_)) {
      const bool is_known = polygon[corner] < positions_.size();
      mesh.indices.push_back(is_known ? base + corner : UINT32_MAX);
    }
  }

  const FbxPlace& place_;
  const FbxRecord& record_;
  const std::vector<glm::vec3>& positions_;
  const Shapes& shapes_;
  Layer normals_ = layer_of(record_, "LayerElementNormal", "Normals", "NormalsIndex", 3),
        uvs_ = layer_of(record_, "LayerElementUV", "UV", "UVIndex", 2),
        colors_ = layer_of(record_, "LayerElementColor", "Colors", "ColorIndex", 4),
        materials_ = layer_of(record_, "LayerElementMaterial", "Materials", "", 1);
  const std::vector<double>& holes_ = record_["LayerElementHole"]["Hole"].array;
  FaceSplitter splitter_{nullptr};
  std::map<int, Part> parts_;
};

bool is_white(const glm::vec3& color) { return color == glm::vec3(1.0f); }

}  // namespace

std::vector<PlacedMesh> fbx_meshes(const FbxPlace& place, std::set<std::string>& warnings) {
  std::vector<glm::dvec3> exact = vectors_of((*place.geometry.record)["Vertices"].array);
  const Shapes shapes = shapes_of(place.geometry, exact.size());
  OriginFinder finder;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (!shapes.moves.empty()) exact[i] += shapes.moves[i];
    finder.add(exact[i]);
  }
  const glm::dvec3 origin = finder.origin();
  std::vector<glm::vec3> positions;
  positions.reserve(exact.size());
  for (const glm::dvec3& p : exact) positions.emplace_back(p - origin);
  const std::vector<BlendedTransform> skins = transforms_of_skins(place, exact.size(), warnings);
  std::vector<PlacedMesh> meshes;
  for (auto& [material, part] : Builder(place, positions, shapes).parts()) {
    Mesh& mesh = part.mesh;
    if (std::all_of(mesh.colors.begin(), mesh.colors.end(), is_white)) mesh.colors.clear();
    const glm::dmat4 from_origin = glm::translate(glm::dmat4(1.0), origin);
    const auto transform_of = [&, &vertex_of = part.vertex_of](std::size_t i) {
      return skins[vertex_of[i]].mean_or(place.world_from_geometry) * from_origin;
    };
    meshes.push_back(skins.empty() ? placed(std::move(mesh), place.world_from_geometry * from_origin)
                                   : skinned(std::move(mesh), transform_of));
  }
  return meshes;
}

}  // namespace umbrage
