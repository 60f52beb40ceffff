// Splits a panorama into lights and ambient light. Based on [Ramamoorthi and Hanrahan 2001] for ambient light,
// [Viriyothai and Debevec 2009] for the lights, [CIE 2003] for the sky.
#include "scene/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <numeric>

namespace umbrage {
namespace {

using glm::dmat3;
using glm::dvec3;

constexpr double kPi = 3.14159265358979;

double luminance(const dvec3& color) { return glm::dot(color, dvec3(0.2126, 0.7152, 0.0722)); }

/// Limits of the size at which a panorama is summed, pixels. Smaller ones are too coarse for sums over pixel centres.
/// At the max size a pixel is a sixth of a degree wide, a third of the sun's diameter.
constexpr int kMinWidth = 512, kMinHeight = 256, kMaxWidth = 2048, kMaxHeight = 1024;

// ---- selection and splitting of lights

constexpr double kBrightRatio = 4.0;  // times the mean luminance over all directions: brighter pixels belong to lights
constexpr double kMinLightFraction = 0.02;  // fraction of all light: weaker parts do not become lights
constexpr double kMaxVarianceLeft = 0.4;    // a part is split if that reduces its variance below this fraction
constexpr double kNarrowDeg = 2.0;          // half angle of a disc, degrees: narrower parts are never split
constexpr double kWideDeg = 20.0;           // half angle of a disc, degrees: wider parts are always split
constexpr float kMaxLightDeg = 90.0f;       // max diameter of a light's disc: its rays must not start below the horizon

/// A bright pixel and the flux that it contributes to a light.
struct Cell {
  dvec3 direction;
  dvec3 flux;     ///< (radiance - mean of the dim pixels) times solid angle
  double weight;  ///< luminance of `flux`
  double solid_angle;
  std::size_t pixel;  ///< index in the panorama
};

/// A set of cells that becomes one light.
struct Patch {
  std::vector<Cell> cells;
  double weight = 0.0;
  dvec3 mean{0.0};        ///< weighted mean of the directions, not unit
  dvec3 axis{0.0};        ///< unit, the direction of the largest variance
  double variance = 0.0;  ///< variance of the directions, summed over all axes

