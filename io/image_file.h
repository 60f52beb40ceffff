// Image files: writing and reading of all formats; each format has its own source file.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/camera.h"
#include "core/image.h"
#include "core/result.h"

namespace umbrage {

/// How image files are written.
struct WriteSettings {
  int bits = 8;        ///< PNG: bits per value, 8 or 16
  bool half = false;   ///< EXR: half instead of float
  bool small = false;  ///< PNG: smallest file instead of fastest writing
  double dpi = 0.0;    ///< PNG and JPEG: pixels per inch on paper; 0: not written
  int quality = 90;    ///< JPEG and WebP: 1 to 100; WebP of 100 is lossless
  /// EXR: planes whose floats hold the bits of integers, written as integers.
  std::vector<std::string> integer_planes = {};
  int threads = 2;  ///< EXR: number of compression threads; 0: all; the file does not depend on it
  /// EXR: camera to write as worldToCamera and worldToNDC, which OpenEXR defines as left-handed with +z forward; or
  /// null.
  const Camera* camera = nullptr;
  /// EXR: view matrix of that camera for coordinates that exceed the precision of floats, in place of its own; or null.
  const glm::dmat4* view_from_world = nullptr;
};

/// Size and plane names of an image.
struct ImageShape {
  int width = 0, height = 0;
  std::vector<std::string> names;  ///< plane names
};

/// A receiver of the next rows of an image, from top to bottom; `rows.height` is their number.
using TakeImageRows = std::function<Result<void>(const Image& rows)>;
/// A producer of all rows of an image, which passes them to `take` as they are produced.
using MakeImageRows = std::function<Result<void>(const TakeImageRows& take)>;

/// An image file format.
struct ImageFormat {
  std::string_view extension, summary;  ///< extension without the dot, lower case
  Result<void> (*write)(const std::filesystem::path&, const ImageShape&, const WriteSettings&, const MakeImageRows&);
  Result<Image> (*read)(const std::filesystem::path&);  ///< null: the format is only written
  bool (*recognises)(std::string_view start);           ///< checks the first 12 bytes of a file
  bool display = false;                                 ///< holds display values from 0 to 1, as viewers show them
  bool alpha = true;                                    ///< can hold transparency
  int max_bits = 8;                                     ///< of values, if these are display values
};

/// Returns the table of all formats.
std::span<const ImageFormat> image_formats();

/// Returns the format for a path's extension. Call it before long work starts. Errors: kUsage, listing the extensions.
Result<const ImageFormat*> format_of(const std::filesystem::path& file);

/// Checks that `file` can be created: its folder exists and is writable, and it is not itself a folder. Errors: kFile.
Result<void> check_writable(const std::filesystem::path& file);

/// Writes the image atomically (to a temporary file beside it, then renamed).
/// PNG, WebP and JPEG: planes color.r, color.g, color.b and, if present and not JPEG, color.a, not converted, clamped
/// to [0, 1], NaN as 0; or the only plane, as grey. PFM: the same planes without alpha, as floats. EXR: every plane;
/// color.r/g/b/a become R, G, B, A; `depth` becomes depth.Z; names ending in .r .g .b .a .x .y .z get this letter in
/// upper case; with `half`, depth and id planes are still float. Errors: kFile; kUsage for an unknown extension.
Result<void> write_image(const std::filesystem::path& file, const Image& image, const WriteSettings& settings = {});

/// Writes the same file as write_image, from rows that are produced during writing, so that they need not all be in
/// memory. Errors: those of write_image and of `make`.
Result<void> write_image_rows(const std::filesystem::path& file, const ImageShape& shape, const WriteSettings& settings,
                              const MakeImageRows& make);

/// Returns the bytes of the PNG file that write_image would write; `name` stands for it in errors. Errors: as there.
Result<std::string> encode_png(const std::string& name, const Image& image, const WriteSettings& settings = {});
Result<std::string> encode_png_rows(const std::string& name, const ImageShape& shape, const WriteSettings& settings,
                                    const MakeImageRows& make);

/// Returns a JPEG for pictures that are seen for a moment: encoded fast, with colour at half resolution (4:2:0) and
/// without a profile. `quality`: 1 to 100. Alpha is ignored. Errors: those of write_image.
Result<std::string> encode_fast_jpeg(const std::string& name, const Image& image, int quality);

/// Reads an image of any of the formats, detected by content. Plane names are as written. A single plane of PNG or PFM
/// is called `grey`. PNG values are in [0, 1], not linearized. For EXR parts and windows see exr.cpp.
/// Errors: kFile.
Result<Image> read_image(const std::filesystem::path& file);

/// Removes the temporary files of writes in progress, in all threads, and makes later writes fail. Signal handlers call
/// it before they end the program.
void abandon_writes();

/// Returns the camera in an EXR file's worldToCamera and worldToNDC. Returns nothing for other formats, or if the file
/// has no camera that Camera can represent. Errors: kFile.
Result<std::optional<Camera>> read_camera(const std::filesystem::path& file);

/// Writes text to a file atomically. Errors: kFile.
Result<void> write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace umbrage
