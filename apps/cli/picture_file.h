// Writes a picture to a file, to standard output or as a frame of a video.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/render_options.h"
#include "apps/cli/video.h"
#include "core/gbuffer.h"
#include "io/image_file.h"
#include "looks/settings.h"

namespace umbrage::cli {

inline constexpr std::string_view kStandardOutput = "-";  // value of --output

/// Returns the extension of a file name, without the dot. Errors: kUsage for a format that cannot be written.
Result<std::string> extension_of(const std::string& file);

/// The destination of a picture.
struct Place {
  std::string file;        ///< file name or kStandardOutput
  Video* video = nullptr;  ///< receives the picture as a frame in place of the file; null: none
  PictureInfo first;       ///< info of the first frame of a turntable
  std::string extension() const { return video || file == kStandardOutput ? "png" : *extension_of(file); }
};

/// Writes the file or standard output from rows that `make` delivers.
Result<void> put_rows(const Place& place, const ImageShape& shape, const WriteSettings& settings,
                      const MakeImageRows& make);

/// Writes the file or standard output, or adds a frame to the video.
Result<void> put_image(const Place& place, const Image& image, const WriteSettings& settings);

/// Converts a drawn picture, or some of its rows, to the planes that the file holds. `names` are the chosen planes.
Image picture_in_file(const RenderOptions& o, const Place& place, const Image& drawn,
                      const std::vector<std::string>& names, const EffectSettings& settings, const PictureInfo& info);

}  // namespace umbrage::cli
