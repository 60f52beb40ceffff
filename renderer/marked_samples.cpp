#include "renderer/marked_samples.h"

#include <algorithm>
#include <vector>

#include "core/check.h"
#include "core/lists.h"
#include "devices/shared/capture_info.h"
#include "effects/effects.h"
#include "effects/resample/resample.h"

namespace umbrage {
namespace {

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

/// Returns the end of the block of pixels that has the row above this one. Pixels of a block are captured together.
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
  const glm::vec2 offset = sample_offset(plan.sample, plan.recipe.frames);
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
  const bool noisy =
      !recipe.edges_alone && recipe.occlusion != kNoOcclusion && (!technique || !technique->filters_itself);
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

/// Sets the plan to a sample that is drawn at marked pixels and returns its camera.
Camera begin_marked(Plan& plan, int sample) {
  const Camera camera = begin_picture(plan, {.sample = sample});
  capture_surfaces_alone(plan.capture);
  plan.capture.soft_shadows = false;
  return camera;
}

}  // namespace

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

namespace {

/// The first sample, whose frames have the planes that further samples borrow; of a strip, if the plan is of one.
struct FirstSample {
  Frame& behind;                                      ///< without blended surfaces
  Rows rows = {};                                     ///< of the strip, or all
  std::optional<Frame> front = {};                    ///< of blended surfaces, where they show; empty if none does
  Rows front_rows = {};                               ///< rows of that frame
  std::shared_ptr<const PixelMask> marks = {};        ///< the pixels that further samples draw
  std::shared_ptr<const PixelMask> front_marks = {};  ///< those of them at which blended surfaces may show
};

/// Returns a plane of a frame with its guard band; of a strip only its own rows.
Result<Plane> whole_plane(Device& device, const Frame& frame, const std::string& name) {
  auto image = device.download_with_guard(frame, {name});
  return image ? Result<Plane>(std::move(image->planes[0])) : image.error();
}

/// Returns the opacity of blended surfaces along the rays of the first sample in these rows, captured in strips if the
/// device can, which takes less memory.
Result<PixelMask> opacity_of(const PictureDrawing& drawing, const Plan& plan, const Camera& camera, const Rows& rows) {
  constexpr int kRows = 128;
  const bool in_strips = drawing.device.draws_strips();
  Plan opacity = plan;
  opacity.marked = false;
  capture_surfaces_alone(opacity.capture);
  opacity.capture.shadows = opacity.capture.shadow_rays = 0;
  opacity.capture.planes = std::vector<std::string>();
  PixelMask all{{}, rows.begin};
  for (Rows part{rows.begin, rows.begin}; part.end < rows.end;) {
    part = {part.end, in_strips ? std::min(part.end + kRows, rows.end) : rows.end};
    if (in_strips) opacity.capture.strip = Strip{part, 0, std::make_shared<WholePlanes>()};
    const auto frame = drawing.capture(opacity, camera);
    if (!frame) return frame.error();
    const auto plane = whole_plane(drawing.device, *frame, "opacity");
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

/// Completes the first sample with its blended surfaces, in strips if the device can: captures them and runs the look
/// on them. Adds their marks to `marks`, which begin at first.rows.
Result<void> add_front(const PictureDrawing& drawing, Plan plan, Plane& marks, FirstSample& first) {
  const PictureInfo& info = first.behind.info;
  const bool in_strips = drawing.device.draws_strips();
  const DrawProgress::Part part(drawing.progress, 1.0 / plan.pictures(), 2.0 / plan.pictures());
  const Camera camera = begin_picture(plan, {.blended = true});
  const Margin reach = reach_of_front(plan, info);
  Strip strip{first.rows, std::min(reach.rows, info.height), std::make_shared<WholePlanes>()};
  Rows rows = rows_with_margin(strip, info.height);
  rows.end = std::min(block_end(rows.end), info.height);
  const auto opacity = opacity_of(drawing, plan, camera, rows);
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
  auto frame = drawing.capture(plan, camera);
  if (!frame) return frame.error();
  const auto shaded = run_look(drawing.run, drawing.device, *frame);
  if (!shaded) return shaded.error();
  if (!shaded->finished) fail_check("blended surfaces wait for other strips");
  const auto in_front = whole_plane(drawing.device, *frame, "marks");
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

/// Completes the first sample of marked_average.
Result<FirstSample> completed(const PictureDrawing& drawing, const Plan& plan, Frame& behind) {
  FirstSample first{.behind = behind};
  first.rows = plan.capture.strip ? plan.capture.strip->rows : Rows{0, behind.info.height};
  auto marks = whole_plane(drawing.device, behind, "marks");
  if (!marks) return marks.error();
  if (plan.has_blended)
    if (auto added = add_front(drawing, plan, *marks, first); !added) return added.error();
  first.marks = std::make_shared<PixelMask>(PixelMask{std::move(*marks), first.rows.begin});
  return first;
}

/// Adds the pictures of a sample to which the plan is set. `front_begin`: first row of the one in front, which may be
/// null.
Result<void> add_sample(Device& device, Plan plan, const Frame* front, int front_begin, const Frame& behind,
                        Average& average) {
  const int begin = plan.capture.strip ? plan.capture.strip->rows.begin : 0;
  if (front) {
    plan.capture.blended = true;
    if (auto added = average.add(device, plan, *front, front_begin); !added) return added;
  }
  plan.capture.blended = false;
  return average.add(device, plan, behind, begin);
}

/// Returns an average that begins with the drawn first sample.
Result<Average> begin_average(Device& device, const Plan& plan, const FirstSample& first) {
  const PictureInfo& info = first.behind.info;
  const int begin = first.rows.begin, guard = info.guard;
  const Rows rows{std::clamp(begin, guard, info.height - guard),
                  std::clamp(first.rows.end, guard, info.height - guard)};
  Plane marks(info.inner_width(), rows.count());
  for (int y = 0; y < rows.count(); ++y)
    std::copy_n(first.marks->plane.row(rows.begin - begin + y) + guard, marks.width, marks.row(y));
  Average average(device, plan, {rows.begin - guard, rows.end - guard}, std::move(marks));
  const Frame* front = first.front ? &*first.front : nullptr;
  const auto added = add_sample(device, plan, front, first.front_rows.begin, first.behind, average);
  return added ? Result<Average>(std::move(average)) : added.error();
}

/// Draws a further sample and adds it to the average. The plan is set to the sample, and to the strip of it that is
/// drawn.
Result<void> add_further(const PictureDrawing& drawing, const Plan& plan, const Camera& camera,
                         const FirstSample& first, Average& average) {
  Device& device = drawing.device;
  Rows front_rows = first.front_rows;
  if (const auto& strip = plan.capture.strip)
    front_rows = {std::max(front_rows.begin, strip->rows.begin), std::min(front_rows.end, strip->rows.end)};
  const auto drawn = [&](bool in_front) -> Result<Frame> {
    Plan sample = plan;
    sample.capture.blended = in_front;
    sample.capture.mask = in_front ? first.front_marks : first.marks;
    if (in_front && front_rows != Rows{0, first.behind.info.height})
      sample.capture.strip = Strip{front_rows, 0, std::make_shared<WholePlanes>()};
    auto frame = drawing.capture(sample, camera);
    if (!frame) return frame;
    const ParameterBytes params = resample_params(plan, frame->info, kResampleBorrow);
    const Frame& from = in_front ? *first.front : first.behind;
    if (auto added = device.add_planes_of(from, borrowed_planes(params), *frame); !added) return added.error();
    const ProgressMonitor& monitor = drawing.run.monitor;
    if (auto borrowed = device.run(resample(), params, *frame, {}, monitor); !borrowed) return borrowed.error();
    drawing.run.after(resample().name);
    LookRun further = drawing.run;
    further.settings = &plan.recipe.settings;
    further.has_technique = true;
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
  if (!behind) return behind.error();
  return add_sample(device, plan, front ? &*front : nullptr, front_rows.begin, *behind, average);
}

/// Returns the strips in which further samples of these rows are drawn: in memory that is small beside that of the
/// first one.
std::vector<Rows> strips_of_further(const Device& device, const Plan& plan, const FirstSample& first) {
  constexpr int kStrips = 8;               // in most pictures: an eighth of the memory of a frame
  constexpr int kPixelsOfStrip = 1 << 19;  // in large pictures: memory that is small beside that of the program
  constexpr int kRowStep = 64;             // min height, since rows beside a strip are captured with it, too
  if (plan.capture.strip || !device.draws_strips()) return {first.rows};
  const int height = first.rows.count();
  const int wanted_rows = std::min(height / kStrips, kPixelsOfStrip / first.behind.info.width);
  const int rows = std::max(wanted_rows / kRowStep, 1) * kRowStep;
  std::vector<Rows> strips;
  for (int begin = 0; begin < height; begin += rows) strips.push_back({begin, std::min(begin + rows, height)});
  return strips;
}

}  // namespace

Result<Average> marked_average(const PictureDrawing& drawing, const Plan& plan, Frame& behind) {
  Device& device = drawing.device;
  auto first = completed(drawing, plan, behind);
  if (!first) return first.error();
  auto average = begin_average(device, plan, *first);
  if (!average) return average;
  // The finished average takes the place of these.
  if (drawing.run.kept) device.release(first->behind, averaged_picture(plan));
  if (drawing.run.kept && first->front) device.release(*first->front, averaged_picture(plan));
  const std::vector<Rows> strips = strips_of_further(device, plan, *first);
  const auto parts = double(plan.recipe.frames * strips.size());
  for (int sample = 1; sample < plan.recipe.frames; ++sample)
    for (std::size_t k = 0; k < strips.size(); ++k) {
      const double done = double(sample * strips.size() + k);
      const DrawProgress::Part part(drawing.progress, done / parts, (done + 1.0) / parts);
      Plan further = plan;
      const Camera camera = begin_marked(further, sample);
      if (plan.capture.strip || strips.size() > 1)
        further.capture.strip = Strip{strips[k], 0, std::make_shared<WholePlanes>()};
      if (auto added = add_further(drawing, further, camera, *first, *average); !added) return added.error();
      drawing.times.done("average");
    }
  return average;
}

}  // namespace umbrage
