// A picture as a file, standard output or a frame of a video.
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

inline constexpr std::string_view kStandardOutput = "-";  // as --output

/// Of a file that can be written. Errors: kUsage.
Result<std::string> extension_of(const std::string& file);

/// Where a picture goes.
struct Place {
  std::string file;        ///< or kStandardOutput
  Video* video = nullptr;  ///< a frame of it, in place of a file
  PictureInfo first;       ///< of the first of several frames
  std::string extension() const { return video || file == kStandardOutput ? "png" : *extension_of(file); }
};

/// Writes the file, or standard output, from rows that are made meanwhile.
Result<void> put_rows(const Place& place, const ImageShape& shape, const WriteSettings& settings,
                      const MakeImageRows& make);

/// Writes the file, or standard output, or adds a frame to a video.
Result<void> put_image(const Place& place, const Image& image, const WriteSettings& settings);

/// What the file holds of a picture, or of some of its rows.
Image picture_in_file(const RenderOptions& o, const Place& place, const Image& drawn,
                      const std::vector<std::string>& names, const EffectSettings& settings, const PictureInfo& info);

}  // namespace umbrage::cli
