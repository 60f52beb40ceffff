#include "gbuffers/depth_trial.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x3.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <numbers>
#include <set>

#include "core/eigen.h"
#include "core/lists.h"

namespace umbrage {
namespace {

/// The value of a model that is linear in the image on flat surfaces: inverse depth, or depth in a parallel picture.
double linear_on_planes(const DepthModel& model, double stored, double ray) {
  const double depth = view_depth(model, stored, ray);
  return model.orthographic ? depth : 1.0 / depth;
}

/// Slopes below this fraction of the value are rounding errors of floats.
constexpr double kRoundedSlope = 1e-5;

/// What a model gives at a cell.
struct Local {
  glm::dvec3 normal{0.0};
  double curvature = 1e9;  ///< second differences over first ones
};

/// As local_at, for a panorama. On a plane n.p = -k, a point at p = direction / value has value = direction.n / -k.
Local local_in_panorama(const Cell& cell, int reach, const PixelGrid& grid) {
  const auto direction = [&](int dx, int dy) { return grid.direction(cell.x + dx * reach, cell.y + dy * reach); };
  const auto value = [&](Tap tap) { return 1.0 / cell.stored[tap]; };
  const glm::dvec3 l = direction(-1, 0), r = direction(1, 0), a = direction(0, -1), b = direction(0, 1);
  const double across = value(kRight) - value(kLeft), up = value(kAbove) - value(kBelow), c = value(kCenter);
  const glm::dvec3 m =
      glm::inverse(glm::transpose(glm::dmat3(direction(0, 0), r - l, a - b))) * glm::dvec3(c, across, up);
  Local local;
  local.curvature = (std::abs(glm::dot(m, l + r) - value(kLeft) - value(kRight)) +
                     std::abs(glm::dot(m, a + b) - value(kAbove) - value(kBelow))) /
                    (std::abs(across) + std::abs(up) + kRoundedSlope * std::abs(c));
  const double length = glm::length(m);
  if (length > 0.0 && std::isfinite(length)) local.normal = -m / length;
  return local;
}

Local local_at(const Cell& cell, int reach, const DepthModel& model, const PixelGrid& grid) {
  if (model.panorama) return local_in_panorama(cell, reach, grid);
  const auto value = [&](Tap tap, int dx, int dy) {
    return linear_on_planes(model, cell.stored[tap], grid.ray(cell.x + dx * reach, cell.y + dy * reach));
  };
  const double c = value(kCenter, 0, 0), l = value(kLeft, -1, 0), r = value(kRight, 1, 0), a = value(kAbove, 0, -1),
               b = value(kBelow, 0, 1);
  const double across = (r - l) / (2.0 * reach * grid.step_x), up = (a - b) / (2.0 * reach * grid.step_y);
  Local local;
  local.curvature = (std::abs(l - 2.0 * c + r) + std::abs(a - 2.0 * c + b)) /
                    (std::abs(r - l) + std::abs(a - b) + kRoundedSlope * std::abs(c));
  // On a plane n.p = -k the inverse depth is (n.x u + n.y v - n.z) / -k.
  const double u = grid.u(cell.x), v = grid.v(cell.y);
  const glm::dvec3 m =
      model.orthographic ? glm::dvec3(across, up, 1.0) : -glm::dvec3(across, up, across * u + up * v - c);
  const double length = glm::length(m);
  if (length > 0.0 && std::isfinite(length)) local.normal = m / length;
  return local;
}

/// Returns the number of a bin of directions.
long bin_of(const glm::dvec3& n) {
  constexpr int kSteps = 3;  // bins per unit of a component
  constexpr long kSide = 2 * kSteps + 1;
  return (std::lround(n.x * kSteps) * kSide + std::lround(n.y * kSteps)) * kSide + std::lround(n.z * kSteps);
}

/// The logarithms of the min and max half height of a camera's window.
using LogRange = std::pair<double, double>;

LogRange angles() {
  return {std::log(std::tan(4.0 * std::numbers::pi / 180.0)), std::log(std::tan(62.0 * std::numbers::pi / 180.0))};
}

/// The half heights that are tried for an orthographic camera, by the range of depths that it sees; a range of 0 if
/// there is none.
LogRange heights(const Cells& cells, const DepthModel& model) {
  constexpr double kMinHeight = 0.05, kMaxHeight = 20.0;  // half height over range of depth
  std::vector<double> depths;
  for (const Cell& cell : cells.cells) depths.push_back(view_depth(model, cell.stored[kCenter], 1.0));
  const double range = depths.empty() ? 0.0 : quantile(depths, 0.98) - quantile(depths, 0.02);
  if (!(range > 0.0 && std::isfinite(range))) return {0.0, 0.0};
  return {std::log(kMinHeight * range), std::log(kMaxHeight * range)};
}

}  // namespace

Cells Cells::some(std::size_t count) const {
  Cells out = *this;
  if (cells.size() <= count) return out;
  out.cells.clear();
  for (std::size_t k = 0; k < count; ++k) out.cells.push_back(cells[k * cells.size() / count]);
  return out;
}

int Cells::directions() const {
  std::set<long> bins;
  if (have_normals)
    for (const Cell& cell : cells) bins.insert(bin_of(cell.normal));
  return int(bins.size());
}

Cells Cells::balanced(std::size_t count) const {
  if (!have_normals) return some(count);
  std::map<long, std::vector<const Cell*>> bins;
  for (const Cell& cell : cells) bins[bin_of(cell.normal)].push_back(&cell);
  // Of one direction not more than these are different, and they are at most a part of all if that leaves enough:
  // directions of few cells may be errors at edges.
  constexpr std::size_t kMost = 125, kEnough = 40, kPart = 4;
  std::size_t most = kMost;
  const auto shares = [&] {
    std::size_t sum = 0;
    for (const auto& [bin, members] : bins) sum += std::min(members.size(), most);
    return sum;
  };
  while (most > kEnough && kPart * most > shares()) most -= most / 8;
  Cells out = *this;
  out.cells.clear();
  for (const auto& [bin, members] : bins) {
    const std::size_t taken = count * std::min(members.size(), most) / shares() + 1;
    for (std::size_t k = 0; k < taken; ++k) out.cells.push_back(*members[k * members.size() / taken]);
  }
  return out;
}

RebuiltNormals rebuild_normals(const Cells& cells, const DepthModel& model, const Camera& camera) {
  constexpr double kEdge = 0.6;    // quantile of curvature above which a cell is at an edge
  constexpr double kExact = 3e-3;  // curvature below which differences are exact
  const PixelGrid grid(camera, cells.width, cells.height);
  RebuiltNormals out;
  std::vector<Local> locals;
  std::vector<double> curvatures;
  for (const Cell& cell : cells.cells) {
    locals.push_back(local_at(cell, cells.reach, model, grid));
    const double curvature = locals.back().curvature;
    curvatures.push_back(std::isfinite(curvature) ? curvature : 1e9);
  }
  const double limit = quantile(curvatures, kEdge);
  out.flatness = curvatures.empty() ? 1e9 : quantile(curvatures, 0.5);
  for (std::size_t k = 0; k < locals.size(); ++k) {
    if (curvatures[k] > limit || locals[k].normal == glm::dvec3(0.0) || cells.cells[k].normal == glm::dvec3(0.0))
      continue;
    out.pairs.from.push_back(cells.cells[k].normal);
    out.pairs.to.push_back(locals[k].normal);
    out.pairs.weights.push_back(1.0 / (curvatures[k] * curvatures[k] + kExact * kExact));
  }
  return out;
}

bool RebuiltNormals::have_one_direction() const {
  constexpr double kSpread = 0.01;  // mean square of the components across the main direction
  SymmetricMatrix<3> sums{};
  for (const glm::dvec3& n : pairs.from)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sums[std::size_t(i)][std::size_t(j)] += n[i] * n[j];
  return pairs.size() > 0 && eigen_of(sums).values[1] < kSpread * double(pairs.size());
}

double RebuiltNormals::bias_deg(const glm::dmat3& matrix) const {
  constexpr double kBeside = 0.85;  // cosine of the angle within which directions are averaged: that of coarse facets
  std::map<long, std::pair<glm::dmat2x3, std::size_t>> bins;  // sums of mapped and of rebuilt normals, and their number
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    auto& [sums, count] = bins.try_emplace(bin_of(pairs.from[k]), glm::dmat2x3(0.0), 0).first->second;
    sums += glm::dmat2x3(matrix * pairs.from[k], pairs.to[k]);
    ++count;
  }
  std::vector<double> angles;
  for (const auto& [key, bin] : bins) {
    glm::dmat2x3 sums(0.0);
    for (const auto& [other_key, other] : bins)
      if (glm::dot(glm::normalize(bin.first[0]), glm::normalize(other.first[0])) > kBeside) sums += other.first;
    const double angle = std::atan2(glm::length(glm::cross(sums[0], sums[1])), glm::dot(sums[0], sums[1]));
    angles.insert(angles.end(), bin.second, angle * 180.0 / std::numbers::pi);
  }
  return quantile(std::move(angles), 0.5);
}

