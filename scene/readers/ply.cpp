// Reads PLY [Turk 1994]. Used instead of Assimp, since Assimp 5.2 does not support triangle strips and hangs on some
// files with a wrong header; this reader is also faster.
#include "scene/readers/model_readers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "scene/readers/field_columns.h"
#include "scene/readers/ply_parts.h"
#include "scene/readers/polygon.h"
#include "scene/readers/positions.h"
#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;
using ply::Body;
using ply::Element;
using ply::Header;
using ply::Number;
using ply::Property;
using ply::Splat;

// clang-format off
/// Destination of a property: a component of position, normal, texture coordinate, colour or Gaussian.
enum Slot { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kU, kV, kRed, kGreen, kBlue, kAlpha, kScalar, kTexture,
            kOpacity, kHarmonic0, kHarmonic1, kHarmonic2, kScale0, kScale1, kScale2, kRotation0, kRotation1, kRotation2,
            kRotation3, kPacked, kNowhere, kSlots };

Slot slot_of(std::string_view name) {
  struct Named {
    std::string_view name;
    Slot slot;
  };
  static constexpr Named kNames[] = {
      {"x", kX}, {"y", kY}, {"z", kZ}, {"nx", kNormalX}, {"ny", kNormalY}, {"nz", kNormalZ},
      {"u", kU}, {"v", kV}, {"s", kU}, {"t", kV}, {"texture_u", kU}, {"texture_v", kV},
      {"red", kRed}, {"green", kGreen}, {"blue", kBlue}, {"r", kRed}, {"g", kGreen}, {"b", kBlue},
      {"diffuse_red", kRed}, {"diffuse_green", kGreen}, {"diffuse_blue", kBlue}, {"alpha", kAlpha},
      {"rgb", kPacked}, {"rgba", kPacked},
      {"intensity", kScalar}, {"quality", kScalar}, {"reflectance", kScalar}, {"texnumber", kTexture},
      {"opacity", kOpacity},
      {"f_dc_0", kHarmonic0}, {"f_dc_1", kHarmonic1}, {"f_dc_2", kHarmonic2},
      {"scale_0", kScale0}, {"scale_1", kScale1}, {"scale_2", kScale2},
      {"rot_0", kRotation0}, {"rot_1", kRotation1}, {"rot_2", kRotation2}, {"rot_3", kRotation3}};
  for (const Named& named : kNames) {
    if (named.name == name) return named.slot;
  }
  return name.starts_with("scalar_") ? kScalar : kNowhere;  // CloudCompare's names
}
// clang-format on

/// Returns the divisor that maps a colour component to the range 0 to 1.
float full_scale(Number number) {
  switch (number) {
    case Number::kInt8:
    case Number::kUint8:
      return 255.0f;
    case Number::kInt16:
    case Number::kUint16:
      return 65535.0f;
    case Number::kInt32:
    case Number::kUint32:
      return 255.0f;  // written by programs without a smaller type
    case Number::kFloat32:
    case Number::kFloat64:
      return 1.0f;
  }
  return 1.0f;
}

/// The destinations of an element's properties.
struct Slots {
  std::vector<Slot> of;  ///< one per property
  std::array<bool, kSlots> has{};
  float color_scale = 1.0f, alpha_scale = 1.0f;
  Number packed = Number::kUint32;  ///< type of kPacked

  explicit Slots(const Element& element) {
    for (const Property& property : element.properties) {
      of.push_back(property.list_size ? kNowhere : slot_of(property.name));
      if (of.back() == kScalar && has[kScalar]) of.back() = kNowhere;  // the first one counts
      if (of.back() == kPacked) {
        packed = property.number;
        color_scale = 255.0f;
        if (ply::kBytes[std::size_t(packed)] != 4) of.back() = kNowhere;
      }
      has[of.back()] = true;
      if (of.back() == kRed) color_scale = full_scale(property.number);
      if (of.back() == kAlpha) alpha_scale = full_scale(property.number);
    }
  }
  bool all(Slot first, Slot last) const {
    return std::all_of(&has[first], &has[last] + 1, [](bool b) { return b; });
  }
  bool colors() const { return all(kRed, kBlue) || has[kPacked]; }
  /// Gaussians have three scales or, if they are flat, two.
  bool splats() const { return all(kOpacity, kScale1) && all(kRotation0, kRotation3); }
};

using Values = std::array<double, kSlots>;

