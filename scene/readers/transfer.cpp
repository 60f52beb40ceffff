// Transfer of a scene or a panorama between two processes. Both programs come from one build and run on one machine, so
// data is written in its memory layout. A mark at the start identifies the version, a mark at the end confirms
// completeness.
#include "scene/readers/transfer.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <functional>
#include <memory>
#include <type_traits>
#include <utility>

#include "core/version.h"

namespace umbrage {
namespace {

// These functions list every field of every struct. The structured bindings do not compile if a field is missing.
template <class Archive>
void list_fields(Archive& archive, Texture& texture) {
  auto& [name, width, height, rgba, linear, nearest, clamped] = texture;
  archive(name, width, height, rgba, linear, nearest, clamped);
}
template <class Archive>
void list_fields(Archive& archive, Material& material) {
  auto& [name, albedo, texture, alpha_mask, alpha_cutoff, specular_strength, specular_exponent, emission,
         emission_texture, metallic, roughness, surface_texture, occlusion_strength, normal_texture, normal_scale,
         blended, opacity, glass, tint, ignored] = material;
  archive(name, albedo, texture, alpha_mask, alpha_cutoff, specular_strength, specular_exponent, emission,
          emission_texture, metallic, roughness, surface_texture, occlusion_strength, normal_texture, normal_scale,
          blended, opacity, glass, tint, ignored);
}
template <class Archive>
void list_fields(Archive& archive, Field& field) {
  auto& [name, components, on_triangles, is_spread, values] = field;
  archive(name, components, on_triangles, is_spread, values);
}
template <class Archive>
void list_fields(Archive& archive, Mesh& mesh) {
  auto& [name, positions, normals, uvs, colors, indices, smoothing, points, spheres, radii, bends, fields, material,
         object] = mesh;
  archive(name, positions, normals, uvs, colors, indices, smoothing, points, spheres, radii, bends, fields, material,
          object);
}
template <class Archive>
void list_fields(Archive& archive, Light& light) {
  auto& [kind, direction, position, color, reach, angle_deg, radius, casts_shadow] = light;
  archive(kind, direction, position, color, reach, angle_deg, radius, casts_shadow);
}
template <class Archive>
void list_fields(Archive& archive, View& view) {
  auto& [eye, target, angle_deg, up, height, name] = view;
  archive(eye, target, angle_deg, up, height, name);
}
template <class Archive>
void list_fields(Archive& archive, AmbientShape& shape) {
  auto& [by_color] = shape;
  for (glm::mat4& matrix : by_color) archive(matrix[0], matrix[1], matrix[2], matrix[3]);
}
template <class Archive>
void list_fields(Archive& archive, Scene& scene) {
  // No reader sets `reflections`, `start`, `value_colors` or `shape_facts`.
  auto& [name, meshes, materials, textures, lights, views, cameras, scene_names, scene_index, animation_names,
         animation_durations_s, origin, up, has_front, ambient, ambient_shape, lit_white_luminance, reflections,
         bounds_min, bounds_max, motion, start, ground_object, ground_center, ground_fade_distance, value_colors,
         warnings, shape_facts] = scene;
  archive(name, meshes, materials, textures, lights, views, cameras, scene_names, scene_index, animation_names,
          animation_durations_s, origin, up, has_front, ambient, ambient_shape, lit_white_luminance, bounds_min,
          bounds_max, motion, ground_object, ground_center, ground_fade_distance, warnings);
}
template <class Archive>
void list_fields(Archive& archive, Panorama& panorama) {
  auto& [name, width, height, rgb] = panorama;
  archive(name, width, height, rgb);
}
template <class Archive>
void list_fields(Archive& archive, FieldValue& set) {
  auto& [field, value] = set;
  archive(field, value);
}
template <class Archive>
void list_fields(Archive& archive, Error& error) {
  auto& [kind, message, fields] = error;
  archive(kind, message, fields);
}

/// Whether values of type T are written as they are in memory: numbers and glm vectors.
template <class T>
constexpr bool kPlain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <glm::length_t n, class T>
constexpr bool kPlain<glm::vec<n, T>> = true;

constexpr std::uint64_t kEnd = 0x656e6f64'656e6f64u;

/// Returns a mark that differs between versions and for changed struct sizes.
std::uint64_t version_mark() {
  std::uint64_t mark = 14695981039346656037u;  // FNV-1a
  const auto add = [&](std::uint64_t value) { mark = (mark ^ value) * 1099511628211u; };
  for (const char c : project_version()) add(std::uint64_t(c));
  for (const std::size_t size : {sizeof(Scene), sizeof(Mesh), sizeof(Material), sizeof(Texture), sizeof(Light),
                                 sizeof(View), sizeof(Panorama), sizeof(Error)})
    add(size);
  return mark;
}

struct Writer {
  int file;
  std::string buffer = {};  // buffer for small values, since a system call costs more than a copy
  bool failed = false;

