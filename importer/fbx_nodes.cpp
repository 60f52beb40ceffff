#include "importer/fbx_nodes.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <set>

#include "scene/front.h"

namespace umbrage {
namespace {

/// Returns a rotation by angles around the three axes. `order`: a value of RotationOrder.
glm::dmat4 rotation_of(const glm::dvec3& angles_deg, int order = 0) {
  static constexpr int kOrders[][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}};
  glm::dmat4 rotation(1.0);
  for (const int axis : kOrders[order]) {
    glm::dvec3 direction(0.0);
    direction[axis] = 1.0;
    rotation = glm::rotate(glm::dmat4(1.0), glm::radians(angles_deg[axis]), direction) * rotation;
  }
  return rotation;
}

glm::dmat4 translation_of(const glm::dvec3& by) { return glm::translate(glm::dmat4(1.0), by); }

constexpr glm::dvec3 kZero(0.0), kOne(1.0);

/// How a child takes the scale of its parent [FBX SDK, FbxTransform::EInheritType].
enum Inherit { kRotateAllScaleAll, kParentScaleFirst, kNoParentScale };

/// A node, with what the transforms of its children depend on.
struct Placing {
  FbxObject* model = nullptr;
  glm::dmat4 world{1.0};
  glm::dmat3 rotation{1.0};  ///< of all nodes from the root on, without their scales
  glm::dvec3 scale{1.0};     ///< its own
  bool is_visible = true;
};

/// Sets the transform [FBX SDK, "Computing transformation matrices"].
void place(const Placing& parent, Placing& node) {
  const FbxObject& m = *node.model;
  const auto vector = [&](const char* name) { return m.vector(name, kZero); };
  node.scale = m.vector("Lcl Scaling", kOne);
  glm::dmat4 rotation = rotation_of(vector("Lcl Rotation"));
  if (m.number("RotationActive", 1.0) != 0.0 && m.number("RotationSpaceForLimitOnly", 0.0) == 0.0)
    rotation = rotation_of(vector("PreRotation")) *
               rotation_of(vector("Lcl Rotation"), m.choice("RotationOrder", 6, 0)) *
               glm::inverse(rotation_of(vector("PostRotation")));
  const glm::dmat4 scaling = glm::scale(glm::dmat4(1.0), node.scale);
  const glm::dvec3 rotation_pivot = vector("RotationPivot"), scaling_pivot = vector("ScalingPivot");
  const glm::dmat4 local = translation_of(vector("Lcl Translation") + vector("RotationOffset") + rotation_pivot) *
                           rotation * translation_of(vector("ScalingOffset") + scaling_pivot - rotation_pivot) *
                           scaling * translation_of(-scaling_pivot);
  node.rotation = parent.rotation * glm::dmat3(rotation);
  glm::dmat3 parent_scale = glm::transpose(parent.rotation) * glm::dmat3(parent.world);
  const int inherit = m.choice("InheritType", 3, kParentScaleFirst);
  if (inherit == kNoParentScale)
    for (int axis = 0; axis < 3; ++axis)
      parent_scale[axis] *= parent.scale[axis] != 0.0 ? 1.0 / parent.scale[axis] : 0.0;
  node.world = parent.world * local;
  if (inherit == kParentScaleFirst) return;
  const glm::dmat3 linear = node.rotation * parent_scale * glm::dmat3(scaling);
  for (int axis = 0; axis < 3; ++axis) node.world[axis] = glm::dvec4(linear[axis], 0.0);
}

/// Returns whether a layer of the display shows a model.
bool is_in_shown_layers(const FbxObject& model) {
  return std::none_of(model.parents.begin(), model.parents.end(), [](const FbxObject::Link& link) {
    return link.object->type == "CollectionExclusive" && link.object->number("Show", 1.0) == 0.0;
  });
}

bool has_levels_of_detail(const FbxObject& model) {
  const auto attributes = model.parts("NodeAttribute");
  return std::any_of(attributes.begin(), attributes.end(),
                     [](const FbxObject* each) { return each->subtype == "LodGroup"; });
}

/// Returns the direction of an axis that the file names, such as "UpAxis".
glm::dvec3 axis_of(const FbxObject& settings, const std::string& name, int otherwise) {
  glm::dvec3 direction(0.0);
  direction[settings.choice(name, 3, otherwise)] = settings.number(name + "Sign", 1.0) < 0.0 ? -1.0 : 1.0;
  return direction;
}

/// Returns the transform from the coordinates of the file to those of the scene.
glm::dmat4 scene_from_file(const FbxFile& file, Scene& scene) {
  FbxObject settings;
  settings.record = &file.root["GlobalSettings"];
  const glm::dvec3 up = axis_of(settings, "UpAxis", 1), front = axis_of(settings, "FrontAxis", 2),
                   right = axis_of(settings, "CoordAxis", 0);
  const glm::dmat3 axes(right, up, front);
  scene.up = glm::vec3(up);
  scene.has_front = glm::determinant(axes) != 0.0 && !settings.property("FrontAxis").values.empty();
  const bool is_usual = glm::vec3(front) == usual_front(scene.up) && glm::determinant(axes) > 0.0;
  if (is_usual || !scene.has_front) return glm::dmat4(1.0);
  scene.up = {0.0f, 1.0f, 0.0f};
  return glm::dmat4(glm::transpose(axes));
}

}  // namespace

glm::dmat4 fbx_node_from_geometry(const FbxObject& model) {
  return translation_of(model.vector("GeometricTranslation", kZero)) *
         rotation_of(model.vector("GeometricRotation", kZero)) *
         glm::scale(glm::dmat4(1.0), model.vector("GeometricScaling", kOne));
}

std::vector<FbxNode> place_fbx_nodes(FbxFile& file, Scene& scene) {
  const glm::dmat4 to_scene = scene_from_file(file, scene);
  std::vector<FbxNode> nodes;
  std::set<const FbxObject*> known;
  std::vector<Placing> stack(1);
  stack[0].model = &file.objects[0];
  bool has_detail = false;
  while (!stack.empty()) {
    const Placing parent = stack.back();
    stack.pop_back();
    const std::vector<FbxObject*> children = parent.model->parts("Model");
    nodes.push_back(
        {parent.model, to_scene * parent.world, parent.is_visible && parent.model->number("Show", 1.0) != 0.0});
    const bool has_levels = has_levels_of_detail(*parent.model);
    has_detail = has_detail || (has_levels && children.size() > 1);
    for (std::size_t k = children.size(); k-- > 0;) {
      if (!known.insert(children[k]).second) continue;
      Placing node{.model = children[k]};
      place(parent, node);
      const bool is_inherited = node.model->number("Visibility Inheritance", 1.0) != 0.0;
      node.is_visible = node.model->number("Visibility", 1.0) > 0.0 && (parent.is_visible || !is_inherited) &&
                        is_in_shown_layers(*node.model) && !(has_levels && k > 0);
      stack.push_back(node);
    }
  }
  if (has_detail) scene.warnings.push_back("of the levels of detail in the file the first is drawn");
  return nodes;
}

}  // namespace umbrage
