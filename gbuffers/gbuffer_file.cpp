#include "gbuffers/gbuffer_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "core/lists.h"
#include "gbuffers/conventions.h"
#include "gbuffers/convert.h"
#include "gbuffers/extent.h"
#include "gbuffers/ids.h"
#include "gbuffers/packing.h"
#include "gbuffers/repair.h"
#include "gbuffers/role_values.h"
#include "gbuffers/steps.h"
#include "io/format.h"
#include "io/layers.h"

namespace umbrage {
namespace {

/// Returns a sentence for each setting of the depth that the conventions do not use.
std::vector<std::string> unused_settings(const GBufferSettings& settings, const DepthConvention& depth) {
  const GBufferSettings initial;
  const DepthMeaning meaning = depth.model.meaning;
  const bool is_buffer =
      !depth.from_position && (meaning == DepthMeaning::kWindow || meaning == DepthMeaning::kReversed);
  struct Setting {
    const char* field;
    bool is_set, is_used;
    const char* why;
  };
  const char* no_buffer =
      "the depth is not that of a depth buffer; try `depth_kind` window, or `depth_range` NEAR,FAR if it is linear";
  const Setting all[] = {
      {"near_plane", settings.near_plane != initial.near_plane, is_buffer, no_buffer},
      {"far_plane", settings.far_plane != initial.far_plane, is_buffer, no_buffer},
      {"cell_size", settings.cell_size.has_value(), meaning == DepthMeaning::kHeight,
       "the depth is no elevation; try `depth_kind` height"},
      {"depth_range", !settings.depth_range.empty(), !depth.from_position, "the depth is that of the positions"}};
  std::vector<std::string> sentences;
  for (const Setting& setting : all)
    if (setting.is_set && !setting.is_used)
      sentences.push_back(fmt::format("`{}` does nothing: {}", setting.field, setting.why));
  return sentences;
}

/// Returns the rows with `margin` further ones above and below, within the picture.
Rows with_margin(const Rows& rows, int margin, int height) {
  return {std::max(rows.begin - margin, 0), std::min(rows.end + margin, height)};
}

}  // namespace

struct GBufferFile::State {
  PictureInfo info;
  GBufferFacts facts;
  Conversion conversion;
  std::vector<std::string> names;
  std::string base;
  double memory = 0.0;
  bool is_display_referred = false;
  std::optional<RawPlanes> raw;
  std::vector<float> steps;  // depths that are smoothed: see depth_steps
  float unit = 0.0f;         // of the steps
  EdgeRepair repair;

