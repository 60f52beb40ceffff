#include "looks/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/check.h"

namespace umbrage {
namespace {

constexpr int kFull = kFullCover;
// Of 9 * 255, between means over 3 x 3 pixels, for lines a pixel wide or more. One of three pixels that one picture has
// right on them and another half a pixel aside differs by 383 once that is moved.
constexpr int kDisputed = 390;
// What of a line a pixel wide or more is part of it when ends are counted: tips that taper end where they are a quarter
// as dark.
constexpr int kInk = kFull / 4;
// A free end is as bad as so many squares of a line's width in which a picture differs from the others: a gap of four
// widths is closed if but one of four pictures does, and strokes of up to about 12 widths that two of four have go.
constexpr double kEnd = 4.0;
// So many free ends is a hole that lines close: tangles of crumbs have many.
constexpr double kHole = 0.25;
// Lines of two pictures together close gaps that each has elsewhere. So many free ends more than one picture they count
// as, and where they have no fewer than each one they are not taken. Of more pictures there would be too many pairs.
constexpr double kPair = 0.5;
constexpr int kMostPaired = 6;
// What counts more: lines that others have, than those that they have not. At 1 to 1 the greyest picture won at folds
// that are a rim here and a crease there, and ridges were lost that two of four have; at 3 to 1 ticks stayed on lines.
constexpr int kMissing = 3, kExcess = 2;
constexpr int kAround = 2;                               // rows and columns that one pixel's dispute looks at
constexpr float kBesideLine = 1.5f, kHalfOfLine = 0.5f;  // pixels, and widths, around a disputed pixel that are, too

constexpr int kOne = 128;  // of a weight

/// Samples of a picture's rows at the pixels' centres, which lie between its own.
struct Between {
  int top, left;      // from a centre to the sample above it on its left, in rows and columns
  float down, right;  // from that sample to the centre, 0 to 1
};

Between between(const LinePicture& picture) {
  const float down = -picture.offset.y, right = -picture.offset.x;
  const int top = int(std::floor(down)), left = int(std::floor(right));
  return {top, left, down - float(top), right - float(left)};
}

/// Weights of four samples in a row, the second of which is so far before a place: a cubic through them all
/// [Catmull and Rom 1974], which keeps lines sharp.
std::array<int, 4> cubic(float t) {
  const auto whole = [](float weight) { return int(std::lround(weight * float(kOne))); };
  const int before = whole(((-0.5f * t + 1.0f) * t - 0.5f) * t), after = whole(((-1.5f * t + 2.0f) * t + 0.5f) * t);
  const int last = whole((0.5f * t - 0.5f) * t * t);
  return {before, kOne - before - after - last, after, last};
}

/// Row y of a picture, moved to the pixels' centres; beyond its borders is what is at them. kAround more values before
/// the row and after it. Bilinear: two pictures of one edge differ by no more than their samples do.
void moved_row(const LinePicture& picture, int width, int height, int y, std::vector<std::int32_t>& blended,
               std::int16_t* out) {
  const Between at = between(picture);
  const int lower = int(std::lround(at.down * kOne)), more = int(std::lround(at.right * kOne)), left = at.left;
  const auto row = [&](int k) { return picture.cover.data() + std::size_t(std::clamp(k, 0, height - 1)) * width; };
  const std::uint8_t *above = row(y + at.top), *below = row(y + at.top + 1);
  const int count = width + 2 * kAround,
            before = std::max(kAround - left, 0);  // values before the picture's first pixel
  blended.resize(std::size_t(count) + 1);
  const int first = std::max(left - kAround, 0), end = std::min(width, count + 1 - kAround + left);
  for (int x = first; x < end; ++x) blended[x + kAround - left] = above[x] * (kOne - lower) + below[x] * lower;
  std::fill_n(blended.begin(), std::min(before, count + 1), above[0] * (kOne - lower) + below[0] * lower);
  const int after = end + kAround - left;
  std::fill(blended.begin() + after, blended.end(), above[width - 1] * (kOne - lower) + below[width - 1] * lower);
  const std::int32_t* in = blended.data();
  for (int x = 0; x < count; ++x)
    out[x] = std::int16_t((in[x] * (kOne - more) + in[x + 1] * more + kOne * kOne / 2) / (kOne * kOne));
}

/// The same of columns first to end of the row, by cubics, no value more: what is drawn of one picture is as sharp as
/// the mean of all beside it.
void sharp_row(const LinePicture& picture, int width, int height, int y, int first, int end,
               std::vector<std::int32_t>& blended, std::int16_t* out) {
  constexpr int kTaps = 4;
  const Between at = between(picture);
  const std::array<int, 4> lower = cubic(at.down), more = cubic(at.right);
  std::array<const std::uint8_t*, kTaps> rows;
  for (int k = 0; k < kTaps; ++k)
    rows[k] = picture.cover.data() + std::size_t(std::clamp(y + at.top - 1 + k, 0, height - 1)) * width;
  const int count = end - first + kTaps - 1;
  blended.resize(std::size_t(count));
  for (int i = 0; i < count; ++i) {
    const int x = std::clamp(first + at.left - 1 + i, 0, width - 1);
    blended[i] = 0;
    for (int k = 0; k < kTaps; ++k) blended[i] += rows[k][x] * lower[k];
  }
  for (int i = 0; i < end - first; ++i) {
    int sum = kOne * kOne / 2;
    for (int k = 0; k < kTaps; ++k) sum += blended[i + k] * more[k];
    out[i] = std::int16_t(std::clamp(sum, 0, kFull * kOne * kOne) / (kOne * kOne));
  }
}

/// A stretch of a row.
struct Run {
  int y, begin, end;
};

/// Runs of all rows, which join those that they touch, also at a corner.
class Runs {
 public:
  explicit Runs(int height) { first_.reserve(std::size_t(height) + 1); }

