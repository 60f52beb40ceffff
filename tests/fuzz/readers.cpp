#include "readers.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "apps/compare/baseline.h"
#include "apps/view/http.h"
#include "apps/view/messages.h"
#include "core/check.h"
#include "core/length.h"
#include "core/parameters.h"
#include "core/printable.h"
#include "gbuffers/gbuffer_file.h"
#include "gbuffers/packing.h"
#include "generators/builtin.h"
#include "importer/decode_image.h"
#include "importer/importer.h"
#include "importer/readers.h"
#include "io/format.h"
#include "io/image_file.h"
#include "io/layers.h"
#include "scene/finish.h"
#include "scene/readers/content.h"
#include "scene/readers/gzip.h"
#include "scene/readers/import_parts.h"
#include "scene/readers/model_readers.h"
#include "scene/readers/mtl.h"
#include "scene/readers/obj.h"
#include "scene/readers/obj_text.h"
#include "scene/readers/text_rules.h"
#include "scene/readers/texture_file.h"
#include "scene/readers/transfer.h"

namespace umbrage::fuzz {
namespace {

namespace fs = std::filesystem;

void expect(bool holds, std::string_view what) {
  if (!holds) fail_check(what);
}

void check(const Error& error, ErrorKind kind = ErrorKind::kFile) {
  expect(error.kind == kind, error.message);
  expect(!error.message.empty() && error.message.find('\n') == std::string::npos, error.message);
}

void check(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    for (const std::uint32_t index : mesh.indices) check_less(index, mesh.positions.size(), "index");
    if (mesh.radii.empty()) {
      check_equal(mesh.normals.size(), mesh.positions.size(), "normals");
    } else {
      check_equal(mesh.radii.size(), mesh.positions.size(), "radii");
      if (!mesh.spheres) check_equal(mesh.normals.size(), mesh.positions.size(), "normals of discs");
      for (const float radius : mesh.radii) expect(radius >= 0.0f, "a radius");
    }
    check_less(std::size_t(mesh.material), scene.materials.size(), "material");
  }
  for (const std::string& warning : scene.warnings) expect(warning.find('\n') == std::string::npos, warning);
}

/// A file in memory that can be opened by its path.
struct MemoryFile {
  int descriptor = ::memfd_create("fuzz", 0);
  fs::path path = fmt::format("/proc/self/fd/{}", descriptor);
  explicit MemoryFile(std::string_view bytes) {
    expect(::pwrite(descriptor, bytes.data(), bytes.size(), 0) == ssize_t(bytes.size()), "no memory for a file");
  }
  ~MemoryFile() { ::close(descriptor); }
};

void check_model(Result<Scene> scene) {
  if (!scene) return check(scene.error());
  finish_scene(*scene);
  check(*scene);
}

void read_as_ply(std::string_view bytes) {
  const MemoryFile file(bytes);
  std::vector<std::string> textures;
  check_model(read_ply(file.path, std::string(), textures));
  static_cast<void>(ply_has_texture(file.path));
}

void read_as_off(std::string_view bytes) { check_model(read_off(MemoryFile(bytes).path)); }

void read_as_stl(std::string_view bytes) { check_model(read_stl(MemoryFile(bytes).path)); }
void read_as_obj(std::string_view bytes) {
  const Result<ObjFile> file = open_obj(MemoryFile(bytes).path);
  if (!file) return check(file.error());
  constexpr bool kThreads = false;
  Result<ObjScene> obj = read_obj(*file, kThreads);
  if (!obj) return check(obj.error());
  check_equal(obj->sources.size(), obj->scene.materials.size(), "materials");
  check_model(std::move(obj->scene));
}

void read_as_mtl(std::string_view bytes) {
  std::string text(bytes);
  normalize_lines(text);
  const MtlLibrary library = read_mtl(text, "a.mtl");
  for (const MtlMaterial& each : library.materials) {
    const Material material = material_of(each);
    expect(material.opacity >= 0.0f && material.opacity <= 1.0f, "an opacity");
    for (int c = 0; c < 3; ++c) expect(material.albedo[c] >= 0.0f && material.albedo[c] <= 1.0f, "a reflectance");
  }
  for (const std::string& warning : library.warnings) expect(warning.find('\n') == std::string::npos, warning);
}

void read_as_xyz(std::string_view bytes) { check_model(read_xyz(MemoryFile(bytes).path, std::string())); }

void read_as_vtk(std::string_view bytes) {
  const std::string all;
  Result<Scene> scene = read_vtk(MemoryFile(bytes).path, all);
  if (scene)
    for (const Mesh& mesh : scene->meshes)
      for (const Field& field : mesh.fields)
        check_equal(
            field.values.size(),
            std::size_t(field.components) * (field.on_triangles ? mesh.indices.size() / 3 : mesh.positions.size()),
            "values");
  check_model(std::move(scene));
}

void read_as_gzip(std::string_view bytes) {
  static_cast<void>(inflated_start(bytes, bytes.size()));
  if (const auto content = inflated(bytes, "a file"); !content) check(content.error());
}

/// Reads through a third-party library, by the file's extension.
template <const char* const& kExtension>
void import_as(std::string_view bytes) {
  static const fs::path folder = [] {
    std::string name = (fs::temp_directory_path() / "umbrage-fuzz-XXXXXX").string();
    expect(::mkdtemp(name.data()) != nullptr, "no folder for a file");
    static const fs::path path = name;
    std::atexit([] {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    });
    return path;
  }();
  const fs::path file = folder / (std::string("model.") + kExtension);
  std::ofstream(file, std::ios::binary) << bytes;
  const Result<Scene> scene = import_in_process(file, {});
  if (scene)
    check(*scene);
  else
    check(scene.error());
}

void read_as_image(std::string_view bytes) {
  const MemoryFile file(bytes);
  const Result<Image> image = read_image(file.path);
  if (image) {
    expect(image->width > 0 && image->height > 0 && !image->planes.empty(), "an empty image");
    for (const Plane& plane : image->planes) {
      check_equal(plane.width, image->width, "width");
      check_equal(plane.height, image->height, "height");
    }
  } else {
    check(image.error());
  }
  if (const auto camera = read_camera(file.path); !camera) check(camera.error());
}

/// Reads a layered file: its header, all channels as a whole, and, of EXR files, a copy with one more layer.
void read_as_layers(std::string_view bytes) {
  const MemoryFile file(bytes);
  const Result<LayeredFile> header = read_header(file.path);
  if (!header) return check(header.error());
  expect(header->width > 0 && header->height > 0 && !header->channels.empty(), "an empty header");
  for (const auto& [name, text] : header->attributes)
    expect((name + text).find('\n') == std::string::npos, "a line end in an attribute");
  std::vector<int> all;
  for (const Channel& channel : header->channels) all.push_back(channel.index);
  constexpr std::int64_t kMaxPixels = 1 << 20;  // more take longer than they find
  if (std::int64_t(header->width) * header->height * std::int64_t(all.size()) > kMaxPixels) return;
  const Result<Image> image = read_channels(*header, all);
  if (!image) return check(image.error());
  check_equal(image->planes.size(), header->channels.size(), "planes");
  int rows = 0;
  const auto status = read_rows(*header, all, [&](const Image& block, int first) -> Result<void> {
    check_equal(first, rows, "the first row of a block");
    rows += block.height;
    return {};
  });
  expect(bool(status), "rows that are whole are an error in blocks");
  check_equal(rows, header->height, "rows");
  if (header->format != "EXR") return;
  Image layer(header->width, header->height);
  layer.names = {"umbrage.ao"};
  layer.planes.emplace_back(header->width, header->height, 0.5f);
  if (const auto merged = write_merged(*header, layer, true, "/dev/null"); !merged) check(merged.error());
}

/// Reads a G-buffer with the packing that the first byte tells, and once more as the next frame of a sequence.
void read_as_gbuffer(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::size_t packing = static_cast<unsigned char>(bytes[0]) % (packings().size() + 1);
  const MemoryFile file(bytes.substr(1));
  constexpr double kMemory = 1 << 24;
  constexpr std::int64_t kMaxPixels = 1 << 16;  // more take longer than they find
  const Result<LayeredFile> header = read_header(file.path);
  if (!header || std::int64_t(header->width) * header->height > kMaxPixels) return;
  GBufferSettings settings{.file = file.path.string()};
  if (packing > 0) settings.depth_packing = packings()[packing - 1].name;
  const auto first = GBufferFile::open(settings, kMemory, "");
  if (!first)
    return check(first.error(), first.error().kind == ErrorKind::kUsage ? ErrorKind::kUsage : ErrorKind::kFile);
  for (const std::string& line : first->facts().lines) expect(line.find('\n') == std::string::npos, line);
  const auto next = GBufferFile::open(settings, kMemory, "", &first->conventions());
  expect(bool(next), "the first frame is an error as the second one");
  const Result<Image> image = next->rows({0, header->height});
  if (!image) return check(image.error());
  check_equal(image->planes.size(), next->plane_names().size(), "planes");
}

void read_as_content(std::string_view bytes) {
  const std::string format = format_of_content(bytes, bytes.size());
  expect(std::all_of(format.begin(), format.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)); }),
         format);
  static_cast<void>(conversion_advice(format));
  static_cast<void>(has_decimal_commas(bytes));
  expect(bytes.starts_with(without_comment(bytes)), "more than a name");
  const std::string text = printable(bytes);
  expect(printable(text) == text, "a printable text is not printable");
}

