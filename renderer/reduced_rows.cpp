#include "renderer/reduced_rows.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/color.h"

namespace umbrage {
namespace {

/// How the pixels of a block become one.
enum class Reduced { kMean, kMeanOfLight, kMiddle };

Reduced reduced_by(std::string_view plane, bool is_srgb) {
  const std::string_view name = name_on_first_layer(plane);
  const std::string_view group = name.substr(0, name.find('.'));
  for (const std::string_view geometry : {"depth", "normal", "object_id", "material_id", "shininess", "roughness"})
    if (group == geometry) return Reduced::kMiddle;
  return group == "color" && is_srgb && name != "color.a" ? Reduced::kMeanOfLight : Reduced::kMean;
}

/// Adds up rows until a row of blocks is complete.
class Reducer {
 public:
  Reducer(int factor, bool is_srgb, TakeRows take) : factor_(factor), is_srgb_(is_srgb), take_(std::move(take)) {}

  Result<void> add(const PictureInfo& info, const Image& rows) {
    const PictureInfo reduced = reduced_picture_info(info, factor_);
    const int width = reduced.inner_width(), height = reduced.inner_height();
    const int complete = std::min((row_ + rows.height) / factor_, height) - std::min(row_ / factor_, height);
    Image finished(width, complete);
    for (const std::string& name : rows.names) finished.add(name) = Plane(width, complete);
    if (sums_.empty()) sums_.assign(rows.names.size(), std::vector<double>(std::size_t(width)));
    if (weights_.empty()) weights_.assign(std::size_t(width), 0.0);
    const int first = row_ / factor_;
    for (int y = 0; y < rows.height; ++y, ++row_) {
      if (row_ / factor_ >= height) continue;
      add_row(rows, y);
      if (row_ % factor_ == factor_ - 1) finish_row(rows.names, row_ / factor_ - first, finished);
    }
    return complete > 0 ? take_(reduced, finished, first) : Result<void>();
  }

 private:
  void add_row(const Image& rows, int y) {
    const Plane* alpha = rows.find("color.a");
    has_alpha_ = alpha != nullptr;
    const int width = int(weights_.size()), middle = factor_ / 2;
    for (std::size_t k = 0; k < rows.names.size(); ++k) {
      const Reduced by = reduced_by(rows.names[k], is_srgb_);
      const bool weighed = is_weighed(rows.names[k]);
      const float* values = rows.planes[k].row(y);
      for (int x = 0; x < width; ++x) {
        double& sum = sums_[k][std::size_t(x)];
        if (by == Reduced::kMiddle) {
          if (row_ % factor_ == middle) sum = values[x * factor_ + middle];
          continue;
        }
        for (int i = x * factor_; i < (x + 1) * factor_; ++i) {
          const float value = by == Reduced::kMeanOfLight ? linear_from_srgb(values[i]) : values[i];
          sum += double(value) * (weighed ? double(alpha->at(i, y)) : 1.0);
        }
      }
    }
    if (alpha)
      for (int x = 0; x < width; ++x)
        for (int i = x * factor_; i < (x + 1) * factor_; ++i) weights_[std::size_t(x)] += double(alpha->at(i, y));
  }

  void finish_row(const std::vector<std::string>& names, int to, Image& finished) {
    const double count = double(factor_) * factor_;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const Reduced by = reduced_by(names[k], is_srgb_);
      const bool weighed = is_weighed(names[k]);
      for (std::size_t x = 0; x < weights_.size(); ++x) {
        const double of = by == Reduced::kMiddle ? 1.0 : weighed ? weights_[x] : count;
        const auto mean = float(of > 0.0 ? sums_[k][x] / of : 0.0);
        finished.planes[k].at(int(x), to) = by == Reduced::kMeanOfLight ? srgb_from_linear(mean) : mean;
        sums_[k][x] = 0.0;
      }
    }
    std::fill(weights_.begin(), weights_.end(), 0.0);
  }

  bool is_weighed(std::string_view name) const { return has_alpha_ && name.starts_with("color.") && name != "color.a"; }

  const int factor_;
  const bool is_srgb_;
  const TakeRows take_;
  int row_ = 0;  // rows received
  bool has_alpha_ = false;
  std::vector<std::vector<double>> sums_;  // of the current row of blocks, by plane
  std::vector<double> weights_;            // of that, the sums of alpha
};

}  // namespace

PictureInfo reduced_picture_info(PictureInfo info, int factor) {
  info.width = info.inner_width() / factor;
  info.height = info.inner_height() / factor;
  info.guard = 0;
  return info;
}

TakeRows reduced_rows(int factor, const Recipe& recipe, const TakeRows& take) {
  if (factor == 1) return take;
  const bool is_srgb = params_of<OutputParams>(recipe.settings).transfer == kTransferSrgb;
  const auto reducer = std::make_shared<Reducer>(factor, is_srgb, take);
  return [reducer](const PictureInfo& info, const Image& rows, int) { return reducer->add(info, rows); };
}

}  // namespace umbrage
