// Reads PLY [Turk 1994]. Used instead of Assimp, since Assimp 5.2 does not support triangle strips and hangs on some
// files with a wrong header; this reader is also faster.
#include "scene/readers/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

#include "scene/readers/vertex_colors.h"
#include "scene/readers/whole_file.h"

namespace umbrage {
namespace {

namespace fs = std::filesystem;

enum class Number { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

constexpr std::array<int, 8> kBytes{1, 1, 2, 2, 4, 4, 4, 8};

std::optional<Number> number_named(std::string_view name) {
  struct Named {
    std::string_view name;
    Number number;
  };
  static constexpr Named kNames[] = {
      {"char", Number::kInt8},      {"int8", Number::kInt8},       {"uchar", Number::kUint8},
      {"uint8", Number::kUint8},    {"short", Number::kInt16},     {"int16", Number::kInt16},
      {"ushort", Number::kUint16},  {"uint16", Number::kUint16},   {"int", Number::kInt32},
      {"int32", Number::kInt32},    {"uint", Number::kUint32},     {"uint32", Number::kUint32},
      {"float", Number::kFloat32},  {"float32", Number::kFloat32}, {"double", Number::kFloat64},
      {"float64", Number::kFloat64}};
  for (const Named& named : kNames) {
    if (named.name == name) return named.number;
  }
  return std::nullopt;
}

struct Property {
  std::string name;
  Number number = Number::kFloat32;
  std::optional<Number> list_size;  ///< set for lists
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

enum class Storage { kText, kLittle, kBig };

struct Header {
  Storage storage = Storage::kText;
  std::vector<Element> elements;
  std::string texture;
};

/// A reader of numbers in sequence. After the end, or at something other than a number, it returns zeros, and `ended`
/// is set.
struct Body {
  const char* at;
  const char* end;
  Storage storage;
  bool ended = false;

  template <class T>
  double binary() {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), at, sizeof(T));
    const bool swap = (storage == Storage::kBig) == (std::endian::native == std::endian::little);
    if (swap) std::reverse(bytes.begin(), bytes.end());
    at += sizeof(T);
    return double(std::bit_cast<T>(bytes));
  }

  double text() {
    while (at < end && (*at == ' ' || *at == '\n' || *at == '\r' || *at == '\t')) ++at;
    if (at < end && *at == '+') ++at;
    double value = 0.0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error == std::errc::result_out_of_range) value = INFINITY;
    if (stop == at) ended = true;
    at = stop;
    return value;
  }

  double next(Number number) {
    if (storage == Storage::kText) return ended ? 0.0 : text();
    if (end - at < kBytes[std::size_t(number)]) {
      ended = true;
      return 0.0;
    }
    switch (number) {
      case Number::kInt8:
        return binary<std::int8_t>();
      case Number::kUint8:
        return binary<std::uint8_t>();
      case Number::kInt16:
        return binary<std::int16_t>();
      case Number::kUint16:
        return binary<std::uint16_t>();
      case Number::kInt32:
        return binary<std::int32_t>();
      case Number::kUint32:
        return binary<std::uint32_t>();
      case Number::kFloat32:
        return binary<float>();
      case Number::kFloat64:
        return binary<double>();
    }
    return 0.0;
  }

  std::size_t left() const { return std::size_t(end - at); }
};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view kBlank = " \t\r";
  for (std::size_t i = line.find_first_not_of(kBlank); i < line.size(); i = line.find_first_not_of(kBlank, i)) {
    const std::size_t end = std::min(line.find_first_of(kBlank, i), line.size());
    words.push_back(line.substr(i, end - i));
    i = end;
  }
  return words;
}