  /// Returns the half angle of a disc that has this variance, radians.
  double half_angle() const { return std::sqrt(2.0 * variance); }
};

/// Returns the eigenvector of the largest eigenvalue of a symmetric matrix, by power iteration. In a
/// round part, whose two largest eigenvalues are nearly equal, it ends before it converges.
dvec3 main_axis(const dmat3& m) {
  constexpr int kRounds = 64;
  dvec3 v(0.577, 0.578, 0.576);
  for (int k = 0; k < kRounds; ++k) {
    const dvec3 next = m * v;
    const double length = glm::length(next);
    if (!(length > 0.0)) break;
    v = next / length;
  }
  return v;
}

Patch part_of(std::vector<Cell> cells) {
  Patch part;
  for (const Cell& cell : cells) {
    part.weight += cell.weight;
    part.mean += cell.weight * cell.direction;
  }
  part.mean /= part.weight;
  dmat3 covariance(0.0);
  for (const Cell& cell : cells) {
    const dvec3 off = cell.direction - part.mean;
    covariance += cell.weight / part.weight * glm::outerProduct(off, off);
  }
  part.variance = covariance[0][0] + covariance[1][1] + covariance[2][2];
  part.axis = main_axis(covariance);
  part.cells = std::move(cells);
  return part;
}

/// Splits a part in two across its axis, where the weighted sum of the halves' variances is smallest. Returns the
/// remaining fraction of the variance; 1 if the part cannot be split. Sorts the part's cells.
double split_part(Patch& part, std::array<Patch, 2>& halves) {
  std::sort(part.cells.begin(), part.cells.end(), [&](const Cell& a, const Cell& b) {
    return glm::dot(a.direction, part.axis) < glm::dot(b.direction, part.axis);
  });
  // The variance within two groups is the total variance minus the variance between their means.
  double before = 0.0, best = 0.0;
  dvec3 sum(0.0);
  std::size_t split = 0;
  for (std::size_t k = 0; k + 1 < part.cells.size(); ++k) {
    before += part.cells[k].weight;
    sum += part.cells[k].weight * part.cells[k].direction;
    const double after = part.weight - before;
    if (!(before > 0.0) || !(after > 0.0)) continue;
    const dvec3 apart = sum / before - (part.mean * part.weight - sum) / after;
    const double between = before * after * glm::dot(apart, apart);
    if (between > best) best = between, split = k + 1;
  }
  if (split == 0) return 1.0;
  const auto middle = part.cells.begin() + std::ptrdiff_t(split);
  halves = {part_of({part.cells.begin(), middle}), part_of({middle, part.cells.end()})};
  return (halves[0].weight * halves[0].variance + halves[1].weight * halves[1].variance) /
         (part.weight * part.variance);
}

/// Splits the cells into at most kMaxEnvironmentLights parts. The part with the largest weight times variance is split
/// first.
std::vector<Patch> parts_of(std::vector<Cell> cells) {
  const double narrow = glm::radians(kNarrowDeg), wide = glm::radians(kWideDeg);
  std::vector<Patch> parts, done;
  parts.push_back(part_of(std::move(cells)));
  while (!parts.empty()) {
    const auto widest = std::max_element(parts.begin(), parts.end(), [](const Patch& a, const Patch& b) {
      return a.weight * a.variance < b.weight * b.variance;
    });
    Patch part = std::move(*widest);
    parts.erase(widest);
    std::array<Patch, 2> halves;
    const bool has_room = parts.size() + done.size() + 2 <= std::size_t(kMaxEnvironmentLights);
    if (has_room && part.half_angle() > narrow) {
      const double variance_left = split_part(part, halves);
      if (variance_left < kMaxVarianceLeft || (variance_left < 1.0 && part.half_angle() > wide)) {
        for (Patch& half : halves) parts.push_back(std::move(half));
        continue;
      }
    }
    done.push_back(std::move(part));
  }
  return done;
}

/// Converts a part to a light. On a surface that faces the light, its irradiance equals the part's. The light's disc
/// has the solid angle over which the part's light is spread.
Light light_of(const Patch& part) {
  std::array<dvec3, 3> vectors{};  // irradiance of each colour, as a vector
  double squares = 0.0;
  for (const Cell& cell : part.cells) {
    for (int c = 0; c < 3; ++c) vectors[c] += cell.flux[c] * cell.direction;
    squares += cell.weight * cell.weight / cell.solid_angle;
  }
  const dvec3 direction = glm::normalize(vectors[0] * 0.2126 + vectors[1] * 0.7152 + vectors[2] * 0.0722);
  Light light;
  light.direction = glm::vec3(direction);
  for (int c = 0; c < 3; ++c) light.color[c] = float(std::max(glm::dot(vectors[c], direction), 0.0) / kPi);
  const double solid_angle = part.weight * part.weight / squares;
  const double half = 2.0 * std::asin(std::min(1.0, std::sqrt(solid_angle / (4.0 * kPi))));
  light.angle_deg = std::min(float(glm::degrees(2.0 * half)), kMaxLightDeg);
  light.casts_shadow = true;
  return light;
}

// ---- spherical harmonics

constexpr int kHarmonics = 9;  // number of spherical harmonics up to degree 2

/// Returns the values of the real spherical harmonics up to degree 2.
std::array<double, kHarmonics> harmonics(const dvec3& d) {
  return {0.282095,
          0.488603 * d.x,
          0.488603 * d.y,
          0.488603 * d.z,
          1.092548 * d.x * d.y,
          1.092548 * d.y * d.z,
          1.092548 * d.z * d.x,
          0.546274 * (d.x * d.x - d.y * d.y),
          0.315392 * (3.0 * d.z * d.z - 1.0)};
}

using Coefficients = std::array<dvec3, kHarmonics>;

void add(Coefficients& sum, const dvec3& direction, const dvec3& flux) {
  const auto y = harmonics(direction);
  for (int k = 0; k < kHarmonics; ++k) sum[std::size_t(k)] += y[std::size_t(k)] * flux;
}

/// Stores the radiance of a white diffuse surface under light with these coefficients: each degree is multiplied by its
/// factor of the clamped cosine and divided by pi [Ramamoorthi and Hanrahan 2001].
void store_ambient(const Coefficients& light, EnvironmentLight& out) {
  constexpr double kFirst = 2.0 / 3.0, kSecond = 1.0 / 4.0;  // factors of degrees 1 and 2; the factor of degree 0 is 1
  out.ambient = glm::vec3(0.282095 * light[0]);
  for (int c = 0; c < 3; ++c) {
    const auto coefficient = [&](int k) { return float(light[std::size_t(k)][c]); };
    glm::mat4& m = out.shape.by_color[std::size_t(c)];
    m = glm::mat4(0.0f);
    const auto set_symmetric = [&](int i, int j, double v) { m[i][j] = m[j][i] = float(v); };
    set_symmetric(0, 3, 0.5 * kFirst * 0.488603 * coefficient(1));
    set_symmetric(1, 3, 0.5 * kFirst * 0.488603 * coefficient(2));
    set_symmetric(2, 3, 0.5 * kFirst * 0.488603 * coefficient(3));
    set_symmetric(0, 1, 0.5 * kSecond * 1.092548 * coefficient(4));
    set_symmetric(1, 2, 0.5 * kSecond * 1.092548 * coefficient(5));
    set_symmetric(2, 0, 0.5 * kSecond * 1.092548 * coefficient(6));
    const double xx_yy = kSecond * 0.546274 * coefficient(7), zz = kSecond * 0.315392 * coefficient(8);
    // 3 z z - 1 = 2 z z - x x - y y on the unit sphere.
    m[0][0] = float(xx_yy - zz);
    m[1][1] = float(-xx_yy - zz);
    m[2][2] = float(2.0 * zz);
  }
}

/// Returns the solid angle of a pixel, for each row.
std::vector<double> solid_angles(int width, int height) {
  std::vector<double> rows;
  rows.reserve(std::size_t(height));
  for (int y = 0; y < height; ++y)
    rows.push_back(2.0 * kPi / width * (std::cos(kPi * y / height) - std::cos(kPi * (y + 1) / height)));
  return rows;
}

/// Directions of the pixel centres, factored into columns and rows.
struct Directions {
  std::vector<dvec3> around;             ///< direction of each column, on the horizon
  std::vector<glm::dvec2> below_zenith;  ///< (cosine, sine) of the polar angle of each row

