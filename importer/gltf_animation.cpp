// Animations of glTF files: sampled at one time.
#include <algorithm>
#include <cmath>

#include "importer/gltf_accessor.h"
#include "importer/gltf_nodes.h"

namespace umbrage {
namespace {

enum class Interpolation { kStep, kLinear, kCubic };

/// The keys of one sampler: at each time `width` values; cubic ones with the tangents before and after them.
struct Keys {
  std::vector<float> times, values;
  std::size_t width = 0;
  Interpolation interpolation = Interpolation::kLinear;

  std::size_t parts() const { return interpolation == Interpolation::kCubic ? 3 : 1; }
  /// Returns values of a key: part 0 tangents before it, 1 values, 2 tangents after it.
  const float* at(std::size_t key, std::size_t part = 1) const {
    return values.data() + (key * parts() + (parts() == 3 ? part : 0)) * width;
  }
};

/// Evaluates a sampler [glTF 2.0, appendix C].
std::vector<float> sampled(const Keys& keys, double time, bool is_rotation) {
  const std::size_t width = keys.width;
  const auto first_value = [&](std::size_t key) { return std::vector<float>(keys.at(key), keys.at(key) + width); };
  const auto after = std::upper_bound(keys.times.begin(), keys.times.end(), float(time));
  if (after == keys.times.begin()) return first_value(0);
  const std::size_t key = std::size_t(after - keys.times.begin()) - 1;
  if (after == keys.times.end() || keys.interpolation == Interpolation::kStep) return first_value(key);
  const double step = double(keys.times[key + 1]) - double(keys.times[key]);
  const double t = step > 0.0 ? std::clamp((time - double(keys.times[key])) / step, 0.0, 1.0) : 0.0;
  const float *a = keys.at(key), *b = keys.at(key + 1);
  std::vector<float> result(width);
  if (keys.interpolation == Interpolation::kLinear && is_rotation) {
    const glm::dquat from(a[3], a[0], a[1], a[2]), to(b[3], b[0], b[1], b[2]);
    const glm::dquat between = glm::slerp(from, to, t);  // the shorter way
    return {float(between.x), float(between.y), float(between.z), float(between.w)};
  }
  if (keys.interpolation == Interpolation::kLinear) {
    for (std::size_t k = 0; k < width; ++k) result[k] = float((1.0 - t) * double(a[k]) + t * double(b[k]));
    return result;
  }
  const double t2 = t * t, t3 = t2 * t;
  const float *leaving = keys.at(key, 2), *arriving = keys.at(key + 1, 0);
  for (std::size_t k = 0; k < width; ++k)
    result[k] = float((2 * t3 - 3 * t2 + 1) * a[k] + step * (t3 - 2 * t2 + t) * leaving[k] + (-2 * t3 + 3 * t2) * b[k] +
                      step * (t3 - t2) * arriving[k]);
  return result;
}

/// Reads a sampler whose values have `width` numbers; 0: as many as there are. Errors: kFile.
Result<Keys> read_keys(GltfFile& file, const Json& sampler, std::size_t width) {
  Keys keys;
  const std::string interpolation = text_of(member(sampler, "interpolation"));
  if (interpolation == "STEP") keys.interpolation = Interpolation::kStep;
  if (interpolation == "CUBICSPLINE") keys.interpolation = Interpolation::kCubic;
  auto times = read_numbers(file, index_of(member(sampler, "input")), 1, 1);
  if (!times) return times.error();
  auto values = read_numbers(file, index_of(member(sampler, "output")), 1, 16);
  if (!values) return values.error();
  keys.times = std::move(times->values);
  keys.values = std::move(values->values);
  const std::size_t count = keys.times.size() * keys.parts();
  if (count == 0) return file_error("it has no keys");
  keys.width = width > 0 ? width : keys.values.size() / count;
  if (keys.width == 0 || keys.values.size() < count * keys.width)
    return file_error("it has {} numbers for {} keys", keys.values.size(), keys.times.size());
  return keys;
}

void set_value(const std::string& path, const std::vector<float>& v, GltfNode& node) {
  if (path == "weights") {
    node.weights = v;
  } else if (path == "translation") {
    node.translation = {v[0], v[1], v[2]};
  } else if (path == "scale") {
    node.scale = {v[0], v[1], v[2]};
  } else {
    const glm::dquat rotation(v[3], v[0], v[1], v[2]);
    if (const double length = glm::length(rotation); length > 0.0) node.rotation = rotation / length;
  }
}

}  // namespace

std::vector<GltfAnimation> list_animations(GltfFile& file) {
  std::vector<GltfAnimation> animations;
  const Json& list = member(file.json, "animations");
  for (std::size_t a = 0; a < count_of(list); ++a) {
    GltfAnimation animation{.name = text_of(member(list[a], "name"))};
    const Json& samplers = member(list[a], "samplers");
    for (std::size_t s = 0; s < count_of(samplers); ++s) {
      const int input = index_of(member(samplers[s], "input"));
      const Json& end = element(member(file.list("accessors", std::size_t(input)), "max"), 0);
      float last = end.is_number() ? end.get<float>() : 0.0f;
      if (!end.is_number())
        if (const auto times = read_numbers(file, input, 1, 1); times && times->count > 0) last = times->values.back();
      if (std::isfinite(last)) animation.duration_s = std::max(animation.duration_s, last);
    }
    animations.push_back(std::move(animation));
  }
  return animations;
}

PoseNodes read_animation(GltfFile& file, int animation, std::size_t node_count) {
  struct Channel {
    std::size_t node;
    std::string path;
    Keys keys;
  };
  std::vector<Channel> read;
  const Json& json = file.list("animations", std::size_t(animation));
  const Json &channels = member(json, "channels"), &samplers = member(json, "samplers");
  for (std::size_t k = 0; k < count_of(channels); ++k) {
    const Json& target = member(channels[k], "target");
    const std::string path = text_of(member(target, "path"));
    const int node = index_of(member(target, "node")), sampler = index_of(member(channels[k], "sampler"));
    const bool is_rotation = path == "rotation", is_weights = path == "weights";
    if (path == "pointer") {
      file.warn_once("KHR_animation_pointer",
                     "the animation changes more than nodes (KHR_animation_pointer), which is not read");
      continue;
    }
    if (node < 0) continue;  // a channel without a target, as the standard allows
    const auto refuse = [&](const std::string& reason) {
      file.warn_once("channel", fmt::format("a channel of the animation cannot be used: {}", reason));
    };
    if (std::size_t(node) >= node_count || (!is_rotation && !is_weights && path != "translation" && path != "scale")) {
      refuse(fmt::format("its target is '{}' of node {}", path, node));
      continue;
    }
    const Json& of_channel = element(samplers, std::size_t(sampler));
    auto keys = read_keys(file, of_channel, is_weights ? 0 : is_rotation ? 4 : 3);
    if (!keys) {
      refuse(keys.error().message);
      continue;
    }
    read.push_back({std::size_t(node), path, std::move(*keys)});
  }
  return [read = std::move(read)](double time_s, std::vector<GltfNode>& nodes) {
    for (const Channel& channel : read) {
      GltfNode& node = nodes[channel.node];
      if (channel.path != "weights") split_matrix(node);
      set_value(channel.path, sampled(channel.keys, time_s, channel.path == "rotation"), node);
    }
  };
}

}  // namespace umbrage