  void flush(const char* bytes, std::size_t size) {
    while (size > 0 && !failed) {
      const ssize_t written = ::write(file, bytes, size);
      if (written < 0 && errno == EINTR) continue;
      failed = written <= 0;
      bytes += written, size -= std::size_t(written);
    }
  }
  void bytes(const void* start, std::size_t size) {
    constexpr std::size_t kBufferSize = 1 << 16;
    if (buffer.size() + size <= kBufferSize) {
      buffer.append(static_cast<const char*>(start), size);
      return;
    }
    flush(buffer.data(), buffer.size());
    buffer.clear();
    flush(static_cast<const char*>(start), size);
  }
  template <class... T>
  void operator()(T&... values) {
    (write(values), ...);
  }
  template <class T>
  void write(T& value) {
    if constexpr (kPlain<T>)
      bytes(&value, sizeof value);
    else
      list_fields(*this, value);
  }
  void write(std::string& text) { write_list(text); }
  template <class T>
  void write(std::vector<T>& list) {
    write_list(list);
  }
  void write_list(auto& list) {
    std::uint64_t count = list.size();
    write(count);
    if constexpr (kPlain<std::remove_cvref_t<decltype(list[0])>>)
      bytes(list.data(), count * sizeof list[0]);
    else
      for (auto& value : list) write(value);
  }
};

struct Reader {
  const char* at;
  std::size_t remaining;
  bool failed = false;
  std::vector<std::pair<const char*, std::size_t>> lists = {};  ///< start and count of lists of numbers, for ListReader

  void bytes(void* to, std::size_t size) {
    failed = failed || size > remaining;
    if (failed || size == 0) return;
    std::memcpy(to, at, size);
    at += size, remaining -= size;
  }
  template <class... T>
  void operator()(T&... values) {
    (read(values), ...);
  }
  template <class T>
  void read(T& value) {
    if constexpr (kPlain<T>)
      bytes(&value, sizeof value);
    else
      list_fields(*this, value);
  }
  void read(bool& value) {
    std::uint8_t byte = 0;
    read(byte);
    value = byte != 0;
  }
  void read(std::string& text) {
    const std::uint64_t count = count_of<char>();
    text.assign(at, count);
    at += count, remaining -= count;
  }
  template <class T>
  void read(std::vector<T>& list) {
    const std::uint64_t count = count_of<T>();
    if constexpr (kPlain<T>) {
      lists.emplace_back(at, count);
      at += count * sizeof(T), remaining -= count * sizeof(T);
    } else {
      for (std::uint64_t i = 0; i < count && !failed; ++i) read(list.emplace_back());
    }
  }
  /// Reads the number of values of a list; 0 if the data ends before.
  template <class T>
  std::uint64_t count_of() {
    std::uint64_t count = 0;
    read(count);
    failed = failed || count > remaining / (kPlain<T> ? sizeof(T) : 1);
    return failed ? 0 : count;
  }
};

/// Copies the lists of numbers of an object that has been read, which are nearly all of its bytes, with all threads.
struct ListReader {
  const Reader& reader;
  std::vector<std::function<void()>> copies = {};

