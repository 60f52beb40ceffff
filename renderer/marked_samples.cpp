#include "renderer/marked_samples.h"

#include <algorithm>

#include "core/check.h"
#include "core/lists.h"
#include "devices/shared/capture_info.h"
#include "effects/effects.h"
#include "effects/resample/resample.h"
#include "renderer/average.h"

namespace umbrage {
namespace {

constexpr float kNoEdge = 1.0f;  // no difference of square roots exceeds it

const Effect& resample() { return effect_with<ResampleParams>(); }

/// Returns what a look's technique gives to a pixel, as ResampleParams::occlusion.
int occlusion_of(const Recipe& recipe) {
  int borrowed = kResampleNothing;
  for (const Effect* effect : steps_of(look_run(recipe))) {
    if (effect->name != recipe.occlusion) continue;
    borrowed = std::max(borrowed, kResampleAo);
    if (writes(*effect, params_of(recipe.settings, effect->name), "indirect.r")) borrowed = kResampleLight;
  }
  return borrowed;
}

/// Returns the parameters of `resample` for a plan that is set to a sample. `info`: that of the sample or of the first.
ParameterBytes resample_params(const Plan& plan, const PictureInfo& info, int part) {
  ParameterBytes bytes = params_of(plan.recipe.settings, resample().name);
  auto& params = as<ResampleParams>(bytes);
  params.part = part;
  params.occlusion = occlusion_of(plan.recipe);
  params.soft_shadows = 0;
  for (const int light : softened_lights(info, plan.capture)) params.soft_shadows |= 1 << light;
  // Only what the whole look reads counts, so that the picture does not depend on the passes that are captured.
  LookRun run = look_run(plan.recipe);
  run.wanted.reset();
  params.hard_shadows = ((1 << shadows_read(plan.recipe, steps_of(run))) - 1) & ~params.soft_shadows;
  if (!planes_read(compile(run, 1)).contains("albedo.r")) params.albedo = kNoEdge;
  const glm::vec2 offset = sample_offset(plan.capture.sample, plan.recipe.frames);
  params.right = offset.x;
  params.below = offset.y;
  return bytes;
}

/// Returns the planes that a further sample borrows from the first.
std::vector<std::string> borrowed_planes(const ParameterBytes& bytes) {
  const auto& params = as<ResampleParams>(bytes);
  std::vector<std::string> planes = {"resample_depth", "normal.x", "normal.y", "normal.z"};
  if (params.occlusion != kResampleNothing) planes.emplace_back("ao");
  if (params.occlusion == kResampleLight) planes.insert(planes.end(), {"indirect.r", "indirect.g", "indirect.b"});
  for (int light = 0; light < kMaxShadows; ++light)
    if ((params.soft_shadows >> light & 1) != 0) planes.push_back(shadow_plane(light));
  return planes;
}

}  // namespace

bool draws_marked_samples(const Recipe& recipe) {
  const Effect* technique = find_effect(recipe.occlusion);
  EffectSettings of_samples = recipe.settings;  // which have no lines
  take_lines_over_average(recipe, of_samples);
  LookRun run = look_run(recipe);
  run.settings = &of_samples;
  run.wanted.reset();  // a pass is the same alone and with others
  const bool noisy = recipe.occlusion != kNoOcclusion && (!technique || !technique->filters_itself);
  return recipe.frames > 1 && !recipe.hdri.shown() && !noisy && runs_on_marked(run, recipe.averaged);
}

bool follows_from_samples(std::string_view parameter) {
  constexpr std::string_view kSet[] = {"part", "occlusion", "hard_shadows", "soft_shadows", "right", "below"};
  return contains(kSet, parameter);
}

namespace {

/// Leaves out what only techniques read.
void capture_surfaces_alone(CaptureSettings& capture) {
  capture.layers = 1;
  capture.back_sides = false;
  capture.extra_views = 0;
  capture.ray_offsets = false;
}

}  // namespace

Camera begin_marked(Plan& plan, int sample) {
  const Camera camera = begin_picture(plan, {.sample = sample});
  capture_surfaces_alone(plan.capture);
  plan.capture.soft_shadows = false;
  return camera;
}

EffectStep marking_step(const Plan& plan, const PictureInfo& info) {
  return {&resample(), resample_params(plan, info, kResampleMark)};
}

void add_margins_for_further(const Plan& plan, const PictureInfo& info, Margins& after) {
  // A further sample borrows from the neighbours of a pixel, and blended surfaces show at most a pixel farther away.
  const int margin = plan.has_blended ? 2 : 1;
  for (const std::string& name : borrowed_planes(resample_params(plan, info, kResampleBorrow)))
    after[name] = {margin, margin};
  after["marks"] = {margin - 1, margin - 1};
}

Result<std::optional<float>> metered_with_blended(Device& device, const Plan& plan, const GetFrame& get, LookRun run) {
  constexpr int kMaxSide = 256;
  Plan small = plan;
  const Camera camera = begin_picture(small, {.blended = true});
  int& width = small.capture.width;
  int& height = small.capture.height;
  const double scale = std::min(1.0, double(kMaxSide) / std::max(width, height));
  width = std::max(int(width * scale), 1);
  height = std::max(int(height * scale), 1);
  small.capture.guard = 0;
  small.capture.strip.reset();
  auto frame = get(small, camera);
  if (!frame) return frame.error();
  std::optional<float> stops;
  run.settings = &small.recipe.settings;
  run.kept.reset();
  run.after = [](std::string_view) {};
  run.meter = [&](Device& of, const Frame& lit, Exposure by) -> Result<std::optional<float>> {
    const auto metered = metered_stops(of, lit, by);
    if (!metered) return metered.error();
    stops = *metered;
    return std::optional<float>();  // ends the run
  };
  const Program program = compile(run, 1 + int(frame->info.more_layers.size()), &frame->info);
  const bool meters = std::any_of(program.operations.begin(), program.operations.end(), [](const Operation& operation) {
    return operation.kind == OperationKind::kMeter && operation.exposure != Exposure::kLights;
  });
  if (!meters || run.stops) return stops;
  const auto state = run_look(run, device, *frame);
  return state ? Result<std::optional<float>>(stops) : state.error();
}

Result<Frame> capture_first(Device& device, const Plan& plan, const Camera& camera, const GetFrame& get,
                            const ProgressMonitor& monitor) {
  auto frame = get(plan, camera);
  if (!frame) return frame;
  const EffectStep step = marking_step(plan, frame->info);
  const auto marked = device.run(*step.effect, step.params, *frame, {}, monitor);
  return marked ? frame : marked.error();
}

namespace {

/// Returns a plane of a frame with its guard band; of a strip only its own rows.
Result<Plane> whole_plane(Device& device, const Frame& frame, const std::string& name) {
  auto image = device.download_with_guard(frame, {name});
  return image ? Result<Plane>(std::move(image->planes[0])) : image.error();
}

/// Returns 1 for the pixels that are above 0 or within this distance, across and down, of one that is, else 0.
Plane grown(const Plane& from, const Margin& by) {
  Plane across(from.width, from.height, 0.0f), all(from.width, from.height, 0.0f);
  for (int y = 0; y < from.height; ++y)
    for (int x = 0, end = 0; x < from.width; ++x)
      if (from.row(y)[x] > 0.0f)
        for (end = std::max(end, x - by.columns); end <= std::min(x + by.columns, from.width - 1); ++end)
          across.row(y)[end] = 1.0f;
  std::vector<int> end(std::size_t(from.width));  // of each column: rows above are done
  for (int y = 0; y < from.height; ++y)
    for (int x = 0; x < from.width; ++x)
      if (across.row(y)[x] > 0.0f) {
        int& row = end[std::size_t(x)];
        for (row = std::max(row, y - by.rows); row <= std::min(y + by.rows, from.height - 1); ++row)
          all.row(row)[x] = 1.0f;
      }
  return all;
}

constexpr int kBlock = 4;  // side of the blocks of pixels that are captured together, in strips and in whole pictures

int block_end(int row) { return (row + kBlock - 1) / kBlock * kBlock; }

/// Returns a mask of all blocks that have a pixel of this one. Then a strip captures each block as a whole picture
/// does.
PixelMask with_whole_blocks(PixelMask mask) {
  const int width = mask.plane.width, end = mask.first_row + mask.plane.height;
  for (int y0 = mask.first_row; y0 < end; y0 += kBlock)
    for (int x0 = 0; x0 < width; x0 += kBlock) {
      const int x1 = std::min(x0 + kBlock, width), y1 = std::min(y0 + kBlock, end);
      if (!mask.any(x0, x1, y0, y1)) continue;
      for (int y = y0; y < y1; ++y) std::fill_n(mask.plane.row(y - mask.first_row) + x0, x1 - x0, 1.0f);
    }
  return mask;
}

/// Returns the rows of `within` at which a mask has pixels, extended to whole blocks. `within` begins with a block.
Rows rows_of(const PixelMask& mask, const Rows& within) {
  Rows rows{within.end, within.begin};
  for (int y = within.begin; y < within.end; ++y)
    if (mask.any(0, mask.plane.width, y, y + 1)) rows = {std::min(rows.begin, y), y + 1};
  if (rows.count() <= 0) return {};
  return {rows.begin / kBlock * kBlock, std::min(block_end(rows.end), within.end)};
}

/// Returns the opacity of blended surfaces along the rays of the first sample in these rows. `in_strips`: captures them
/// in strips, which takes less memory.
Result<PixelMask> opacity_of(Device& device, const Plan& plan, const Camera& camera, const Rows& rows, bool in_strips,
                             const GetFrame& get) {
  constexpr int kRows = 128;
  Plan opacity = plan;
  capture_surfaces_alone(opacity.capture);
  opacity.capture.shadows = opacity.capture.shadow_rays = 0;
  opacity.capture.planes = std::vector<std::string>();
  PixelMask all{{}, rows.begin};
  for (Rows part{rows.begin, rows.begin}; part.end < rows.end;) {
    part = {part.end, in_strips ? std::min(part.end + kRows, rows.end) : rows.end};
    if (in_strips) opacity.capture.strip = Strip{part, 0, std::make_shared<WholePlanes>()};
    const auto frame = get(opacity, camera);
    if (!frame) return frame.error();
    const auto plane = whole_plane(device, *frame, "opacity");
    if (!plane) return plane.error();
    if (!all.plane.data()) all.plane = Plane(plane->width, rows.count());
    for (int y = 0; y < plane->height; ++y)
      std::copy_n(plane->row(y), plane->width, all.plane.row(part.begin - rows.begin + y));
  }
  return all;
}

/// Returns how far from a pixel the first sample of blended surfaces reads what is captured.
Margin reach_of_front(const Plan& plan, const PictureInfo& info) {
  Margins after;
  for (const std::string& name : averaged_planes(plan)) after[name] = {};
  add_margins_for_further(plan, info, after);
  const EffectStep marking[] = {marking_step(plan, info)};
  return plan.given.needed(margins_before(look_run(plan.recipe), info, marking, after));
}

/// Completes the first sample with its blended surfaces: see complete_first. Adds their marks to `marks`, which begin
/// at first.rows.
Result<void> add_front(Device& device, Plan plan, bool in_strips, const GetFrame& get, const LookRun* run, Plane& marks,
                       FirstSample& first) {
  const PictureInfo& info = first.behind.info;
  const Camera camera = begin_picture(plan, {.blended = true});
  const Margin reach = reach_of_front(plan, info);
  Strip strip{first.rows, std::min(reach.rows, info.height), std::make_shared<WholePlanes>()};
  Rows rows = rows_with_margin(strip, info.height);
  rows.end = std::min(block_end(rows.end), info.height);
  const auto opacity = opacity_of(device, plan, camera, rows, in_strips, get);
  if (!opacity) return opacity.error();
  // Further samples may show a surface one pixel farther away, and borrow from the neighbours of that pixel.
  const PixelMask near{grown(opacity->plane, {1, 1}), opacity->first_row};
  const PixelMask read{grown(opacity->plane, {2, 2}), opacity->first_row};
  strip.rows = rows_of(read, first.rows);
  if (strip.rows.count() <= 0) return {};
  if (in_strips) plan.capture.strip = strip;
  if (in_strips && info.more_layers.empty() && std::max(reach.rows, reach.columns) < kAnywhere)
    plan.capture.mask =
        std::make_shared<PixelMask>(with_whole_blocks({grown(opacity->plane, reach), opacity->first_row}));
  auto frame = capture_first(device, plan, camera, get, run ? run->monitor : ProgressMonitor());
  if (!frame) return frame.error();
  if (run) {
    const auto shaded = run_look(*run, device, *frame);
    if (!shaded) return shaded.error();
    if (!shaded->finished) fail_check("blended surfaces wait for other strips");
  }
  const auto in_front = whole_plane(device, *frame, "marks");
  if (!in_front) return in_front.error();
  first.front_rows = in_strips ? strip.rows : first.rows;
  Plane front_marks(marks.width, first.front_rows.count(), 0.0f);
  for (int y = 0; y < front_marks.height; ++y) {
    float* row = marks.row(first.front_rows.begin - first.rows.begin + y);
    for (int x = 0; x < marks.width; ++x)
      if (near.at(x, first.front_rows.begin + y))
        front_marks.row(y)[x] = row[x] = std::max(row[x], in_front->row(y)[x]);
  }
  first.front_marks = std::make_shared<PixelMask>(PixelMask{std::move(front_marks), first.front_rows.begin});
  first.front = std::move(*frame);
  return {};
}

}  // namespace

Result<FirstSample> complete_first(Device& device, const Plan& plan, Frame behind, bool in_strips, const GetFrame& get,
                                   const LookRun* run) {
  FirstSample first{.behind = std::move(behind)};
  first.rows = plan.capture.strip ? plan.capture.strip->rows : Rows{0, first.behind.info.height};
  auto marks = whole_plane(device, first.behind, "marks");
  if (!marks) return marks.error();
  if (plan.has_blended)
    if (auto added = add_front(device, plan, in_strips, get, run, *marks, first); !added) return added.error();
  first.marks = std::make_shared<PixelMask>(PixelMask{std::move(*marks), first.rows.begin});
  return first;
}

namespace {

/// Adds the pictures of a sample. `first`: it is the first one, which is added to all pixels. A strip is added to the
/// sum of the whole picture if that is larger than the strip. `front_begin`: the first row of the picture in `front`.
Result<void> add_sample(Device& device, const Plan& plan, const Frame* front, int front_begin, const Frame& behind,
                        bool first, PictureSum& total) {
  const std::vector<std::string> names = averaged_planes(plan);
  const int guard = behind.info.guard, height = total.marks.height;
  const int begin = plan.capture.strip ? std::max(plan.capture.strip->rows.begin - guard, 0) : 0;
  const int first_row = height == behind.info.inner_height() ? begin : 0;
  const auto add = [&](const Image& image, int row) {
    std::vector<const Plane*> planes;
    for (const Plane& plane : image.planes) planes.push_back(&plane);
    add_planes(total, names, planes, row, first);
  };
  auto image = front ? device.download(behind, names) : device.view(behind, names);
  if (!image) return image.error();
  if (image->height == 0) return {};  // a strip of the guard band
  if (plan.has_blended && first_row == 0) count_picture(total, first);
  if (first_row == 0) count_picture(total, first);
  if (front) {
    auto in_front = device.download(*front, with_blend_planes(names));
    if (!in_front) return in_front.error();
    const int offset = std::max(front_begin - guard, 0) - begin;  // of the rows in front
    BlendedSample blended;
    blended.take_front(*in_front, offset, image->height);
    add(*in_front, first_row + offset);
    blended.weigh_behind(*image, 0);
  }
  add(*image, first_row);
  return {};
}

}  // namespace

Result<PictureSum> begin_sum(Device& device, const Plan& plan, const FirstSample& first) {
  const PictureInfo& info = first.behind.info;
  const Plane& marks = first.marks->plane;
  PictureSum total{.as_square_roots = plan.recipe.look->averages_square_roots,
                   .per_sample = plan.has_blended ? 2 : 1,
                   .threads = device.threads()};
  const int begin = first.marks->first_row, guard = info.guard;
  const Rows rows{std::clamp(begin, guard, info.height - guard),
                  std::clamp(begin + marks.height, guard, info.height - guard)};
  total.marks = Plane(info.inner_width(), rows.count());
  for (int y = 0; y < rows.count(); ++y)
    std::copy_n(marks.row(rows.begin - begin + y) + guard, total.marks.width, total.marks.row(y));
  total.sum = Image(total.marks.width, rows.count());
  for (const std::string& name : averaged_planes(plan))
    total.sum.add(name) = Plane(total.sum.width, total.sum.height, 0.0f);
  const Frame* front = first.front ? &*first.front : nullptr;
  if (auto added = add_sample(device, plan, front, first.front_rows.begin, first.behind, true, total); !added)
    return added.error();
  return total;
}

Result<void> draw_marked(Device& device, const Plan& plan, const Camera& camera, const FirstSample& first,
                         const GetFrame& get, const LookRun& run, PictureSum* total) {
  Rows front_rows = first.front_rows;
  if (const auto& strip = plan.capture.strip)
    front_rows = {std::max(front_rows.begin, strip->rows.begin), std::min(front_rows.end, strip->rows.end)};
  const auto drawn = [&](bool in_front) -> Result<Frame> {
    Plan sample = plan;
    sample.capture.blended = in_front;
    sample.capture.mask = in_front ? first.front_marks : first.marks;
    if (in_front && front_rows != Rows{0, first.behind.info.height})
      sample.capture.strip = Strip{front_rows, 0, std::make_shared<WholePlanes>()};
    auto frame = get(sample, camera);
    if (!frame || !total) return frame;
    const ParameterBytes params = resample_params(plan, frame->info, kResampleBorrow);
    const Frame& from = in_front ? *first.front : first.behind;
    if (auto added = device.add_planes_of(from, borrowed_planes(params), *frame); !added) return added.error();
    if (auto borrowed = device.run(resample(), params, *frame, {}, run.monitor); !borrowed) return borrowed.error();
    run.after(resample().name);
    LookRun further = run;
    further.settings = &plan.recipe.settings;
    further.further = true;
    const auto status = run_look(further, device, *frame);
    return status ? frame : status.error();
  };
  std::optional<Frame> front;
  if (first.front && front_rows.count() > 0) {
    auto frame = drawn(true);
    if (!frame) return frame.error();
    front = std::move(*frame);
  }
  const auto behind = drawn(false);
  if (!behind || !total) return behind ? Result<void>() : behind.error();
  return add_sample(device, plan, front ? &*front : nullptr, front_rows.begin, *behind, false, *total);
}

}  // namespace umbrage
