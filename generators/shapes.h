// Modelling kit of the built-in scenes: shapes as triangle meshes, curves and profiles, placing and joining.
//
// Conventions for all shapes: y is up and lengths are metres; triangles are counter-clockwise seen from outside;
// normals are unit and point outwards; texture coordinates are metres along the surface (scale_uvs converts them to
// repeats) unless noted otherwise; the caller sets every tessellation count, and counts below a shape's minimum are
// raised to it. In profiles, sections and outlines, a point that occurs twice in a row is a sharp edge; all other
// points are smooth.
#pragma once
#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace umbrage::shapes {

using Points2 = std::vector<glm::vec2>;
using Points3 = std::vector<glm::vec3>;

// ---------------------------------------------------------------------------------------------------------- surfaces

/// A point of a parametric surface.
struct SurfacePoint {
  glm::vec3 position{0.0f};
  glm::vec2 uv{0.0f};
};

/// Directions in which a surface closes on itself; normals are smooth across the seam.
struct Wrap {
  bool u = false, v = false;
};

/// Makes nu x nv quads over (u, v) in [0, 1]^2; the front is where d/du x d/dv points. Normals are averaged over the
/// faces. Rows that shrink to a point (poles) are allowed.
Mesh surface(int nu, int nv, const std::function<SurfacePoint(float u, float v)>& at, Wrap wrap = {});

/// Makes a flat sheet in the plane y = height, facing +y, between two corners (x, z).
Mesh plane(glm::vec2 low, glm::vec2 high, float height, int nx, int nz);

/// Makes the quadrilateral a b c d (counter-clockwise from the front), nu quads along ab and nv along bc.
Mesh quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, int nu, int nv);

/// Makes hanging cloth: width along x, centred, from y = 0 down to -height, front +z. It has `folds` waves of depth
/// +-depth, gathered at the top, which open and drift downwards; `seed` changes them. nu quads across, nv down.
Mesh drape(float width, float height, float folds, float depth, std::uint32_t seed, int nu, int nv);

// ------------------------------------------------------------------------------------------------------------ solids

/// Makes a box between two corners. Edges are rounded by `bevel` with 2 * bevel_segments quads across; if either is 0,
/// edges are sharp.
Mesh box(glm::vec3 low, glm::vec3 high, float bevel = 0.0f, int bevel_segments = 1);

/// Makes a sphere around the origin.
Mesh sphere(float radius, int slices, int stacks);

/// Makes a sphere around the origin made of six faces of n x n quads, without poles. `displace` maps a unit direction
/// to a radius.
Mesh cube_sphere(int n, const std::function<float(glm::vec3)>& displace);

/// Makes a superellipsoid |x/rx|^p + |y/ry|^p + |z/rz|^p = 1 around the origin: power 2 is an ellipsoid, 3 to 6 a
/// cushion or a worn stone. Six faces of n x n quads.
Mesh superellipsoid(glm::vec3 radii, float power, int n);

/// Makes a cushion: size.x by size.z, size.y thick in the middle and thin along its seam, corners pulled out. Around
/// the origin, lying flat; n x n quads on either side.
Mesh cushion(glm::vec3 size, int n);

/// Makes a torus around the y axis.
Mesh torus(float ring_radius, float tube_radius, int slices, int sides);

/// Makes a cylinder or cone on the y axis from y = 0 to height, with flat caps.
Mesh cone(float radius_bottom, float radius_top, float height, int slices, int stacks = 1);
inline Mesh cylinder(float radius, float height, int slices, int stacks = 1) {
  return cone(radius, radius, height, slices, stacks);
}

/// Makes a surface of revolution about y. The profile holds (radius, y) and runs upwards on the outside: from the axis
/// at the bottom, out, up and back to the axis closes the solid. `turn_deg` below 360 makes a sector, open at its ends.
/// uvs: metres around the widest place, and metres along the profile.
Mesh lathe(std::span<const glm::vec2> profile, int slices, float turn_deg = 360.0f);

/// Makes a prism: an outline (x, y), counter-clockwise, without holes, from z = 0 to depth, with both caps.
Mesh extrusion(std::span<const glm::vec2> outline, float depth);

/// Sweeps a closed section (counter-clockwise seen against the direction of travel) along a smooth path. The section's
/// x axis starts as close to `side` as possible and rotates as little as possible [Wang et al. 2008,
/// rotation-minimising frames]. `scale` holds one factor per path point, or is empty. Open paths get flat caps.
Mesh sweep(std::span<const glm::vec3> path, std::span<const glm::vec2> section, glm::vec3 side,
           bool closed_path = false, std::span<const float> scale = {});

/// Makes a round bar along a smooth path.
Mesh tube(std::span<const glm::vec3> path, float radius, int sides, bool closed_path = false,
          std::span<const float> scale = {});

/// Makes a moulding with mitred corners along a horizontal polyline: skirting, cornice, frame. The open section holds
/// (out, up): out is to the right of travel, and the outside is on the right-hand side of the section: for a cornice on
/// the right of the path it runs from bottom to top. Ends are left open.
Mesh moulding(std::span<const glm::vec3> path, std::span<const glm::vec2> section, bool closed);

/// Makes a wall over a round-headed opening: x in +-width/2, y in [0, height], z in +-depth/2, minus a half disc of
/// diameter `opening` around the origin. Front, back, the underside of the arch and the two springings; with `closed`,
/// also top and ends.
Mesh arch(float opening, float width, float height, float depth, int segments, bool closed = false);

/// Makes a wall in the plane z, x in [0, size.x], y in [0, size.y], `depth` thick (z in [-depth, 0], front +z), with
/// one rectangular hole between two corners; reveals included.
Mesh wall_with_hole(glm::vec2 size, glm::vec2 hole_low, glm::vec2 hole_high, float depth);