  Directions(int width, int height) {
    for (int x = 0; x < width; ++x) {
      const double angle = 2.0 * kPi * ((x + 0.5) / width - 0.5);
      around.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    }
    for (int y = 0; y < height; ++y) {
      // The centre of a row divides its solid angle into halves.
      const double cosine = 0.5 * (std::cos(kPi * y / height) + std::cos(kPi * (y + 1) / height));
      below_zenith.emplace_back(cosine, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)));
    }
  }
  dvec3 at(int x, int y) const {
    const glm::dvec2 row = below_zenith[std::size_t(y)];
    const dvec3 column = around[std::size_t(x)];
    return {column.x * row.y, column.y * row.y, row.x};
  }
};

}  // namespace

glm::vec3 Panorama::at(int x, int y) const {
  const float* p = rgb.data() + (std::size_t(y) * std::size_t(width) + std::size_t(x)) * 3;
  return {p[0], p[1], p[2]};
}

std::size_t clean_panorama(Panorama& panorama) {
  constexpr float kMaxHalf = 65504.0f;
  std::size_t changed = 0;
  for (std::size_t p = 0; p + 2 < panorama.rgb.size(); p += 3) {
    bool is_changed = false;
    for (std::size_t k = p; k < p + 3; ++k) {
      float& v = panorama.rgb[k];
      if (v >= 0.0f && v <= kMaxRadiance) continue;
      is_changed = true;
      v = !(v > 0.0f) ? 0.0f : std::isinf(v) ? kMaxHalf : kMaxRadiance;
    }
    changed += is_changed;
  }
  return changed;
}

