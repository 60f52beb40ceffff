// Plan: how one scene is drawn by a recipe. Camera, lights and every effect's parameters are fixed, lengths are in
// scene units, the scene makes what passes want, and all that can be wrong with a request has been told: drawing reads
// the plan alone.
#pragma once
#include "renderer/recipe.h"

namespace umbrage {

struct Plan {
  Recipe recipe;  ///< of one frame
  Camera camera;
  CaptureSettings capture;         ///< with the lighting
  bool lit_from_camera = false;    ///< that was made for the camera, and goes around the scene with it
  glm::vec3 up{0.0f, 1.0f, 0.0f};  ///< of the scene
  bool has_ground = false;         ///< the scene was furnished with one
  float sky_gain = 1.0f;           ///< on the image around the scene, where that is seen
  ParameterBytes output;           ///< how the finished picture is made of averaged frames
  ParameterBytes lines;  ///< of `outline`, where that is drawn once, by frame 0, over averaged frames; or empty
  int first_noise = 0;   ///< of frame 0: see Effect::noise

  Lighting& lighting() { return *capture.lighting; }
  const Lighting& lighting() const { return *capture.lighting; }
  /// Frames are drawn from the last to the first, which has its samples at the pixels' centres.
  bool averages() const { return recipe.frames > 1; }
};

/// Whether the picture wants a ground below a scene, which may lack one.
bool wants_ground(const Scene& scene, bool lacks_one, const Recipe& recipe);

/// Adds to a scene what the picture wants besides the model: the ground, and the light of the image around it, which
/// takes the place of the scene's own. Before a device is prepared.
void furnish(Scene& scene, const Recipe& recipe);

/// The plan of a furnished scene, in the light of recipe.capture where that has one. Lights that the scene lacks are
/// found with so many threads; 0: all. Errors: kUsage; kInterrupted.
Result<Plan> make_plan(const Recipe& recipe, const Scene& scene, int threads, const ProgressMonitor& monitor = {});

/// The plan of a model that has turned before the camera: this has gone so far around, counterclockwise as seen from
/// above. The light of an image around the scene goes along, and so does the light that a scene without any got from
/// the first plan; what a scene brings, and what was made for a camera inside it, is part of the model.
Plan turned(const Plan& first, const Scene& scene, float angle_deg);

/// Makes it that frame of several that are averaged, and returns its camera.
Camera begin_frame(Plan& plan, int frame);

}  // namespace umbrage
