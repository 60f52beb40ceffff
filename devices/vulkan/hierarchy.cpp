#include "devices/vulkan/hierarchy.h"

#include <bit>
#include <exception>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <memory>
#include <new>

#include "core/check.h"
#include "devices/vulkan/capture.h"
#include "rays/embree.h"

namespace umbrage {
namespace {

constexpr unsigned kMaxInLeaf = 4;  // a child has three bits for the count: see Hierarchy
// At greater depth Embree splits into halves, so that the tree has at most kHierarchyDepth levels.
constexpr unsigned kDepth = 40;

/// A node made by Embree's builder: two children, or triangles and points.
struct BuiltNode {
  const BuiltNode* children[2] = {nullptr, nullptr};
  RTCBounds bounds[2];
  unsigned count = 0;
  unsigned meshes[kMaxInLeaf], triangles[kMaxInLeaf];
};

/// Thrown when the work is cancelled. Embree's builder ignores the result of its progress callback.
struct Ended : std::exception {};

/// Allocates a node. Embree converts exceptions to errors; its allocator returns null when out of memory. `pointer` is
/// the Watch.
BuiltNode* new_node(RTCThreadLocalAllocator memory, void* pointer) {
  if (static_cast<const Watch*>(pointer)->ended()) throw Ended();
  void* address = rtcThreadLocalAlloc(memory, sizeof(BuiltNode), 16);
  if (!address) throw std::bad_alloc();
  return new (address) BuiltNode;
}

// Enlargement of boxes, relative to position and size: a ray along a side must not miss the box.
constexpr float kBoxEnlargement = 5e-7f;

// Approximate progress when the primitives are collected, and when the tree is built.
constexpr double kCollected = 0.1, kBuilt = 0.8;

float bits(int v) { return std::bit_cast<float>(v); }

/// Writes nodes and triangles in the order of the tree.
struct Flattener {
  const Scene& scene;
  const std::vector<glm::vec3>& positions;
  const std::vector<int>& first_vertex;
  float scale;
  Hierarchy& out;
  Watch& watch;
  int leaves = 0;  ///< number of leaves written so far

  int add(const BuiltNode& node, int depth) {
    check_less(depth, kHierarchyDepth + 1, "depth of a hierarchy");
    if (watch.ended()) return 0;
    if (node.count > 0) {
      const int first = int(out.triangles.size());
      constexpr int kLeaves = 1024;  // leaves between progress reports
      if (leaves++ % kLeaves == 0)
        watch.reached(kBuilt + (1.0 - kBuilt) * double(first) / double(out.triangles.capacity()));
      for (unsigned k = 0; k < node.count; ++k) {
        const Mesh& mesh = scene.meshes[node.meshes[k]];
        if (mesh.points) {
          const std::size_t point = node.triangles[k];
          const int vertex = first_vertex[node.meshes[k]] + int(point);
          const glm::vec3 bend = mesh.bends.empty() ? glm::vec3(0.0f) : mesh.bends[point] / scale;
          out.triangles.push_back({glm::vec4(positions[vertex], bits(int(node.meshes[k]))),
                                   glm::vec4(mesh.spheres ? glm::vec3(0.0f) : mesh.normals[point], bits(vertex)),
                                   glm::vec4(mesh.radii[point] * scale, bend.x, bend.y, bits(vertex)),
                                   glm::vec4(bits(vertex), bits(mesh.spheres ? kSphere : kDisc), bend.z, 0.0f)});
          continue;
        }
        int corner[3];
        for (int c = 0; c < 3; ++c)
          corner[c] = first_vertex[node.meshes[k]] + int(mesh.indices[std::size_t(node.triangles[k]) * 3 + c]);
        out.triangles.push_back({glm::vec4(positions[corner[0]], bits(int(node.meshes[k]))),
                                 glm::vec4(positions[corner[1]], bits(corner[0])),
                                 glm::vec4(positions[corner[2]], bits(corner[1])),
                                 glm::vec4(bits(corner[2]), 0.0f, 0.0f, 0.0f)});
      }
      return ~(first * 8 + int(node.count));
    }
    const std::size_t at = out.nodes.size();
    out.nodes.emplace_back();
    for (int side = 0; side < 2; ++side) {
      const int child = add(*node.children[side], depth + 1);
      const RTCBounds& b = node.bounds[side];
      const glm::vec3 low(b.lower_x, b.lower_y, b.lower_z), high(b.upper_x, b.upper_y, b.upper_z);
      const glm::vec3 margin = kBoxEnlargement * (glm::max(glm::abs(low), glm::abs(high)) + (high - low));
      out.nodes[at][2 * side] = glm::vec4(low - margin, bits(child));
      out.nodes[at][2 * side + 1] = glm::vec4(high + margin, 0.0f);
    }
    return int(at);
  }
};

std::vector<RTCBuildPrimitive> primitives_of(const Scene& scene, const std::vector<glm::vec3>& positions,
                                             const std::vector<int>& first_vertex, float scale, Watch& watch) {
  std::vector<RTCBuildPrimitive> primitives;
  primitives.reserve(scene.triangle_count() + scene.point_count());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    watch.reached(kCollected * double(primitives.size()) / double(primitives.capacity()));
    if (watch.ended()) break;
    for (std::size_t k = 0; k < mesh.radii.size(); ++k) {
      const glm::vec3 p = positions[std::size_t(first_vertex[m]) + k];
      const glm::vec3 n = mesh.spheres ? glm::vec3(0.0f) : mesh.normals[k];
      const glm::vec3 reach = mesh.radii[k] * scale * glm::sqrt(glm::max(1.0f - n * n, glm::vec3(0.0f)));
      const glm::vec3 low = p - reach, high = p + reach;
      primitives.push_back({low.x, low.y, low.z, unsigned(m), high.x, high.y, high.z, unsigned(k)});
    }
    for (std::size_t t = 0; t < scene.meshes[m].indices.size() / 3; ++t) {
      glm::vec3 low(0.0f), high(0.0f);
      for (int c = 0; c < 3; ++c) {
        const glm::vec3 p = positions[std::size_t(first_vertex[m]) + scene.meshes[m].indices[3 * t + c]];
        low = c == 0 ? p : glm::min(low, p);
        high = c == 0 ? p : glm::max(high, p);
      }
      primitives.push_back({low.x, low.y, low.z, unsigned(m), high.x, high.y, high.z, unsigned(t)});
    }
  }
  return primitives;
}

}  // namespace

