// The kit that the built-in scenes are made with: shapes as triangle meshes, curves and profiles, placing and joining.
//
// What holds for every shape: y is up and lengths are metres; triangles are counter-clockwise seen from outside;
// normals are unit and point outwards; texture coordinates are metres along the surface (scale_uvs makes repeats of
// them) unless the shape says otherwise; the caller names every tessellation count, and counts below a shape's least
// are raised to it. In profiles, sections and outlines, a point given twice running is a sharp edge; all other points
// are smooth.
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

/// Directions in which a surface closes on itself, so that normals are smooth across the seam.
struct Wrap {
  bool u = false, v = false;
};

/// nu x nv quads over (u, v) in [0, 1]^2; the front is where d/du x d/dv points. Normals are averaged over the faces.
/// Rows that shrink to a point (poles) are allowed.
Mesh surface(int nu, int nv, const std::function<SurfacePoint(float u, float v)>& at, Wrap wrap = {});

/// A flat sheet in the plane y = height, facing +y, between two corners (x, z).
Mesh plane(glm::vec2 low, glm::vec2 high, float height, int nx, int nz);

/// The quadrilateral a b c d (counter-clockwise from the front), nu quads along ab and nv along bc.
Mesh quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, int nu, int nv);

/// Hanging cloth: width along x, centred, from y = 0 down to -height, front +z. `folds` waves of depth +-depth that
/// start gathered at the top and open and wander downwards; `seed` changes them. nu quads across, nv down.
Mesh drape(float width, float height, float folds, float depth, std::uint32_t seed, int nu, int nv);

// ------------------------------------------------------------------------------------------------------------ solids

/// A box between two corners. Edges are rounded by `bevel` with 2 * bevel_segments quads across; with either 0, sharp.
Mesh box(glm::vec3 low, glm::vec3 high, float bevel = 0.0f, int bevel_segments = 1);

/// A sphere round the origin.
Mesh sphere(float radius, int slices, int stacks);

/// A sphere round the origin made of six faces of n x n quads: no poles. `displace` maps a unit direction to a radius.
Mesh cube_sphere(int n, const std::function<float(glm::vec3)>& displace);

/// A superellipsoid |x/rx|^p + |y/ry|^p + |z/rz|^p = 1 round the origin: power 2 is an ellipsoid, 3 to 6 a cushion or a
/// worn stone. Six faces of n x n quads.
Mesh superellipsoid(glm::vec3 radii, float power, int n);

/// A cushion: size.x by size.z, size.y thick in the middle and thin along its seam, corners pulled out. Round the
/// origin, lying flat; n x n quads on either side.
Mesh cushion(glm::vec3 size, int n);

/// A ring round the y axis.
Mesh torus(float ring_radius, float tube_radius, int slices, int sides);

/// A cylinder or cone on the y axis from y = 0 to height, with flat caps.
Mesh cone(float radius_bottom, float radius_top, float height, int slices, int stacks = 1);
inline Mesh cylinder(float radius, float height, int slices, int stacks = 1) {
  return cone(radius, radius, height, slices, stacks);
}

/// Surface of revolution about y. The profile holds (radius, y) and runs upwards on the outside: from the axis at the
/// bottom, out, up and back to the axis closes the solid. `turn_deg` below 360 makes a sector, open at its ends.
/// uvs: metres round the widest place, and metres along the profile.
Mesh lathe(std::span<const glm::vec2> profile, int slices, float turn_deg = 360.0f);

/// Prism: an outline (x, y), counter-clockwise, without holes, from z = 0 to depth, with both caps.
Mesh extrusion(std::span<const glm::vec2> outline, float depth);

/// A closed section (counter-clockwise seen against the direction of travel) along a smooth path; its x axis starts
/// as near to `side` as it can and turns as little as possible [Wang et al. 2008, rotation-minimising frames].
/// `scale` holds one factor per path point, or is empty. Open paths get flat caps.
Mesh sweep(std::span<const glm::vec3> path, std::span<const glm::vec2> section, glm::vec3 side,
           bool closed_path = false, std::span<const float> scale = {});

/// A round bar along a smooth path.
Mesh tube(std::span<const glm::vec3> path, float radius, int sides, bool closed_path = false,
          std::span<const float> scale = {});

/// A moulding with mitred corners along a horizontal polyline: skirting, cornice, frame. The open section holds
/// (out, up): out is to the right of travel, and the section runs so that its right-hand side is the outside: from
/// bottom to top of a cornice on the right of the path. Ends are left open.
Mesh moulding(std::span<const glm::vec3> path, std::span<const glm::vec2> section, bool closed);