  bool orthographic() const { return info.camera.projection == Projection::kOrthographic; }
  /// Returns converted rows without steps and with repaired edges.
  Result<Image> finished(const Rows& rows) const {
    const int margin = (repair.any() ? kRepairMargin : 0) + (steps.empty() ? 0 : kStepsMargin);
    const Rows around = with_margin(rows, margin, info.height);
    const auto stored = raw->rows(around);
    if (!stored) return stored.error();
    Image converted = convert(*stored, conversion, around);
    if (margin == 0) return converted;
    if (!steps.empty()) {
      Plane& depth = converted.plane("depth");
      depth = smoothed_steps(depth, {0, depth.height}, steps, orthographic(), unit);
    }
    const Rows own{rows.begin - around.begin, rows.end - around.begin};
    return repaired_rows(converted, own, repair, info.pixel_width(), orthographic());
  }
};

namespace {

/// The files of the settings, with their headers and roles.
struct Opened {
  std::vector<RoleFile> files;
  std::vector<LayeredFile> headers;
  Roles roles;
  bool crypto_objects = false, crypto_materials = false;
};

/// Uses Cryptomatte for ids if the files have no other ids of that kind.
bool use_cryptomatte(const Opened& opened, Role role, Roles& roles) {
  if (!roles[role].empty()) return false;
  for (std::size_t file = 0; file < opened.files.size(); ++file) {
    if (!opened.files[file].all_roles && opened.files[file].role != role) continue;
    if (auto found = find_cryptomatte(opened.headers[file], int(file), role == Role::kMaterialId)) {
      roles[role] = *found;
      return true;
    }
  }
  return false;
}

Result<Opened> open_files(const GBufferSettings& settings, GBufferFacts& facts) {
  Opened opened;
  opened.files = role_files(settings);
  if (opened.files.empty()) return usage_error("no file is given");
  for (const RoleFile& file : opened.files) {
    auto header = read_header(file.path);
    if (!header) return with_field(header.error(), file.field);
    for (const std::string& layer : layer_list(*header))
      facts.layers.push_back(opened.files.size() == 1 ? layer : fmt::format("{}: {}", file.path, layer));
    opened.headers.push_back(std::move(*header));
  }
  return opened;
}

/// Finds roles, which describe_gbuffer reports even if the file cannot be shaded.
Result<void> find_all_roles(const GBufferSettings& settings, Opened& opened) {
  auto roles = find_roles(opened.files, opened.headers, settings.view);
  if (!roles) return roles.error();
  opened.roles = std::move(*roles);
  opened.crypto_objects = use_cryptomatte(opened, Role::kObjectId, opened.roles);
  opened.crypto_materials = use_cryptomatte(opened, Role::kMaterialId, opened.roles);
  return {};
}

/// Returns the distance of neighbours in samples: farther for values of few bits, whose small differences are noise.
int sample_reach(const Opened& opened) {
  constexpr int kExact = 2, kCoarse = 4, kNarrow = 90, kWidth = 480;  // wider pictures have farther neighbours
  const RoleChannels& depth = opened.roles[Role::kDepth];
  const LayeredFile& header = opened.headers[std::size_t(depth.file)];
  const bool is_float = depth.empty() || header.channels[std::size_t(depth.channels[0])].type == ChannelType::kFloat ||
                        header.channels[std::size_t(depth.channels[0])].type == ChannelType::kDouble;
  return is_float ? std::max(std::clamp(header.width / kNarrow, 1, kExact), header.width / kWidth)
                  : std::max(kCoarse, 2 * header.width / kWidth);
}

constexpr double kStoredFraction = 0.25;  // of the memory, for stored values: shading needs the rest
constexpr int kSampleCount = 1 << 15;     // enough to recognise conventions

/// Returns bands of rows that are spread over the picture: a sample of whole neighbourhoods.
std::vector<Rows> spread_bands(const PictureInfo& info) {
  constexpr int kBands = 16;
  constexpr double kPixels = 1 << 19;  // in all bands: enough discontinuities, in a few milliseconds
  const int rows = std::clamp(int(kPixels / kBands / info.width), 8, std::max(info.height, 8));
  const int bands = std::min(kBands, std::max(info.height / rows, 1));
  std::vector<Rows> spread;
  for (int band = 0; band < bands; ++band) {
    const int begin = int(long(info.height) * band / bands);
    spread.push_back({begin, std::min(begin + rows, info.height)});
  }
  return spread;
}

/// Counts depth discontinuities. Errors: kFile.
Result<EdgeCounts> sampled_edges(const RawPlanes& raw, const Conversion& conversion, const PictureInfo& info) {
  EdgeCounts counts;
  for (const Rows& band : spread_bands(info)) {
    const auto stored = raw.rows(band);
    if (!stored) return stored.error();
    counts.add(count_edges(convert(*stored, conversion, band), info.pixel_width(),
                           info.camera.projection == Projection::kOrthographic));
  }
  return counts;
}

/// Finds the steps of the depth, and tells of them. `unit`: see depth_steps. Errors: kFile.
Result<std::vector<float>> find_steps(const GBufferSettings& settings, const RawPlanes& raw,
                                      const Conventions& conventions, const PictureInfo& info, GBufferFacts& facts,
                                      float& unit) {
  std::vector<float> steps;
  if (settings.repair == "off" || (settings.repair == "auto" && conventions.depth.is_own)) return steps;
  std::vector<Plane> bands;
  for (const Rows& band : spread_bands(info)) {
    const auto stored = raw.rows(band);
    if (!stored) return stored.error();
    bands.push_back(converted_depth(*stored, conventions, band));
  }
  steps = depth_steps(bands, info.pixel_width(), info.camera.projection == Projection::kOrthographic, unit);
  constexpr int kBlockRows = 256;
  for (int begin = 0; begin < info.height && !steps.empty(); begin += kBlockRows) {
    const Rows block{begin, std::min(begin + kBlockRows, info.height)};
    const auto stored = raw.rows(block);
    if (!stored) return stored.error();
    add_levels(converted_depth(*stored, conventions, block), steps);
  }
  if (!steps.empty())
    facts.lines.push_back(fmt::format("steps: {} different depths; smoothed by at most one step", steps.size()));
  return steps;
}

/// Decides which repair the edges get, and tells it. Errors: kFile.
Result<EdgeRepair> decide_repair(const GBufferSettings& settings, const RawPlanes& raw, const Conversion& conversion,
                                 const PictureInfo& info, GBufferFacts& facts) {
  if (settings.repair == "off") return EdgeRepair();
  if (settings.repair == "on") return EdgeRepair{.depth = true, .normals = true};
  // Terrain has slopes of every kind between two steps, and no renderer averaged it.
  if (conversion.conventions.depth.model.meaning == DepthMeaning::kHeight) return EdgeRepair();
  const auto counts = sampled_edges(raw, conversion, info);
  if (!counts) return counts.error();
  const EdgeRepair needed = counts->needed();
  const auto percent = [](long some, long others) { return 100.0 * double(some) / double(some + others); };
  if (needed.depth)
    facts.lines.push_back(fmt::format("edges: {:.0f} % of the depth discontinuities are averaged; repaired",
                                      percent(counts->mixed, counts->sharp)));
  if (needed.normals)
    facts.lines.push_back(fmt::format("edges: {:.0f} % of the normals at depth discontinuities are averaged; repaired",
                                      percent(counts->mixed_normals, counts->clean_normals)));
  return needed;
}

/// Returns the number of pixels in some rows whose depth is a length below 0, which shows no surface.
long negative_depths(const RawRows& raw, const DepthConvention& depth, const Rows& rows) {
  const DepthModel& model = depth.model;
  const bool is_length = model.meaning == DepthMeaning::kPlanar || model.meaning == DepthMeaning::kDistance ||
                         model.meaning == DepthMeaning::kDisparity;
  const Plane* stored = raw.find(Role::kDepth, 0);
  if (depth.from_position || !is_length || !stored) return 0;
  long count = 0;
  for (int y = rows.begin; y < rows.end; ++y)
    for (int x = 0; x < stored->width; ++x)
      count += model.offset + model.scale * stored_depth(depth, double(stored->at(x, y - raw.first))) < 0.0;
  return count;
}

/// Measures the extent of the picture after the repair of its edges, and warns of depths below 0. Errors: kFile.
Result<void> measure_extent(const RawPlanes& raw, const Conventions& conventions, const EdgeRepair& repair,
                            float scene_radius, PictureInfo& info, GBufferFacts& facts) {
  ExtentOfDepth extent(info);
  long negative = 0;
  constexpr int kBlockRows = 256;
  for (int begin = 0; begin < info.height; begin += kBlockRows) {
    const Rows block{begin, std::min(begin + kBlockRows, info.height)};
    const Rows around = with_margin(block, repair.depth ? kRepairMargin : 0, info.height);
    const auto rows = raw.rows(around);
    if (!rows) return rows.error();
    Image depth(info.width, around.count());
    depth.add("depth") = converted_depth(*rows, conventions, around);
    if (repair.depth)
      depth = repaired_rows(depth, {block.begin - around.begin, block.end - around.begin}, {.depth = true},
                            info.pixel_width(), info.camera.projection == Projection::kOrthographic);
    negative += negative_depths(*rows, conventions.depth, block);
    for (int y = block.begin; y < block.end; ++y) extent.add(depth.planes[0].row(y - block.begin), y);
  }
  extent.finish(scene_radius, info);
  const double pixels = double(info.width) * info.height;
  if (negative > 0)
    facts.warnings.push_back(
        fmt::format("the depth is below 0 at {} pixels ({:.2g} %), which show no surface: `depth_background` names a "
                    "value that means none",
                    negative, 100.0 * double(negative) / pixels));
  return {};
}

}  // namespace

GBufferFile::GBufferFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
GBufferFile::GBufferFile(GBufferFile&&) noexcept = default;
GBufferFile& GBufferFile::operator=(GBufferFile&&) noexcept = default;
GBufferFile::~GBufferFile() = default;

Result<GBufferFile> GBufferFile::open(const GBufferSettings& settings, double memory, const std::string& scratch_folder,
                                      const Conventions* first, bool* is_unreadable) {
  const ReadingLimits limits(std::numeric_limits<double>::infinity(), memory);
  auto state = std::make_unique<State>();
  state->memory = memory;
  auto opened = open_files(settings, state->facts);
  if (!opened) return opened.error();
  if (auto found = find_all_roles(settings, *opened); !found) return found.error();
  const auto reading = [&](const Packing* packing) {
    return RawReading{.flip = settings.flip,
                      .packing = packing,
                      .memory = kStoredFraction * memory,
                      .scratch_folder = scratch_folder,
                      .read_rows = [&](const auto&... what) {
                        auto status = read_rows(what...);
                        if (is_unreadable) *is_unreadable = !status;
                        return status;
                      }};
  };
  const auto sample_roles = [&](const Roles& some) -> Result<Samples> {
    const auto raw = RawPlanes::read(opened->headers, some, reading(nullptr));
    if (!raw) return raw.error();
    return sample(*raw, sample_reach(*opened), kSampleCount);
  };
  if (auto found = find_roles_by_values(settings, opened->headers, sample_roles, opened->roles, state->facts); !found)
    return found.error();
  const Roles& roles = opened->roles;
  if (roles[Role::kDepth].empty() && roles[Role::kPosition].empty())
    return file_error("'{}' has neither depth nor positions; its layers are {}: `depth_file` FILE:LAYER names another",
                      opened->files[0].path, fmt::join(state->facts.layers, ", "));
  auto raw = RawPlanes::read(opened->headers, roles, reading(find_packing(settings.depth_packing)));
  if (!raw) return raw.error();
  const auto samples = sample(*raw, sample_reach(*opened), kSampleCount);
  if (!samples) return samples.error();
  auto conventions = decide_conventions(settings, opened->headers, roles, *samples, state->facts, first);
  if (!conventions) return conventions.error();
  for (std::string& sentence : unused_settings(settings, conventions->depth))
    state->facts.warnings.push_back(std::move(sentence));
  state->conversion.conventions = *conventions;
  state->conversion.own = roles.own;
  for (const Role role : {Role::kObjectId, Role::kMaterialId}) {
    if (roles[role].empty()) continue;
    auto ids = collect_ids(*raw, role, role == Role::kObjectId ? opened->crypto_objects : opened->crypto_materials);
    if (!ids) return ids.error();
    (role == Role::kObjectId ? state->conversion.object_ids : state->conversion.material_ids) = std::move(*ids);
  }
  PictureInfo& info = state->info;
  info.width = raw->width();
  info.height = raw->height();
  info.camera = conventions->camera;
  state->unit = float(conventions->depth.unit);
  auto steps = find_steps(settings, *raw, *conventions, info, state->facts, state->unit);
  if (!steps) return steps.error();
  if (!conventions->step_warning.empty())
    state->facts.warnings.push_back(conventions->step_warning +
                                    (steps->empty() ? ": surfaces show terraces; " + conventions->step_cure
                                                    : ": they are smoothed, but fine shapes are lost"));
  state->steps = std::move(*steps);
  const auto repair = decide_repair(settings, *raw, state->conversion, info, state->facts);
  if (!repair) return repair.error();
  state->repair = *repair;
  if (auto status = measure_extent(*raw, *conventions, *repair, settings.scene_radius, info, state->facts); !status)
    return status.error();
  state->names = converted_names(*raw, state->conversion);
  state->is_display_referred = conventions->color[std::size_t(Role::kBeauty)].is_srgb;
  if (opened->files[0].all_roles && opened->headers[0].format == "EXR") state->base = opened->files[0].path;
  state->raw = std::move(*raw);
  return GBufferFile(std::move(state));
}

const PictureInfo& GBufferFile::info() const { return state_->info; }
const GBufferFacts& GBufferFile::facts() const { return state_->facts; }
const Conventions& GBufferFile::conventions() const { return state_->conversion.conventions; }
const std::vector<std::string>& GBufferFile::plane_names() const { return state_->names; }
bool GBufferFile::has_plane(std::string_view name) const { return contains(state_->names, name); }

Result<Image> GBufferFile::rows(const Rows& rows) const { return state_->finished(rows); }

Result<Image> GBufferFile::stored_motion() const {
  Image out(state_->info.width, state_->info.height);
  const auto stored = state_->raw->rows({0, out.height});
  if (!stored) return stored.error();
  for (std::size_t c = 0; const Plane* plane = stored->find(Role::kMotion, c); ++c)
    out.add(raw_plane(Role::kMotion, c)) = *plane;
  return out;
}

bool GBufferFile::is_in_memory() const { return state_->raw->is_in_memory(); }
double GBufferFile::memory() const { return state_->memory; }
DepthMeaning GBufferFile::depth_meaning() const { return state_->conversion.conventions.depth.model.meaning; }
bool GBufferFile::is_display_referred() const { return state_->is_display_referred; }
std::string GBufferFile::merge_base() const { return state_->base; }

Result<GBufferFacts> describe_gbuffer(const GBufferSettings& settings) {
  GBufferFacts facts;
  auto opened = open_files(settings, facts);
  if (!opened) return opened.error();
  constexpr double kMemory = 4e9;  // bytes; larger pictures go to the folder for temporary files
  std::error_code ignored;
  bool is_unreadable = false;
  auto file = GBufferFile::open(settings, kMemory, std::filesystem::temp_directory_path(ignored).string(), nullptr,
                                &is_unreadable);
  if (file) return file->facts();
  if (file.error().kind != ErrorKind::kFile || is_unreadable) return file.error();
  // Files whose pixels can be read may yet hold no G-buffer.
  for (const LayeredFile& header : opened->headers) {
    std::vector<int> all;
    for (const Channel& channel : header.channels) all.push_back(channel.index);
    const auto read = read_rows(header, all, [](const Image&, int) { return Result<void>(); });
    if (!read) return read.error();
  }
  facts.warnings.push_back(file.error().message);
  return facts;
}

}  // namespace umbrage