namespace {

/// Resamples a panorama: each pixel is the mean of the pixels it covers, weighted by solid angle; pixels have constant
/// colour.
Panorama resampled(const Panorama& panorama, int width, int height) {
  if (width == panorama.width && height == panorama.height) return panorama;
  // The weights of the source pixels that a new pixel covers, separately for each axis.
  struct Span {
    int first;
    std::vector<double> weights;
  };
  const auto spans = [](int from, int to, const auto& extent) {
    std::vector<Span> all;
    for (int k = 0; k < to; ++k) {
      const double start = double(k) * from / to, end = double(k + 1) * from / to;
      Span span{std::min(int(start), from - 1), {}};
      for (int i = span.first; i < from && i < end; ++i)
        span.weights.push_back(extent(std::max(start, double(i)), std::min(end, double(i + 1))));
      const double sum = std::accumulate(span.weights.begin(), span.weights.end(), 0.0);
      for (double& weight : span.weights) weight /= sum;
      all.push_back(std::move(span));
    }
    return all;
  };
  const auto columns = spans(panorama.width, width, [](double a, double b) { return b - a; });
  const auto rows = spans(panorama.height, height, [&](double a, double b) {
    return std::cos(kPi * a / panorama.height) - std::cos(kPi * b / panorama.height);
  });
  Panorama out{panorama.name, width, height, {}};
  out.rgb.reserve(std::size_t(width) * std::size_t(height) * 3);
  std::vector<dvec3> line(std::size_t(panorama.width));
  for (const Span& row : rows) {
    std::fill(line.begin(), line.end(), dvec3(0.0));
    for (std::size_t j = 0; j < row.weights.size(); ++j)
      for (int x = 0; x < panorama.width; ++x)
        line[std::size_t(x)] += row.weights[j] * dvec3(panorama.at(x, row.first + int(j)));
    for (const Span& column : columns) {
      dvec3 sum(0.0);
      for (std::size_t i = 0; i < column.weights.size(); ++i)
        sum += column.weights[i] * line[std::size_t(column.first) + i];
      for (int c = 0; c < 3; ++c) out.rgb.push_back(float(sum[c]));
    }
  }
  return out;
}

}  // namespace

Panorama reduced_panorama(const Panorama& panorama, int max_width, int max_height) {
  return resampled(panorama, std::min(panorama.width, max_width), std::min(panorama.height, max_height));
}

glm::mat3 panorama_axes(glm::vec3 up, float rotation_deg) {
  up = glm::normalize(up);
  constexpr float kUpright = 0.9f;
  const glm::vec3 toward = std::abs(up.x) < kUpright ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  const glm::vec3 front = glm::normalize(toward - up * glm::dot(toward, up)), left = glm::cross(up, front);
  const float angle = glm::radians(rotation_deg);
  const glm::vec3 turned_front = std::cos(angle) * front + std::sin(angle) * left;
  return {turned_front, glm::cross(turned_front, up), up};
}

glm::vec3 panorama_direction(float x, float y) {
  const float angle = glm::two_pi<float>() * (x - 0.5f), below = glm::pi<float>() * y;
  return {std::cos(angle) * std::sin(below), std::sin(angle) * std::sin(below), std::cos(below)};
}

glm::vec3 panorama_radiance(const Panorama& panorama, glm::vec3 direction) {
  const glm::vec3 d = glm::normalize(direction);
  const float u = std::atan2(d.y, d.x) / glm::two_pi<float>() + 0.5f;
  const float v = std::acos(std::clamp(d.z, -1.0f, 1.0f)) / glm::pi<float>();
  const float x = u * float(panorama.width) - 0.5f, y = v * float(panorama.height) - 0.5f;
  const float x0 = std::floor(x), y0 = std::floor(y);
  const auto pixel = [&](int i, int j) {
    // Rows beyond a pole continue on the opposite side.
    if (j < 0 || j >= panorama.height) i += panorama.width / 2;
    i = (i % panorama.width + panorama.width) % panorama.width;
    return panorama.at(i, std::clamp(j, 0, panorama.height - 1));
  };
  const int i = int(x0), j = int(y0);
  const float s = x - x0, t = y - y0;
  return (pixel(i, j) * (1 - s) + pixel(i + 1, j) * s) * (1 - t) +
         (pixel(i, j + 1) * (1 - s) + pixel(i + 1, j + 1) * s) * t;
}