/// Recognises what image files hold, as `umbrage info` does, within limits that suit small files.
void read_as_info(std::string_view bytes) {
  const MemoryFile file(bytes);
  constexpr double kSeconds = 2.0, kMemory = 5e8;
  const ReadingLimits limits(kSeconds, kMemory);
  GBufferSettings settings;
  settings.file = file.path.string();
  const auto facts = describe_gbuffer(settings);
  if (!facts)
    return check(facts.error(), facts.error().kind == ErrorKind::kUsage ? ErrorKind::kUsage : ErrorKind::kFile);
  for (const std::vector<std::string>& texts : {facts->lines, facts->warnings, facts->layers})
    for (const std::string& text : texts) expect(text.find('\n') == std::string::npos, text);
}

void read_as_texture(std::string_view bytes) {
  const auto* start = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const Result<Texture> texture = decode_texture_image({start, bytes.size()}, "a texture", {.footprint = 0.25f});
  if (!texture) return check(texture.error());
  check_equal(texture->rgba.size(), std::size_t(texture->width) * std::size_t(texture->height) * 4, "texels");
}

void read_as_radiance(std::string_view bytes) {
  const auto* start = reinterpret_cast<const std::uint8_t*>(bytes.data());
  const std::span<const std::uint8_t> all(start, bytes.size());
  if (!is_radiance(all)) return;
  Result<Panorama> panorama = decode_radiance(all, "a panorama", 1 << 20);
  if (!panorama) return check(panorama.error());
  check_equal(panorama->rgb.size(), std::size_t(panorama->width) * std::size_t(panorama->height) * 3, "radiances");
  clean_panorama(*panorama);
  for (const float value : panorama->rgb) expect(value >= 0.0f && value <= kMaxRadiance, "a radiance");
}

