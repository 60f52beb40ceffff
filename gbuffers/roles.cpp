#include "gbuffers/roles.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "core/lists.h"
#include "core/lowercase.h"
#include "core/suggest.h"

namespace umbrage {
namespace {

/// Returns whether a group of one channel is coverage, which no picture can be made of.
bool is_coverage(const ChannelGroup& group, const LayeredFile& header) {
  const std::string channel = plain(header.channels[std::size_t(group.channels.front())].name);
  return channel == "a" || channel == "alpha";
}

bool fits(Role role, const ChannelGroup& group, const LayeredFile& header) {
  const std::size_t count = group.channels.size();
  switch (role) {
    case Role::kNormal:
    case Role::kPosition:
      return count >= 3;
    case Role::kDepth:
      return count == 1 || (group.is_color && count >= 3);
    case Role::kAlpha:
    case Role::kMaterialId:
      return count == 1;
    case Role::kAlbedo:
    case Role::kBeauty:
    case Role::kIndirect:
    case Role::kIndirectColor:
    case Role::kEmission:
      return group.is_color || (count == 1 && !is_coverage(group, header));
    case Role::kObjectId:
      return count == 1 || group.is_color;
    case Role::kMask:
      return count == 1 && header.format == "NPZ";
    case Role::kMotion:  // see find_motion
      return false;
    case Role::kOwn:
      return count == 1;
  }
  return false;
}

/// Letters that say nothing but "the channel of this layer".
bool is_generic(std::string_view channel) {
  constexpr std::string_view kLetters[] = {"z", "v", "r", "y", "t", "d", "a", "l", "x", "i", "g", "b", "value", "grey"};
  return contains(kLetters, channel);
}

/// Returns where a channel stands in a colour or vector, and which of the two: 'c' or 'v'.
std::optional<std::pair<char, int>> component_of(const std::string& channel) {
  constexpr std::string_view kColors[] = {"r", "g", "b", "a"}, kWords[] = {"red", "green", "blue", "alpha"};
  for (int k = 0; k < 4; ++k)
    if (channel == kColors[k] || channel == kWords[k]) return std::pair('c', k);
  if (channel.size() == 1 && channel[0] >= 'x' && channel[0] <= 'z') return std::pair('v', channel[0] - 'x');
  return std::nullopt;
}

/// Channels that are depth whatever the name of their layer: z of most, t of Mitsuba.
struct DepthChannel {
  std::string_view letter, name;
  std::string_view beside;  ///< a channel of the same layer by which it is another coordinate
};
constexpr DepthChannel kDepthChannels[] = {{"z", "z", ""}, {"t", "raylength", "s"}};

/// Words that say what a layer is at the end of its name, too: "FinalImage_WorldDepth". Others, such as color, are
/// then something else.
constexpr std::string_view kEndings[] = {"depth", "depthworldunits", "normal", "normals", "position", "basecolor"};

/// Returns the ends of a name that begin with a word, without the whole name: "WorldDepth" and "Depth" of
/// "FinalImage_WorldDepth".
std::vector<std::string> ends_of(std::string_view name) {
  const auto is_upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  std::vector<std::string> ends;
  for (std::size_t k = 1; k < name.size(); ++k) {
    const bool is_word = !plain(name.substr(k - 1, 1)).empty() ? is_upper(name[k]) && !is_upper(name[k - 1]) : true;
    const std::string end = plain(name.substr(k));
    if (is_word && std::any_of(std::begin(kEndings), std::end(kEndings),
                               [&](std::string_view word) { return end.ends_with(word); }))
      ends.push_back(end);
  }
  return ends;
}

/// Weakness of the end of a name: below all whole names of a list.
constexpr int kOfAnEnd = 10000;

/// A name by which a group may be known. The weaker, the less it says.
struct KnownAs {
  std::string name;
  int weakness = 0;
};

/// Returns the part's name without the view that it repeats: "depth_left" of the view "left".
std::string part_name(const ChannelGroup& group) {
  std::string part = plain(group.part);
  const std::string view = plain(group.view);
  if (!view.empty() && part.size() > view.size() && part.ends_with(view)) part.resize(part.size() - view.size());
  return part;
}

std::vector<KnownAs> known_as(const ChannelGroup& group, const LayeredFile& header) {
  std::vector<KnownAs> names;
  const std::string channel = plain(header.channels[std::size_t(group.channels.front())].name);
  const bool single = group.channels.size() == 1;
  if (single && !is_generic(channel)) names.push_back({channel, group.layer.empty() ? 0 : 2});
  const std::size_t dot = group.layer.rfind('.');
  if (!group.layer.empty()) {
    names.push_back({plain(group.layer.substr(dot == std::string::npos ? 0 : dot + 1)), 0});
    const std::size_t before =
        dot == std::string::npos || dot == 0 ? std::string::npos : group.layer.rfind('.', dot - 1);
    if (dot != std::string::npos)
      names.push_back({plain(group.layer.substr(before == std::string::npos ? 0 : before + 1)), 0});
  }
  if (!group.part.empty()) {
    const std::string part = part_name(group);
    names.push_back({part, 1});
    if (const std::size_t last = group.part.rfind('.'); last != std::string::npos)
      names.push_back({plain(group.part.substr(last + 1)), 1});
    names.push_back({plain(group.part.substr(0, group.part.find('_'))), 2});
  }
  // "R G B" and "Z" without the name of a layer are the beauty and the depth. Parts of an EXR may have any name; the
  // name of an array says what it is.
  const bool unnamed = group.layer.empty() && (group.part.empty() || header.format == "EXR");
  for (const DepthChannel& depth : kDepthChannels)
    if (single && channel == depth.letter &&
        (depth.beside.empty() ||
         std::none_of(header.channels.begin(), header.channels.end(), [&](const Channel& other) {
           return other.part == group.part && other.layer == group.layer && plain(other.name) == depth.beside;
         })))
      names.push_back({std::string(depth.name), unnamed ? 1 : 5});
  for (const std::string& end : ends_of(group.layer.empty() ? group.part : group.layer))
    names.push_back({end, kOfAnEnd});
  if (group.is_color && unnamed) names.push_back({"rgba", group.part.empty() ? 1 : 3});
  return names;
}

/// Returns whether a group's name says that it is something other than depth, for which there is no role.
bool is_no_depth(const ChannelGroup& group, const LayeredFile& header) {
  constexpr std::string_view kOthers[] = {"ao", "ambientocclusion", "occlusion", "shadow", "outline", "mask", "cover"};
  for (const KnownAs& known : known_as(group, header))
    if (contains(kOthers, known.name)) return true;
  return false;
}

/// A penalty: the lower, the better; none if no name fits.
std::optional<int> rank_in(Names names, const std::vector<KnownAs>& known) {
  constexpr int kPerName = 8;  // more than the weakness of a whole name: the list's order decides first
  std::optional<int> best;
  for (const KnownAs& k : known)
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == k.name) best = std::min(best.value_or(1 << 20), int(i) * kPerName + k.weakness);
  return best;
}

/// Returns what precedes the last word of a layer: the view layer.
std::string prefix_of(const ChannelGroup& group) {
  const std::string& name = group.layer.empty() ? group.part : group.layer;
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? std::string() : name.substr(0, dot);
}

struct Search {
  std::span<const LayeredFile> headers;
  const std::vector<ChannelGroup>& groups;
  std::string prefix;                           ///< preferred view layer
  std::vector<const ChannelGroup*> taken = {};  ///< those that have a role
};

const ChannelGroup* best_group(const Search& search, Role role, Names names) {
  constexpr int kOtherPrefix = 4;
  const ChannelGroup* best = nullptr;
  int best_rank = std::numeric_limits<int>::max();
  for (const ChannelGroup& group : search.groups) {
    const LayeredFile& header = search.headers[std::size_t(group.file)];
    if (!fits(role, group, header) || contains(search.taken, &group)) continue;
    const auto rank = rank_in(names, known_as(group, header));
    if (!rank) continue;
    const int total = *rank + (prefix_of(group) == search.prefix ? 0 : kOtherPrefix);
    if (total >= best_rank) continue;
    best_rank = total;
    best = &group;
  }
  return best;
}

DepthHint hint_of(const ChannelGroup& group, const LayeredFile& header) {
  for (const KnownAs& known : known_as(group, header))
    for (const DepthName& depth : depth_names())
      if (depth.name == known.name && depth.hint != DepthHint::kNone) return depth.hint;
  if (header.geo) return DepthHint::kHeight;
  const std::string stem = plain(header.path.stem().string());
  for (const char* word : {"disparity", "inversedepth", "invdepth"})
    if (stem.find(word) != std::string::npos) return DepthHint::kDisparity;
  return stem.ends_with("disp") ? DepthHint::kDisparity : DepthHint::kNone;
}

RoleChannels taken(const ChannelGroup& group, Role role) {
  RoleChannels out{group.file, group.channels, group.name};
  const bool takes_alpha = role == Role::kBeauty || role == Role::kDepth;  // the fourth byte of a packed depth
  if (!takes_alpha && out.channels.size() > 3) out.channels.resize(3);
  return out;
}

/// Returns whether the group is what "FILE:LAYER" names: its whole name, or the end of it after a dot.
bool is_named(const ChannelGroup& group, const LayeredFile& header, const std::string& layer) {
  const std::string wanted = plain(layer);
  const auto ends = [&](const std::string& text) {
    const std::string name = plain(text);
    return name == wanted || (name.size() > wanted.size() && name.ends_with("." + wanted));
  };
  return ends(group.layer) || ends(group.part) || ends(group.part + "." + group.layer) ||
         (group.channels.size() == 1 && ends(header.channels[std::size_t(group.channels[0])].full_name()));
}

Error unknown_layer(const RoleFile& file, const LayeredFile& header, std::string_view why) {
  return field_error(file.field, "", "'{2}' {3} '{4}'; its layers are {5}", file.path, why, file.layer,
                     fmt::join(layer_list(header), ", "));
}

/// Returns the channel of a colour or vector that "FILE:LAYER" names, as a group of its own.
std::optional<ChannelGroup> named_channel(const std::vector<ChannelGroup>& groups, const LayeredFile& header,
                                          const std::string& layer) {
  for (const ChannelGroup& group : groups)
    for (const int channel : group.channels) {
      ChannelGroup one = group;
      one.channels = {channel};
      one.is_color = false;
      one.name = header.channels[std::size_t(channel)].full_name();
      if (is_named(one, header, layer)) return one;
    }
  return std::nullopt;
}

/// Returns the group of a file that serves one role. Errors: kUsage.
Result<ChannelGroup> group_for(const RoleFile& file, std::span<const LayeredFile> headers,
                               const std::vector<ChannelGroup>& groups) {
  const LayeredFile& header = headers[std::size_t(groups.front().file)];
  if (!file.layer.empty()) {
    bool named = false;
    for (const ChannelGroup& group : groups) {
      if (!is_named(group, header, file.layer)) continue;
      named = true;
      if (fits(file.role, group, header)) return group;
    }
    return unknown_layer(file, header, named ? "has too few channels in the layer" : "has no layer");
  }
  const Search search{headers, groups, ""};
  const Names names = names_of(file.role);
  if (const ChannelGroup* best = best_group(search, file.role, names)) return *best;
  for (const ChannelGroup& group : groups)
    if (fits(file.role, group, header)) return group;
  return usage_error("'{}' has no layer that can be used; its layers are {}", file.path,
                     fmt::join(layer_list(header), ", "));
}

void find_own(const LayeredFile& header, int file, Roles& roles) {
  if (!is_own_file(header)) return;
  for (const Channel& channel : header.channels)
    for (const std::string_view name : names_of(Role::kOwn))
      if (channel.part.empty() && channel.layer.empty() && channel.name == name) {
        roles[Role::kOwn].file = file;
        roles[Role::kOwn].channels.push_back(channel.index);
        roles.own.emplace_back(name);
      }
}

/// Assigns the roles of the main file by the names of its groups.
void find_all(const LayeredFile& header, int file, const std::vector<ChannelGroup>& groups,
              std::span<const LayeredFile> headers, Roles& roles) {
  Search search{headers, groups, ""};
  const ChannelGroup* depth = best_group(search, Role::kDepth, names_of(Role::kDepth));
  if (depth) {
    search.prefix = prefix_of(*depth);
    roles[Role::kDepth] = taken(*depth, Role::kDepth);
    roles.depth_hint = hint_of(*depth, header);
    for (const ChannelGroup& group : groups)
      if (&group != depth && group.channels.size() == 1 && rank_in(names_of(Role::kDepth), known_as(group, header)))
        roles.other_depths.emplace_back(taken(group, Role::kDepth), hint_of(group, header));
  }
  search.taken = {depth};
  for (const Role role : {Role::kNormal, Role::kPosition, Role::kAlbedo, Role::kIndirect, Role::kEmission,
                          Role::kObjectId, Role::kMaterialId, Role::kMask, Role::kAlpha, Role::kBeauty})
    if (const ChannelGroup* group = best_group(search, role, names_of(role))) {
      roles[role] = taken(*group, role);
      search.taken.push_back(group);
    }
  search.taken = {depth};  // what the indirect light is multiplied by is the albedo, too
  if (const ChannelGroup* group = best_group(search, Role::kIndirectColor, names_of(Role::kIndirectColor)))
    roles[Role::kIndirectColor] = taken(*group, Role::kIndirectColor);
  find_own(header, file, roles);
  find_motion(header, groups, search.prefix, false, roles);
  for (const ChannelGroup& group : groups)
    if (group.channels.size() >= 3 && (!group.is_color || header.format == "NPZ") &&
        std::none_of(roles.of.begin(), roles.of.end(),
                     [&](const RoleChannels& role) { return contains(role.channels, group.channels.front()); }))
      roles.unknown.push_back(group);
  if (depth || !roles[Role::kPosition].empty() || groups.size() != 1 || !fits(Role::kDepth, groups[0], header)) return;
  // A single layer without a name, such as that of a greyscale PNG: depth, unless its channels turn out to differ.
  if (is_no_depth(groups[0], header)) return;
  roles[Role::kDepth] = taken(groups[0], Role::kDepth);
  roles.depth_hint = hint_of(groups[0], header);
  roles.depth_is_guess = true;
  roles[Role::kBeauty] = {};
}

/// Returns the view to use, and fills `views`. Errors: kUsage.
Result<std::string> chosen_view(const LayeredFile& header, const std::string& wanted, std::vector<std::string>& views) {
  for (const Channel& channel : header.channels)
    if (!channel.view.empty() && !contains(views, channel.view)) views.push_back(channel.view);
  if (views.empty()) return std::string();
  if (wanted.empty()) return views.front();
  if (contains(views, wanted)) return wanted;
  return field_error("view", wanted, "'{2}' has no {0} '{1}'{3}", header.path.string(), suggestion(wanted, views));
}

/// Collects single channels whose names differ in a last letter x y z or r g b: "Nx", "Ny", "Nz".
void join_singles(const LayeredFile& header, std::vector<ChannelGroup>& groups) {
  const auto name_of = [&](const ChannelGroup& group) { return header.channels[std::size_t(group.channels[0])].name; };
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<std::size_t>> singles;
  for (std::size_t k = 0; k < groups.size(); ++k)
    if (groups[k].channels.size() == 1) singles[{groups[k].part, groups[k].layer, name_of(groups[k])}].push_back(k);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    if (groups[k].channels.size() != 1 || name_of(groups[k]).size() < 2) continue;
    const std::string name = name_of(groups[k]), start = name.substr(0, name.size() - 1);
    for (const std::string_view letters : {"xyz", "rgb", "XYZ", "RGB"}) {
      std::vector<std::size_t> found;
      for (const char letter : letters)
        if (const auto at = singles.find({groups[k].part, groups[k].layer, start + letter}); at != singles.end())
          std::copy_if(at->second.begin(), at->second.end(), std::back_inserter(found),
                       [&](std::size_t other) { return groups[other].channels.size() == 1; });
      if (found.size() != 3 || found[0] == found[1]) continue;
      ChannelGroup& first = groups[std::min({found[0], found[1], found[2]})];
      std::vector<int> channels;
      for (const std::size_t f : found) channels.push_back(groups[f].channels[0]);
      const std::string word = start.ends_with('_') || start.ends_with('.') ? start.substr(0, start.size() - 1) : start;
      first.layer += (first.layer.empty() ? "" : ".") + word;
      first.channels = channels;
      first.is_color = letters[0] == 'r' || letters[0] == 'R';
      for (const std::size_t f : found)
        if (&groups[f] != &first) groups[f].channels.clear();
      break;
    }
  }
  std::erase_if(groups, [](const ChannelGroup& group) { return group.channels.empty(); });
}

