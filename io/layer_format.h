// Parts that the formats of layered files have in common: their table entries and the target of decoded rows.
#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "io/format.h"
#include "io/layers.h"

namespace umbrage {

/// Where a reader puts the rows that it decodes: into a whole image, or into blocks that are passed on.
class RowTarget {
 public:
  /// Rows go to `whole`, which has a plane per channel.
  RowTarget(const LayeredFile& file, Image& whole);
  /// Rows go to blocks with planes of these names, which are passed to `take`.
  RowTarget(const LayeredFile& file, std::vector<std::string> names, const TakeLayerRows& take);

  /// Calls `fill` for blocks of rows [first, end), from top to bottom, then passes them on. Blocks begin at multiples
  /// of `unit`, the number of rows that the format decodes together. Errors: kFile if `unit` rows have too many values;
  /// those of `fill` and of the receiver.
  Result<void> each_block(int unit, const std::function<Result<void>(int first, int end)>& fill);
  /// Returns the pixels of a row of the current block; `channel` counts the requested channels. Rows of a channel are
  /// stride() floats apart.
  float* row(int channel, int y) { return image_->planes[std::size_t(channel)].row(y - first_); }
  int stride() const { return image_->planes[0].stride; }

  /// The value of depth outside the data window.
  float outside_depth;

 private:
  const LayeredFile& file_;
  Image* image_ = nullptr;
  Image block_;
  int first_ = 0;
  std::vector<std::string> names_;
  const TakeLayerRows* take_ = nullptr;
};

/// A format of layered files.
struct LayerFormat {
  std::string_view name;
  std::string_view extensions;                 ///< separated by blanks, the usual one first: "tif tiff"
  bool (*recognises)(std::string_view start);  ///< checks the first kLayerMagic bytes of a file
  Result<LayeredFile> (*header)(const std::filesystem::path& file);
  Result<void> (*rows)(const LayeredFile& file, std::span<const int> channels, RowTarget& target);
};
inline constexpr std::size_t kLayerMagic = 16;

extern const LayerFormat kExrLayers, kPngLayers, kPfmLayers, kTiffLayers, kNpyLayers, kNpzLayers, kPnmLayers,
    kGridLayers, kJpegLayers, kWebpLayers, kHdrLayers, kColmapLayers;

/// Return what read_header and read_channels do for files of this format; depth outside the data window has the value
/// `outside_depth`.
Result<LayeredFile> read_header_as(const LayerFormat& format, const std::filesystem::path& file);
Result<Image> read_channels_as(const LayerFormat& format, const LayeredFile& file, std::span<const int> channels,
                               float outside_depth);

/// Reads all channels of a picture into the planes of picture(), with integers divided by their maximum. Errors: kFile.
Result<Image> read_picture_as(const LayerFormat& format, const std::filesystem::path& file);

/// Returns the header of a file with one picture whose data fill the display window, without channels.
LayeredFile plain_header(int width, int height);
/// Adds `count` channels: Y for 1, Y A for 2, R G B, R G B A. `max_integer`: that of display values; 0: floats.
void add_picture_channels(LayeredFile& file, int count, ChannelType type, double max_integer);

/// Returns the error for a file that is not the one whose header was read.
Error changed_file(const LayeredFile& file);

}  // namespace umbrage
