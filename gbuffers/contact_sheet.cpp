#include "gbuffers/contact_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/color.h"
#include "core/lists.h"
#include "gbuffers/depth_values.h"
#include "gbuffers/fit.h"
#include "gbuffers/roles.h"

namespace umbrage {
namespace {

constexpr int kCellWidth = 240, kGap = 6;  // pixels
constexpr std::array<float, 3> kNothing = {0.05f, 0.05f, 0.2f};
constexpr float kBetween = 0.5f;  // grey between the cells

/// One cell: three planes of display values.
struct SheetCell {
  int width = 0, height = 0;
  std::array<std::vector<float>, 3> values;
};

/// Returns the plane at a smaller size: the mean of each block, without values that are no lengths.
std::vector<float> shrunk(const Plane& plane, int width, int height) {
  std::vector<float> out;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int x0 = int(long(x) * plane.width / width), x1 = std::max(x0 + 1, int(long(x + 1) * plane.width / width));
      const int y0 = int(long(y) * plane.height / height);
      const int y1 = std::max(y0 + 1, int(long(y + 1) * plane.height / height));
      double sum = 0.0;
      int count = 0;
      for (int row = y0; row < y1; ++row)
        for (int column = x0; column < x1; ++column)
          if (const float v = plane.at(column, row); !is_never_depth(v)) sum += v, ++count;
      out.push_back(count > 0 ? float(sum / count) : plane.at(x0, y0));
    }
  return out;
}

/// Maps values to 0..1 for display.
class DisplayMap {
 public:
  DisplayMap(const std::vector<std::vector<float>>& channels, const Channel& first, bool is_color, bool is_vector)
      : is_color_(is_color), is_srgb_(first.is_srgb) {
    std::vector<double> finite;
    for (const auto& channel : channels)
      for (const float v : channel)
        if (!is_never_depth(v) && (is_color || is_vector || v != 0.0f)) finite.push_back(v);
    constexpr double kOutliers = 0.01;
    low_ = quantile(finite, kOutliers);
    high_ = quantile(finite, 1.0 - kOutliers);
    constexpr double kUnit = 1.05;
    if (is_vector && low_ > -kUnit && high_ < kUnit) low_ = low_ < 0.0 ? -1.0 : 0.0, high_ = 1.0;
    if (is_color && first.max_integer > 0.0) low_ = 0.0, high_ = first.max_integer;
    if (is_color && first.max_integer == 0.0) low_ = 0.0, high_ = std::clamp(high_, 1e-6, 1.0);
    if (!is_color && !is_vector) std::swap(low_, high_);
  }
  float operator()(float v) const {
    const auto t = float(std::clamp((v - low_) / (high_ == low_ ? 1.0 : high_ - low_), 0.0, 1.0));
    return is_color_ && !is_srgb_ ? srgb_from_linear(t) : t;
  }

 private:
  double low_ = 0.0, high_ = 1.0;
  bool is_color_, is_srgb_;
};

Result<SheetCell> draw_cell(const LayeredFile& header, const ChannelGroup& group) {
  std::vector<int> used = group.channels;
  if (used.size() > 3) used.resize(3);
  const auto image = read_channels(header, used);
  if (!image) return image.error();
  SheetCell cell;
  cell.width = std::min(kCellWidth, header.width);
  cell.height = std::max(1, int(std::lround(double(cell.width) * header.height / header.width)));
  std::vector<std::vector<float>> channels;
  for (const Plane& plane : image->planes) channels.push_back(shrunk(plane, cell.width, cell.height));
  const bool is_vector = !group.is_color && channels.size() == 3;
  const DisplayMap map(channels, header.channels[std::size_t(used[0])], group.is_color, is_vector);
  const bool is_length = channels.size() == 1;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& from = channels[std::min(c, channels.size() - 1)];
    for (const float v : from)
      cell.values[c].push_back(std::isfinite(v) && !(is_length && is_never_depth(v)) ? map(v) : kNothing[c]);
  }
  return cell;
}

}  // namespace

Result<ContactSheet> draw_contact_sheet(const GBufferSettings& settings) {
  ContactSheet sheet;
  std::vector<SheetCell> cells;
  for (const RoleFile& file : role_files(settings)) {
    const auto header = read_header(file.path);
    if (!header) return header.error();
    for (const ChannelGroup& group : groups_of(*header, 0)) {
      auto cell = draw_cell(*header, group);
      if (!cell) return cell.error();
      cells.push_back(std::move(*cell));
      sheet.layers.push_back(group.name + (group.view.empty() ? "" : ", view " + group.view));
    }
  }
  if (cells.empty()) return file_error("there is no layer to draw");
  int width = 1, height = 1;
  for (const SheetCell& cell : cells) width = std::max(width, cell.width), height = std::max(height, cell.height);
  sheet.columns = int(std::ceil(std::sqrt(double(cells.size()) * height / width)));
  sheet.columns = std::clamp(sheet.columns, 1, int(cells.size()));
  const int rows = (int(cells.size()) + sheet.columns - 1) / sheet.columns;
  sheet.picture = Image(sheet.columns * (width + kGap) + kGap, rows * (height + kGap) + kGap);
  for (std::size_t c = 0; c < 3; ++c) {
    constexpr const char* kNames[] = {"color.r", "color.g", "color.b"};
    Plane& plane = sheet.picture.add(kNames[c]) = Plane(sheet.picture.width, sheet.picture.height, kBetween);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const int left = kGap + int(k) % sheet.columns * (width + kGap),
                top = kGap + int(k) / sheet.columns * (height + kGap);
      for (int y = 0; y < cells[k].height; ++y)
        std::copy_n(cells[k].values[c].begin() + long(y) * cells[k].width, cells[k].width, plane.row(top + y) + left);
    }
  }
  return sheet;
}

}  // namespace umbrage
