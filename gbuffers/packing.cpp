// rgb24: Unity and others; bgr24: CARLA; float32: OpenGL's bytes; float32-bgra: TartanAir, whose bytes are those of
// OpenCV; terrain-rgb: Mapbox; terrarium: Mapzen.
#include "gbuffers/packing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/lists.h"

namespace umbrage {
namespace {

constexpr double kByte = 256.0, kTwo = kByte * kByte, kThree = kTwo * kByte;

constexpr Packing kPackings[] = {
    {.name = "rgb24", .weights = {kTwo, kByte, 1.0, 0.0}, .max_integer = kThree - 1.0},
    {.name = "bgr24", .weights = {1.0, kByte, kTwo, 0.0}, .max_integer = kThree - 1.0},
    {.name = "float32", .weights = {1.0, kByte, kTwo, kThree}, .is_bits = true},
    {.name = "float32-bgra", .weights = {kTwo, kByte, 1.0, kThree}, .is_bits = true},
    {.name = "terrain-rgb", .weights = {0.1 * kTwo, 0.1 * kByte, 0.1, 0.0}, .offset = -10000.0, .is_height = true},
    {.name = "terrarium", .weights = {kByte, 1.0, 1.0 / kByte, 0.0}, .offset = -32768.0, .is_height = true},
};

/// Returns the median of the second differences over that of the first ones; large where most values are equal.
template <class Value>
double roughness(const Samples& samples, const Value& value) {
  std::vector<double> bends, slopes;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double c = value(kCenter, k), l = value(kLeft, k), r = value(kRight, k), a = value(kAbove, k),
                 b = value(kBelow, k);
    const double bend = std::abs(l - 2.0 * c + r) + std::abs(a - 2.0 * c + b),
                 slope = std::abs(r - l) + std::abs(b - a);
    // Where nothing changes there is nothing to see: the sky.
    if (!std::isfinite(bend) || (bend == 0.0 && slope == 0.0)) continue;
    bends.push_back(bend);
    slopes.push_back(slope);
  }
  constexpr std::size_t kEnough = 100;
  constexpr double kRough = 1e9;
  if (bends.size() < kEnough) return kRough;
  const double slope = quantile(std::move(slopes), 0.5);
  return slope > 0.0 ? quantile(std::move(bends), 0.5) / slope : kRough;
}

}  // namespace

float Packing::decoded(const std::array<float, 4>& bytes) const {
  double sum = offset;
  for (std::size_t c = 0; c < channels(); ++c) sum += weights[c] * double(bytes[c]);
  if (is_bits) return std::bit_cast<float>(std::uint32_t(std::clamp(sum, 0.0, kByte * kThree - 1.0)));
  return float(sum);
}

std::span<const Packing> packings() { return kPackings; }

const Packing* find_packing(std::string_view name) {
  for (const Packing& packing : kPackings)
    if (packing.name == name) return &packing;
  return nullptr;
}

std::vector<const Packing*> recognised_packings(const Samples& samples) {
  constexpr double kSmooth = 0.3;     // roughness of depth; that of noise is above 1
  constexpr double kSmoother = 0.5;   // than the highest byte alone
  constexpr double kAsSmooth = 1.05;  // the same bytes are the highest
  // Metres on the Earth; lengths in any unit.
  constexpr std::pair kHeights = {-11100.0, 9000.0}, kLengths = {1e-6, 1e9};
  std::vector<std::pair<double, const Packing*>> found;
  for (const Packing& packing : kPackings) {
    std::array<const TapValues*, 4> channels{};
    for (std::size_t c = 0; c < packing.channels(); ++c) channels[c] = samples.find(Role::kDepth, c);
    if (!channels[packing.channels() - 1]) continue;
    const auto value = [&](int tap, std::size_t k) {
      std::array<float, 4> bytes{};
      for (std::size_t c = 0; c < packing.channels(); ++c) bytes[c] = (*channels[c])[std::size_t(tap)][k];
      return double(packing.decoded(bytes));
    };
    std::vector<double> values;
    for (std::size_t k = 0; k < samples.size(); ++k) values.push_back(value(kCenter, k));
    constexpr double kOutliers = 0.02;
    const auto [min, max] = packing.is_height ? kHeights : kLengths;
    if (!(quantile(values, kOutliers) >= (packing.is_bits || packing.is_height ? min : 0.0) &&
          quantile(values, 1.0 - kOutliers) <= max))
      continue;
    const auto highest =
        std::size_t(std::max_element(packing.weights.begin(), packing.weights.end()) - packing.weights.begin());
    const double of_high =
        roughness(samples, [&](int tap, std::size_t k) { return double((*channels[highest])[std::size_t(tap)][k]); });
    const double of_all = roughness(samples, value);
    if (of_all < kSmooth && of_all < kSmoother * of_high) found.emplace_back(of_all, &packing);
  }
  std::vector<const Packing*> best;
  if (found.empty()) return best;
  const double smoothest = std::min_element(found.begin(), found.end())->first;
  for (const auto& [rough, packing] : found)
    if (rough <= kAsSmooth * smoothest) best.push_back(packing);
  return best;
}

}  // namespace umbrage