// ---------------------------------------------------------------------------------------------- curves and profiles

/// Returns n evenly spaced points on a circle, counter-clockwise from (radius, 0).
Points2 circle(float radius, int n);

/// Returns a rectangle around the origin, counter-clockwise, all four corners sharp; with `round` and n > 0, rounded by
/// n segments.
Points2 rectangle(glm::vec2 size, float round = 0.0f, int n = 1);

/// Returns the same points, each as a sharp corner.
Points2 sharp(std::span<const glm::vec2> points);

/// Returns a smooth curve through the points (Catmull-Rom), `segments` per span.
Points2 smooth(std::span<const glm::vec2> points, int segments);
Points3 smooth(std::span<const glm::vec3> points, int segments, bool closed = false);

/// Returns points on an arc around `centre`, from one angle to another (degrees, from +x towards +y), both ends
/// included.
Points2 arc(glm::vec2 centre, float radius, float from_deg, float to_deg, int segments);

/// Joins parts of a profile, with sharp edges between them.
Points2 join(std::initializer_list<Points2> pieces);

// --------------------------------------------------------------------------------------------- placing and joining

/// Applies an affine map; the triangles of mirrored meshes are reversed, so that their fronts stay outside.
Mesh transformed(Mesh mesh, const glm::mat4& map);
Mesh moved(Mesh mesh, glm::vec3 by);
Mesh scaled(Mesh mesh, glm::vec3 by);
/// Rotates about an axis through the origin, counter-clockwise seen from the axis' tip.
Mesh turned(Mesh mesh, glm::vec3 axis, float angle_deg);
inline Mesh turned_x(Mesh mesh, float angle_deg) { return turned(std::move(mesh), {1, 0, 0}, angle_deg); }
inline Mesh turned_y(Mesh mesh, float angle_deg) { return turned(std::move(mesh), {0, 1, 0}, angle_deg); }
inline Mesh turned_z(Mesh mesh, float angle_deg) { return turned(std::move(mesh), {0, 0, 1}, angle_deg); }

/// Turns a mesh inside out.
Mesh flipped(Mesh mesh);

/// Appends `part` to `mesh`.
void append(Mesh& mesh, const Mesh& part);

/// Maps every point by a function of its position and recomputes the normals, smooth over shared vertices.
void displace(Mesh& mesh, const std::function<glm::vec3(glm::vec3)>& move);

/// Recomputes normals from the faces around each vertex, weighted by area.
void recompute_normals(Mesh& mesh);

/// Multiplies texture coordinates.
void scale_uvs(Mesh& mesh, glm::vec2 by);

/// Sets texture coordinates in metres from the positions, projected along the axis closest to each normal.
void box_uvs(Mesh& mesh);

// ----------------------------------------------------------------------------------------------------------- scenes

/// Add an element to a scene. Return its index.
int add_texture(Scene& scene, Texture texture);
int add_material(Scene& scene, Material material);

/// Adds materials to a scene and returns their indices. Highlights: strength from 0 to 1, and Blinn-Phong exponent.
struct MaterialMaker {
  Scene& scene;
  int plain(std::string name, glm::vec3 albedo, float strength = 0.0f, float exponent = 32.0f) const;
  int textured(std::string name, Texture texture, float strength = 0.0f, float exponent = 32.0f) const;
  /// Makes a material whose texture's alpha cuts it out.
  int cut_out(std::string name, Texture texture) const;
};

/// Adds a mesh under a name; its object id is its index, or the object id of the earlier mesh `part_of`. Empty meshes
/// are left out. Returns the object id.
int add_mesh(Scene& scene, std::string name, Mesh mesh, int material, int part_of = -1);

/// Tessellation of a scene: counts in the code are for scale 1, and grow with the scale.
struct Detail {
  float scale = 1.0f;
  /// Returns a count that is `base` at scale 1, and at least `min`.
  int operator()(float base, int min = 1) const;
};

/// Builds a scene with about the requested number of triangles: builds it at scale 1, counts the triangles, and adjusts
/// the scale until the count is within a fifth or no longer changes (the minimum of the scene).
Scene build_to_count(int triangles, const std::function<Scene(const Detail&)>& build);

/// Does the same for a scene whose materials and textures are made only once; each attempt gets their indices.
template <class Materials>
Scene build_with_materials(std::string name, int triangles, Materials (*add_materials)(Scene&),
                           Scene (*build)(const Materials&, const Detail&)) {
  Scene palette;
  const Materials materials = add_materials(palette);
  Scene scene = build_to_count(triangles, [&](const Detail& detail) { return build(materials, detail); });
  scene.name = std::move(name);
  scene.materials = std::move(palette.materials);
  scene.textures = std::move(palette.textures);
  return scene;
}

}  // namespace umbrage::shapes

namespace umbrage {

// ------------------------------------------------------------------------------------------------------ rounded hulls

/// Makes a convex solid whose rounded edges catch light as cast and milled ones do: armour plates, wedges, gems. It is
/// the convex hull of at least four points that are not all in one plane. Edges and corners are rounded with radius
/// `bevel` in `segments` steps; faces keep their planes. With 0 segments edges are sharp. The radius must be positive
/// and less than that of the largest sphere inside. Faces are counter-clockwise from outside.
Mesh rounded_hull(std::span<const glm::vec3> points, float bevel, int segments);
inline Mesh rounded_hull(std::initializer_list<glm::vec3> points, float bevel, int segments) {
  return rounded_hull(std::span<const glm::vec3>(points.begin(), points.size()), bevel, segments);
}

}  // namespace umbrage
