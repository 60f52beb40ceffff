#include "gbuffers/raw_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/lists.h"
#include "gbuffers/packing.h"
#include "io/format.h"

namespace umbrage {
namespace {

/// A channel of a file and the plane that it fills.
struct Filled {
  int channel = 0;
  std::string plane;
};

std::vector<Filled> planes_of(const Roles& roles, int file) {
  std::vector<Filled> planes;
  for (int role = 0; role < kRoleCount; ++role) {
    const RoleChannels& of = roles.of[std::size_t(role)];
    for (std::size_t c = 0; c < of.channels.size(); ++c)
      if (of.file_of(c) == file) planes.push_back({of.channels[c], raw_plane(Role(role), c)});
  }
  return planes;
}

/// Sets depth and positions to NaN where the mask is 0.
void apply_mask(Image& rows) {
  const Plane* mask = rows.find(raw_plane(Role::kMask, 0));
  if (!mask) return;
  for (const Role role : {Role::kDepth, Role::kPosition})
    for (std::size_t c = 0; c < 3; ++c)
      if (Plane* plane = rows.find(raw_plane(role, c)))
        for (int y = 0; y < rows.height; ++y)
          for (int x = 0; x < rows.width; ++x)
            if (mask->at(x, y) == 0.0f) plane->at(x, y) = std::numeric_limits<float>::quiet_NaN();
}

/// Replaces the channels of a packed depth by one.
void unpack(const Packing& packing, Image& rows) {
  Plane* first = rows.find(raw_plane(Role::kDepth, 0));
  if (!first) return;
  for (int y = 0; y < rows.height; ++y)
    for (int x = 0; x < rows.width; ++x) {
      std::array<float, 4> bytes{};
      for (std::size_t c = 0; c < packing.channels(); ++c) bytes[c] = rows.plane(raw_plane(Role::kDepth, c)).at(x, y);
      first->at(x, y) = packing.decoded(bytes);
    }
}

/// Returns the rows in the opposite order.
Image upside_down(const Image& rows) {
  Image out(rows.width, rows.height);
  for (std::size_t k = 0; k < rows.planes.size(); ++k) {
    Plane& plane = out.add(rows.names[k]) = Plane(rows.width, rows.height);
    for (int y = 0; y < rows.height; ++y)
      std::copy_n(rows.planes[k].row(rows.height - 1 - y), rows.width, plane.row(y));
  }
  return out;
}

/// Reads the channels of one file into a store with one plane per role that uses them.
Result<void> fill(const LayeredFile& header, const std::vector<Filled>& planes, const RawReading& reading,
                  RowStore& store) {
  std::vector<int> channels;
  for (const Filled& filled : planes)
    if (!contains(channels, filled.channel)) channels.push_back(filled.channel);
  return reading.read_rows(header, channels, [&](const Image& rows, int first) -> Result<void> {
    Image named(rows.width, rows.height);
    for (const Filled& filled : planes) {
      const auto at = std::find(channels.begin(), channels.end(), filled.channel) - channels.begin();
      named.add(filled.plane) = rows.planes[std::size_t(at)];
    }
    if (reading.packing) unpack(*reading.packing, named);
    apply_mask(named);
    if (!reading.flip) return store.write(named, first);
    return store.write(upside_down(named), header.height - first - rows.height);
  });
}

}  // namespace

std::string raw_plane(Role role, std::size_t channel) {
  constexpr std::string_view kNames[] = {"depth",       "normal",   "position",       "albedo",   "beauty",
                                         "alpha",       "indirect", "indirect_color", "emission", "object_id",
                                         "material_id", "mask",     "motion",         "own"};
  return fmt::format("{}.{}", kNames[std::size_t(role)], channel);
}

const Plane* RawRows::find(Role role, std::size_t channel) const {
  const std::string name = raw_plane(role, channel);
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) return planes[k];
  return nullptr;
}

Result<RawPlanes> RawPlanes::read(std::span<const LayeredFile> headers, const Roles& roles, const RawReading& reading) {
  RawPlanes raw;
  const LayeredFile* sized = nullptr;
  double bytes = 0.0;
  for (std::size_t file = 0; file < headers.size(); ++file) {
    const std::size_t count = planes_of(roles, int(file)).size();
    if (count == 0) continue;
    const LayeredFile& header = headers[file];
    bytes += double(count) * sizeof(float) * header.width * header.height;
    if (!sized) sized = &header;
    if (header.width != sized->width || header.height != sized->height)
      return usage_error("'{}' has {} x {} pixels, and '{}' has {} x {}: files of one G-buffer have the same size",
                         header.path.string(), header.width, header.height, sized->path.string(), sized->width,
                         sized->height);
  }
  if (sized && reading.scratch_folder.empty())  // stored and converted values stay in memory
    if (auto fits = check_memory(sized->path, 2.0 * bytes); !fits) return fits.error();
  for (std::size_t file = 0; file < headers.size(); ++file) {
    const std::vector<Filled> planes = planes_of(roles, int(file));
    if (planes.empty()) continue;
    const LayeredFile& header = headers[file];
    std::vector<std::string> names;
    for (const Filled& filled : planes) names.push_back(filled.plane);
    // All files go to scratch files if they do not fit together.
    auto store = RowStore::create(header.width, header.height, std::move(names),
                                  bytes <= reading.memory ? reading.memory : 0.0, reading.scratch_folder);
    if (!store) return store.error();
    if (auto filled = fill(header, planes, reading, *store); !filled) return filled.error();
    raw.width_ = header.width;
    raw.height_ = header.height;
    raw.stores_.push_back(std::move(*store));
  }
  return raw;
}

bool RawPlanes::is_in_memory() const {
  return std::all_of(stores_.begin(), stores_.end(), [](const RowStore& store) { return store.is_in_memory(); });
}

bool RawPlanes::has(Role role, std::size_t channel) const {
  const std::string name = raw_plane(role, channel);
  return std::any_of(stores_.begin(), stores_.end(),
                     [&](const RowStore& store) { return contains(store.names(), name); });
}

Result<RawRows> RawPlanes::rows(const Rows& rows) const {
  RawRows out;
  const bool in_memory = is_in_memory();
  out.first = in_memory ? 0 : rows.begin;
  out.owned.reserve(stores_.size());
  for (const RowStore& store : stores_) {
    const Image* image = store.whole();
    if (!in_memory) {
      auto read = store.read(rows);
      if (!read) return read.error();
      image = &out.owned.emplace_back(std::move(*read));
    }
    for (std::size_t k = 0; k < image->planes.size(); ++k) {
      out.names.push_back(image->names[k]);
      out.planes.push_back(&image->planes[k]);
    }
  }
  return out;
}

}  // namespace umbrage
