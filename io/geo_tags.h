// The tags of a georeferenced TIFF: size of its cells and the value of cells without data. Based on "GeoTIFF Standard"
// 1.1 (OGC 19-008r4), read as plain tags, and on GDAL's tag for missing data.
#pragma once
#include <tiffio.h>

#include <optional>

#include "io/layers.h"

namespace umbrage {

/// Returns what the tags of the current picture say; nothing if it has neither georeference nor a value for missing
/// data. Cells in degrees become metres on the ellipsoid WGS 84 at the latitude of the raster's centre.
std::optional<GeoRaster> geo_raster_of(TIFF* tiff, int width, int height);

/// Returns the width and height in metres of one degree of longitude and latitude at a latitude, on WGS 84.
void metres_per_degree(double latitude_deg, double& width, double& height);

}  // namespace umbrage