EnvironmentLight environment_light(const Panorama& panorama) {
  EnvironmentLight out;
  const Panorama image = resampled(panorama, std::clamp(panorama.width, kMinWidth, kMaxWidth),
                                   std::clamp(panorama.height, kMinHeight, kMaxHeight));
  const auto solid = solid_angles(image.width, image.height);
  const Directions directions(image.width, image.height);
  const auto for_each_pixel = [&](const auto& visit) {
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) visit(directions.at(x, y), dvec3(image.at(x, y)), solid[std::size_t(y)]);
  };
  Coefficients coefficients{};
  dvec3 all(0.0);
  for_each_pixel([&](const dvec3& direction, const dvec3& radiance, double solid_angle) {
    add(coefficients, direction, radiance * solid_angle);
    all += radiance * solid_angle;
  });
  // The lights receive the radiance above the mean of the dim pixels.
  const double bright = kBrightRatio * luminance(all) / (4.0 * kPi);
  dvec3 dim(0.0);
  double dim_angle = 0.0;
  for_each_pixel([&](const dvec3&, const dvec3& radiance, double solid_angle) {
    if (luminance(radiance) > bright) return;
    dim += radiance * solid_angle;
    dim_angle += solid_angle;
  });
  if (dim_angle > 0.0) dim /= dim_angle;
  std::vector<Cell> cells;
  std::size_t pixel = 0;
  for_each_pixel([&](const dvec3& direction, const dvec3& radiance, double solid_angle) {
    const std::size_t index = pixel++;
    if (!(luminance(radiance) > bright)) return;
    const dvec3 flux = glm::max(radiance - dim, dvec3(0.0)) * solid_angle;
    if (luminance(flux) > 0.0) cells.push_back({direction, flux, luminance(flux), solid_angle, index});
  });
  Panorama rest = image;
  if (!cells.empty()) {
    const auto parts = parts_of(std::move(cells));
    for (const Patch& part : parts) {
      if (!(part.weight > kMinLightFraction * luminance(all))) continue;
      out.lights.push_back(light_of(part));
      for (const Cell& cell : part.cells)
        for (int c = 0; c < 3; ++c) rest.rgb[3 * cell.pixel + std::size_t(c)] -= float(cell.flux[c] / cell.solid_angle);
    }
    std::stable_sort(out.lights.begin(), out.lights.end(),
                     [](const Light& a, const Light& b) { return luminance(a.color) > luminance(b.color); });
  }
  for (const Light& light : out.lights) add(coefficients, dvec3(light.direction), dvec3(light.color) * -kPi);
  store_ambient(coefficients, out);
  out.rest = reduced_panorama(rest, kMaxRestWidth, kMaxRestWidth / 2);
  // Maximum over normals in all directions and towards the lights.
  const auto white_luminance = [&](const glm::vec3& n) {
    glm::vec3 sum = glm::max(out.ambient + out.shape.at(n), glm::vec3(0.0f));
    for (const Light& light : out.lights) sum += light.color * std::max(glm::dot(light.direction, n), 0.0f);
    return float(luminance(sum));
  };
  constexpr int kNormals = 32;
  for (int y = 0; y < kNormals / 2; ++y)
    for (int x = 0; x < kNormals; ++x)
      out.brightest = std::max(out.brightest, white_luminance(panorama_direction((float(x) + 0.5f) / kNormals,
                                                                                 (float(y) + 0.5f) * 2.0f / kNormals)));
  for (const Light& light : out.lights) out.brightest = std::max(out.brightest, white_luminance(light.direction));
  return out;
}

