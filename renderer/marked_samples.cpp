#include "renderer/marked_samples.h"

#include <algorithm>

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
  LookRun run = look_run(recipe);
  run.wanted.reset();  // a pass is the same alone and with others
  const bool noisy = recipe.occlusion != kNoOcclusion && (!technique || !technique->filters_itself);
  return recipe.frames > 1 && !recipe.hdri.shown() && !noisy && runs_on_marked(run, recipe.averaged);
}

bool follows_from_samples(std::string_view parameter) {
  constexpr std::string_view kSet[] = {"part", "occlusion", "hard_shadows", "soft_shadows", "right", "below"};
  return contains(kSet, parameter);
}

Camera begin_marked(Plan& plan, int sample) {
  const Camera camera = begin_picture(plan, {.sample = sample});
  plan.capture.layers = 1;
  plan.capture.back_sides = false;
  plan.capture.extra_views = 0;
  plan.capture.ray_offsets = false;
  return camera;
}

Result<Frame> capture_sample(Device& device, const Plan& plan, const Camera& camera, const Frame* first,
                             const ProgressMonitor& monitor) {
  if (first) return device.capture_marked(camera, plan.capture, *first, monitor);
  auto frame = device.capture(camera, plan.capture, monitor);
  if (!frame || !plan.marked) return frame;
  if (auto marked = mark_pixels(device, plan, *frame, monitor); !marked) return marked.error();
  return frame;
}

Result<RunState> mark_pixels(Device& device, const Plan& plan, Frame& frame, const ProgressMonitor& monitor) {
  return device.run(resample(), resample_params(plan, frame.info, kResampleMark), frame, 0, PixelSet::kAll, monitor);
}

int missing_rows_for_marked(const Device& device, const Plan& plan, const Frame& first) {
  constexpr int kReach = 1;  // rows above and below a pixel from which it borrows
  const ParameterBytes params = resample_params(plan, first.info, kResampleBorrow);
  return std::max(device.missing_rows(first, {"marks"}), device.missing_rows(first, borrowed_planes(params), kReach));
}

Result<void> shade_marked(Device& device, const Plan& plan, LookRun run, const Frame& first, Frame& frame) {
  const ParameterBytes params = resample_params(plan, frame.info, kResampleBorrow);
  if (auto added = device.add_first(first, borrowed_planes(params), frame); !added) return added;
  const auto borrowed = device.run(resample(), params, frame, 0, PixelSet::kMarked, run.monitor);
  if (!borrowed) return borrowed.error();
  run.after(resample().name);
  run.settings = &plan.recipe.settings;
  run.pixels = PixelSet::kMarked;
  const auto status = run_look(run, device, frame);
  return status ? Result<void>() : status.error();
}

Result<PictureSum> begin_sum(Device& device, const Plan& plan, const Frame& first) {
  PictureSum total{.as_square_roots = plan.recipe.look->averages_square_roots, .threads = device.threads()};
  auto marks = device.download(first, {"marks"});
  if (!marks) return marks.error();
  total.marks = std::move(marks->planes[0]);
  if (auto added = add_marked(device, plan, first, total); !added) return added.error();
  return total;
}

Result<void> add_marked(Device& device, const Plan& plan, const Frame& frame, PictureSum& total) {
  const std::vector<std::string> names = averaged_planes(plan);
  // A strip is added to the sum of the whole picture if that is larger than the strip.
  const int guard = frame.info.guard, height = total.marks.height;
  const bool in_part = plan.capture.strip && height == frame.info.inner_height();
  const int first_row = in_part ? std::max(plan.capture.strip->rows.begin - guard, 0) : 0;
  const auto image = device.view(frame, names);
  if (!image) return image.error();
  std::vector<const Plane*> planes;
  for (const Plane& plane : image->planes) planes.push_back(&plane);
  add_planes(total, names, planes, first_row, height);
  return {};
}

}  // namespace umbrage
