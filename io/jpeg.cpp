// JPEG through libjpeg-turbo, only written: baseline JFIF. Files are without subsampling of colour, which would fray
// coloured lines, and with the profile of sRGB.
#include <cstdio>
// jpeglib.h needs cstdio before it.
#include <jpeglib.h>

#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>
#include <vector>

#include "io/format.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

// ---- the profile of sRGB

using Bytes = std::vector<std::uint8_t>;

/// Appends an unsigned integer of `size` bytes, the most significant first.
void add(Bytes& to, std::uint32_t value, int size = 4) {
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) to.push_back(std::uint8_t(value >> shift));
}

void add(Bytes& to, std::string_view text) {
  for (const char c : text) to.push_back(std::uint8_t(c));
}

/// Appends numbers as s15Fixed16Number.
void add_fixed(Bytes& to, std::initializer_list<double> numbers) {
  constexpr double kOne = 65536.0;
  for (const double number : numbers) add(to, std::uint32_t(std::int32_t(std::lround(number * kOne))));
}

Bytes xyz(double x, double y, double z) {
  Bytes tag;
  add(tag, "XYZ ");
  add(tag, 0);
  add_fixed(tag, {x, y, z});
  return tag;
}

Bytes text(std::string_view ascii) {
  constexpr std::uint32_t kRecordSize = 12, kTextStart = 28;
  Bytes tag;
  add(tag, "mluc");
  for (const std::uint32_t field : {0u, 1u, kRecordSize}) add(tag, field);
  add(tag, "enUS");
  add(tag, std::uint32_t(2 * ascii.size()));
  add(tag, kTextStart);
  for (const char c : ascii) add(tag, std::uint32_t(c), 2);
  return tag;
}

Bytes curve() {
  constexpr std::uint32_t kType = 3;  // (a x + b)^g from d, below that c x
  Bytes tag;
  add(tag, "para");
  add(tag, 0);
  add(tag, kType, 2);
  add(tag, 0, 2);
  add_fixed(tag, {2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045});
  return tag;
}

Bytes adaptation() {  // Bradford, from D65 to D50
  Bytes tag;
  add(tag, "sf32");
  add(tag, 0);
  add_fixed(tag, {1.04788, 0.02292, -0.05022, 0.02959, 0.99048, -0.01707, -0.00925, 0.01508, 0.75168});
  return tag;
}

Bytes make_profile() {
  const std::pair<std::string_view, Bytes> tags[] = {
      {"desc", text("sRGB")},
      {"cprt", text("No copyright, use freely")},
      {"wtpt", xyz(0.9642, 1.0, 0.8249)},
      {"chad", adaptation()},
      {"rXYZ", xyz(0.43607, 0.22249, 0.01392)},
      {"gXYZ", xyz(0.38515, 0.71687, 0.09708)},
      {"bXYZ", xyz(0.14307, 0.06061, 0.71410)},
      {"rTRC", curve()},
      {"gTRC", curve()},
      {"bTRC", curve()},
  };
  constexpr std::size_t kHeaderSize = 128, kEntrySize = 12;
  Bytes table, data;
  add(table, std::uint32_t(std::size(tags)));
  const std::size_t start = kHeaderSize + 4 + kEntrySize * std::size(tags);
  std::size_t last = 0;
  for (const auto& [name, tag] : tags) {
    if (!name.ends_with("TRC") || name[0] == 'r') {  // the three curves are one
      last = start + data.size();
      for (const std::uint8_t byte : tag) data.push_back(byte);
      data.resize((data.size() + 3) / 4 * 4);
    }
    add(table, name);
    add(table, std::uint32_t(last));
    add(table, std::uint32_t(tag.size()));
  }
  Bytes profile;
  add(profile, std::uint32_t(start + data.size()));
  add(profile, 0);
  add(profile, 0x04300000);  // version
  add(profile, "mntrRGB XYZ ");
  for (const std::uint32_t part : {2026, 1, 1, 0, 0, 0}) add(profile, part, 2);  // date
  add(profile, "acsp");
  profile.resize(68);                         // platform, flags, device, rendering intent: perceptual
  add_fixed(profile, {0.9642, 1.0, 0.8249});  // D50
  profile.resize(kHeaderSize);
  for (const Bytes* part : {&table, &data})
    for (const std::uint8_t byte : *part) profile.push_back(byte);
  return profile;
}

/// Returns an ICC profile, version 4.3 (ICC.1:2010), of sRGB (IEC 61966-2-1): primaries adapted to D50, and the
/// transfer function as a parametric curve of type 3.
const std::vector<std::uint8_t>& srgb_profile() {
  static const Bytes profile = make_profile();
  return profile;
}

// ---- pictures

/// libjpeg reports errors by a call that must not return; here longjmp, so functions that call setjmp own nothing with
/// a destructor.
struct JpegError {
  jpeg_error_mgr manager;
  std::jmp_buf jump;
  char text[JMSG_LENGTH_MAX] = "";
};

[[noreturn]] void on_error(j_common_ptr jpeg) {
  auto* error = reinterpret_cast<JpegError*>(jpeg->err);
  (*error->manager.format_message)(jpeg, error->text);
  std::longjmp(error->jump, 1);
}

