// Parts that the image formats have in common: their table entries, the choice of planes for a picture, limits for
// reading, and atomic writing of files.
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/printable.h"
#include "io/image_file.h"

namespace umbrage {

extern const ImageFormat kPng, kExr, kPfm, kJpg, kJpeg, kWebp;

/// Max side and max number of pixels of a picture that is read. Larger ones are rejected before memory is allocated:
/// only damaged headers have such sizes.
inline constexpr std::int64_t kMaxFileSide = 65536, kMaxFilePixels = std::int64_t(1) << 28;

/// Checks the sides of a picture that is read by rows: each at most kMaxFileSide. Errors: kFile, naming the file.
Result<void> check_sides(const std::filesystem::path& file, std::int64_t width, std::int64_t height);

/// Checks the size of a picture that is read as a whole. Errors: kFile, naming the file.
Result<void> check_size(const std::filesystem::path& file, std::int64_t width, std::int64_t height);

/// Limits for what this thread reads from files until the object is destroyed: processor time from now, without that of
/// the receivers of rows, and the bytes that may be in memory at once. Of limits within others the stricter hold.
class ReadingLimits {
 public:
  ReadingLimits(double seconds, double memory);
  /// Those for a file, as umbrage-import has them: 8 s, and 2 s for each megabyte.
  explicit ReadingLimits(const std::filesystem::path& file);
  ~ReadingLimits();
  ReadingLimits(const ReadingLimits&) = delete;

 private:
  double outer_end_s_, outer_memory_;
};

/// Checks the limit of time. Loops call it whose length a file determines. Errors: kFile.
Result<void> check_reading_time(const std::filesystem::path& file);

/// Checks that a number of bytes may be in memory at once: at most the limit, and half of what is available. Errors:
/// kFile.
Result<void> check_memory(const std::filesystem::path& file, double bytes);

/// Returns the file's extension in lower case without the dot, such as "png"; empty if there is none.
std::string lowercase_extension(const std::filesystem::path& file);

/// Returns the planes of a picture: color.r, color.g, color.b and, with `with_alpha` and if present, color.a; or the
/// only plane. Errors: kFile for an image without pixels, and for one that has neither the colour planes nor a single
/// plane.
Result<std::vector<const Plane*>> picture_planes(const std::filesystem::path& file, const Image& image,
                                                 bool with_alpha);

/// Converts row `y` of 1, 3 or 4 planes to interleaved bytes: [0, 1] rounded to nearest, NaN as 0.
void bytes_of_row(std::span<const Plane* const> planes, int y, std::uint8_t* out);

/// Returns an image of this shape whose planes have no pixels.
Image image_without_pixels(const ImageShape& shape);

/// Returns the shape of an image.
ImageShape shape_of(const Image& image);
/// Returns a producer of rows that passes the whole image at once.
MakeImageRows rows_of(const Image& image);

/// Returns an image with `channels` planes: `grey` for 1, else the first of color.r, color.g, color.b and color.a.
Image picture(int width, int height, int channels);

/// Calls `write` on a temporary file beside `file`, then renames it. After a failure the temporary file is removed
/// and an existing `file` is unchanged. Devices and pipes are written directly. `write` need not report disk errors.
Result<void> write_atomically(const std::filesystem::path& file, const std::function<Result<void>(std::FILE*)>& write);

/// Runs `write` on an open stream of `file` and closes it. Turns exceptions into errors. `stream`: null if it could not
/// be opened, for the reason in errno. Errors: kFile; kDevice without memory.
Result<void> write_and_close(const std::filesystem::path& file, std::FILE* stream,
                             const std::function<Result<void>(std::FILE*)>& write);

/// A temporary file beside `file`, called path(), that another program writes. keep() renames it to `file`. If keep()
/// is not called, the destructor or abandon_writes removes it.
class PartFile {
 public:
  /// Checks that `file` can be written and chooses the temporary name. Errors: kFile: those of check_writable, and for
  /// devices and pipes.
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

/// Closes an open file; a deleter for unique_ptr.
struct CloseFile {
  void operator()(std::FILE* stream) const { std::fclose(stream); }
};
using InputFile = std::unique_ptr<std::FILE, CloseFile>;

/// Opens a file for reading; `size` receives its length in bytes. Errors: kFile, naming the file and the cause.
Result<InputFile> open_to_read(const std::filesystem::path& file, std::int64_t& size);

}  // namespace umbrage
