// Roles: which channels of image files hold depth, normals and the other planes of a G-buffer, by their names. The
// names are those that renderers write; Open Image Denoise's script split_exr.py has a part of the list.
#pragma once
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "gbuffers/settings.h"
#include "io/layers.h"

namespace umbrage {

enum class Role {
  kDepth,
  kNormal,
  kPosition,
  kAlbedo,
  kBeauty,
  kAlpha,          ///< coverage of the beauty
  kIndirect,       ///< indirect diffuse light
  kIndirectColor,  ///< the albedo by which it is still to be multiplied
  kEmission,
  kObjectId,
  kMaterialId,
  kMask,    ///< 0 where there is no surface
  kMotion,  ///< motion vectors: one or two pairs of channels
  kOwn,     ///< further planes of core/gbuffer.h, in files that Umbrage wrote
};
inline constexpr int kRoleCount = int(Role::kOwn) + 1;

/// Channels of one file that belong together: a colour, a vector, or a single one.
struct ChannelGroup {
  int file = 0;      ///< index of the file
  std::string name;  ///< as messages show it: "ViewLayer.Depth (Z)"
  std::string part, view, layer;
  std::vector<int> channels;  ///< in the order r g b (a) or x y z
  bool is_color = false;      ///< has r, g and b; a, if there is one, is the fourth
};

/// What the name of a depth layer says of its values.
enum class DepthHint {
  kNone,
  kPlanar,
  kDistance,
  kDisparity,
  kWindow,
  kReversed,
  kGrey,  ///< brightness between two depths that the file does not state
  kHeight,
};

/// The channels that hold a role; none if the files do not have it.
struct RoleChannels {
  int file = 0;
  std::vector<int> channels;
  std::string name;          ///< as messages show it
  std::vector<int> files{};  ///< of each channel, if they are in several files; else empty

  int file_of(std::size_t channel) const { return files.empty() ? file : files[channel]; }
  bool empty() const { return channels.empty(); }
};

struct Roles {
  std::array<RoleChannels, kRoleCount> of;
  DepthHint depth_hint = DepthHint::kNone;
  bool depth_is_guess = false;   ///< no name says that this is depth: it is the only layer
  bool normal_is_guess = false;  ///< no name says that these are normals: their length is 1
  std::vector<std::pair<RoleChannels, DepthHint>> other_depths;  ///< of the main file, by their names
  std::vector<ChannelGroup> unknown;                             ///< vectors of the main file whose names say nothing
  std::vector<std::vector<std::string>> motion_words;            ///< what names say of each pair of kMotion
  std::vector<std::string> own;    ///< plane names of the channels of kOwn, in their order
  std::string view;                ///< view of a stereo file; else empty
  std::vector<std::string> views;  ///< all views of the first file

  RoleChannels& operator[](Role role) { return of[std::size_t(role)]; }
  const RoleChannels& operator[](Role role) const { return of[std::size_t(role)]; }
};

/// A file of the settings, and what it is for.
struct RoleFile {
  Role role = Role::kDepth;
  bool all_roles = false;     ///< the main file, whose layers are recognised
  std::string path, layer;    ///< of "FILE:LAYER"
  bool is_component = false;  ///< one of three files that hold a vector: "X.png,Y.png,Z.png"
  std::string_view field = "file";
};

/// Returns the three image files of "X.png,Y.png,Z.png", which hold the components of a vector; else the text.
std::vector<std::string> component_files(const std::string& text);

/// Returns the files of the settings, the main one first.
std::vector<RoleFile> role_files(const GBufferSettings& settings);

/// Returns the channels of a file in groups, in the order of the file; `file` becomes ChannelGroup::file.
std::vector<ChannelGroup> groups_of(const LayeredFile& header, int file);

/// Returns the layers as messages list them: "ViewLayer.Depth (Z)"; also arrays of an NPZ that are no layers.
std::vector<std::string> layer_list(const LayeredFile& header);

/// Assigns roles. `headers` are those of `files`. Errors: kUsage for a layer or view that a file does not have.
Result<Roles> find_roles(std::span<const RoleFile> files, std::span<const LayeredFile> headers,
                         const std::string& view);

/// Finds motion vectors, in a layer that begins with `prefix` if there are some, and what their name says. `is_given`:
/// in a layer of any name.
void find_motion(const LayeredFile& header, std::span<const ChannelGroup> groups, std::string_view prefix,
                 bool is_given, Roles& roles);

/// Returns a name in small letters without blanks, underscores and hyphens: "Denoising Depth" -> "denoisingdepth".
std::string plain(std::string_view text);

/// Returns whether Umbrage wrote the file, whose conventions are then known.
bool is_own_file(const LayeredFile& header);

using Names = std::span<const std::string_view>;

/// A name of depth layers, and what it says of their values.
struct DepthName {
  std::string_view name;
  DepthHint hint = DepthHint::kNone;
};

/// Returns the names of depth layers, the preferred first: exact depth before depth for a denoiser, planar before ray
/// distance.
std::span<const DepthName> depth_names();

/// Returns the names of layers with a role, the preferred first, in small letters without blanks, underscores and
/// hyphens.
Names names_of(Role role);

}  // namespace umbrage
