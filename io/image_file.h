// Image files: one source file per format behind one function to write and one to read.
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

struct WriteSettings {
  int bits = 8;        ///< PNG: 8 or 16
  bool half = false;   ///< EXR: half instead of float
  bool small = false;  ///< PNG: as small as deflate makes it rather than fast
  /// EXR: planes whose floats are the bits of whole numbers, written as those.
  std::vector<std::string> whole_numbers = {};
  int threads = 2;  ///< EXR: that compress; 0: all. The file does not depend on it
  /// EXR: written as worldToCamera and worldToNDC, which OpenEXR defines left-handed with +z forward.
  const Camera* camera = nullptr;
};

/// What an image has besides its pixels.
struct ImageShape {
  int width = 0, height = 0;
  std::vector<std::string> names;  ///< of its planes
};

/// Takes the next rows of an image from its top down, as many as these have.
using TakeImageRows = std::function<Result<void>(const Image& rows)>;
/// Makes all rows of an image, and hands them on as they are made.
using MakeImageRows = std::function<Result<void>(const TakeImageRows& take)>;

/// An image file format.
struct ImageFormat {
  std::string_view extension, summary;  ///< without the dot, lower case
  Result<void> (*write)(const std::filesystem::path&, const ImageShape&, const WriteSettings&, const MakeImageRows&);
  Result<Image> (*read)(const std::filesystem::path&);
  bool (*recognises)(std::string_view start);  ///< by the first 8 bytes of a file
};

std::span<const ImageFormat> image_formats();

/// The format that a path's ending names, or an error that lists the endings. Call it before long work starts.
/// Errors: kUsage.
Result<const ImageFormat*> format_of(const std::filesystem::path& file);

/// Whether a file can be created at `file`: its folder exists and is writable, and it is not itself a folder.
Result<void> check_writable(const std::filesystem::path& file);

/// Writes the image whole or not at all (beside, then renamed).
/// PNG: planes color.r, color.g, color.b and, if there, color.a as they are, clamped to [0, 1], NaN as 0; or the only
/// plane, as grey. PFM: the same, float, without alpha. EXR: every plane; color.r/g/b/a become R, G, B, A; `depth`
/// becomes depth.Z; names ending in .r .g .b .a .x .y .z get that letter in upper case; with `half`, depth and id
/// planes are float all the same. Errors: kFile; kUsage for an ending that names no format.
Result<void> write_image(const std::filesystem::path& file, const Image& image, const WriteSettings& settings = {});

/// Writes the same file from rows that are made while it is written, so that not all of them need be held. Errors:
/// those of `make` besides.
Result<void> write_image_rows(const std::filesystem::path& file, const ImageShape& shape, const WriteSettings& settings,
                              const MakeImageRows& make);

/// The bytes of the PNG file that write_image would write. Errors: kFile.
Result<std::string> encode_png(const Image& image, const WriteSettings& settings = {});
Result<std::string> encode_png_rows(const ImageShape& shape, const WriteSettings& settings, const MakeImageRows& make);

/// Reads an image of any of the formats, told apart by content; the same names back. A single plane of PNG or PFM is
/// called `grey`. PNG values are in [0, 1], not linearised. What EXR parts and windows become is said in exr.cpp.
/// Errors: kFile.
Result<Image> read_image(const std::filesystem::path& file);

/// Removes the temporary files of writes that are under way. For signal handlers, before they end the program.
void abandon_writes();

/// The camera that an EXR file's worldToCamera and worldToNDC give; nothing where it has none that we can use, and for
/// other formats. Errors: kFile.
Result<std::optional<Camera>> read_camera(const std::filesystem::path& file);

/// Writes text whole or not at all.
Result<void> write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace umbrage