Result<Hierarchy> build_hierarchy(const Scene& scene, glm::vec3 center, float scale, const ProgressMonitor& monitor) {
  Watch watch(monitor, 1);
  if (watch.ended()) return interrupted();
  Hierarchy out;
  std::vector<glm::vec3> positions;
  std::vector<int> first_vertex;
  for (const Mesh& mesh : scene.meshes) {
    first_vertex.push_back(int(positions.size()));
    for (const glm::vec3& p : mesh.positions) positions.push_back((p - center) * scale);
  }
  std::vector<RTCBuildPrimitive> primitives = primitives_of(scene, positions, first_vertex, scale, watch);
  if (watch.ended()) return interrupted();
  if (primitives.empty()) return out;

  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCBVH bvh) const { rtcReleaseBVH(bvh); }
  };
  const auto started = new_embree_device();
  if (!started) return started.error();
  const std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device(*started);
  const std::unique_ptr<std::remove_pointer_t<RTCBVH>, Release> bvh(rtcNewBVH(device.get()));
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.maxLeafSize = kMaxInLeaf;
  arguments.maxDepth = kDepth;
  arguments.bvh = bvh.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = [](RTCThreadLocalAllocator memory, unsigned, void* pointer) -> void* {
    return new_node(memory, pointer);
  };
  arguments.setNodeChildren = [](void* node, void** children, unsigned, void*) {
    for (int k = 0; k < 2; ++k) static_cast<BuiltNode*>(node)->children[k] = static_cast<const BuiltNode*>(children[k]);
  };
  arguments.setNodeBounds = [](void* node, const RTCBounds** bounds, unsigned, void*) {
    for (int k = 0; k < 2; ++k) static_cast<BuiltNode*>(node)->bounds[k] = *bounds[k];
  };
  arguments.createLeaf = [](RTCThreadLocalAllocator memory, const RTCBuildPrimitive* primitives, std::size_t count,
                            void* pointer) -> void* {
    BuiltNode* node = new_node(memory, pointer);
    node->count = unsigned(count);
    for (std::size_t k = 0; k < count; ++k) {
      node->meshes[k] = primitives[k].geomID;
      node->triangles[k] = primitives[k].primID;
    }
    return node;
  };
  arguments.userPtr = &watch;
  arguments.buildProgress = [](void* pointer, double fraction) {
    auto& building = *static_cast<Watch*>(pointer);
    building.reached(kCollected + (kBuilt - kCollected) * fraction);
    return !building.ended();
  };
  const auto* root = static_cast<const BuiltNode*>(rtcBuildBVH(&arguments));
  if (watch.ended()) return interrupted();
  if (!root) return build_error(scene, rtcGetDeviceError(device.get()));
  out.triangles.reserve(primitives.size());
  out.root = Flattener{scene, positions, first_vertex, scale, out, watch}.add(*root, 1);
  if (watch.ended()) return interrupted();
  return out;
}

}  // namespace umbrage
