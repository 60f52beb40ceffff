// What the image formats share: the entry of each in the table, the choice of planes for a picture, limits on what is
// read, and files that appear whole or not at all.
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/image_file.h"

namespace umbrage {

extern const ImageFormat kPng, kExr, kPfm;

/// Larger pictures are refused before memory is asked for: no camera makes them, damaged headers do.
inline constexpr std::int64_t kMaxSide = 65536, kMaxPixels = std::int64_t(1) << 28;

/// Whether a size read from a file is sane; the error names the file.
Result<void> check_size(const std::filesystem::path& file, std::int64_t width, std::int64_t height);

/// How a file's name ends, without the dot and in lower case, such as "png"; empty where there is no ending.
std::string ending_of(const std::filesystem::path& file);

/// The planes of a picture: color.r, color.g, color.b and, if wanted and there, color.a; or the only plane.
Result<std::vector<const Plane*>> picture_planes(const std::filesystem::path& file, const Image& image,
                                                 bool with_alpha);

/// An image of that shape whose planes have no pixels.
Image bare_image(const ImageShape& shape);

/// The shape of an image, and its rows all at once.
ImageShape shape_of(const Image& image);
MakeImageRows rows_of(const Image& image);

/// An image with planes for `channels` values per pixel: one is `grey`, more are color.r, color.g, color.b, color.a.
Image picture(int width, int height, int channels);

/// Lets `write` fill a file beside `file`, then renames it. On any failure the new file is removed and an older `file`
/// stays as it was. Devices and pipes are written to directly. `write` may leave errors of the disk to this function.
Result<void> write_whole(const std::filesystem::path& file, const std::function<Result<void>(std::FILE*)>& write);

/// A file that another program fills beside `file`, under the name path(); keep() makes it `file`. What is not kept is
/// removed, also by abandon_writes.
class PartFile {
 public:
  /// Errors: kFile, as of check_writable, and for devices and pipes.
  static Result<std::unique_ptr<PartFile>> begin(const std::filesystem::path& file);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  const std::filesystem::path& path() const;
  Result<void> keep();

 private:
  struct State;
  explicit PartFile(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// An open file that closes itself.
struct CloseFile {
  void operator()(std::FILE* stream) const { std::fclose(stream); }
};
using InputFile = std::unique_ptr<std::FILE, CloseFile>;

/// Opens a file to read; the error names it and says why not. `size` becomes its length in bytes.
Result<InputFile> open_to_read(const std::filesystem::path& file, std::int64_t& size);

}  // namespace umbrage