Trial try_depth(const Cells& cells, const DepthModel& model, const Camera& camera) {
  Trial trial{model, camera, {}, 1e9};
  trial.model.orthographic = camera.projection == Projection::kOrthographic;
  const RebuiltNormals rebuilt = rebuild_normals(cells, trial.model, camera);
  trial.flatness = rebuilt.flatness;
  if (cells.have_normals) trial.normals = fit_directions(rebuilt.pairs, true);
  return trial;
}

bool is_panorama(const Cells& cells, const Trial& best) {
  constexpr double kMaxScore_deg = 5.0, kMaxFlatness = 0.1;  // of what fits at all
  if (cells.width != 2 * cells.height) return false;
  DepthModel model;
  model.panorama = true;
  const Trial trial = try_depth(cells, model, best.camera);
  return is_much_better(cells, trial, best) &&
         (cells.have_normals ? trial.normals.score_deg < kMaxScore_deg : trial.flatness < kMaxFlatness);
}

Camera symmetric_camera(double half_height, double aspect, Projection projection) {
  Camera camera;
  camera.projection = projection;
  camera.top = float(half_height);
  camera.bottom = -camera.top;
  camera.right = float(half_height * aspect);
  camera.left = -camera.right;
  return camera;
}

Trial try_cameras(const Cells& cells, const DepthModel& model, double aspect, Projection projection, bool& is_clear) {
  constexpr std::size_t kCoarse = 400;  // cells of the first trials
  constexpr int kMinSteps = 16, kRefinements = 14;
  constexpr double kMaxStep = 0.25;  // in logarithm
  const auto [min_log, max_log] = projection == Projection::kOrthographic ? heights(cells, model) : angles();
  is_clear = false;
  if (min_log == max_log) return try_depth(cells, model, symmetric_camera(1.0, aspect, projection));
  const int steps = std::max(kMinSteps, int((max_log - min_log) / kMaxStep) + 1);
  const Cells few = cells.some(kCoarse);
  const auto cost = [&](const Trial& trial) { return cells.have_normals ? trial.normals.squares : trial.flatness; };
  const auto at = [&](const Cells& used, double log_height) {
    return try_depth(used, model, symmetric_camera(std::exp(log_height), aspect, projection));
  };
  double best_log = min_log, best_cost = 1e300;
  const double step = (max_log - min_log) / (steps - 1);
  for (int k = 0; k < steps; ++k) {
    const double log_height = min_log + k * step, c = cost(at(few, log_height));
    if (c < best_cost) best_cost = c, best_log = log_height;
  }
  // Golden section search around the best.
  const double ratio = (std::sqrt(5.0) - 1.0) / 2.0;
  double low = best_log - step, high = best_log + step;
  double x1 = high - ratio * (high - low), x2 = low + ratio * (high - low);
  double c1 = cost(at(cells, x1)), c2 = cost(at(cells, x2));
  for (int k = 0; k < kRefinements; ++k) {
    if (c1 < c2) {
      high = x2, x2 = x1, c2 = c1;
      x1 = high - ratio * (high - low);
      c1 = cost(at(cells, x1));
    } else {
      low = x1, x1 = x2, c1 = c2;
      x2 = low + ratio * (high - low);
      c2 = cost(at(cells, x2));
    }
  }
  const double found = (low + high) / 2.0;
  const Trial best = at(cells, found);
  constexpr double kBeside = 0.15, kRise = 1.15;  // a change of the angle by this factor must raise the error
  const auto error = [&](const Trial& trial) { return cells.have_normals ? trial.normals.median_deg : trial.flatness; };
  is_clear = std::min(error(at(cells, found - kBeside)), error(at(cells, found + kBeside))) > kRise * error(best) &&
             found > min_log && found < max_log;
  return best;
}

bool is_much_better(const Cells& cells, const Trial& other, const Trial& prior) {
  constexpr double kBetterNormals = 0.7, kSlack_deg = 0.05, kBetterFlatness = 0.4;
  if (cells.have_normals) return other.normals.score_deg < kBetterNormals * prior.normals.score_deg - kSlack_deg;
  return other.flatness < kBetterFlatness * prior.flatness;
}

}  // namespace umbrage
