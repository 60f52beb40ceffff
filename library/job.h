// JobObject: a picture of the C interface that is made again and again, and what it keeps from one to the next.
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
#include "renderer/draw.h"
#include "renderer/lines.h"
#include "renderer/shared_gbuffer.h"

namespace umbrage {

/// Whether a row is a parameter of "render", "shade" or "scene": see umbGetParameter.
bool is_parameter(const Option& row, std::string_view owner);

/// That "render", "shade" or "scene" has no such parameter.
Error unknown_parameter(const std::string& name, std::string_view owner);

/// A pass that is wanted, and where.
struct Output {
  std::string pass;
  SharedImage image;       ///< without data: in `own`
  std::vector<float> own;  ///< the library's memory
};

/// See umbGetJobCounter. Callbacks and other threads may look while the job executes.
struct Counters {
  std::atomic<std::int64_t> hierarchies_built = 0, captures_made = 0, planes_copied = 0;
};

class JobObject final : public Object {
 public:
  JobObject(std::shared_ptr<DeviceObject> device, std::shared_ptr<SceneObject> scene)
      : device_(std::move(device)), scene_(std::move(scene)) {}
  ~JobObject() override;

  std::string asked(const char* call) const override;
  bool renders() const { return scene_ != nullptr; }
  /// A parameter from text, numbers or a flag. Empty text resets it. Errors: kUsage.
  Result<void> set(const std::string& name, const std::string& text);
  Result<void> set(const std::string& name, std::span<const double> numbers);
  Result<void> set(const std::string& name, bool value);
  /// Null: all.
  Result<void> reset(const char* name);
  Result<void> set_image(const std::string& name, const UmbImage* image);
  Result<void> set_output(const std::string& name, const UmbImage* image);
  /// See umbCheckJob.
  Result<void> check() const;
  Result<void> prepare();
  Result<void> execute();
  Result<UmbImage> output(const std::string& name) const;
  /// Null beyond the last.
  const char* output_name(int index) const;

  ProgressMonitor progress;
  Counters counters;
  Lines lines;  ///< of the last execution
  std::array<float, 3> line_color{};
  float line_opacity = 0.0f;

 protected:
  DeviceObject* teller() override { return device_.get(); }

 private:
  /// What an execution is to do, as far as the parameters tell.
  struct Order {
    Request request;  ///< with the passes that are wanted
    Recipe recipe;
    ParameterBytes lines;  ///< of the lines where strokes are wanted; else empty
  };
  /// Errors: kUsage.
  Result<Order> order() const;
  Request full_request() const;
  /// Null where it is not set.
  const NamedImage* find_image(std::string_view name) const;
  Result<Recipe> recipe_of(const Request& request) const;
  /// Warns of settings that do nothing, but of the same ones once.
  void tell_unused(const Request& request, const Recipe& recipe);
  Result<Frame> rendered(Recipe recipe);
  Result<Frame> shaded(const Request& request, const Recipe& recipe);
  /// The caller's progress for what comes before the drawing, which is what shares are told of.
  ProgressMonitor before_drawing() const;
  /// Gives the recipe the image around the scene, too.
  Result<void> make_scene_ready(Recipe& recipe, const ProgressMonitor& before);
  Result<void> choose_view(const Recipe& recipe);
  Result<void> prepare_device(const ProgressMonitor& before);
  Result<Frame> drawn(const Plan& plan);
  Result<void> hand_out(const Frame& frame, std::vector<Output> outputs);
  Result<void> fill(const Frame& frame, const std::vector<std::string>& planes, Output& output);
  /// What is wanted where no output is set.
  std::vector<Output> usual_outputs(const Recipe& recipe) const;

  std::shared_ptr<DeviceObject> device_;
  std::list<DeviceObject::Left> last_left_{1};  // memory for the end, when there may be none
  std::shared_ptr<SceneObject> scene_;
  Request request_;
  std::map<std::string, std::string> settings_;  // of effects, by "effect.parameter"
  std::vector<NamedImage> images_;
  std::vector<Output> outputs_;    // that are set
  std::vector<Output> made_;       // by the last execution
  SharedIds ids_;                  // of the last G-buffer
  std::vector<std::string> told_;  // of settings that do nothing

  // Of the last picture of a scene:
  std::unique_ptr<Scene> furnished_;
  std::string furnished_for_;                  // what of the request and the scene it was made for
  bool lacks_ground_ = false;                  // the scene that was furnished
  long furnished_version_ = -1;                // of the scene
  std::vector<View> views_;                    // that it suggests by itself
  std::map<std::string, Lighting> lightings_;  // that were made for a scene without lights, by light_key
  Hdri hdri_;                                  // with its panorama
  std::optional<Plan> captured_plan_;
  Captures captures_;
};

}  // namespace umbrage
