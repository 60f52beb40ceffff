// Reads camera paths, and evaluates their curve: a cubic Hermite spline with the tangents of a Catmull-Rom spline whose
// knots are the times of the keys. Without times the knots are centripetal [Yuksel et al. 2011]: the curve has no loops
// between keys.
#include "scene/camera_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/lists.h"
#include "core/numbers.h"
#include "core/suggest.h"

namespace umbrage {
namespace {

constexpr std::array<std::string_view, 11> kColumns = {"position_x",    "position_y",    "position_z", "focal_point_x",
                                                       "focal_point_y", "focal_point_z", "up_x",       "up_y",
                                                       "up_z",          "view_angle",    "time"};
constexpr std::size_t kUp = 6, kAngle = 9;
constexpr std::size_t kMaxKeys = 1000000;
constexpr double kMinAngle_deg = 0.1, kMaxAngle_deg = 179.0;

using Row = std::map<std::string, double>;  // values by column

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t\r\"");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r\"") - begin + 1);
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream rest(line);
  for (std::string cell; std::getline(rest, cell, ',');) cells.push_back(trimmed(cell));
  return cells;
}

/// Checks the names of columns. Errors: kFile for an unknown name, one given twice, and one that is missing.
Result<void> check_columns(std::vector<std::string> names, const std::string& file) {
  for (const std::string& name : names) {
    if (!contains(kColumns, name))
      return file_error("'{}': there is no column '{}'{}", file, name, suggestion(name, kColumns));
    if (std::count(names.begin(), names.end(), name) > 1)
      return file_error("'{}': the column '{}' is there twice", file, name);
  }
  const bool has_up = contains(names, kColumns[kUp]);
  for (std::size_t k = 0; k < kAngle; ++k)
    if ((k < kUp || has_up) && !contains(names, kColumns[k]))
      return file_error("'{}': the column '{}' is missing; a path has {}", file, kColumns[k],
                        fmt::join(kColumns, ", "));
  return {};
}

Result<std::vector<Row>> rows_of_csv(std::istream& in, const std::string& file) {
  std::vector<Row> rows;
  std::vector<std::string> names;
  int number = 0;
  for (std::string line; std::getline(in, line) && rows.size() <= kMaxKeys;) {
    ++number;
    if (trimmed(line).empty() || trimmed(line)[0] == '#') continue;
    const auto cells = cells_of(line);
    if (names.empty()) {
      if (cells.size() == 1 && line.find(';') != std::string::npos)
        return file_error("'{}': values are separated by ';', but a path takes commas", file);
      names = cells;
      if (auto status = check_columns(names, file); !status) return status.error();
      continue;
    }
    if (cells.size() != names.size())
      return file_error("'{}', line {}: {} values for {} columns", file, number, cells.size(), names.size());
    Row& row = rows.emplace_back();
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const auto value = parse_number(cells[k]);
      if (!value) return file_error("'{}', line {}: {} must be a number, not '{}'", file, number, names[k], cells[k]);
      row[names[k]] = *value;
    }
  }
  return rows;
}

/// Adds a value of a key camera in JSON, a number or a vector. Returns whether it is one.
bool add_value(const std::string& name, const nlohmann::json& value, Row& row) {
  if (value.is_number()) row[name] = value.get<double>();
  const bool is_vector = value.is_array() && value.size() == 3 &&
                         std::all_of(value.begin(), value.end(), [](const auto& each) { return each.is_number(); });
  for (std::size_t k = 0; is_vector && k < 3; ++k) row[fmt::format("{}_{}", name, "xyz"[k])] = value[k].get<double>();
  return value.is_number() || is_vector;
}

Result<std::vector<Row>> rows_of_json(std::istream& in, const std::string& file) {
  const auto keys = nlohmann::json::parse(in, nullptr, false);
  if (keys.is_discarded()) return file_error("'{}' is no valid JSON", file);
  if (!keys.is_array()) return file_error("'{}' must be an array of key cameras", file);
  std::vector<Row> rows;
  for (const auto& key : keys) {
    Row& row = rows.emplace_back();
    if (!key.is_object()) return file_error("'{}', key camera {} is no object", file, rows.size());
    std::vector<std::string> names;
    for (const auto& [name, value] : key.items())
      if (!add_value(name, value, row))
        return file_error("'{}', key camera {}: '{}' must be a number or three", file, rows.size(), name);
    for (const auto& [name, value] : row) names.push_back(name);
    if (auto status = check_columns(names, file); !status) return status.error();
  }
  return rows;
}

glm::dvec3 vector_at(const std::array<double, 10>& key, std::size_t first) {
  return {key[first], key[first + 1], key[first + 2]};
}

}  // namespace

