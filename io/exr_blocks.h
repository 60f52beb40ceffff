// Fast decoding of scanline blocks of OpenEXR files that are not compressed or compressed by ZIP, which most renderers
// write.
#pragma once
#include <ImfHeader.h>
#include <ImfInputPart.h>

#include <span>
#include <string>

namespace umbrage {

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