void name_groups(const LayeredFile& header, std::vector<ChannelGroup>& groups) {
  for (ChannelGroup& group : groups) {
    std::string letters;
    for (const int channel : group.channels) {
      const std::string& name = header.channels[std::size_t(channel)].name;
      letters += (letters.empty() || name.size() == 1 ? "" : " ") + name;
    }
    const std::string words = layer_with_part(group.part, group.layer);
    group.name = words.empty() ? letters : fmt::format("{} ({})", words, letters);
  }
}

}  // namespace

std::vector<ChannelGroup> groups_of(const LayeredFile& header, int file) {
  std::vector<ChannelGroup> groups;
  std::vector<char> kinds;  // 'c' colour, 'v' vector, 's' single
  std::vector<std::array<int, 4>> components;
  std::map<std::tuple<std::string, std::string, std::string, char>, std::size_t> known;  // colours and vectors
  for (const Channel& channel : header.channels) {
    const auto component = component_of(plain(channel.name));
    std::size_t k = groups.size();
    if (component)
      k = known.try_emplace({channel.part, channel.view, channel.layer, component->first}, k).first->second;
    if (k == groups.size()) {
      groups.push_back({file, {}, channel.part, channel.view, channel.layer, {}, false});
      kinds.push_back(component ? component->first : 's');
      components.push_back({-1, -1, -1, -1});
    }
    components[k][component ? std::size_t(component->second) : 0] = channel.index;
  }
  // A colour needs r, g and b, and a vector x, y and z; others are single channels.
  std::vector<ChannelGroup> out;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const std::array<int, 4>& c = components[k];
    const bool whole = kinds[k] != 's' && c[0] >= 0 && c[1] >= 0 && c[2] >= 0;
    ChannelGroup group = groups[k];
    group.is_color = whole && kinds[k] == 'c';
    for (const int channel : c) {
      if (channel < 0) continue;
      group.channels.push_back(channel);
      if (whole) continue;
      out.push_back(group);
      group.channels.clear();
    }
    if (whole) out.push_back(group);
  }
  join_singles(header, out);
  name_groups(header, out);
  return out;
}