Result<CameraPath> CameraPath::read(const std::filesystem::path& path) {
  const std::string file = path.string();
  std::ifstream in(path, std::ios::binary);
  if (!in) return file_error("cannot read '{}'", file);
  if (std::filesystem::is_directory(path)) return file_error("'{}' is a folder", file);
  for (const int byte : {0xef, 0xbb, 0xbf})  // the byte order mark of UTF-8
    if (in.peek() == byte) in.get();
  const bool is_json = (in >> std::ws).peek() == '[' || in.peek() == '{';
  const auto rows = is_json ? rows_of_json(in, file) : rows_of_csv(in, file);
  if (!rows) return rows.error();
  if (rows->size() < 2) return file_error("'{}' has fewer than two key cameras", file);
  if (rows->size() > kMaxKeys) return file_error("'{}' has more than {} key cameras", file, kMaxKeys);
  CameraPath result;
  const bool has_times = rows->front().contains("time");
  for (std::size_t k = 0; k < rows->size(); ++k) {
    const Row& row = (*rows)[k];
    if (row.size() != rows->front().size())
      return file_error("'{}', key camera {}: it has other columns than the first", file, k + 1);
    Key& key = result.keys_.emplace_back();
    for (std::size_t column = 0; column < kValues; ++column)
      if (const auto found = row.find(std::string(kColumns[column])); found != row.end()) key[column] = found->second;
    if (vector_at(key, 0) == vector_at(key, 3))
      return file_error("'{}', key camera {}: position and focal point are equal", file, k + 1);
    if (row.contains(std::string(kColumns[kUp])) && vector_at(key, kUp) == glm::dvec3(0.0))
      return file_error("'{}', key camera {}: up must not be 0", file, k + 1);
    if (const auto angle = row.find(std::string(kColumns[kAngle]));
        angle != row.end() && !(angle->second >= kMinAngle_deg && angle->second <= kMaxAngle_deg))
      return file_error("'{}', key camera {}: view_angle must be from {} to {}, not {}", file, k + 1, kMinAngle_deg,
                        kMaxAngle_deg, angle->second);
    if (has_times) result.times_.push_back(row.at("time"));
    if (has_times && k > 0 && result.times_[k] <= result.times_[k - 1])
      return file_error("'{}', key camera {}: its time, {}, is not after that of the one before", file, k + 1,
                        result.times_[k]);
  }
  result.has_up_ = rows->front().contains("up_x");
  result.has_angle_ = rows->front().contains(std::string(kColumns[kAngle]));
  if (!has_times) result.set_even_times();
  return result;
}

void CameraPath::set_even_times() {
  times_ = {0.0};
  for (std::size_t k = 1; k < keys_.size(); ++k) {
    const double way = glm::distance(vector_at(keys_[k], 0), vector_at(keys_[k - 1], 0)) +
                       glm::distance(vector_at(keys_[k], 3), vector_at(keys_[k - 1], 3));
    times_.push_back(times_.back() + std::sqrt(way));
  }
  // A camera that stands still takes a second, too.
  const double scale = times_.back() > 0.0 ? double(keys_.size() - 1) / times_.back() : 0.0;
  for (std::size_t k = 1; k < times_.size(); ++k)
    times_[k] = scale > 0.0 ? std::max(times_[k] * scale, times_[k - 1] + 1e-3) : double(k);
}

double CameraPath::speed(std::size_t k, std::size_t value) const {
  const auto of_segment = [&](std::size_t begin) {
    return (keys_[begin + 1][value] - keys_[begin][value]) / (times_[begin + 1] - times_[begin]);
  };
  const bool is_first = k == 0, is_last = k + 1 == keys_.size();
  if (is_first || is_last) return of_segment(is_first ? 0 : k - 1);
  if (keys_[k] == keys_[k - 1] || keys_[k] == keys_[k + 1]) return 0.0;  // where the camera stands, it comes to rest
  const double before = times_[k] - times_[k - 1], after = times_[k + 1] - times_[k];
  return (of_segment(k - 1) * after + of_segment(k) * before) / (before + after);
}

void CameraPath::set_camera(double time_s, Framing& framing) const {
  const double time = std::clamp(times_.front() + time_s, times_.front(), times_.back());
  const auto next = std::size_t(std::upper_bound(times_.begin() + 1, times_.end() - 1, time) - times_.begin());
  const double duration = times_[next] - times_[next - 1];
  const double u = (time - times_[next - 1]) / duration, v = 1.0 - u;
  Key at;
  for (std::size_t value = 0; value < kValues; ++value) {
    const double begin = keys_[next - 1][value], change = keys_[next][value] - begin;
    const double bend = v * (speed(next - 1, value) * duration - change) - u * (speed(next, value) * duration - change);
    at[value] = begin + u * (change + v * bend);
  }
  framing.position = vector_at(at, 0);
  framing.focal_point = vector_at(at, 3);
  framing.direction.reset();
  if (has_up_) framing.view_up = glm::vec3(vector_at(at, 6));
  if (has_angle_) framing.view_angle_deg = float(std::clamp(at[kAngle], kMinAngle_deg, kMaxAngle_deg));
}

}  // namespace umbrage