/// Sets red, green and blue of a row that has them as bytes of one number, as PCL writes them: blue is the lowest, and
/// the number may be a float with these bits.
void unpack_color(const Slots& slots, Values& value) {
  if (!slots.has[kPacked] || !std::isfinite(value[kPacked])) return;
  const double whole = std::clamp(value[kPacked], -2147483648.0, 4294967295.0);  // as int32 or as uint32
  const std::uint32_t bits = slots.packed == Number::kFloat32 ? std::bit_cast<std::uint32_t>(float(value[kPacked]))
                                                              : std::uint32_t(std::int64_t(whole));
  for (int c = 0; c < 3; ++c) value[std::size_t(kRed + c)] = double(bits >> (16 - 8 * c) & 255u);
}

glm::vec3 triple(const Values& values, Slot first) {
  return {float(values[first]), float(values[first + 1]), float(values[first + 2])};
}

/// Returns the fields that `wanted` asks for among the properties of an element.
std::vector<FieldColumns> fields_of(const Element& element, const std::optional<std::string>& wanted) {
  const Slots slots(element);
  std::vector<FileColumn> columns;
  for (std::size_t k = 0; k < slots.of.size(); ++k) {
    const Property& property = element.properties[k];
    const bool is_value = slots.of[k] == kNowhere || slots.of[k] == kScalar || slots.of[k] == kOpacity;
    columns.push_back({property.list_size ? "" : property.name, is_value});
  }
  auto fields = field_columns(columns, wanted);
  for (FieldColumns& each : fields) each.field.on_triangles = element.name != "vertex";
  return fields;
}

/// Moves the values of fields to a mesh.
void add_fields(std::vector<FieldColumns> fields, Mesh& mesh) {
  for (FieldColumns& each : fields) mesh.fields.push_back(std::move(each.field));
}

/// What is read from a file besides its mesh.
struct Contents {
  Mesh mesh;
  std::vector<Splat> splats;
  std::vector<float> scalars;  ///< one per vertex, or empty
  std::string scalar_name;
  FaceAttributes faces;
  std::vector<int> textures;  ///< for each triangle: index of a texture; kNoTexture: none
  bool has_textures = false;  ///< some triangles have texture coordinates at their corners
  bool transparent = false;
};

/// Reads a list and calls visit(number) for each of its numbers. A count that is too large ends with its row.
template <class Visit>
void read_list(const Property& property, Body& body, Visit visit) {
  const double count = body.next(*property.list_size);
  for (double j = 0; j < count && body.row_goes_on(); ++j) visit(body.next(property.number));
}

/// `indexed`: other elements refer to vertices by their index, so bad ones are kept, and dropped with their triangles.
void read_vertices(const Element& element, bool indexed, const std::optional<std::string>& field, Body& body,
                   Contents& out, Scene& scene, Poll* poll) {
  const Slots slots(element);
  Mesh& mesh = out.mesh;
  const bool has_normals = slots.all(kNormalX, kNormalZ), has_uvs = slots.all(kU, kV), has_colors = slots.colors();
  std::vector<glm::dvec3> positions;
  positions.reserve(element.count);
  if (has_normals) mesh.normals.reserve(element.count);
  if (has_uvs) mesh.uvs.reserve(element.count);
  if (has_colors) mesh.colors.reserve(element.count);
  const auto is_scalar = [](Slot slot) { return slot == kScalar; };
  if (slots.has[kScalar])
    out.scalar_name =
        element.properties[std::size_t(std::find_if(slots.of.begin(), slots.of.end(), is_scalar) - slots.of.begin())]
            .name;
  std::vector<FieldColumns> fields = fields_of(element, field);
  std::vector<double> row(slots.of.size());
  for (std::size_t i = 0; i < element.count && !body.ended() && !stops(poll, i, element.count); ++i) {
    Values value{};
    body.begin_row();
    for (std::size_t k = 0; k < slots.of.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.list_size) {
        read_list(property, body, [](double) {});
      } else {
        value[slots.of[k]] = row[k] = body.next(property.number);
      }
    }
    if (body.end_row()) {
      if (!indexed) continue;
      value[kX] = std::numeric_limits<double>::quiet_NaN();
    }
    unpack_color(slots, value);
    if (!slots.has[kScale2]) value[kScale2] = -std::numeric_limits<double>::infinity();
    positions.emplace_back(value[kX], value[kY], value[kZ]);
    for (FieldColumns& each : fields) each.append([&](std::size_t k) { return row[k]; });
    if (has_normals) mesh.normals.push_back(triple(value, kNormalX));
    if (has_uvs) mesh.uvs.emplace_back(float(value[kU]), float(value[kV]));
    if (has_colors) mesh.colors.push_back(triple(value, kRed));
    if (slots.has[kAlpha]) out.transparent = out.transparent || value[kAlpha] < slots.alpha_scale;
    if (slots.has[kScalar] && !has_colors) out.scalars.push_back(float(value[kScalar]));
    if (slots.splats())
      out.splats.push_back({triple(value, kHarmonic0), float(value[kOpacity]), triple(value, kScale0),
                            glm::vec4(float(value[kRotation0]), triple(value, kRotation1))});
  }
  set_positions(positions, mesh, scene);
  add_fields(std::move(fields), mesh);
  float brightest = 0.0f;
  for (const glm::vec3& c : mesh.colors) brightest = std::max({brightest, c.x, c.y, c.z});
  // Some programs write bytes as floats.
  const float scale = slots.color_scale == 1.0f && brightest > 1.0f ? 255.0f : slots.color_scale;
  for (glm::vec3& c : mesh.colors) c = linear_color(c / scale);
}

