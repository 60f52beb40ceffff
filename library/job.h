// JobObject: a job of the C interface, with the data that it keeps from one picture to the next.
#pragma once
#include <atomic>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "library/device.h"
#include "library/scene.h"
#include "library/shared_gbuffer.h"
#include "renderer/completed_scene.h"
#include "renderer/draw.h"
#include "renderer/shade_file.h"
#include "renderer/strokes.h"

namespace umbrage {

/// Returns whether an option is a parameter of "render", "shade" or "scene": see umbGetParameter.
bool is_parameter(const Option& row, std::string_view owner);

/// Returns the option that is a parameter of "render", "shade" or "scene", or null.
const Option* find_parameter(std::string_view name, std::string_view owner);

/// Returns the error for a parameter that "render", "shade" or "scene" does not have.
Error unknown_parameter(const std::string& name, std::string_view owner);

/// A requested pass, and the memory into which it is written.
struct Output {
  std::string pass;
  SharedImage image;       ///< without data: the output is written into `own`, as values of `own_type`
  std::vector<float> own;  ///< memory of the library
  PixelType own_type = PixelType::kFloat32;
};

/// See umbGetJobCounter. Callbacks and other threads may read the counters while the job executes.
struct Counters {
  std::atomic<std::int64_t> hierarchies_built = 0, captures_made = 0, planes_copied = 0;
};

class JobObject final : public Object {
 public:
  JobObject(std::shared_ptr<DeviceObject> device, std::shared_ptr<SceneObject> scene)
      : device_(std::move(device)), scene_(std::move(scene)) {}
  ~JobObject() override;

  std::string memory_purpose(const char* call) const override;
  bool renders() const { return scene_ != nullptr; }
  std::string_view kind() const { return renders() ? "render" : "shade"; }  ///< owner of its parameters
  /// Sets a parameter from text, numbers or a flag. Empty text resets it. Errors: kUsage.
  Result<void> set(const std::string& name, const std::string& text);
  Result<void> set(const std::string& name, std::span<const double> numbers);
  Result<void> set(const std::string& name, bool value);
  /// Resets a parameter; null: all parameters.
  Result<void> reset(const char* name);
  Result<void> set_image(const std::string& name, const UmbImage* image);
  Result<void> set_output(const std::string& name, const UmbImage* image);
  /// See umbCheckJob.
  Result<void> check() const;
  Result<void> prepare();
  Result<void> execute();
  Result<UmbImage> output(const std::string& name) const;
  /// Returns the name of an output; null beyond the last one.
  const char* output_name(int index) const;

  ProgressMonitor progress;
  Counters counters;
  Strokes strokes;  ///< of the last execution
  std::array<float, 3> stroke_color{};
  float stroke_opacity = 0.0f;
  std::optional<Camera> camera;  ///< of the last picture of a scene or of files
  glm::dvec3 origin{0.0};        ///< Scene::origin of that scene
  GBufferFacts facts;            ///< of the last files

 protected:
  Object* reporting_device() override { return device_.get(); }

 private:
  /// A job with all parameters resolved, as far as this is possible without its scene.
  struct ResolvedJob {
    Request request;  ///< with the requested passes
    Recipe recipe;
    StrokeParameters strokes;  ///< their parameters if strokes are requested; otherwise empty
  };
  /// Resolves the parameters, for these files if there are any and they are open. Errors: kUsage.
  Result<ResolvedJob> resolve(const GBufferFile* file = nullptr) const;
  /// Returns whether the G-buffer is read from files.
  bool reads_files() const { return !renders() && request_.gbuffer.has_files(); }
  /// Opens the files. Reports their warnings. Errors: those of GBufferFile::open; kUsage for a picture that is too
  /// large to be drawn whole.
  Result<GBufferFile> open_files();
  Request full_request() const;
  /// Returns an input image; null if it is not set.
  const NamedImage* find_image(std::string_view name) const;
  Result<Recipe> recipe_of(const Request& request, const GBufferFile* file) const;
  /// Warns of settings that have no effect. Does not repeat the warnings of the last execution.
  void report_setting_warnings(const Request& request, const Recipe& recipe);
  Result<Frame> render_frame(Recipe recipe);
  Result<Frame> shade_frame(const Request& request, const Recipe& recipe);
  Result<Frame> shade_files(const GBufferFile& file, const Recipe& recipe);
  /// Returns a monitor for the work that precedes drawing. It reports 0, since the reported fractions are those of
  /// drawing.
  ProgressMonitor preparation_progress() const;
  /// Prepares the scene, and reads the environment image into the recipe.
  Result<void> prepare_scene(Recipe& recipe, const ProgressMonitor& monitor);
  Result<void> prepare_device(const ProgressMonitor& monitor);
  Result<Frame> draw_frame(const Plan& plan);
  Result<void> write_outputs(const Frame& frame, const Recipe& recipe, std::vector<Output> requested);
  Result<void> fill(const Frame& frame, const Recipe& recipe, const std::vector<std::string>& planes, Output& output);
  /// Returns the outputs of a job for which no output is set.
  std::vector<Output> default_outputs(const Recipe& recipe) const;

  std::shared_ptr<DeviceObject> device_;
  // Allocated in advance, since the destructor cannot fail.
  std::list<DeviceObject::DeferredRelease> deferred_release_{1};
  std::shared_ptr<SceneObject> scene_;
  Request request_;
  std::map<std::string, std::string> settings_;  // of effects, by "effect.parameter"
  std::vector<NamedImage> images_;
  std::vector<Output> outputs_;         // requested by the caller
  std::vector<Output> results_;         // of the last execution
  SharedIds ids_;                       // of the last G-buffer
  std::optional<SequenceStart> start_;  // of a sequence: of its first picture
  std::vector<std::string> reported_;   // the last warnings of settings without effect

  // Data of the last picture of a scene:
  CompletedScene completed_;
  std::map<std::string, Lighting> lightings_;  // lights found for a camera inside the scene, by light_key
  Hdri hdri_;                                  // with its panorama
  KeptCapture kept_;
};

}  // namespace umbrage
