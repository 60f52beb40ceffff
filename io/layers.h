// Image files with layers: every channel of a file under the name that it has there. Renderers, cameras and surveys
// write such files. What the channels mean is not decided here: see gbuffers/.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/result.h"

namespace umbrage {

/// The type of the values of a channel in its file.
enum class ChannelType { kUint8, kUint16, kUint32, kInt, kHalf, kFloat, kDouble };

/// A channel of a file.
struct Channel {
  std::string part;   ///< name of the part of a multi-part EXR, or of the array in an NPZ; else empty
  std::string view;   ///< view of a stereo EXR, "left"; else empty
  std::string layer;  ///< the name before its last dot: "ViewLayer.Depth"; empty if it has none
  std::string name;   ///< the name after its last dot: "Z"; "R", "G", "B", "A" or "Y" (grey) in files without names
  ChannelType type = ChannelType::kFloat;
  int index = 0;             ///< position in LayeredFile::channels
  double max_integer = 0.0;  ///< integer value that reads as 1 unless read raw; 0: no such scale
  bool is_srgb = false;      ///< display values of 8 or 16 bits: PNG, JPEG, WebP

  /// Returns part, layer and name, joined by dots; the part only if the layer does not repeat it.
  std::string full_name() const;
};

/// Returns part and layer, joined by a dot; the part only if the layer does not repeat it.
std::string layer_with_part(const std::string& part, const std::string& layer);

/// A rectangle of pixels: [x0, x1) by [y0, y1).
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// What a georeferenced raster says of itself.
struct GeoRaster {
  double cell_width = 1.0, cell_height = 1.0;  ///< metres, converted if the file has degrees or feet
  std::optional<double> no_data;               ///< stored value of cells without data
  double value_unit = 1.0;                     ///< metres per unit of an elevation
  bool has_cell = true;                        ///< the file states the cell size
};

/// The header of an image file: everything but its pixels.
struct LayeredFile {
  std::filesystem::path path;
  std::string_view format;        ///< "EXR", "PNG", "TIFF", "NPY"
  int width = 0, height = 0;      ///< pixels of the display window
  PixelBox data;                  ///< where there are pixels, in the display window; of all parts together
  std::vector<Channel> channels;  ///< in the order of the file
  bool is_deep = false;           ///< samples along each ray, which are flattened while reading
  double pixel_aspect = 1.0;      ///< width / height of a pixel
  std::optional<Camera> camera;   ///< from worldToCamera and worldToNDC
  std::optional<GeoRaster> geo;   ///< of a georeferenced TIFF
  /// Further text and numbers of the header, as text: "software", "cryptomatte/ab12cd3/name".
  std::vector<std::pair<std::string, std::string>> attributes;

  /// Returns the value of an attribute, or null.
  const std::string* attribute(std::string_view name) const;
};

/// Returns whether a name has the extension of one of the formats.
bool has_image_extension(const std::filesystem::path& file);

/// Reads the header of a file of any format, detected by content. Errors: kFile.
Result<LayeredFile> read_header(const std::filesystem::path& file);

/// Receives rows from top to bottom: one plane per requested channel, named by Channel::full_name.
using TakeLayerRows = std::function<Result<void>(const Image& rows, int first)>;

/// Reads channels of a file, by index, and passes rows of the display window to `take`; not all rows need be in memory.
/// Values are as stored: integers from 0 to Channel::max_integer, floats unchanged. Outside the data window they are 0,
/// and NaN in channels named Z or depth. Errors: kFile; those of `take`.
Result<void> read_rows(const LayeredFile& file, std::span<const int> channels, const TakeLayerRows& take);

/// Reads whole channels: the same planes as read_rows. Errors: kFile; kDevice without memory.
Result<Image> read_channels(const LayeredFile& file, std::span<const int> channels);

/// Writes a copy of an EXR file with more layers: all parts, channels, attributes and pixel types are kept. A layer
/// that the part for new layers already has is replaced; a file of several parts gets one named "umbrage" for them.
/// `layers` has the size of the display window; a plane's name is `layer.x`. Errors: kFile.
Result<void> write_merged(const LayeredFile& file, const Image& layers, bool half, const std::filesystem::path& to);

}  // namespace umbrage