constexpr std::uint32_t kNoVertex = 0xffffffffu;  // out of range of any mesh; such triangles are dropped later

std::uint32_t vertex_of(double index) {
  return index >= 0.0 && index < double(kNoVertex) ? std::uint32_t(index) : kNoVertex;
}

/// Adds the triangles of strips. Every second triangle of a strip has the opposite winding; index -1 starts a new
/// strip.
void add_strips(const std::vector<std::uint32_t>& corners, Mesh& mesh) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] == kNoVertex) {
      begin = i + 1;
    } else if (i >= begin + 2) {
      const bool is_flipped = (i - begin) % 2 == 1;
      mesh.indices.insert(mesh.indices.end(),
                          {corners[is_flipped ? i - 1 : i - 2], corners[is_flipped ? i - 2 : i - 1], corners[i]});
    }
  }
}

/// Reads the lists of faces or strips; skips all other elements.
void read_lists(const Element& element, const std::optional<std::string>& field, Body& body, std::size_t texture_count,
                Contents& out, Poll* poll) {
  const bool strips = element.name == "tristrips", faces = element.name == "face";
  const Slots slots(element);
  const auto list_named = [&](const char* a, const char* b) {
    const int found = faces || strips ? element.find(a, true) : -1;
    return found >= 0 || !(faces || strips) ? found : element.find(b, true);
  };
  const int index_list = list_named("vertex_indices", "vertex_index"), uv_list = list_named("texcoord", "texcoords");
  const bool has_colors = faces && slots.colors(), has_uvs = faces && uv_list >= 0;
  FaceSplitter splitter(poll);
  std::vector<FieldColumns> fields = faces ? fields_of(element, field) : std::vector<FieldColumns>();
  std::vector<double> row(slots.of.size());
  std::vector<std::uint32_t> corners;
  std::vector<float> uvs;
  for (std::size_t i = 0; i < element.count && !body.ended() && !stops(poll, i, element.count); ++i) {
    Values value{};
    corners.clear();
    uvs.clear();
    if (!element.properties.empty()) body.begin_row();
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const Property& property = element.properties[k];
      if (!property.list_size) {
        value[slots.of[k]] = row[k] = body.next(property.number);
        continue;
      }
      read_list(property, body, [&](double number) {
        if (int(k) == index_list) corners.push_back(vertex_of(number));
        if (int(k) == uv_list && has_uvs) uvs.push_back(float(number));
      });
    }
    if (!element.properties.empty() && body.end_row()) continue;
    if (body.ended()) return;
    if (strips) {
      add_strips(corners, out.mesh);
      continue;
    }
    if (!faces) continue;
    const std::vector<std::uint32_t>& triangles = splitter.split(corners, out.mesh.positions);
    for (const std::uint32_t corner : triangles) out.mesh.indices.push_back(corners[corner]);
    for (FieldColumns& each : fields)
      for (std::size_t k = 0; k < triangles.size() / 3; ++k)
        each.append([&](std::size_t column) { return row[column]; });
    const bool textured = uvs.size() == 2 * corners.size();
    if (has_uvs) {
      for (const std::uint32_t k : triangles)
        out.faces.uvs.push_back(textured ? glm::vec2(uvs[2 * k], uvs[2 * k + 1]) : glm::vec2(0.0f));
      const double number = slots.has[kTexture] ? value[kTexture] : 0.0;
      const bool known = textured && number >= 0.0 && number < double(texture_count);
      out.textures.insert(out.textures.end(), triangles.size() / 3, known ? int(number) : kNoTexture);
      out.has_textures = out.has_textures || textured;
    }
    unpack_color(slots, value);
    if (has_colors)
      out.faces.colors.insert(out.faces.colors.end(), triangles.size() / 3,
                              linear_color(triple(value, kRed) / slots.color_scale));
    if (slots.has[kAlpha]) out.transparent = out.transparent || value[kAlpha] < slots.alpha_scale;
  }
  add_fields(std::move(fields), out.mesh);
}

