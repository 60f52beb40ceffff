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

/// Returns the options of each picture: those for one model each, with its name in place of {stem}, with --same-view;
/// else the given ones. Errors: kUsage.
Result<std::vector<RenderOptions>> options_by_model(const RenderOptions& o);

/// Returns the settings of a video with frames of this size; 0: of the first frame.
VideoSettings video_settings(const RenderOptions& o, int width, int height);

/// Returns whether files of this extension hold display values, 0 to 1, which viewers show.
bool holds_display_values(std::string_view extension);

/// Checks that the format can hold the size and the transparency that the request asks for. Errors: kUsage.
Result<void> check_format(const RenderOptions& o, const std::string& extension);

/// The destination of a picture.
struct Destination {
  std::string file;        ///< file name or kStandardOutput
  Video* video = nullptr;  ///< if not null, receives the picture as a frame, and `file` is not written
  PictureInfo first_info;  ///< info of the first frame of a turntable
  /// Returns the extension of a file that holds the same picture: of a page of vector graphics, "png".
  std::string extension() const;
};

/// Writes a picture, whose rows `make` delivers, to the file or to standard output.
Result<void> write_rows(const Destination& destination, const ImageShape& shape, const WriteSettings& settings,
                        const MakeImageRows& make);

/// Writes a picture to the file or to standard output, or adds it to the video as a frame.
Result<void> write_picture(const Destination& destination, const Image& image, const WriteSettings& settings);

/// Returns how files of this extension hold the picture: .exr as scene-linear light, unless output.transfer is set.
PictureValues values_for(const RenderOptions& o, std::string_view extension);
/// Returns whether the request has such values.
bool is_scene_linear(const RenderOptions& o);

/// Returns the planes of the picture as the file holds it.
std::vector<std::string> picture_planes(const RenderOptions& o, const Destination& destination);

/// Returns the planes of the requested passes of a picture with the planes `available`. Errors: kUsage.
Result<std::vector<std::string>> pass_planes_of(const RenderOptions& o, std::span<const std::string> available,
                                                const PictureInfo& info);

/// Converts a drawn picture, or some of its rows, to the planes of the file. `names`: the planes of `drawn` to
/// write. `info`: properties of the picture, for the range of depth. In .exr, colour is premultiplied, and `beauty`, if
/// the picture is scene-linear, is the colour. The planes may be views of `drawn`, which must outlive them.
Image convert_for_file(const RenderOptions& o, const Destination& destination, const Image& drawn,
                       const std::vector<std::string>& names, const EffectSettings& settings, const PictureInfo& info);

}  // namespace umbrage::cli
