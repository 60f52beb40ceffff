#include "io/geo_tags.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <string_view>

#include "core/numbers.h"

namespace umbrage {
namespace {

enum Tag : std::uint32_t {
  kPixelScale = 33550,
  kTiepoint = 33922,
  kTransformation = 34264,
  kKeyDirectory = 34735,
  kKeyDoubles = 34736,
  kNoData = 42113,
};

enum Key : std::uint16_t {
  kModelType = 1024,
  kGeographicType = 2048,
  kAngularUnits = 2054,
  kAngularUnitSize = 2055,
  kProjectedType = 3072,
  kLinearUnits = 3076,
  kLinearUnitSize = 3077,
  kVerticalUnits = 4099,
};

constexpr int kGeographicModel = 2, kUserDefined = 32767;

/// Returns the values of a tag that libtiff does not know by itself; none if it is missing or of another type.
template <class Value>
std::span<const Value> values_of(TIFF* tiff, std::uint32_t tag, TIFFDataType type) {
  const TIFFField* field = TIFFFindField(tiff, tag, TIFF_ANY);
  if (!field || TIFFFieldDataType(field) != type || !TIFFFieldPassCount(field)) return {};
  void* data = nullptr;
  std::uint32_t count = 0;
  std::uint16_t short_count = 0;
  const bool is_short = TIFFFieldReadCount(field) != TIFF_VARIABLE2;
  if (!(is_short ? TIFFGetField(tiff, tag, &short_count, &data) : TIFFGetField(tiff, tag, &count, &data)) || !data)
    return {};
  return {static_cast<const Value*>(data), is_short ? short_count : count};
}

/// The directory of keys: each has a number, or a position in the list of doubles.
struct Keys {
  std::span<const std::uint16_t> directory;
  std::span<const double> doubles;

  /// Returns a key's code, or `missing`, also if the file has a number of another kind.
  int code(Key key, int missing) const {
    const double found = value(key, missing);
    return found >= 0.0 && found <= 65535.0 ? int(found) : missing;
  }
  /// Returns a key's value, or `missing`.
  double value(Key key, double missing) const {
    constexpr std::size_t kEntry = 4;  // shorts per entry; the first is the header
    for (std::size_t at = kEntry; at + kEntry <= directory.size(); at += kEntry) {
      if (directory[at] != key) continue;
      const std::uint16_t location = directory[at + 1], offset = directory[at + 3];
      if (location == 0) return offset;
      if (location == kKeyDoubles && offset < doubles.size()) return doubles[offset];
    }
    return missing;
  }
};

/// Returns the metres of a unit of length, by its EPSG code; 0 if it is not one of these.
double metres_of(int code) {
  constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937.0;
  switch (code) {
    case 9001:
      return 1.0;
    case 9002:
      return kFoot;
    case 9003:
      return kSurveyFoot;
    case 9036:
      return 1000.0;
    default:
      return 0.0;
  }
}

double degrees_of(int code) {
  switch (code) {
    case 9101:
      return 180.0 / std::numbers::pi;
    case 9103:
      return 1.0 / 60.0;
    case 9104:
      return 1.0 / 3600.0;
    case 9105:
      return 0.9;
    default:
      return 1.0;  // 9102, and other notations of degrees
  }
}

double positive_or(double value, double otherwise) { return std::isfinite(value) && value > 0.0 ? value : otherwise; }

std::optional<double> no_data_of(TIFF* tiff) {
  const auto text = values_of<char>(tiff, kNoData, TIFF_ASCII);
  if (text.empty()) return std::nullopt;
  std::string_view word(text.data(), strnlen(text.data(), text.size()));
  return take_number(word);
}

}  // namespace

void metres_per_degree(double latitude_deg, double& width, double& height) {
  constexpr double kRadius = 6378137.0, kEccentricity2 = 6.69437999014e-3;                   // of WGS 84
  const double latitude = std::clamp(latitude_deg, -89.9, 89.9) * std::numbers::pi / 180.0;  // poles have no width
  const double root = std::sqrt(1.0 - kEccentricity2 * std::sin(latitude) * std::sin(latitude));
  const double per_radian = std::numbers::pi / 180.0 * kRadius;
  width = per_radian * std::cos(latitude) / root;
  height = per_radian * (1.0 - kEccentricity2) / (root * root * root);
}

std::optional<GeoRaster> geo_raster_of(TIFF* tiff, int width, int height) {
  const auto scale = values_of<double>(tiff, kPixelScale, TIFF_DOUBLE);
  const auto tie = values_of<double>(tiff, kTiepoint, TIFF_DOUBLE);
  const auto matrix = values_of<double>(tiff, kTransformation, TIFF_DOUBLE);
  const Keys keys{values_of<std::uint16_t>(tiff, kKeyDirectory, TIFF_SHORT),
                  values_of<double>(tiff, kKeyDoubles, TIFF_DOUBLE)};
  GeoRaster geo;
  geo.no_data = no_data_of(tiff);
  double cell_width = 0.0, cell_height = 0.0, centre_y = 0.0;  // in the units of the model
  if (matrix.size() >= 16) {
    cell_width = std::hypot(matrix[0], matrix[4]);
    cell_height = std::hypot(matrix[1], matrix[5]);
    centre_y = matrix[4] * width / 2.0 + matrix[5] * height / 2.0 + matrix[7];
  } else if (scale.size() >= 2) {
    cell_width = std::abs(scale[0]);
    cell_height = std::abs(scale[1]);
    if (tie.size() >= 6) centre_y = tie[4] - (height / 2.0 - tie[1]) * scale[1];
  } else if (keys.directory.empty() && !geo.no_data) {
    return std::nullopt;
  }
  geo.has_cell = cell_width > 0.0 && std::isfinite(cell_width);
  cell_width = positive_or(cell_width, 1.0);
  cell_height = positive_or(cell_height, cell_width);
  const bool is_projected = keys.code(kProjectedType, 0) != 0;
  if (keys.code(kModelType, 0) == kGeographicModel || (!is_projected && keys.code(kGeographicType, 0) != 0)) {
    const int unit = keys.code(kAngularUnits, 9102);
    const double degrees = unit == kUserDefined ? positive_or(keys.value(kAngularUnitSize, 0), std::numbers::pi / 180) *
                                                      180 / std::numbers::pi
                                                : degrees_of(unit);
    double metres_x = 1.0, metres_y = 1.0;
    metres_per_degree(std::isfinite(centre_y) ? centre_y * degrees : 0.0, metres_x, metres_y);
    geo.cell_width = cell_width * degrees * metres_x;
    geo.cell_height = cell_height * degrees * metres_y;
  } else {
    const int unit = keys.code(kLinearUnits, 9001);
    const double metres = positive_or(unit == kUserDefined ? keys.value(kLinearUnitSize, 1.0) : metres_of(unit), 1.0);
    geo.cell_width = cell_width * metres;
    geo.cell_height = cell_height * metres;
  }
  geo.value_unit = positive_or(metres_of(keys.code(kVerticalUnits, 9001)), 1.0);
  return geo;
}

}  // namespace umbrage