/// Colours points from grey to white by a scalar, over the range of most of its values.
void color_by_scalar(Contents& contents, Scene& scene) {
  std::vector<float> sorted;
  for (const float v : contents.scalars)
    if (std::isfinite(v)) sorted.push_back(v);
  if (sorted.empty()) return;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t cut = sorted.size() / 50;
  const float low = sorted[cut], high = sorted[sorted.size() - 1 - cut];
  if (!(high > low)) return;
  constexpr float kDarkest = 0.35f;  // so that shading remains visible
  for (const float v : contents.scalars) {
    const float grey = kDarkest + (1.0f - kDarkest) * std::clamp((v - low) / (high - low), 0.0f, 1.0f);
    contents.mesh.colors.push_back(linear_color(glm::vec3(grey)));
  }
  scene.warnings.push_back(
      fmt::format("the points have no colours; they are drawn in greys by their '{}', {:g} to {:g}",
                  contents.scalar_name, low, high));
}

/// Adds warnings about what is in the file and is not drawn. `field`: see ImportSettings.
void warn_of_ignored(const Header& header, const Contents& contents, const std::optional<std::string>& field,
                     Scene& scene) {
  for (const Element& element : header.elements) {
    if (element.count == 0) continue;
    if (element.name == "edge") scene.warnings.push_back(fmt::format("{} edges are not drawn", element.count));
    if (element.name == "material") scene.warnings.push_back("the file's materials are not drawn");
    if (element.name != "vertex" || !contents.splats.empty()) continue;
    const bool draws_scalar =
        contents.mesh.indices.empty() || !contents.mesh.colors.empty() || !contents.faces.colors.empty();
    std::vector<std::string> lost, values;
    const Slots slots(element);
    for (std::size_t k = 0; k < slots.of.size(); ++k)
      if (slots.of[k] == kNowhere || (slots.of[k] == kScalar && !draws_scalar))
        (element.properties[k].list_size ? lost : values).push_back("'" + element.properties[k].name + "'");
    // A request for a field shows that they are known.
    const bool is_hint = lost.empty() && !values.empty();
    if (!field) lost.insert(lost.begin(), values.begin(), values.end());
    if (!lost.empty())
      scene.warnings.push_back(
          fmt::format("not drawn: {}{}", fmt::join(lost, ", "), is_hint ? "; `color_by` shows values as colours" : ""));
  }
  if (contents.transparent) scene.warnings.push_back("the property 'alpha' is not drawn: surfaces are opaque");
  if (!header.textures.empty() && contents.mesh.uvs.empty() && !contents.has_textures)
    scene.warnings.push_back(
        fmt::format("the texture '{}' is not drawn: there are no texture coordinates", header.textures[0]));
}

