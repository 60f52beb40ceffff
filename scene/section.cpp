#include "scene/section.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "core/numbers.h"
#include "scene/framing.h"
#include "scene/section_parts.h"

namespace umbrage {
namespace {

constexpr std::string_view kAxes = "xyz";
constexpr double kInPlane = 2e-7;  // of the radius, a few roundings of floats: distances that count as 0

/// The positions of a scene along a direction, in its coordinates.
struct Range {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
};

Range range_along(const glm::dvec3& normal, const Scene& scene) {
  Range range;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.object == scene.ground_object) continue;
    for (const glm::vec3& p : mesh.positions) {
      const double at = glm::dot(normal, glm::dvec3(p));
      range.low = std::min(range.low, at), range.high = std::max(range.high, at);
    }
  }
  return range;
}

/// Returns the axis of a normal, or -1.
int axis_of(const glm::dvec3& normal) {
  for (int k = 0; k < 3; ++k)
    if (std::abs(normal[k]) == 1.0) return k;
  return -1;
}

/// Returns a plane in the coordinates of the scene, with its normal towards what is removed.
CutPlane cut_plane(const SectionPlane& plane, const glm::vec3& looks_along, const Scene& scene) {
  CutPlane out{.normal = plane.normal,
               .offset = plane.offset - glm::dot(plane.normal, scene.origin),
               .tolerance = kInPlane * double(scene.radius()),
               .text = plane.text};
  if (plane.is_fraction) {
    const int axis = axis_of(plane.normal);
    const double low = scene.bounds_min[axis], high = scene.bounds_max[axis];
    out.offset = low + plane.offset * (high - low);
  }
  const bool looks_up = glm::dot(out.normal, glm::dvec3(looks_along)) > 0.0;
  if (plane.kept == SectionPlane::Kept::kAbove || (plane.kept == SectionPlane::Kept::kFar && looks_up))
    out.normal = -out.normal, out.offset = -out.offset;
  return out;
}

/// Returns the plane of "x=0.4" and its like; none if the text is not valid.
std::optional<SectionPlane> axis_plane(std::string_view text) {
  if (text.size() < 3) return std::nullopt;
  const std::size_t relation = std::string_view("=<>").find(text[1]);
  const bool is_fraction = text.ends_with('%');
  const auto value = parse_number(text.substr(2, text.size() - 2 - std::size_t(is_fraction)));
  if (relation == std::string_view::npos || !value) return std::nullopt;
  SectionPlane plane{.text = std::string(text), .offset = is_fraction ? *value / 100.0 : *value};
  plane.normal[int(kAxes.find(char(text[0] | 0x20)))] = 1.0;
  plane.is_fraction = is_fraction;
  constexpr SectionPlane::Kept kKept[] = {SectionPlane::Kept::kFar, SectionPlane::Kept::kBelow,
                                          SectionPlane::Kept::kAbove};
  plane.kept = kKept[relation];
  return plane;
}

/// Returns the error for a plane that leaves nothing of a model, or all of it.
Error missed_error(const CutPlane& plane, const char* what, const Scene& scene) {
  const int axis = axis_of(plane.normal);
  const glm::dvec3 normal = axis >= 0 ? glm::abs(plane.normal) : plane.normal;
  const Range range = range_along(normal, scene);
  const double shift = glm::dot(normal, scene.origin);
  return field_error("sections", plane.text, "`{}` '{}' {}: along {} '{}' extends from {:g} to {:g}", what,
                     axis >= 0 ? std::string(1, kAxes[std::size_t(axis)])
                               : fmt::format("the unit normal {:.3g},{:.3g},{:.3g}", normal.x, normal.y, normal.z),
                     scene.name, range.low + shift, range.high + shift);
}

/// Checks that planes cut a model. `may_miss`: some of its poses, or of several models, may stay whole.
Result<void> check_planes(const SectionSettings& settings, std::span<const CutPlane> planes, bool may_miss,
                          const Scene& scene) {
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const CutPlane& plane = planes[k];
    const Range range = range_along(plane.normal, scene);
    const bool leaves_nothing = range.low >= plane.offset - plane.tolerance;
    if (!leaves_nothing && (may_miss || range.high > plane.offset + plane.tolerance)) continue;
    const bool is_aimed = settings.planes[k].kept != SectionPlane::Kept::kFar;
    return missed_error(plane, leaves_nothing && is_aimed ? "leaves nothing" : "cuts nothing", scene);
  }
  return {};
}

void warn_of_section(const std::vector<SectionPart>& parts, bool has_spheres, Scene& scene) {
  const auto count = [&](auto is_counted) { return std::count_if(parts.begin(), parts.end(), is_counted); };
  const auto open = count([](const SectionPart& part) { return part.is_open; });
  const auto closed = count([](const SectionPart& part) { return part.has_gaps && !part.is_open; });
  if (closed > 0)
    scene.warnings.push_back(fmt::format("{} small gaps where `sections` cut {}: caps close them by straight lines",
                                         closed == 1 ? "1 part has" : fmt::format("{} parts have", closed),
                                         closed == 1 ? "it" : "them"));
  if (open > 0)
    scene.warnings.push_back(fmt::format("{} not closed where `sections` cut {}: there is no cap there",
                                         open == 1 ? "1 part is" : fmt::format("{} parts are", open),
                                         open == 1 ? "it" : "them"));
  if (has_spheres)
    scene.warnings.push_back("`sections` cut no spheres: each is drawn if its centre is on the side that stays");
}

}  // namespace