/// Sets a parameter. The first byte selects a row of a table with every type of parameter; the other bytes are the
/// value.
void read_as_setting(std::string_view bytes) {
  struct Params {
    float real;
    int whole, on, choice;
    Length length, above_zero;
  };
  static const std::vector<Parameter> table = {
      real_row("real", &Params::real, {.min = -1.5, .max = 1e6}, ""),
      int_row("whole", &Params::whole, {.min = -3, .max = 1e9}, ""),
      bool_row("on", &Params::on, false, ""),
      choice_row("choice", &Params::choice, 0, {"skip", "zero", "clamp"}, ""),
      length_row("length", &Params::length, {.max = 1e3}, ""),
      length_row("above_zero", &Params::above_zero, {.max = 1e9, .above_zero = true}, "")};
  if (bytes.empty()) return;
  const Parameter& row = table[static_cast<unsigned char>(bytes[0]) % table.size()];
  const std::string_view text = bytes.substr(1);
  ParameterBytes params = initial_parameters(table, sizeof(Params));
  const ParameterBytes before = params;
  if (const auto set = set_parameter("effect", row, text, params); !set) {
    expect(set.error().kind == ErrorKind::kUsage && !set.error().message.empty(), "the kind of an error");
    return expect(params == before, "a wrong value changed something");
  }
  // The text of a value must itself be a valid value, with the same text.
  const std::string value_text = parameter_text(row, params);
  const auto again = set_parameter("effect", row, value_text, params);
  expect(bool(again), value_text);
  check_equal(parameter_text(row, params), value_text, "a value's text");
}

void read_as_scene_name(std::string_view bytes) {
  // Skip valid names: they make scenes, which takes time and is tested elsewhere.
  constexpr std::string_view kDetail = "?detail=";
  for (const BuiltinScene& scene : builtin_scenes()) {
    const std::string name = "scene:" + std::string(scene.name);
    if (bytes == name || (bytes.starts_with(name + std::string(kDetail)) && bytes.size() <= name.size() + 16)) return;
  }
  const Result<Scene> scene = make_builtin_scene(bytes);
  expect(!scene && scene.error().kind == ErrorKind::kUsage, "an invalid name was accepted");
}

void read_as_transfer(std::string_view bytes) {
  const MemoryFile file(bytes);
  auto received = receive_import(file.descriptor);
  if (!received) return;
  const Result<Scene> scene = complete_import(std::move(*received), "a.glb", {});
  if (!scene) return;
  for (const Mesh& mesh : scene->meshes)
    for (const std::uint32_t index : mesh.indices) check_less(index, mesh.positions.size(), "index");
}

void read_as_baseline(std::string_view bytes) {
  const MemoryFile file(bytes);
  const auto baseline = read_baseline(file.path);
  if (!baseline) return check(baseline.error());
  if (const auto checked = check_baseline(*baseline, *baseline, "a baseline"); checked)
    check_equal(checked->worse.size(), 0u, "scores worse than themselves");
}