/// Reads the header and moves `text` past it.
Result<Header> read_header(std::string_view& text, const std::string& file) {
  Header header;
  constexpr std::size_t kMaxShown = 60;  // characters of a line in a message
  bool first = true, has_format = false;
  while (true) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return file_error("'{}' has a PLY header without end_header", file);
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    const std::vector<std::string_view> words = words_of(line);
    if (first && (words.size() != 1 || words[0] != "ply")) {
      return file_error("'{}' cannot be read as PLY (its first line is not 'ply')", file);
    }
    first = false;
    if (words.empty() || words[0] == "ply" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    std::string shown(line.substr(0, kMaxShown));
    std::replace_if(
        shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    const Error wrong = file_error("'{}' has the PLY header line '{}', which is not valid", file, shown);
    if (words[0] == "comment") {
      if (words.size() > 2 && words[1] == "TextureFile") header.texture = line.substr(words[2].data() - line.data());
    } else if (words[0] == "format") {
      if (words.size() < 2) return wrong;
      if (words[1] == "ascii") {
        header.storage = Storage::kText;
      } else if (words[1] == "binary_little_endian") {
        header.storage = Storage::kLittle;
      } else if (words[1] == "binary_big_endian") {
        header.storage = Storage::kBig;
      } else {
        return wrong;
      }
      has_format = true;
    } else if (words[0] == "element") {
      if (words.size() != 3) return wrong;
      Element element{std::string(words[1]), 0, {}};
      const auto [stop, error] = std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
      if (error != std::errc() || stop != words[2].data() + words[2].size()) return wrong;
      header.elements.push_back(std::move(element));
    } else if (words[0] == "property") {
      if (header.elements.empty() || words.size() < 3) return wrong;
      Property property;
      const bool is_list = words[1] == "list";
      if (words.size() != (is_list ? 5u : 3u)) return wrong;
      const std::optional<Number> number = number_named(words[is_list ? 3 : 1]);
      if (is_list) property.list_size = number_named(words[2]);
      if (!number || (is_list && !property.list_size)) return wrong;
      property.number = *number;
      property.name = words.back();
      header.elements.back().properties.push_back(std::move(property));
    } else {
      return wrong;
    }
  }
  if (!has_format) return file_error("'{}' has a PLY header without a format", file);
  return header;
}

/// Destination of a vertex property: a component of position, normal, texture coordinate or colour.
enum Slot { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kU, kV, kRed, kGreen, kBlue, kNowhere };

Slot slot_of(std::string_view name) {
  struct Named {
    std::string_view name;
    Slot slot;
  };
  static constexpr Named kNames[] = {{"x", kX},
                                     {"y", kY},
                                     {"z", kZ},
                                     {"nx", kNormalX},
                                     {"ny", kNormalY},
                                     {"nz", kNormalZ},
                                     {"u", kU},
                                     {"v", kV},
                                     {"s", kU},
                                     {"t", kV},
                                     {"texture_u", kU},
                                     {"texture_v", kV},
                                     {"red", kRed},
                                     {"green", kGreen},
                                     {"blue", kBlue},
                                     {"r", kRed},
                                     {"g", kGreen},
                                     {"b", kBlue},
                                     {"diffuse_red", kRed},
                                     {"diffuse_green", kGreen},
                                     {"diffuse_blue", kBlue}};
  for (const Named& named : kNames) {
    if (named.name == name) return named.slot;
  }
  return kNowhere;
}

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

void read_vertices(const Element& element, Body& body, Mesh& mesh, Poll* poll) {
  std::vector<Slot> slots;
  std::array<bool, kNowhere + 1> has{};
  float color_scale = 1.0f;
  for (const Property& property : element.properties) {
    slots.push_back(property.list_size ? kNowhere : slot_of(property.name));
    has[slots.back()] = true;
    if (slots.back() == kRed) color_scale = full_scale(property.number);
  }
  const bool has_colors = has[kRed] && has[kGreen] && has[kBlue];
  const bool has_normals = has[kNormalX] && has[kNormalY] && has[kNormalZ], has_uvs = has[kU] && has[kV];
  mesh.positions.reserve(element.count);
  if (has_normals) mesh.normals.reserve(element.count);
  if (has_uvs) mesh.uvs.reserve(element.count);
  if (has_colors) mesh.colors.reserve(element.count);
  for (std::size_t i = 0; i < element.count && !body.ended && !stops(poll, i, element.count); ++i) {
    std::array<float, kNowhere + 1> value{};
    for (std::size_t k = 0; k < slots.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.list_size) {
        const double count = body.next(*property.list_size);
        for (double j = 0; j < count && !body.ended; ++j) body.next(property.number);
      } else {
        value[slots[k]] = float(body.next(property.number));
      }
    }
    mesh.positions.emplace_back(value[kX], value[kY], value[kZ]);
    if (has_normals) mesh.normals.emplace_back(value[kNormalX], value[kNormalY], value[kNormalZ]);
    if (has_uvs) mesh.uvs.emplace_back(value[kU], value[kV]);
    if (has_colors) {
      mesh.colors.push_back(linear_color(glm::vec3(value[kRed], value[kGreen], value[kBlue]) / color_scale));
    }
  }
}