  template <class... T>
  void operator()(T&... values) {
    (visit(values), ...);
  }
  template <class T>
  void visit(T& value) {
    if constexpr (!kPlain<T>) list_fields(*this, value);
  }
  void visit(std::string&) {}
  template <class T>
  void visit(std::vector<T>& list) {
    if constexpr (kPlain<T>) {
      const auto [first, count] = reader.lists[copies.size()];
      copies.emplace_back([&list, first, count] {
        if constexpr (sizeof(T) == 1) {  // unlike resize, assign writes each byte once
          list.assign(reinterpret_cast<const T*>(first), reinterpret_cast<const T*>(first) + count);
        } else {
          list.resize(count);
          if (count > 0) std::memcpy(list.data(), first, count * sizeof(T));
        }
      });
    } else {
      for (T& value : list) visit(value);
    }
  }
  void copy() {
    tbb::parallel_for(std::size_t(0), copies.size(), [&](std::size_t k) { copies[k](); });
  }
};

/// Returns whether the textures have all their pixels. What else is inconsistent, complete_import repairs.
bool is_consistent(const Scene& scene) {
  return std::all_of(scene.textures.begin(), scene.textures.end(), [](const Texture& texture) {
    return texture.width >= 1 && texture.height >= 1 &&
           texture.rgba.size() == std::size_t(texture.width) * std::size_t(texture.height) * 4;
  });
}

bool is_consistent(const Panorama& panorama) {
  return panorama.width >= 1 && panorama.height >= 1 &&
         panorama.rgb.size() == std::size_t(panorama.width) * std::size_t(panorama.height) * 3;
}

template <class T>
bool send(int file, const Result<T>& read) {
  Writer writer{file};
  std::uint64_t mark = version_mark(), end = kEnd;
  bool has_value = bool(read);
  writer(mark, has_value);
  // The functions that list the fields take mutable objects because they are also used for reading; writing does not
  // change the objects.
  if (has_value)
    writer(const_cast<T&>(*read));
  else
    writer(const_cast<Error&>(read.error()));
  writer(end);
  writer.flush(writer.buffer.data(), writer.buffer.size());
  return !writer.failed;
}

template <class T>
std::optional<Result<T>> receive(int file) {
  struct stat status {};
  if (::fstat(file, &status) != 0 || status.st_size <= 0) return std::nullopt;
  const std::size_t size = std::size_t(status.st_size);
  void* mapped = ::mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_POPULATE, file, 0);
  if (mapped == MAP_FAILED) return std::nullopt;
  const auto unmap = [size](void* start) { ::munmap(start, size); };
  const std::unique_ptr<void, decltype(unmap)> mapping(mapped, unmap);

  Reader reader{static_cast<const char*>(mapped), size};
  std::uint64_t mark = 0, end = 0;
  bool has_value = false;
  reader(mark, has_value);
  if (mark != version_mark()) return std::nullopt;
  T value;
  Error error;
  if (has_value)
    reader(value);
  else
    reader(error);
  reader(end);
  if (reader.failed || end != kEnd) return std::nullopt;
  if (!has_value) return std::optional<Result<T>>(std::in_place, std::move(error));
  ListReader lists{reader};
  lists(value);
  lists.copy();
  if (!is_consistent(value)) return std::nullopt;
  return std::optional<Result<T>>(std::in_place, std::move(value));
}

}  // namespace

bool send_import(int file, const Result<Scene>& imported) { return send(file, imported); }
bool send_panorama(int file, const Result<Panorama>& read) { return send(file, read); }
std::optional<Result<Scene>> receive_import(int file) { return receive<Scene>(file); }
std::optional<Result<Panorama>> receive_panorama(int file) { return receive<Panorama>(file); }

}  // namespace umbrage