Panorama sky_panorama() {
  // Luminance of the CIE standard clear sky, type 12 [CIE 2003]: brighter towards the sun and the horizon.
  constexpr int kWidth = 1024, kHeight = 512;
  constexpr double kSunHeight = 42.0, kSunAngle = 0.53 / 2.0;  // degrees; kSunAngle: half angle of the disc
  constexpr double kSunIrradiance = 6.5, kSkyIrradiance = 2.0;
  constexpr double kHaze = 0.06;  // optical thickness of the air between the eye and the ground straight below
  const double height = glm::radians(kSunHeight);
  const dvec3 sun(std::cos(height) * std::cos(2.2), std::cos(height) * std::sin(2.2), std::sin(height));
  // Colours with a luminance of about 1, and the albedo of dry, light ground.
  const dvec3 zenith(0.55, 0.92, 1.75), horizon(0.92, 1.0, 1.14), sunlight(1.12, 0.98, 0.80);
  const dvec3 ground_albedo(0.41, 0.40, 0.37);
  const auto gradation = [](double rise) { return 1.0 - std::exp(-0.32 / std::max(rise, 0.01)); };
  const auto indicatrix = [](double angle) {
    const double cosine = std::cos(angle);
    return 1.0 + 10.0 * (std::exp(-3.0 * angle) - std::exp(-1.5 * kPi)) + 0.45 * cosine * cosine;
  };
  const auto luminance_at = [&](const dvec3& d) {
    return gradation(d.z) * indicatrix(std::acos(std::clamp(glm::dot(d, sun), -1.0, 1.0)));
  };
  const Directions directions(kWidth, kHeight);
  const auto solid = solid_angles(kWidth, kHeight);
  double scale = 0.0;  // irradiance of a level surface by luminance_at
  for (int y = 0; y < kHeight / 2; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const dvec3 d = directions.at(x, y);
      scale += luminance_at(d) * d.z * solid[std::size_t(y)];
    }
  scale = kSkyIrradiance / scale;
  const auto sky_at = [&](const dvec3& d) {
    return glm::mix(horizon, zenith, std::sqrt(d.z)) * (luminance_at(d) * scale);
  };
  dvec3 irradiance = kSunIrradiance * sun.z * sunlight;
  for (int y = 0; y < kHeight / 2; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const dvec3 d = directions.at(x, y);
      irradiance += sky_at(d) * (d.z * solid[std::size_t(y)]);
    }
  const dvec3 ground = ground_albedo * irradiance / kPi;
  // The ray to the ground is the longer, the closer it is to the horizon, where only air is visible.
  const auto ground_at = [&](const dvec3& d) {
    return glm::mix(sky_at(glm::normalize(dvec3(d.x, d.y, 0.0))), ground, std::exp(-kHaze / -d.z));
  };
  const double sun_radiance = kSunIrradiance / (kPi * std::pow(std::sin(glm::radians(kSunAngle)), 2.0));
  Panorama sky{"sky:", kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      // The sun is smaller than two pixels: sample it within each pixel.
      constexpr int kSamples = 8;
      const dvec3 middle = directions.at(x, y);
      const bool near_sun = glm::dot(middle, sun) > std::cos(glm::radians(1.5));
      dvec3 sum = middle.z < 0.0 ? ground_at(middle) : sky_at(middle);
      double fraction = 0.0;
      for (int k = 0; near_sun && k < kSamples * kSamples; ++k) {
        const dvec3 d = panorama_direction((float(x) + (float(k % kSamples) + 0.5f) / kSamples) / kWidth,
                                           (float(y) + (float(k / kSamples) + 0.5f) / kSamples) / kHeight);
        fraction += glm::dot(d, sun) > std::cos(glm::radians(kSunAngle)) ? 1.0 / (kSamples * kSamples) : 0.0;
      }
      sum += fraction * sun_radiance * sunlight;
      for (int c = 0; c < 3; ++c) sky.rgb.push_back(float(sum[c]));
    }
  return sky;
}

}  // namespace umbrage
