// Motion vectors by names, which also say what their values mean, in words of `motion_kind`.

#include <algorithm>
#include <array>

#include "core/lists.h"
#include "gbuffers/roles.h"

namespace umbrage {
namespace {

using Words = std::vector<std::string>;

struct MotionName {
  std::string_view name;
  Words words = {}, second = {};  ///< of each pair of channels
};

const std::vector<MotionName>& motion_names() {
  static const std::vector<MotionName> names = {
      {"vector", {"px", "previous", "up", "to"}, {"px", "next", "up", "from"}},  // Blender
      {"backward", {"px", "previous", "up", "to"}},                              // Nuke
      {"forward", {"px", "next", "up", "to"}},
      {"motionvec", {"ndc"}},  // MoonRay
      {"motionvectors"},
      {"motionvector"},
      {"motionvectorssd"},
      {"mv"},
      {"motion"},
      {"velocity"},
      {"vrayvelocity"},
      {"flow"},
      {"opticalflow"}};
  return names;
}
constexpr int kUnknownName = 1000;

/// A pair of channels, or two.
struct Found {
  std::string layer;
  Words words, second;
  int rank = kUnknownName;
  std::array<int, 4> channels{-1, -1, -1, -1};

  bool is_whole() const {
    return channels[0] >= 0 && channels[1] >= 0 && (second.empty() || (channels[2] >= 0 && channels[3] >= 0));
  }
};

/// Sets rank and words by the last word of the layer, in which a direction may be beside the name.
void find_name(Found& found) {
  std::string name = plain(found.layer.substr(found.layer.rfind('.') + 1));
  if (name.ends_with("motionvectors")) name = "motionvectors";  // of Unreal
  for (const std::string_view direction : {"forward", "next", "backward", "previous", "prev"})
    if (const auto at = name.find(direction); at != name.npos && name.size() > direction.size()) {
      name.erase(at, direction.size());
      found.words = {direction == "forward" || direction == "next" ? "next" : "previous"};
      break;
    }
  for (std::size_t k = 0; k < motion_names().size(); ++k)
    if (const MotionName& known = motion_names()[k]; known.name == name) {
      found.rank = int(k);
      found.words.insert(found.words.end(), known.words.begin(), known.words.end());
      found.second = known.second;
    }
}

/// Returns the place of a channel in its layer by its last letter; -1: none.
int place_of(const std::string& channel) {
  for (const std::string_view letters : {"xyzw", "rgba", "uv"})
    if (const auto at = letters.find(plain(channel).back()); at != letters.npos) return int(at);
  return -1;
}

}  // namespace

void find_motion(const LayeredFile& header, std::span<const ChannelGroup> groups, std::string_view prefix,
                 bool is_given, Roles& roles) {
  std::vector<Found> all;
  for (const ChannelGroup& group : groups)
    for (const int index : group.channels) {
      const Channel& channel = header.channels[std::size_t(index)];
      std::string layer = channel.layer.empty() ? channel.part : channel.layer;
      if (layer.empty()) layer = channel.name.substr(0, channel.name.size() - 1);  // "motionX"
      if (plain(channel.name).empty() || place_of(channel.name) < 0) continue;
      auto at = std::find_if(all.begin(), all.end(), [&](const Found& found) { return found.layer == layer; });
      if (at == all.end()) {
        all.push_back({layer, {}, {}});
        at = all.end() - 1;
        find_name(*at);
      }
      at->channels[std::size_t(place_of(channel.name))] = index;
    }
  std::erase_if(all,
                [&](const Found& found) { return !found.is_whole() || (!is_given && found.rank == kUnknownName); });
  std::stable_sort(all.begin(), all.end(), [&](const Found& a, const Found& b) {
    return std::pair(!a.layer.starts_with(prefix), a.rank) < std::pair(!b.layer.starts_with(prefix), b.rank);
  });
  if (all.empty()) return;
  const Found& first = all.front();
  RoleChannels role{groups.front().file, {first.channels[0], first.channels[1]}, first.layer};
  roles.motion_words = {first.words};
  if (!first.second.empty()) {
    role.channels.assign(first.channels.begin(), first.channels.end());
    roles.motion_words.push_back(first.second);
  } else {
    const auto other = std::find_if(all.begin(), all.end(), [&](const Found& each) {
      return each.second.empty() && ((contains(each.words, "next") && contains(first.words, "previous")) ||
                                     (contains(each.words, "previous") && contains(first.words, "next")));
    });
    if (other != all.end()) {
      role.channels.insert(role.channels.end(), {other->channels[0], other->channels[1]});
      role.name += ", " + other->layer;
      roles.motion_words.push_back(other->words);
    }
  }
  roles[Role::kMotion] = std::move(role);
}

}  // namespace umbrage