void check_options(const view::ViewOptions& options) {
  for (const auto& [name, values] : options) {
    expect(!name.empty() && name[0] != '-' && name.find('=') == std::string::npos, name);
    for (const std::string& value : values) expect(value.find('\n') == std::string::npos, value);
  }
}

void read_as_page_message(std::string_view bytes) {
  if (const auto save = view::parse_save(bytes)) {
    check_options(save->options);
    expect(save->width >= 1 && save->height >= 1 && save->model >= 0, "a picture to save");
  }
  const auto message = view::parse_message(bytes);
  if (!message) return check(message.error(), ErrorKind::kUsage);
  if (const auto* state = std::get_if<view::State>(&*message)) {
    for (const int side : {state->width, state->height})
      expect(side >= view::kMinViewSide && side <= view::kMaxViewSide, "a side of a view");
    expect(state->id >= 0 && state->model >= 0, "an id");
    expect(!state->views.empty() && state->views.size() <= view::kMaxViews, "a number of views");
    for (const view::View& view : state->views) check_options(view.options);
  }
}

/// Reads what a client sends: the head of a request, or frames. Frames in chunks must give the same messages.
void read_as_page_bytes(std::string_view bytes) {
  if (const auto request = view::parse_head(bytes)) {
    expect(request->path.starts_with('/'), "a path");
    expect(request->content_length() >= -1, "a size");
    for (const auto& [name, value] : request->headers) expect(!name.empty() && !view::has_control(value), "a header");
    static_cast<void>(request->parameter("name"));
    static_cast<void>(view::with_port(request->header("host"), 1));
  }
  static_cast<void>(view::is_host(bytes));
  std::string whole;
  for (const std::size_t chunk : {bytes.size(), std::size_t(7)}) {
    view::FrameReader reader;
    std::string messages;
    for (std::size_t at = 0; at < bytes.size(); at += chunk) {
      reader.add(bytes.substr(at, chunk));
      while (const auto message = reader.next()) {
        expect(message->data.size() <= view::kMaxMessageBytes, "the size of a message");
        messages += fmt::format("{} {} {} ", int(message->opcode), message->data.size(), message->data);
      }
    }
    messages += fmt::format("{} {}", int(reader.error()), reader.sentence());
    expect(whole.empty() || whole == messages, "messages that depend on chunks");
    whole = std::move(messages);
  }
}

constexpr const char *kGltf = "gltf", *kGlb = "glb", *k3ds = "3ds", *kDae = "dae", *kPdb = "pdb", *kFbx = "fbx",
                     *k3mf = "3mf";

constexpr Reader kReaders[] = {
    {"ply", read_as_ply, ply_seeds, false},
    {"off", read_as_off, off_seeds, false},
    {"stl", read_as_stl, stl_seeds, false},
    {"obj", read_as_obj, obj_seeds, false},
    {"mtl", read_as_mtl, mtl_seeds, false},
    {"xyz", read_as_xyz, xyz_seeds, false},
    {"gzip", read_as_gzip, gzip_seeds, false},
    {"radiance", read_as_radiance, radiance_seeds, false},
    {"png", read_as_image, png_seeds, false},
    {"pfm", read_as_image, pfm_seeds, false},
    {"setting", read_as_setting, setting_seeds, false},
    {"scene-name", read_as_scene_name, scene_name_seeds, false},
    {"transfer", read_as_transfer, transfer_seeds, false},
    {"baseline", read_as_baseline, baseline_seeds, false},
    {"page-message", read_as_page_message, page_message_seeds, false},
    {"page-bytes", read_as_page_bytes, page_bytes_seeds, false},
    {"exr", read_as_image, exr_seeds, true},
    {"layers-exr", read_as_layers, exr_seeds, true},
    {"layers-tiff", read_as_layers, tiff_seeds, true},
    {"layers-array", read_as_layers, array_seeds, false},
    {"gbuffer", read_as_gbuffer, gbuffer_seeds, false},
    {"content", read_as_content, content_seeds, false},
    {"layers-picture", read_as_layers, picture_seeds, true},
    {"info", read_as_info, info_seeds, true},
    {"texture", read_as_texture, texture_seeds, true},
    {"gltf", import_as<kGltf>, gltf_seeds, true},
    {"glb", import_as<kGlb>, glb_seeds, true},
    {"3ds", import_as<k3ds>, seeds_of_3ds, true},
    {"dae", import_as<kDae>, dae_seeds, true},
    {"fbx", import_as<kFbx>, fbx_seeds, false},
    {"pdb", import_as<kPdb>, pdb_seeds, true},
    {"3mf", import_as<k3mf>, three_mf_seeds, true},
    {"vtk", read_as_vtk, vtk_seeds, false},
};

}  // namespace

std::span<const Reader> readers() { return kReaders; }

}  // namespace umbrage::fuzz