std::vector<std::string> layer_list(const LayeredFile& header) {
  std::vector<std::string> list;
  for (const ChannelGroup& group : groups_of(header, 0)) list.push_back(group.name);
  for (const auto& [name, text] : header.attributes)
    if (header.format == "NPZ" && text.starts_with("array of "))
      list.push_back(fmt::format("{} ({}, not used: layers are {} x {})", name, text, header.height, header.width));
  return list;
}

Result<Roles> find_roles(std::span<const RoleFile> files, std::span<const LayeredFile> headers,
                         const std::string& view) {
  Roles roles;
  for (std::size_t k = 0; k < files.size(); ++k) {
    const RoleFile& file = files[k];
    std::vector<std::string> views;
    const auto chosen = chosen_view(headers[k], view, views);
    if (!chosen) return chosen.error();
    if (roles.views.empty()) roles.view = *chosen, roles.views = views;
    std::vector<ChannelGroup> groups = groups_of(headers[k], int(k));
    std::erase_if(groups, [&](const ChannelGroup& g) { return !g.view.empty() && g.view != *chosen; });
    const bool has_layer = std::any_of(groups.begin(), groups.end(),
                                       [&](const ChannelGroup& g) { return is_named(g, headers[k], file.layer); });
    if (!file.layer.empty() && !has_layer)
      if (auto one = named_channel(groups, headers[k], file.layer)) groups = {std::move(*one)};
    if (file.all_roles && !file.layer.empty()) {
      std::erase_if(groups, [&](const ChannelGroup& g) {
        return !is_named(g, headers[k], file.layer) && plain(prefix_of(g)) != plain(file.layer);
      });
      if (groups.empty()) return unknown_layer(file, headers[k], "has no layer");
    }
    if (groups.empty()) return file_error("'{}' has no channels", file.path);
    if (file.all_roles) {
      find_all(headers[k], int(k), groups, headers, roles);
      continue;
    }
    if (file.is_component) {
      RoleChannels& role = roles[file.role];
      if (role.files.size() != 1 && role.files.size() != 2) role = {};
      role.file = role.files.empty() ? int(k) : role.files[0];
      role.channels.push_back(groups[0].channels[0]);
      role.files.push_back(int(k));
      role.name += (role.name.empty() ? "" : ", ") + headers[k].path.filename().string();
      continue;
    }
    if (file.role == Role::kMotion) {
      if (!file.layer.empty())
        std::erase_if(groups, [&](const auto& g) { return !is_named(g, headers[k], file.layer); });
      find_motion(headers[k], groups, "", true, roles);
      if (roles[file.role].empty() || roles[file.role].file != int(k))
        return field_error(file.field, file.path, "`{}` '{}' has no layer with two channels; its layers are {}",
                           fmt::join(layer_list(headers[k]), ", "));
      continue;
    }
    const auto group = group_for(file, headers, groups);
    if (!group) return group.error();
    if (file.role == Role::kDepth || file.role == Role::kPosition)
      if (const ChannelGroup* mask = best_group({headers, groups, ""}, Role::kMask, names_of(Role::kMask)))
        roles[Role::kMask] = taken(*mask, Role::kMask);
    if (file.role == Role::kDepth) {
      // A picture whose only layer was taken for depth is the beauty if another file has the depth.
      if (roles.depth_is_guess && roles[Role::kDepth].channels.size() >= 3) roles[Role::kBeauty] = roles[Role::kDepth];
      roles.depth_is_guess = false;
      roles.other_depths.clear();
      roles.depth_hint = hint_of(*group, headers[k]);
    }
    roles[file.role] = taken(*group, file.role);
  }
  if (!view.empty() && roles.views.empty())
    return field_error("view", view, "'{2}' has no views: `{0}` cannot be '{1}'", files[0].path);
  // Only Cycles leaves the albedo out of its indirect light.
  if (roles[Role::kIndirect].empty()) roles[Role::kIndirectColor] = {};
  return roles;
}

std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' && c != '_' && c != '-') out += lowercase(c);
  return out;
}

bool is_own_file(const LayeredFile& header) {
  const std::string* software = header.attribute("software");
  return software && *software == "Umbrage";
}

}  // namespace umbrage
