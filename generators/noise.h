// Noise for the built-in scenes: gradient noise over integer hashes, identical on all machines.
// Based on [Perlin 2002] (interpolation) and [Jarzynski and Olano 2020] (the pcg hash).
#pragma once
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace umbrage::noise {

inline std::uint32_t hash(std::uint32_t x) {
  const std::uint32_t state = x * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}
inline std::uint32_t hash(int x, int y, std::uint32_t seed = 0) {
  return hash(std::uint32_t(x) + hash(std::uint32_t(y) + hash(seed)));
}
inline std::uint32_t hash(int x, int y, int z, std::uint32_t seed = 0) {
  return hash(std::uint32_t(x) + hash(std::uint32_t(y) + hash(std::uint32_t(z) + hash(seed))));
}

/// Converts a hash to a number in [0, 1).
inline float unit(std::uint32_t h) { return float(h >> 8) * 0x1p-24f; }

/// A pseudorandom sequence of numbers. `state` is the seed.
struct Random {
  std::uint32_t state = 0;
  float next() { return unit(hash(state++)); }
  float between(float low, float high) { return low + (high - low) * next(); }
};

inline float fade(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

/// Returns gradient noise in the plane: about -1 to 1, mean 0, one feature per unit. If `period` (in units) is
/// positive, the noise repeats.
inline float gradient(glm::vec2 p, std::uint32_t seed, int period = 0) {
  // Sixteen directions, since eight leave visible streaks along the axes.
  static constexpr float kX[16] = {1.0f,  0.924f,  0.707f,  0.383f,  0.0f, -0.383f, -0.707f, -0.924f,
                                   -1.0f, -0.924f, -0.707f, -0.383f, 0.0f, 0.383f,  0.707f,  0.924f};
  static constexpr float kY[16] = {0.0f, 0.383f,  0.707f,  0.924f,  1.0f,  0.924f,  0.707f,  0.383f,
                                   0.0f, -0.383f, -0.707f, -0.924f, -1.0f, -0.924f, -0.707f, -0.383f};
  const int ix = int(std::floor(p.x)), iy = int(std::floor(p.y));
  const float fx = p.x - float(ix), fy = p.y - float(iy);
  int x0 = ix, x1 = ix + 1, y0 = iy, y1 = iy + 1;
  if (period > 0) {
    x0 = (ix % period + period) % period;
    y0 = (iy % period + period) % period;
    x1 = x0 + 1 == period ? 0 : x0 + 1;
    y1 = y0 + 1 == period ? 0 : y0 + 1;
  }
  // The hash of (x, y, seed); parts common to the four corners are computed once.
  const std::uint32_t seed_hash = hash(seed);
  const std::uint32_t row0 = hash(std::uint32_t(y0) + seed_hash), row1 = hash(std::uint32_t(y1) + seed_hash);
  const auto corner = [](int x, std::uint32_t row, float dx, float dy) {
    const std::uint32_t h = hash(std::uint32_t(x) + row) >> 28;
    return kX[h] * dx + kY[h] * dy;
  };
  const float u = fade(fx), v = fade(fy);
  const float a = corner(x0, row0, fx, fy), b = corner(x1, row0, fx - 1.0f, fy);
  const float c = corner(x0, row1, fx, fy - 1.0f), d = corner(x1, row1, fx - 1.0f, fy - 1.0f);
  const float low = a + u * (b - a), high = c + u * (d - c);
  return 1.4f * (low + v * (high - low));
}

/// Returns value noise in space: -1 to 1, one feature per unit.
inline float value(glm::vec3 p, std::uint32_t seed) {
  const int ix = int(std::floor(p.x)), iy = int(std::floor(p.y)), iz = int(std::floor(p.z));
  const float u = fade(p.x - float(ix)), v = fade(p.y - float(iy)), w = fade(p.z - float(iz));
  const auto row = [&](int dy, int dz) {
    const float a = unit(hash(ix, iy + dy, iz + dz, seed)), b = unit(hash(ix + 1, iy + dy, iz + dz, seed));
    return a + u * (b - a);
  };
  const float near = row(0, 0) + v * (row(1, 0) - row(0, 0)), far = row(0, 1) + v * (row(1, 1) - row(0, 1));
  return 2.0f * (near + w * (far - near)) - 1.0f;
}

/// Returns a sum of octaves of gradient noise, each with twice the frequency and `gain` times the amplitude; about -1
/// to 1.
inline float fractal(glm::vec2 p, int octaves, std::uint32_t seed, int period = 0, float gain = 0.5f) {
  float sum = 0.0f, height = 1.0f, total = 0.0f;
  for (int i = 0; i < octaves; ++i) {
    sum += height * gradient(p, seed + std::uint32_t(i), period);
    total += height;
    height *= gain;
    p *= 2.0f;
    period *= 2;
  }
  return sum / total;
}

/// The distances from a position to the nearest and the second nearest of scattered points, and the hash of the
/// nearest.
struct Cell {
  float nearest = 1e9f, second = 1e9f;
  std::uint32_t id = 0;
};
/// Returns the cell of a position. There is one point per unit square.
inline Cell cells(glm::vec2 p, std::uint32_t seed, int period = 0) {
  const int ix = int(std::floor(p.x)), iy = int(std::floor(p.y));
  const auto wrap = [period](int i) { return period > 0 ? ((i % period) + period) % period : i; };
  Cell cell;
  for (int y = iy - 1; y <= iy + 1; ++y)
    for (int x = ix - 1; x <= ix + 1; ++x) {
      const std::uint32_t h = hash(wrap(x), wrap(y), seed);
      const glm::vec2 point(float(x) + unit(h), float(y) + unit(hash(h)));
      const float distance = glm::length(p - point);
      if (distance < cell.nearest) {
        cell = {distance, cell.nearest, h};
      } else if (distance < cell.second) {
        cell.second = distance;
      }
    }
  return cell;
}

}  // namespace umbrage::noise
