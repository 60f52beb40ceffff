// Averaged pictures: which planes are averaged, and the lines drawn over the average. Internal to renderer/.
#pragma once
#include <string>
#include <vector>

#include "renderer/accumulation.h"
#include "renderer/blend.h"
#include "renderer/plan.h"
#include "renderer/times.h"

namespace umbrage {

/// averaged_planes returns the planes that are averaged; averaged_picture returns those of the
/// picture, `color`, `beauty`, both or none; other_averaged_planes the others.
std::vector<std::string> averaged_planes(const Plan& plan);
std::vector<std::string> averaged_picture(const Plan& plan);
std::vector<std::string> other_averaged_planes(const Plan& plan);

/// Returns the planes of sample 0 from which `output` draws the lines.
std::vector<std::string> line_planes(const Plan& plan);

/// The average of the samples of a plan, of all rows of the picture or of some, while they are drawn. A sample with
/// blended surfaces is the sum of two pictures; the rows of the one in front are added before those of the one behind.
/// Rows are those without the guard band.
class Average {
 public:
  /// An average of nothing.
  Average() = default;
  /// `marks`: the pixels of `rows` to which further samples are added, if the plan has marked samples.
  Average(const Device& device, const Plan& plan, const Rows& rows, Plane marks = {});

  /// Returns the planes that `add` takes of the picture to which a plan is set.
  static std::vector<std::string> planes_of(const Plan& plan);
  /// Adds rows of the picture to which a plan is set; `first`: index of the first row.
  void add(const Plan& plan, Image rows, int first);
  /// Adds a drawn picture, or strip of it. `begin`: its first row, guard band included.
  Result<void> add(Device& device, const Plan& plan, const Frame& frame, int begin);

  /// See accumulation.h.
  void count_as_one() { umbrage::count_as_one(sum_); }
  void repeat_mean(int first) { umbrage::repeat_mean(sum_, first); }
  /// See BlendedSample.
  void join_lines(Image& rows, int first) const { blended_.join_lines(rows, first); }
  /// Returns the sum of these rows.
  PictureSum sum_of(int first, int count) const { return rows_of(sum_, first, count); }
  /// Takes the sum of all rows out of the average.
  PictureSum take_sum() { return std::move(sum_); }

 private:
  PictureSum sum_;
  BlendedSample blended_;  // of sample 0 in the end
};

/// Returns the finished planes of an average: the picture, as color.r, .g, .b and .a or beauty.r and so on, and the
/// other means. `lines`: the line_planes of sample 0. `info`: properties of a picture that has the size of the sum.
Result<Image> finished_average(Device& device, PictureSum total, const Plan& plan, const Image& lines,
                               const PictureInfo& info);

/// Stores the finished planes in `frame`, the frame of sample 0, and joins its lines with those of blended surfaces.
Result<void> finish_average(Device& device, Average average, const Plan& plan, Frame& frame);

}  // namespace umbrage
