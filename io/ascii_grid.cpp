// ESRI ASCII grids (.asc) of elevations: lines with keywords (ncols, nrows, cellsize or dx and dy, nodata_value,
// position of the lower left corner), then the rows from the north. Based on "ESRI ASCII raster format" (ArcGIS
// documentation). The units are those of a .prj file beside the grid: degrees if it has a geographic system, else
// metres.
#include <cctype>
#include <cmath>
#include <fstream>
#include <map>

#include "core/lowercase.h"
#include "core/numbers.h"
#include "io/geo_tags.h"
#include "io/layer_format.h"

namespace umbrage {
namespace fs = std::filesystem;
namespace {

/// A grid being read.
struct GridReader {
  InputFile stream;
  int width = 0, height = 0;
  GeoRaster geo;
};

/// Reads the next word; empty at the end. Longer words than numbers and keywords can be are cut.
std::string next_word(std::FILE* stream) {
  constexpr std::size_t kMaxLength = 64;
  std::string word;
  int c = std::fgetc(stream);
  while (c != EOF && std::isspace(c)) c = std::fgetc(stream);
  for (; c != EOF && !std::isspace(c); c = std::fgetc(stream))
    if (word.size() < kMaxLength) word += char(c);
  return word;
}

/// Sets `number` to a word's value. Decimal commas are accepted. Returns false if it is not a number.
bool to_number(std::string word, double& number) {
  for (char& c : word)
    if (c == ',') c = '.';
  std::string_view rest = word;
  const auto value = take_number(rest);
  number = value.value_or(0.0);
  return value && rest.empty();
}

/// Returns whether the .prj file beside the grid has a geographic system, whose units are degrees.
bool is_in_degrees(const fs::path& file) {
  fs::path beside = file;
  std::ifstream stream(beside.replace_extension(".prj"), std::ios::binary);
  std::string start(256, '\0');
  stream.read(start.data(), std::streamsize(start.size()));
  start = lowercase(start);
  return start.starts_with("geogcs") || start.starts_with("geogcrs") ||
         (start.starts_with("projection") && start.find("geographic") < start.find('\n'));
}

Result<void> open(const fs::path& file, GridReader& reader) {
  std::int64_t size = 0;
  Result<InputFile> stream = open_to_read(file, size);
  if (!stream) return stream.error();
  reader.stream = std::move(*stream);
  std::FILE* in = reader.stream.get();
  std::map<std::string, double> values;
  off_t data = 0;
  while (true) {
    data = ::ftello(in);
    std::string key = next_word(in);
    if (key.empty() || !std::isalpha(static_cast<unsigned char>(key[0])) || lowercase(key[0]) == 'n') {
      double number = 0.0;  // nan is the first value, not a keyword
      if (key.empty() || to_number(key, number)) break;
      if (!std::isalpha(static_cast<unsigned char>(key[0])))
        return file_error("'{}' cannot be read as a grid: its header or first value is damaged", file.string());
    }
    key = lowercase(key);
    double number = 0.0;
    if (!to_number(next_word(in), number))
      return file_error("'{}' has no number after '{}' in its header", file.string(), printable(key));
    values[key] = number;
    constexpr std::size_t kMaxKeys = 32;
    if (values.size() > kMaxKeys) return file_error("'{}' is not a grid: it has too many keywords", file.string());
  }
  ::fseeko(in, data, SEEK_SET);
  const double width = values.count("ncols") ? values["ncols"] : 0.0,
               height = values.count("nrows") ? values["nrows"] : 0.0;
  const auto is_whole = [](double side) { return side >= 0.0 && side < 1e9 && side == std::floor(side); };
  if (!is_whole(width) || !is_whole(height))
    return file_error("'{}' has {} x {} cells in its header: both must be integers", file.string(), width, height);
  if (auto status = check_sides(file, std::int64_t(width), std::int64_t(height)); !status) return status;
  if (double(size - data) < 2.0 * width * height - 1.0)  // a digit and a space per value
    return file_error("'{}' is cut short: {} bytes cannot hold {} x {} values", file.string(), size - data, width,
                      height);
  reader.width = int(width);
  reader.height = int(height);
  const auto cell = [&](const char* key) {
    const double own = values.count(key) ? values[key] : values.count("cellsize") ? values["cellsize"] : 1.0;
    return std::isfinite(own) && own > 0.0 ? own : 1.0;
  };
  reader.geo.has_cell = values.count("cellsize") || values.count("dx");
  reader.geo.cell_width = cell("dx");
  reader.geo.cell_height = cell("dy");
  if (values.count("nodata_value")) reader.geo.no_data = values["nodata_value"];
  if (is_in_degrees(file)) {
    const double south = values.count("yllcorner") ? values["yllcorner"] : values["yllcenter"];
    double metres_x = 1.0, metres_y = 1.0;
    metres_per_degree(std::isfinite(south) ? south + height * reader.geo.cell_height / 2.0 : 0.0, metres_x, metres_y);
    reader.geo.cell_width *= metres_x;
    reader.geo.cell_height *= metres_y;
  }
  return {};
}

Result<LayeredFile> read_grid_header(const fs::path& file) {
  GridReader reader;
  if (auto opened = open(file, reader); !opened) return opened.error();
  LayeredFile header = plain_header(reader.width, reader.height);
  add_picture_channels(header, 1, ChannelType::kFloat, 0.0);
  header.geo = reader.geo;
  return header;
}

Result<void> read_grid_rows(const LayeredFile& file, std::span<const int> channels, RowTarget& target) {
  GridReader reader;
  if (auto opened = open(file.path, reader); !opened) return opened;
  if (reader.width != file.width || reader.height != file.height) return changed_file(file);
  return target.each_block(1, [&](int first, int end) -> Result<void> {
    for (int y = first; y < end; ++y)
      for (int x = 0; x < file.width; ++x) {
        double number = 0.0;
        if (!to_number(next_word(reader.stream.get()), number))
          return file_error("'{}' cannot be read: the value of row {}, column {} is missing or no number",
                            file.path.string(), y + 1, x + 1);
        for (std::size_t c = 0; c < channels.size(); ++c) target.row(int(c), y)[x] = float(number);
      }
    if (end == file.height && !next_word(reader.stream.get()).empty())
      return file_error("'{}' has more values than the {} x {} of its header", file.path.string(), file.width,
                        file.height);
    return {};
  });
}

bool is_grid(std::string_view start) {
  const std::string word = lowercase(start.substr(0, start.find_first_of(" \t")));
  return start.find_first_of(" \t") != std::string_view::npos && (word == "ncols" || word == "nrows");
}

}  // namespace

const LayerFormat kGridLayers = {"ASCII grid", "asc", is_grid, read_grid_header, read_grid_rows};

}  // namespace umbrage
