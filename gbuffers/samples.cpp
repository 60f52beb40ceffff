#include "gbuffers/samples.h"

#include <algorithm>
#include <cmath>

namespace umbrage {

const TapValues* Samples::find(Role role, std::size_t channel) const {
  const std::string plane = raw_plane(role, channel);
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == plane) return &values[k];
  return nullptr;
}

std::array<const TapValues*, 3> Samples::find_three(Role role) const {
  return {find(role, 0), find(role, 1), find(role, 2)};
}

Result<Samples> sample(const RawPlanes& raw, int reach, int count) {
  return sample(
      raw.width(), raw.height(), [&](const Rows& rows) { return raw.rows(rows); }, reach, count);
}

Result<Samples> sample(int width, int height, const RowsOf& rows_of, int reach, int count) {
  Samples out;
  out.width = width;
  out.height = height;
  out.reach = std::min({reach, (out.width - 1) / 2, (out.height - 1) / 2});
  const int step = std::max(1, int(std::ceil(std::sqrt(double(out.width) * out.height / count))));
  for (int y = out.reach; y < out.height - out.reach; y += step) {
    const auto rows = rows_of({y - out.reach, y + out.reach + 1});
    if (!rows) return rows.error();
    if (out.names.empty()) {
      out.names = rows->names;
      out.values.resize(rows->names.size());
    }
    const int row = y - rows->first, r = out.reach;
    for (int x = out.reach; x < out.width - out.reach; x += step) {
      out.x.push_back(x);
      out.y.push_back(y);
    }
    for (std::size_t k = 0; k < rows->planes.size(); ++k) {
      const Plane& plane = *rows->planes[k];
      auto& taps = out.values[k];
      for (int x = out.reach; x < out.width - out.reach; x += step) {
        taps[kCenter].push_back(plane.at(x, row));
        taps[kLeft].push_back(plane.at(x - r, row));
        taps[kRight].push_back(plane.at(x + r, row));
        taps[kAbove].push_back(plane.at(x, row - r));
        taps[kBelow].push_back(plane.at(x, row + r));
      }
    }
  }
  return out;
}

}  // namespace umbrage
