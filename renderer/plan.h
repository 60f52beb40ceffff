// Plan: a recipe resolved for one scene. Camera, lights and all effect parameters are fixed, lengths are in scene
// units, the requested passes exist, and all errors of the request are reported. Drawing depends on the plan only.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "renderer/recipe.h"
#include "renderer/strokes.h"

namespace umbrage {

/// The planes that a frame has before any effect runs.
struct GivenPlanes {
  std::vector<std::string> names;
  std::vector<std::string> softened;  ///< shadows: within kSoftenMargin of the border of what is captured, they differ

  /// Returns the margin around a result with which they must be captured, for margins of program/program.h.
  Margin needed(const Margins& margins) const;
};

struct Plan {
  Recipe recipe;  ///< for one sample of the picture
  Camera camera;
  CaptureSettings capture;       ///< includes the lighting
  bool lit_from_camera = false;  ///< the lights were placed relative to the camera and rotate with it around the scene
  glm::vec3 up{0.0f, 1.0f, 0.0f};  ///< up direction of the scene
  glm::dvec3 origin{0.0};          ///< Scene::origin
  bool has_ground = false;         ///< the scene has a ground that `complete_scene` added
  bool has_blended = false;        ///< the picture shows blended surfaces: each sample blends two pictures, see blend.h
  float sky_gain = 1.0f;           ///< factor for the radiance of the environment image as background
  ParameterBytes output;           ///< parameters of `output` for the averaged picture
  /// Parameters of the effects whose lines are drawn once, by sample 0, over the averaged picture; else empty.
  StrokeParameters lines;
  std::shared_ptr<const LinesBetween> lines_between;  ///< see PictureInfo::lines_between
  int sample = 0;               ///< index of the sample to which the plan is set: see begin_picture
  int first_noise = 0;          ///< noise index of sample 0: see Effect::noise
  int first_shadow_sample = 0;  ///< CaptureSettings::sample of sample 0
  PictureInfo info;             ///< of sample 0
  GivenPlanes given;            ///< of the picture without blended surfaces
  /// Samples beyond the first are drawn only at the pixels that the first one marks: see marked_samples.h. Then sample
  /// 0 is drawn first.
  bool marked = false;
  /// The view of the whole model whose exposure the picture has, so that it does not change with the camera. Null if
  /// nothing is metered on a picture, or the camera is inside the scene: the picture's own view is metered.
  std::shared_ptr<const Plan> metered;
  std::shared_ptr<const Scene> start;  ///< of `metered`: Scene::start, on which the exposure is metered

  Lighting& lighting() { return *capture.lighting; }
  const Lighting& lighting() const { return *capture.lighting; }
  /// Returns whether the picture is the mean of several pictures: samples, and the two pictures of blended surfaces.
  /// Index 0 samples the pixel centres.
  bool averages() const { return pictures() > 1; }
  int pictures() const { return recipe.frames * (has_blended ? 2 : 1); }
};

/// Returns whether a ground is added below the scene: if the look uses one, the camera is outside the model and above
/// its foot, and the picture shows no ground of the scene's own; or if the request asks for it.
bool needs_ground(const Scene& scene, const Recipe& recipe);

/// Adds to a scene what the picture needs besides the model: the ground, and the light of the environment image, which
/// replaces the scene's lights. Call it before Device::prepare.
Result<void> complete_scene(Scene& scene, const Recipe& recipe);

/// Plans a scene that `complete_scene` has completed. Uses the lighting of recipe.capture if it has one. Missing lights
/// are placed using `threads` threads; 0: all. Errors: kUsage; kInterrupted.
Result<Plan> make_plan(const Recipe& recipe, const Scene& scene, int threads, const ProgressMonitor& monitor = {});

/// Applies the directions and factors that a request gives for lights in the space of `camera`. `of_studio`: the lights
/// are those of studio_lighting, of which the second and third are the fill and the rim light.
void adjust_lights(const Recipe& recipe, const Camera& camera, bool of_studio, std::vector<Light>& lights);

/// Returns the plan with the model turned in front of the camera: the camera moves by `angle_deg` around it,
/// counterclockwise as seen from above. The environment image and lights that were placed relative to the camera move
/// with it; the scene's own lights, and those placed for a camera inside the scene, belong to the model.
Plan turned(const Plan& first, const Scene& scene, float angle_deg);

/// Returns the plan with another view of the scene. The lights stay where they are.
Plan seen_from(const Plan& first, const Scene& scene, const Framing& framing);

/// Returns the plans of the frames of a sequence. `pose` moves the camera, the model or the lights of the first plan.
/// All frames have the exposure of the first one, whichever are drawn. If the recipe is steady, each frame has noise of
/// its own: it begins `stride` indices after that of the frame before.
std::function<Plan(int frame)> plans_of_sequence(Plan first, int stride,
                                                 std::function<Plan(const Plan& first, int frame)> pose);

/// Returns the program of sample 0.
Program program_of(const Plan& plan);

/// Returns the names of the planes that the frame of a drawn plan can have.
std::vector<std::string> planes_of_frame(const Plan& plan);

/// A picture of a plan: sample index, and whether it shows blended surfaces.
struct PictureIndex {
  int sample = 0;
  bool blended = false;
};

/// Returns the pictures of a plan that are drawn at all pixels, in the order in which they are drawn: samples in
/// descending order, of each the one with blended surfaces first. The last one is that of sample 0 without them.
std::vector<PictureIndex> pictures_of(const Plan& plan);

/// Gives the technique of a recipe the noise of a later sample.
void advance_noise(Recipe& recipe, int samples);

/// Sets the plan to a picture, which is none of those drawn at marked pixels only, and returns its camera.
Camera begin_picture(Plan& plan, const PictureIndex& picture);

}  // namespace umbrage