Result<std::vector<SectionPlane>> parse_sections(const std::string& text) {
  const auto refused = [&](const char* reason) {
    return field_error(
        "sections", text,
        "`{}` cannot be '{}'{}: it takes x=0.4, y=50%, z<0.4 or z>0.4 (the side that stays), or nx,ny,nz,d", reason);
  };
  constexpr const char* kSeparators = ", ";
  std::vector<SectionPlane> planes;
  std::vector<double> numbers;
  std::size_t first = text.find_first_not_of(kSeparators);
  for (std::size_t end; first != text.npos; first = text.find_first_not_of(kSeparators, end)) {
    end = std::min(text.find_first_of(kSeparators, first), text.size());
    std::string_view word = std::string_view(text).substr(first, end - first);
    if (kAxes.find(char(word[0] | 0x20)) != kAxes.npos && numbers.empty()) {
      auto plane = axis_plane(word);
      if (!plane) return refused("");
      planes.push_back(std::move(*plane));
      continue;
    }
    const auto number = parse_number(word);
    if (!number) return refused("");
    numbers.push_back(*number);
    if (numbers.size() < 4) continue;
    const glm::dvec3 normal(numbers[0], numbers[1], numbers[2]);
    const double length = glm::length(normal);
    if (!(length > 0.0) || !std::isfinite(length)) return refused(", whose normal has no length");
    planes.push_back({.text = fmt::format("{:g}", fmt::join(numbers, ",")),
                      .normal = normal / length,
                      .offset = numbers[3] / length,
                      .kept = SectionPlane::Kept::kBelow});
    numbers.clear();
  }
  if (planes.empty() || !numbers.empty()) return refused("");
  return planes;
}

std::string key_of(const SectionSettings& settings) {
  std::string key = fmt::format(" sections {} {}", settings.hatched, settings.is_blank);
  for (const SectionPlane& plane : settings.planes)
    key += fmt::format(" {} {} {} {} {} {}", plane.normal.x, plane.normal.y, plane.normal.z, plane.offset,
                       plane.is_fraction, int(plane.kept));
  if (settings.tint) key += fmt::format(" {} {} {}", settings.tint->r, settings.tint->g, settings.tint->b);
  return key;
}

Result<void> cut_scene(const SectionSettings& settings, Scene& scene) {
  if (settings.planes.empty()) return {};
  const bool may_miss = scene.start || !scene.motion.empty();
  const float radius = scene.radius();
  // A view from inside may look up, but plans show what is below.
  const glm::vec3 looks_along =
      -1.01f * glm::normalize(scene.up) - glm::vec3(glm::transpose(frame_scene(scene, {}, 1, 1).view_from_world)[2]);
  std::vector<CutPlane> planes;
  for (const SectionPlane& plane : settings.planes) planes.push_back(cut_plane(plane, looks_along, scene));
  if (auto checked = check_planes(settings, planes, may_miss, scene); !checked) return checked;
  auto around = scene.motion.empty() ? points_around(scene) : scene.motion;
  if (!scene.start) scene.start = std::make_shared<const Scene>(scene);

  std::vector<PartedMesh> meshes;
  std::optional<Mesh> ground;
  bool has_spheres = false;
  int objects = 0;
  for (Mesh& mesh : scene.meshes) {
    objects = std::max(objects, mesh.object + 1);
    if (mesh.object == scene.ground_object) {
      ground = std::move(mesh);
      continue;
    }
    has_spheres |= mesh.spheres;
    meshes.push_back({.mesh = std::move(mesh), .parts = {}});
  }
  std::vector<SectionPart> parts(find_parts(meshes));
  const std::size_t model_meshes = meshes.size();
  for (std::size_t k = 0; k < planes.size(); ++k) {
    std::vector<CutSegment> segments;
    for (PartedMesh& mesh : meshes) cut_mesh(planes[k], mesh, segments);
    for (PartedMesh& cap : caps_of(planes[k], std::move(segments), scene.up, parts)) {
      cap.cap_of = int(k);
      meshes.push_back(std::move(cap));
    }
  }

  scene.meshes.clear();
  for (std::size_t k = 0; k < model_meshes; ++k)
    if (!meshes[k].mesh.positions.empty()) scene.meshes.push_back(std::move(meshes[k].mesh));
  if (ground) scene.meshes.push_back(std::move(*ground));
  meshes.erase(meshes.begin(), meshes.begin() + std::ptrdiff_t(model_meshes));
  add_caps(settings, planes, std::move(meshes), parts, radius, objects, scene);
  if (scene.meshes.size() == std::size_t(bool(ground)))
    return field_error("sections", planes.back().text, "`{}` '{}' leaves nothing of what the others leave of '{}'",
                       scene.name);
  set_motion(std::move(around), scene);
  scene.shape_facts = std::make_shared<ShapeFacts>();
  warn_of_section(parts, has_spheres, scene);
  return {};
}

}  // namespace umbrage