struct JpegWriter {
  jpeg_compress_struct jpeg{};
  JpegError error;
  unsigned char* bytes = nullptr;  // of a picture in memory
  unsigned long size = 0;
  ~JpegWriter() {
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
  }
};

/// Starts a file or, if `stream` is null, a picture in memory that is encoded for speed.
bool start(JpegWriter& writer, std::FILE* stream, int width, int height, int channels, const WriteSettings& settings) {
  jpeg_compress_struct& jpeg = writer.jpeg;
  jpeg.err = jpeg_std_error(&writer.error.manager);
  writer.error.manager.error_exit = on_error;
  writer.error.manager.output_message = [](j_common_ptr) {};
  if (setjmp(writer.error.jump)) return false;
  jpeg_create_compress(&jpeg);
  if (stream)
    jpeg_stdio_dest(&jpeg, stream);
  else
    jpeg_mem_dest(&jpeg, &writer.bytes, &writer.size);
  jpeg.image_width = JDIMENSION(width);
  jpeg.image_height = JDIMENSION(height);
  jpeg.input_components = channels;
  jpeg.in_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);  // 4:2:0
  jpeg_set_quality(&jpeg, settings.quality, TRUE);
  if (const auto dpi = std::lround(settings.dpi)) {
    jpeg.density_unit = 1;  // per inch
    jpeg.X_density = jpeg.Y_density = UINT16(dpi);
  }
  if (!stream) {
    jpeg.dct_method = JDCT_IFAST;
    jpeg_start_compress(&jpeg, TRUE);
    return true;
  }
  for (int c = 0; c < jpeg.num_components; ++c) jpeg.comp_info[c].h_samp_factor = jpeg.comp_info[c].v_samp_factor = 1;
  jpeg.optimize_coding = TRUE;
  jpeg_start_compress(&jpeg, TRUE);
  const auto& profile = srgb_profile();
  if (channels == 3) jpeg_write_icc_profile(&jpeg, profile.data(), unsigned(profile.size()));
  return true;
}

bool write_row(JpegWriter& writer, std::uint8_t* row) {
  if (setjmp(writer.error.jump)) return false;
  jpeg_write_scanlines(&writer.jpeg, &row, 1);
  return true;
}

bool finish(JpegWriter& writer) {
  if (setjmp(writer.error.jump)) return false;
  jpeg_finish_compress(&writer.jpeg);
  return true;
}

/// Writes the rows to an open file, or to memory as for start; `name` is its name in errors.
Result<void> write_to(JpegWriter& writer, std::FILE* stream, const fs::path& name, const ImageShape& shape,
                      int channels, const WriteSettings& settings, const MakeImageRows& make) {
  const auto failed = [&] {
    return file_error("'{}' cannot be written as JPEG: {}", name.string(), writer.error.text);
  };
  if (!start(writer, stream, shape.width, shape.height, channels, settings)) return failed();
  std::vector<std::uint8_t> row(std::size_t(shape.width) * std::size_t(channels));
  Result<void> made = make([&](const Image& rows) -> Result<void> {
    const auto planes = picture_planes(name, rows, false);
    if (!planes) return planes.error();
    for (int y = 0; y < rows.height; ++y) {
      bytes_of_row(*planes, y, row.data());
      if (!write_row(writer, row.data())) return failed();
    }
    return {};
  });
  if (!made) return made;
  return finish(writer) ? Result<void>() : failed();
}

Result<void> write_jpeg(const fs::path& file, const ImageShape& shape, const WriteSettings& settings,
                        const MakeImageRows& make) {
  const Image bare = image_without_pixels(shape);
  const auto planes = picture_planes(file, bare, true);
  if (!planes) return planes.error();
  if (planes->size() > 3)
    return file_error("'{}' cannot be written: JPEG has no transparency; .png and .webp have", file.string());
  return write_atomically(file, [&](std::FILE* to) {
    JpegWriter writer;
    return write_to(writer, to, file, shape, int(planes->size()), settings, make);
  });
}

bool is_jpeg(std::string_view start) { return start.starts_with("\xff\xd8\xff"); }

constexpr std::string_view kSummary = "8 bit grey or RGB pictures, sRGB, only written";

}  // namespace

Result<std::string> encode_fast_jpeg(const std::string& name, const Image& image, int quality) {
  const auto planes = picture_planes(name, image, false);
  if (!planes) return planes.error();
  JpegWriter writer;
  const auto written = write_to(writer, nullptr, name, {image.width, image.height, image.names}, int(planes->size()),
                                {.quality = quality}, [&](const TakeImageRows& take) { return take(image); });
  if (!written) return written.error();
  return std::string(reinterpret_cast<const char*>(writer.bytes), writer.size);
}

const ImageFormat kJpg = {"jpg", kSummary, write_jpeg, nullptr, is_jpeg, true, false, 8};
const ImageFormat kJpeg = {"jpeg", kSummary, write_jpeg, nullptr, is_jpeg, true, false, 8};

}  // namespace umbrage