/// Makes meshes and materials of what was read.
void assemble(const Header& header, Contents contents, const std::optional<std::string>& field, Scene& scene) {
  Mesh& mesh = contents.mesh;
  mesh.points = mesh.indices.empty();
  if (mesh.positions.empty()) {
    scene.materials.emplace_back();
    return;
  }
  const bool is_splats = mesh.points && contents.splats.size() == mesh.positions.size();
  const bool shows_field = !field.value_or("").empty();
  if (mesh.points && mesh.colors.empty() && !contents.scalars.empty() && !is_splats && !shows_field)
    color_by_scalar(contents, scene);
  FaceAttributes& faces = contents.faces;
  if (!contents.has_textures) faces.uvs.clear();
  const auto complete = [&](std::size_t count, std::size_t per) { return count * per == mesh.indices.size(); };
  if (!complete(faces.uvs.size(), 1)) faces.uvs.clear();  // a file with faces and strips
  if (!complete(faces.colors.size(), 3)) faces.colors.clear();
  if (!mesh.colors.empty() && !faces.colors.empty()) {
    if (std::any_of(faces.colors.begin(), faces.colors.end(), [&](const glm::vec3& c) { return c != faces.colors[0]; }))
      scene.warnings.push_back("colours of faces are not drawn, since vertices have colours");
    faces.colors.clear();
  }
  set_face_attributes(faces, mesh);
  const bool is_colored = !mesh.colors.empty();
  const bool by_face = complete(contents.textures.size(), 3) && !faces.uvs.empty() && !header.textures.empty();
  const int plain = by_face ? int(header.textures.size()) : 0;  // the material without a texture
  scene.materials.resize(std::size_t(plain) + 1);
  if (is_colored || is_splats)
    for (Material& material : scene.materials) material.albedo = glm::vec3(1.0f);
  if (!by_face) {
    scene.meshes.push_back(std::move(mesh));
    if (is_splats) draw_splats(contents.splats, scene);
    return;
  }
  for (int& texture : contents.textures) texture = texture == kNoTexture ? plain : texture;
  scene.meshes = split_by_material(std::move(mesh), contents.textures);
}

}  // namespace

bool ply_has_texture(const fs::path& path) {
  constexpr std::size_t kMaxHeaderLength = 1 << 16;
  const std::string bytes = read_file_start(path, kMaxHeaderLength);
  std::string_view text = bytes;
  const Result<Header> header = ply::read_header(text, path.string());
  if (header) return !header->textures.empty();
  return bytes.size() == kMaxHeaderLength && bytes.find("end_header") == std::string::npos;
}

Result<Scene> read_ply(const fs::path& path, const std::optional<std::string>& field,
                       std::vector<std::string>& textures, Poll* poll) {
  const std::string file = path.string();
  const auto bytes = read_whole_file(path, poll);
  if (!bytes) return bytes.error();
  std::string_view text = *bytes;
  Result<Header> header = ply::read_header(text, file);
  if (!header) return header.error();
  textures = header->textures;

  Scene scene;
  Contents contents;
  contents.mesh.name = path.stem().string();
  Body body(*bytes, text, *header);
  bool has_vertices = false;
  for (const Element& element : header->elements) {
    // Check the header's count against the remaining bytes: each property takes at least one byte, plus a blank in text
    // form.
    const std::size_t row = std::max<std::size_t>(1, element.properties.size());
    if (element.count > body.left() / row + 1) {
      return file_error(
          "'{}' is cut short, or its header is wrong: the element '{}' has {} entries, too many for the "
          "{} bytes that follow",
          file, element.name, element.count, body.left());
    }
    body.forget_bad_rows();
    if (element.name == "vertex") {
      if (has_vertices) return file_error("'{}' has two lists of vertices", file);
      has_vertices = true;
      if (element.find("packed_position") >= 0)
        return file_error("'{}' has compressed Gaussian splats, which are not read; save them uncompressed", file);
      for (const char* name : {"x", "y", "z"})
        if (element.find(name) < 0) return file_error("'{}' has vertices without '{}'", file, name);
      const bool indexed = std::any_of(header->elements.begin(), header->elements.end(),
                                       [](const Element& other) { return other.name != "vertex" && other.count > 0; });
      read_vertices(element, indexed, field, body, contents, scene, poll);
    } else {
      read_lists(element, field, body, header->textures.size(), contents, poll);
    }
    if (poll && poll->ended()) return interrupted();
    if (body.comma_line() > 0) return decimal_commas_error(file, body.comma_line());
    constexpr std::size_t kMaxBad = 4;  // one in four
    if (body.ended() || body.bad_rows() * kMaxBad > element.count) {
      return file_error("'{}' is cut short, or has something other than a number, in its list of '{}'{}", file,
                        element.name,
                        body.bad_rows() > 0 ? fmt::format(", line {}", body.first_bad_line()) : std::string());
    }
    if (body.bad_rows() > 0)
      scene.warnings.push_back(fmt::format("{} of {} entries of '{}' lack a number and are left out, first in line {}",
                                           body.bad_rows(), element.count, element.name, body.first_bad_line()));
  }
  warn_of_ignored(*header, contents, field, scene);
  assemble(*header, std::move(contents), field, scene);
  return scene;
}

}  // namespace umbrage
