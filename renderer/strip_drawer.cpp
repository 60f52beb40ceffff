#include "renderer/strip_drawer.h"

#include <algorithm>

#include "core/check.h"
#include "devices/shared/planes.h"

namespace umbrage {

namespace {

/// Returns the max number of rows above and below a strip.
int margin_of(const StripSource& source, const StripNeeds& needs) {
  int margin = 0;
  for (const Margins& sweep : needs.sweeps) margin = std::max(margin, source.given.needed(sweep).rows);
  return std::min(margin, source.info.height);
}

}  // namespace

Result<StripSizes> plan_strips(const Device& device, const StripSource& source, const SumPlanes& sum, double memory) {
  constexpr double kFixed = 60e6;               // the program and a scene of 100 000 triangles, bytes
  constexpr int kMinRows = 64, kMaxRows = 512;  // rows of a strip
  constexpr double kPartOfMarked = 1.0 / 8.0;
  constexpr double kMasks = 3.0;  // of blended surfaces
  const PictureInfo& info = source.info;
  std::vector<std::string> first = source.given.names;
  for (const EffectStep& step : source.before)
    for (const auto& [dispatch, round] : dispatches_in_order(*step.effect, step.params, info, PixelSet::kAll))
      for (const std::string_view name : dispatch->outputs)
        if (!contains(first, name)) first.emplace_back(name);
  LookRun without_lines = source.run;  // further samples
  without_lines.lines.clear();
  const LivePlanes live = live_planes(source.run, info, first), of_further = live_planes(without_lines, info, first);
  const double plane = plane_bytes(info.width, info.height), row = plane / info.height;
  /// Returns the planes of `own` rows, drawn in a frame of `all` rows of which further samples have a part.
  const auto rows_of_planes = [&](double stored, double all, double own, double part) {
    const double left = std::min(live.at_end, stored) - sum.released;
    const double front = sum.blended ? (left + kMasks) * all : 0.0;  // the first sample of blended surfaces
    const double further = of_further.max + (sum.blended ? of_further.at_end : 0.0);
    const double later = std::max(sum.finished * own, sum.marked > 0.0 ? sum.marked * own + further * part : 0.0);
    const double first = sum.blended ? (live.at_end + live.max + kMasks) * all : 0.0;
    return std::max({stored * all, first, left * all + front + later});
  };
  const double height = info.height, drawing = rows_of_planes(live.max, height, height, height * kPartOfMarked);
  const int layers = 1 + int(info.more_layers.size());
  StripSizes whole{.bytes = kFixed + plane * sum.held + row * drawing};
  const bool fits = double(info.width) * info.height * layers <= double(kMaxPixels);
  whole.exceeds = device.draws_strips() && whole.bytes > memory;
  if (fits && whole.bytes <= memory) return whole;
  const bool traced = find_named(source.run.external_effects, source.run.occlusion);
  if (!device.draws_strips() || traced) {
    if (fits) return whole;
    return usage_error(
        "{} of {} x {} pixels {} too large: at most {} pixels in total; "
        "larger pictures are drawn in strips, but not {}",
        layers == 1 ? "one layer" : fmt::format("{} layers", layers), info.width, info.height,
        layers == 1 ? "is" : "are", kMaxPixels,
        traced ? "with `occlusion` reference" : fmt::format("on the device {}: try `device` cpu", device.name()));
  }
  Margins after = source.after;
  for (const std::string& name : source.run.wanted.value_or(std::vector<std::string>{"color.r", "depth"}))
    after.emplace(name, Margin{});
  const StripNeeds needs = needs_of_strips(source.run, info, source.before, source.given.names, after);
  const double margins = 2.0 * margin_of(source, needs);
  const std::vector<std::string_view> edges = edge_planes(source.lines, layers);
  const auto of_lines = std::count_if(edges.begin(), edges.end(), [&](std::string_view name) {
    return source.run.wanted && contains(*source.run.wanted, name) && !contains(needs.whole_names, name);
  });
  const double fixed = kFixed + plane * (needs.whole_planes + double(of_lines) + sum.held);
  const auto bytes = [&](int rows) {
    const double own = std::min(rows, info.height);
    return fixed + row * rows_of_planes(live.max - needs.not_stored, std::min(own + margins, height), own, own);
  };
  StripSizes strips{.rows = kMinRows};
  while (strips.rows < kMaxRows && bytes(strips.rows + kMinRows) <= memory) strips.rows += kMinRows;
  strips.bytes = bytes(strips.rows);
  strips.exceeds = strips.bytes > memory;
  // Planes that dispatches read at arbitrary distance are whole ones in strips, too.
  return fits && strips.bytes >= whole.bytes ? whole : strips;
}

StripDrawer::StripDrawer(Device& device, StripSource source, int rows, DrawProgress& progress, StageTimes& times)
    : device_(device), source_(std::move(source)), rows_(rows), progress_(progress), times_(times) {
  report_to(progress, times, source_.run);
  source_.run.meter = [this](Device& of, const Frame& frame) { return meter(of, frame); };
}

Result<Strokes> StripDrawer::draw_picture(const std::vector<std::string>& planes, bool lines, const Finish& finish) {
  const int height = source_.info.height;
  const auto whole_planes = std::make_shared<WholePlanes>();
  Margins after = source_.after;
  for (const std::string& name : planes) after.emplace(name, Margin{});
  std::vector<std::string_view> edges;
  if (lines) edges = edge_planes(source_.lines, int(source_.info.more_layers.size()) + 1);
  for (const std::string_view name : edges) after.emplace(name, Margin{});
  const StripNeeds needs = needs_of_strips(source_.run, source_.info, source_.before, source_.given.names, after);
  edges_ = Image(source_.info.width, height);
  for (const std::string_view name : edges)
    if (!contains(needs.whole_names, name)) edges_.add(name) = Plane(edges_.width, height);
  bool finished = false;
  const auto sweeps = double(needs.sweeps.size());
  for (std::size_t sweep = 0; sweep < needs.sweeps.size(); ++sweep) {
    const int margin = std::min(source_.given.needed(needs.sweeps[sweep]).rows, height);
    metered_in_sweep_ = false;
    for (int begin = 0; begin < height; begin += rows_) {
      const Rows strip{begin, std::min(begin + rows_, height)};
      const DrawProgress::Part part(progress_, (double(sweep) + double(begin) / height) / sweeps,
                                    (double(sweep) + double(strip.end) / height) / sweeps);
      const auto strip_finished = draw_strip({strip, margin, whole_planes}, planes, finish);
      if (!strip_finished) return strip_finished.error();
      if (begin > 0 && finished != *strip_finished) fail_check("strips of one picture wait for different dispatches");
      finished = *strip_finished;
    }
    for (auto& [key, entry] : whole_planes->planes) entry.complete = true;
    if (metered_in_sweep_) source_.run.stops = metering_.stops(stops_from_lights_);
  }
  if (!finished) fail_check("a picture in strips needs more sweeps than were planned");
  if (!lines) return Strokes();
  for (auto& [key, entry] : whole_planes->planes)
    if (const auto& [reduced, name, version] = key; reduced == info_.reduced && contains(edges, name))
      edges_.add(name) = std::move(entry.plane);
  return traced_strokes(info_, edges_, source_.lines, device_.threads());
}

/// Adds the rows of a finished strip to the planes from which lines are traced, besides those that dispatches gather.
Result<void> StripDrawer::add_edges(const Frame& frame, const Rows& rows) {
  if (edges_.names.empty()) return {};
  const auto part = device_.download_with_guard(frame, edges_.names);
  if (!part) return part.error();
  for (std::size_t k = 0; k < edges_.planes.size(); ++k)
    for (int y = 0; y < part->height; ++y)
      std::copy_n(part->planes[k].row(y), edges_.width, edges_.planes[k].row(rows.begin + y));
  return {};
}

/// Prepares the plane pool for strips with this number of rows: drops planes of other sizes, which cannot be reused.
void StripDrawer::prepare_plane_pool(const Rows& rows) {
  if (kept_ && kept_rows_ == rows.count()) return;
  kept_.reset();
  kept_.emplace(device_.pool());
  kept_rows_ = rows.count();
}

/// Draws a strip. Returns whether it is finished; if not, its next dispatch reads planes that other strips must
/// complete first.
Result<bool> StripDrawer::draw_strip(const Strip& strip, const std::vector<std::string>& planes, const Finish& finish) {
  const int height = source_.info.height, guard = source_.info.guard;
  prepare_plane_pool(rows_with_margin(strip, height));
  first_ = std::clamp(strip.rows.begin, guard, height - guard) - guard;
  auto frame = source_.make_frame(strip);
  if (!frame) return frame.error();
  info_ = frame->info;
  const auto state = run_look(source_.run, device_, *frame);
  if (!state) return state.error();
  if (!state->finished) return false;
  stops_ = state->stops;
  if (auto added = add_edges(*frame, strip.rows); !added) return added.error();
  auto rows = device_.download(*frame, planes);
  if (!rows) return rows.error();
  if (rows->height > 0)
    if (auto taken = finish(*frame, *rows, first_); !taken) return taken.error();
  return true;
}

/// Adds a strip to the metering. Returns no exposure: it is known only after a sweep over all strips, and the next
/// sweep uses it.
Result<std::optional<float>> StripDrawer::meter(Device& device, const Frame& frame) {
  const auto rows = device.download(frame, kMeteredPlanes);
  if (!rows) return rows.error();
  metering_.add(*rows, first_, source_.info.inner_height());
  stops_from_lights_ = stops_from_lights(frame.info);
  metered_in_sweep_ = true;
  return std::optional<float>();
}

}  // namespace umbrage