  void begin_row() { first_.push_back(int(runs_.size())); }
  void add(int y, int begin, int end) {
    runs_.push_back({y, begin, end});
    parent_.push_back(int(parent_.size()));
  }
  /// After the last row: joins them.
  void join() {
    first_.push_back(int(runs_.size()));
    touches_.assign(runs_.size(), 0);
    for (std::size_t y = 1; y + 1 < first_.size(); ++y) {
      int above = first_[y - 1];
      for (int here = first_[y]; here < first_[y + 1]; ++here) {
        while (above < first_[y] && runs_[above].end < runs_[here].begin) ++above;
        for (int k = above; k < first_[y] && runs_[k].begin <= runs_[here].end; ++k) {
          unite(k, here);
          ++touches_[here];
        }
      }
    }
  }
  int size() const { return int(runs_.size()); }
  const Run& operator[](int k) const { return runs_[k]; }
  /// How many runs of the row above it joins. Joined runs have so many holes between: the sum of these, less the number
  /// of runs, and 1.
  int touches(int k) const { return touches_[k]; }
  /// The same number for all that are joined.
  int root(int k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  /// The run of row y that has column x.
  int at(int y, int x) const {
    const auto end = runs_.begin() + first_[y + 1];
    const auto after =
        std::upper_bound(runs_.begin() + first_[y], end, x, [](int a, const Run& r) { return a < r.end; });
    if (after == end || after->begin > x) fail_check("a place of a run is in none");
    return int(after - runs_.begin());
  }

 private:
  void unite(int a, int b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  std::vector<Run> runs_;
  std::vector<int> parent_, first_, touches_;
};

/// Appends the runs of a row of which `in` is true.
template <typename In>
void add_runs(Runs& runs, int y, int begin, int end, const In& in) {
  for (int x = begin; x < end; ++x) {
    if (!in(x)) continue;
    const int first = x;
    while (x < end && in(x)) ++x;
    runs.add(y, first, x);
  }
}

using Bytes = std::vector<std::uint8_t>;

/// The pixels that pictures disagree at.
class Dispute {
 public:
  Dispute(std::span<const LinePicture> pictures, int width, int height, float width_px)
      : pictures_(pictures),
        width_(width),
        height_(height),
        padded_(width + 2 * kAround),
        most_(int(float(kDisputed) * std::min(width_px, 1.0f))) {
    rows_.assign(pictures.size(), std::vector<std::int16_t>(std::size_t(padded_) * kKept));
    means_ = rows_;
    sums_.resize(padded_);
  }

  Bytes pixels() {
    Bytes disputed(std::size_t(width_) * height_, 0);
    // Of the means: the most and the least of all pictures; and the least of each one's most nearby, and the reverse.
    std::vector<std::int16_t> most(width_), least(width_), most_near(width_), least_near(width_);
    std::vector<std::int16_t> low(padded_), high(padded_);
    for (int y = -kAround; y < height_ + kAround; ++y) {
      for (std::size_t k = 0; k < pictures_.size(); ++k) take_row(k, y);
      const int here = y - kAround;
      if (here < 0) continue;
      std::fill(most.begin(), most.end(), std::int16_t(0));
      std::fill(most_near.begin(), most_near.end(), std::int16_t(0));
      std::fill(least.begin(), least.end(), kMostSum);
      std::fill(least_near.begin(), least_near.end(), kMostSum);
      for (std::size_t k = 0; k < pictures_.size(); ++k) {
        const std::int16_t *a = mean_row(k, here - 1), *b = mean_row(k, here), *c = mean_row(k, here + 1);
        for (int x = 0; x < width_ + 2; ++x) low[x] = std::min(a[x], std::min(b[x], c[x]));
        for (int x = 0; x < width_ + 2; ++x) high[x] = std::max(a[x], std::max(b[x], c[x]));
        const std::int16_t *l = low.data(), *h = high.data();
        for (int x = 0; x < width_; ++x) most[x] = std::max(most[x], b[x + 1]);
        for (int x = 0; x < width_; ++x) least[x] = std::min(least[x], b[x + 1]);
        for (int x = 0; x < width_; ++x)
          most_near[x] = std::max(most_near[x], std::min(l[x], std::min(l[x + 1], l[x + 2])));
        for (int x = 0; x < width_; ++x)
          least_near[x] = std::min(least_near[x], std::max(h[x], std::max(h[x + 1], h[x + 2])));
      }
      // At the border all have what is there, wherever their samples are: none tells of what is beyond.
      if (here < kAround || here >= height_ - kAround) continue;
      std::uint8_t* out = disputed.data() + std::size_t(here) * width_;
      for (int x = kAround; x < width_ - kAround; ++x)
        out[x] = std::max(most[x] - least_near[x], most_near[x] - least[x]) > most_;
    }
    return disputed;
  }

 private:
  static constexpr int kKept = 4;  // rows of a picture
  static constexpr std::int16_t kMostSum = 9 * kFull;

  std::int16_t* kept(std::vector<std::int16_t>& rows, int y) {
    return rows.data() + std::size_t((y + kKept) % kKept) * padded_;
  }
  /// Sums over 3 x 3 pixels, from column -1 on.
  const std::int16_t* mean_row(std::size_t k, int y) { return kept(means_[k], y); }

  void take_row(std::size_t k, int y) {
    moved_row(pictures_[k], width_, height_, y, blended_, kept(rows_[k], y));
    const std::int16_t *a = kept(rows_[k], y - 2), *b = kept(rows_[k], y - 1), *c = kept(rows_[k], y);
    for (int x = 0; x < padded_; ++x) sums_[x] = std::int16_t(a[x] + b[x] + c[x]);
    std::int16_t* out = kept(means_[k], y - 1);
    for (int x = 0; x < width_ + 2; ++x) out[x] = std::int16_t(sums_[x] + sums_[x + 1] + sums_[x + 2]);
  }

  std::span<const LinePicture> pictures_;
  int width_, height_, padded_;
  int most_;  // that pictures differ by without dispute
  std::vector<std::vector<std::int16_t>> rows_, means_;
  std::vector<std::int16_t> sums_;
  std::vector<std::int32_t> blended_;
};

/// All pixels no farther in either direction from those than `reach`.
Bytes widened(const Bytes& pixels, int width, int height, int reach) {
  Bytes wide(pixels.size(), 0);
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* row = pixels.data() + std::size_t(y) * width;
    for (int x = 0; x < width; ++x) {
      if (!row[x]) continue;
      const int begin = std::max(x - reach, 0);
      while (x < width && row[x]) ++x;
      const int count = std::min(x + reach, width) - begin;
      for (int j = std::max(y - reach, 0); j <= std::min(y + reach, height - 1); ++j)
        std::fill_n(wide.data() + std::size_t(j) * width + begin, count, std::uint8_t(1));
    }
  }
  return wide;
}

/// The pixels beside which, or beyond the picture's border, are others.
Bytes rim_of(const Bytes& pixels, const Runs& runs, int width, int height) {
  Bytes rim(pixels.size(), 0);
  const auto in = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height && pixels[std::size_t(y) * width + x];
  };
  for (int k = 0; k < runs.size(); ++k)
    for (int x = runs[k].begin; x < runs[k].end; ++x) {
      bool inside = true;
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) inside = inside && in(x + i, runs[k].y + j);
      rim[std::size_t(runs[k].y) * width + x] = !inside;
    }
  return rim;
}

/// What a picture has on the runs of places in dispute, one after the other.
std::vector<std::int16_t> cover_on(const LinePicture& picture, const Runs& places, int width, int height) {
  std::vector<std::int16_t> row(std::size_t(width) + 2 * kAround), cover;
  std::vector<std::int32_t> blended;
  std::size_t pixels = 0;
  for (int k = 0; k < places.size(); ++k) pixels += std::size_t(places[k].end - places[k].begin);
  cover.reserve(pixels);
  int there = -1;
  for (int k = 0; k < places.size(); ++k) {
    const Run& run = places[k];
    if (run.y != there) moved_row(picture, width, height, there = run.y, blended, row.data());
    cover.insert(cover.end(), row.begin() + kAround + run.begin, row.begin() + kAround + run.end);
  }
  return cover;
}

/// Adds to each place how many ends of lines are free there: a line that goes through it leaves it twice, what leaves
/// it once has one, and what lies within it two, or none if it closes.
void add_free_ends(const std::vector<std::int16_t>& cover, Runs& places, const Bytes& rim, int width, int height,
                   int ink, std::vector<double>& ends) {
  Runs lines(height), exits(height);
  std::vector<int> place_of_line;
  int k = 0;
  std::size_t before = 0;
  for (int y = 0; y < height; ++y) {
    lines.begin_row();
    exits.begin_row();
    for (; k < places.size() && places[k].y == y; ++k) {
      const Run& run = places[k];
      const auto own = [&](int x) { return cover[before + std::size_t(x - run.begin)]; };
      const std::uint8_t* edge = rim.data() + std::size_t(y) * width;
      add_runs(lines, y, run.begin, run.end, [&](int x) { return own(x) > ink; });
      add_runs(exits, y, run.begin, run.end, [&](int x) { return own(x) > ink && edge[x]; });
      place_of_line.resize(lines.size(), places.root(k));
      before += std::size_t(run.end - run.begin);
    }
  }
  lines.join();
  exits.join();
  std::vector<int> leaves(lines.size(), 0), holes(lines.size(), 1);
  for (int l = 0; l < lines.size(); ++l) holes[lines.root(l)] += lines.touches(l) - 1;
  for (int e = 0; e < exits.size(); ++e)
    if (exits.root(e) == e) ++leaves[lines.root(lines.at(exits[e].y, exits[e].begin))];
  for (int l = 0; l < lines.size(); ++l)
    if (lines.root(l) == l)
      ends[place_of_line[l]] += (leaves[l] > 0 || holes[l] == 0 ? std::max(2 - leaves[l], 0) : 0) + kHole * holes[l];
}

/// One picture, or two together.
struct Choice {
  int first, second;
};

/// Each of so many pictures, and each two of them.
std::vector<Choice> choices_of(int count) {
  std::vector<Choice> choices;
  for (int p = 0; p < count; ++p) choices.push_back({p, p});
  for (int p = 0; p < count && count <= kMostPaired; ++p)
    for (int q = 0; q < p; ++q) choices.push_back({p, q});
  return choices;
}

}  // namespace

