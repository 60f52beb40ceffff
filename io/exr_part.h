// One part of an OpenEXR file as its channels are read: shared by the readers of flat and of deep parts.
#pragma once
#include <ImathBox.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/layer_format.h"

namespace umbrage {

/// How a channel is obtained from its part.
enum class ExrSource {
  kStored,     ///< as it is
  kLuminance,  ///< R, G or B of a part that has Y, RY and BY
};

/// A channel of a file, as its header lists it.
struct ExrChannel {
  std::string name;  ///< in the file
  int part = 0;
  Imf::PixelType type = Imf::FLOAT;
  int x_sampling = 1, y_sampling = 1;  ///< pixels per stored value
  ExrSource source = ExrSource::kStored;
  bool is_depth = false;  ///< has no value where nothing is visible
};

/// Returns the channels of all parts, in the order of LayeredFile::channels.
std::vector<ExrChannel> exr_channels_of(const Imf::MultiPartInputFile& input);

/// Requested channels of one part. `target` is the position in the request of each.
struct ExrPart {
  int index = 0;
  Imath::Box2i data, display;  ///< windows
  std::vector<ExrChannel> channels;
  std::vector<int> target;
};

/// Returns whether a part has several samples per pixel.
bool is_deep(const Imf::Header& header);

/// Reads rows [first, end) of the display window of a deep part, flattened: colours are composited front to back, other
/// channels have the value of the front sample with any coverage. Rows and columns outside the data window are not
/// written. `file_bytes`: size of the file. Throws the library's exceptions. Errors: kFile.
Result<void> read_deep_rows(const LayeredFile& file, Imf::MultiPartInputFile& input, const ExrPart& part, int first,
                            int end, RowTarget& target);

/// Returns the number of rows that a part's blocks or tiles have.
int rows_per_block(const Imf::Header& header);

/// Rows of a channel as floats: where pixel (x0, first row) goes, and how far apart rows are.
struct ExrRows {
  std::string channel;
  float* start = nullptr;
  std::ptrdiff_t stride = 0;  ///< floats
};

/// Returns whether read_exr_blocks can read a part: scanlines, no or ZIP compression, no subsampled channels.
bool has_plain_blocks(const Imf::Header& header);

/// Reads rows [first, last] and columns [x0, x1] of the data window. Throws the library's exceptions, and others of the
/// standard library, for damaged data.
void read_exr_blocks(Imf::InputPart& part, int first, int last, int x0, int x1, std::span<const ExrRows> channels);

}  // namespace umbrage