constexpr std::uint32_t kNoVertex = 0xffffffffu;  // out of range of any mesh; such triangles are dropped later

std::uint32_t vertex_of(double index) {
  return index >= 0.0 && index < double(kNoVertex) ? std::uint32_t(index) : kNoVertex;
}

void add_fan(const std::vector<std::uint32_t>& corners, Mesh& mesh) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    mesh.indices.insert(mesh.indices.end(), {corners[0], corners[i - 1], corners[i]});
  }
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

/// Reads the lists of indices of faces or strips; skips all other properties.
void read_lists(const Element& element, Body& body, bool strips, Mesh* mesh, Poll* poll) {
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < element.count && !body.ended && !stops(poll, i, element.count); ++i) {
    for (const Property& property : element.properties) {
      if (!property.list_size) {
        body.next(property.number);
        continue;
      }
      const bool is_index_list = mesh && (property.name == "vertex_indices" || property.name == "vertex_index");
      const double count = body.next(*property.list_size);
      corners.clear();
      for (double j = 0; j < count && !body.ended; ++j) {
        const double index = body.next(property.number);
        if (is_index_list) corners.push_back(vertex_of(index));
      }
      if (!is_index_list || body.ended) continue;
      if (strips) {
        add_strips(corners, *mesh);
      } else {
        add_fan(corners, *mesh);
      }
    }
  }
}

}  // namespace

std::string ply_texture(const fs::path& path) {
  constexpr std::size_t kMaxHeaderLength = 1 << 16;
  std::string bytes(kMaxHeaderLength, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(bytes.data(), std::streamsize(bytes.size()));
  std::string_view text(bytes.data(), std::size_t(stream.gcount()));
  const Result<Header> header = read_header(text, path.string());
  return header ? header->texture : std::string();
}

Result<Scene> read_ply(const fs::path& path, std::string& texture_name, Poll* poll) {
  const std::string file = path.string();
  const auto bytes = read_whole_file(path, poll);
  if (!bytes) return bytes.error();
  std::string_view text = *bytes;
  Result<Header> header = read_header(text, file);
  if (!header) return header.error();
  texture_name = header->texture;

  Scene scene;
  Mesh mesh;
  Body body{text.data(), text.data() + text.size(), header->storage};
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
    if (element.name == "vertex") {
      for (const char* name : {"x", "y", "z"}) {
        if (std::none_of(element.properties.begin(), element.properties.end(),
                         [&](const Property& property) { return property.name == name && !property.list_size; }))
          return file_error("'{}' has vertices without '{}'", file, name);
      }
      read_vertices(element, body, mesh, poll);
    } else {
      const bool strips = element.name == "tristrips";
      read_lists(element, body, strips, strips || element.name == "face" ? &mesh : nullptr, poll);
    }
    if (poll && poll->ended()) return interrupted();
    if (body.ended) {
      return file_error("'{}' is cut short, or has something other than a number, in its list of '{}'", file,
                        element.name);
    }
  }
  mesh.name = path.stem().string();
  mesh.points = mesh.indices.empty();
  scene.materials.emplace_back();
  if (!mesh.colors.empty()) scene.materials[0].albedo = glm::vec3(1.0f);
  if (!mesh.positions.empty()) scene.meshes.push_back(std::move(mesh));
  return scene;
}

}  // namespace umbrage