/// Wall over a round-headed opening: x in +-width/2, y in [0, height], z in +-depth/2, less a half disc of diameter
/// `opening` round the origin. Front, back, the underside of the arch and the two springings; with `closed`, also top
/// and ends.
Mesh arch(float opening, float width, float height, float depth, int segments, bool closed = false);

/// A wall in the plane z, x in [0, size.x], y in [0, size.y], `depth` thick (z in [-depth, 0], front +z), with one
/// rectangular hole between two corners; reveals included.
Mesh wall_with_hole(glm::vec2 size, glm::vec2 hole_low, glm::vec2 hole_high, float depth);

// ---------------------------------------------------------------------------------------------- curves and profiles

/// n points evenly round a circle, counter-clockwise from (radius, 0).
Points2 circle(float radius, int n);

/// A rectangle round the origin, counter-clockwise, all four corners sharp; with `round` and n > 0, rounded by n
/// segments.
Points2 rectangle(glm::vec2 size, float round = 0.0f, int n = 1);

/// The same points, each a sharp corner.
Points2 sharp(std::span<const glm::vec2> points);

/// A smooth curve through the points (Catmull-Rom), `segments` per span.
Points2 smooth(std::span<const glm::vec2> points, int segments);
Points3 smooth(std::span<const glm::vec3> points, int segments, bool closed = false);

/// Points on an arc round `centre`, from one angle to another (degrees, from +x towards +y), both ends included.
Points2 arc(glm::vec2 centre, float radius, float from_deg, float to_deg, int segments);

/// Joins pieces of a profile; where one ends and the next begins, the edge is sharp.
Points2 join(std::initializer_list<Points2> pieces);

// --------------------------------------------------------------------------------------------- placing and joining

/// Applies an affine map; mirrored meshes are turned right side out again.
Mesh transformed(Mesh mesh, const glm::mat4& map);
Mesh moved(Mesh mesh, glm::vec3 by);
Mesh scaled(Mesh mesh, glm::vec3 by);
/// Turned about an axis through the origin, counter-clockwise seen from the axis' tip.
Mesh turned(Mesh mesh, glm::vec3 axis, float angle_deg);
inline Mesh turned_x(Mesh mesh, float angle_deg) { return turned(std::move(mesh), {1, 0, 0}, angle_deg); }
inline Mesh turned_y(Mesh mesh, float angle_deg) { return turned(std::move(mesh), {0, 1, 0}, angle_deg); }
inline Mesh turned_z(Mesh mesh, float angle_deg) { return turned(std::move(mesh), {0, 0, 1}, angle_deg); }

/// Inside out.
Mesh flipped(Mesh mesh);

/// Adds `part` to `mesh`.
void append(Mesh& mesh, const Mesh& part);

/// Moves every point by a function of its place and makes the normals anew, smooth over shared vertices.
void displace(Mesh& mesh, const std::function<glm::vec3(glm::vec3)>& move);

/// Makes normals anew from the faces round each vertex, weighted by area.
void renew_normals(Mesh& mesh);

/// Multiplies texture coordinates.
void scale_uvs(Mesh& mesh, glm::vec2 by);

/// Texture coordinates in metres from the positions, seen along the axis nearest to each normal.
void box_uvs(Mesh& mesh);

// ----------------------------------------------------------------------------------------------------------- scenes

/// Add to a scene and return the index.
int add_texture(Scene& scene, Texture texture);
int add_material(Scene& scene, Material material);

/// Adds materials to a scene and returns their indices. Highlights: strength from 0 to 1, and Blinn-Phong exponent.
struct MaterialMaker {
  Scene& scene;
  int plain(std::string name, glm::vec3 albedo, float strength = 0.0f, float exponent = 32.0f) const;
  int textured(std::string name, Texture texture, float strength = 0.0f, float exponent = 32.0f) const;
  /// Its texture's alpha says where it is.
  int cut_out(std::string name, Texture texture) const;
};

/// Adds a mesh under a name; its object id is its index, or that of an earlier mesh whose part it is. Empty meshes are
/// left out. Returns the object id.
int add_mesh(Scene& scene, std::string name, Mesh mesh, int material, int part_of = -1);

/// How finely a scene is tessellated: counts at scale 1 are what the code says, and all grow with the scale.
struct Detail {
  float scale = 1.0f;
  /// A count that is `base` at scale 1, never below `least`.
  int operator()(float base, int least = 1) const;
};

/// Builds a scene with about the wanted number of triangles: makes it at scale 1, sees how many that gives, and mends
/// the scale until the count is within a fifth or does not follow any more (the scene's least).
Scene build_to_count(int triangles, const std::function<Scene(const Detail&)>& build);

/// The same with materials and textures that are made once: every try gets their indices alone.
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