Plane agreed_lines(std::span<const LinePicture> pictures, Plane mean, float opacity, float width_px) {
  const int width = mean.width, height = mean.height, count = int(pictures.size());
  check_less(kLeastThatAgree - 1, count, "pictures that are to agree");
  for (const LinePicture& picture : pictures)
    check_equal(picture.cover.size(), std::size_t(width) * height, "pixels of lines and of their mean");
  const int reach = int(std::ceil(kBesideLine + kHalfOfLine * width_px));
  const Bytes wide = widened(Dispute(pictures, width, height, width_px).pixels(), width, height, reach);
  Runs places(height);
  for (int y = 0; y < height; ++y) {
    places.begin_row();
    const std::uint8_t* row = wide.data() + std::size_t(y) * width;
    add_runs(places, y, 0, width, [&](int x) { return row[x] != 0; });
  }
  places.join();
  if (places.size() == 0) return mean;

  std::vector<std::vector<std::int16_t>> covers;
  for (const LinePicture& picture : pictures) covers.push_back(cover_on(picture, places, width, height));
  const std::vector<Choice> chosen = choices_of(count);
  const int choices = int(chosen.size());
  for (int p = count; p < choices; ++p) {
    covers.push_back(covers[chosen[p].first]);
    const std::vector<std::int16_t>& other = covers[chosen[p].second];
    for (std::size_t i = 0; i < other.size(); ++i) covers[p][i] = std::max(covers[p][i], other[i]);
  }
  std::vector<std::vector<double>> cost(choices, std::vector<double>(places.size(), 0.0));
  const int ink = int(float(kInk) * std::min(width_px, 1.0f));
  const Bytes rim = rim_of(wide, places, width, height);
  for (int p = 0; p < choices; ++p) add_free_ends(covers[p], places, rim, width, height, ink, cost[p]);
  for (int k = 0; k < places.size(); ++k) {
    double least = cost[0][k];
    for (int p = 1; p < count; ++p) least = std::min(least, cost[p][k]);
    for (int p = count; p < choices; ++p)
      cost[p][k] = cost[p][k] < least ? cost[p][k] + kPair : std::numeric_limits<double>::infinity();
    for (int p = 0; p < choices; ++p) cost[p][k] *= kEnd;
  }
  const double line = std::max(double(width_px), 1.0);
  const double share = 1.0 / (0.5 * (kExcess + kMissing) * kFull * (count - 1) * line * line);  // of each pair
  std::size_t at = 0;
  std::vector<int> apart(choices);
  for (int k = 0; k < places.size(); ++k) {
    std::fill(apart.begin(), apart.end(), 0);
    for (int x = places[k].begin; x < places[k].end; ++x, ++at)
      for (int p = 0; p < choices; ++p)
        for (int q = 0; q < count; ++q) {
          const int more = covers[p][at] - covers[q][at];
          apart[p] += more > 0 ? kExcess * more : -kMissing * more;
        }
    for (int p = 0; p < choices; ++p) cost[p][places.root(k)] += share * apart[p];
  }
  std::vector<std::int32_t> blended;
  std::vector<std::int16_t> row(width), other(width);
  for (int k = 0; k < places.size(); ++k) {
    const int place = places.root(k);
    int best = 0;
    for (int p = 1; p < choices; ++p)
      if (cost[p][place] < cost[best][place] || (p < count && cost[p][place] == cost[best][place])) best = p;
    const Run& run = places[k];
    const auto [first, second] = chosen[best];
    sharp_row(pictures[first], width, height, run.y, run.begin, run.end, blended, row.data());
    if (second != first) {
      sharp_row(pictures[second], width, height, run.y, run.begin, run.end, blended, other.data());
      for (int x = 0; x < run.end - run.begin; ++x) row[x] = std::max(row[x], other[x]);
    }
    for (int x = run.begin; x < run.end; ++x) mean.row(run.y)[x] = float(row[x - run.begin]) / kFull * opacity;
  }
  return mean;
}

}  // namespace umbrage
