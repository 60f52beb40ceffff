// ViewModel: a loaded model or G-buffer, and what is kept from one of its pictures to the next.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/view/quality.h"
#include "gbuffers/gbuffer_file.h"
#include "renderer/completed_scene.h"
#include "renderer/steady.h"

namespace umbrage::view {

/// A device with what it is prepared for.
struct DrawingDevice {
  std::unique_ptr<Device> device;
  long prepared = 0;                  ///< number of the scene that the device is prepared for: see ViewModel; 0: none
  std::optional<PlanePoolLock> kept;  ///< keeps the planes of one picture for the next
  std::pair<int, int> sizes[2];       ///< last ones of pictures of full size, and of others, pixels

  /// Keeps the memory of planes while pictures of full size, and others, have the same size as the last ones.
  void keep_memory_for(int width, int height, bool is_full_size);
};

/// How a picture is drawn.
struct DrawControl {
  bool moving = false;
  /// Width / height of what is shown, if the size of the picture was rounded: nothing is distorted. 0: as the size.
  double aspect = 0.0;
  ProgressMonitor monitor = {};
  /// Receives the picture, whose planes are as for write_image: after the samples of the request, and then of each
  /// larger number of samples that is wanted. `is_final`: further samples would not change it.
  std::function<Result<void>(const Image& picture, int samples, bool is_final)> take = {};
  int max_samples = 0;  ///< to which the picture is refined; 0: it is not
  /// As in Continuation, for numbers of samples below max_samples. Needed only with it.
  std::function<bool(int samples)> wants_mean = {}, wants_another = {};
};

/// What the page has to know of a loaded file. Vectors are in the coordinates of the file.
struct ModelFacts {
  std::string summary;  ///< "69,666 triangles"
  std::vector<std::string> warnings;
  glm::dvec3 center{0.0}, extent{0.0};  ///< of the bounding box
  double radius = 1.0;
  glm::vec3 up{0.0f, 1.0f, 0.0f};
  int width = 0, height = 0;  ///< of a G-buffer, pixels; else 0
  std::string look;           ///< of a G-buffer: that which shades it if none is chosen; else empty
};

/// A camera as options of the command line describe it, in the coordinates of the file.
struct ViewCamera {
  glm::dvec3 position{0.0}, focal_point{0.0};
  glm::dvec3 view_up{0.0, 1.0, 0.0};
  double view_angle_deg = 30.0;
  bool orthographic = false;
};

class ViewModel {
 public:
  /// Loads a model with the import options of a request, or a G-buffer. Errors: those of load_scene, of
  /// import_settings and of GBufferFile::open.
  static Result<std::unique_ptr<ViewModel>> load(const std::string& file, bool is_gbuffer, const Request& request,
                                                 const ProgressMonitor& monitor = {});
  ~ViewModel();

  bool is_gbuffer() const { return gbuffer_.has_value(); }
  const ModelFacts& facts() const { return facts_; }
  /// Returns a number that no other loaded file of the process has.
  long number() const { return loaded_; }
  /// Returns whether it was loaded with the import options of this request.
  bool is_loaded_for(const Request& request) const;
  /// Returns the camera with which the request draws the model. Errors: those of make_recipe and of use_camera.
  Result<ViewCamera> camera(const Request& request);

  /// Draws a picture of the request, whose size a G-buffer ignores. Its pixels are those of `umbrage render` or
  /// `umbrage shade`, unless it is moving. Errors: kUsage, with fields as in renderer/options.h; kInterrupted;
  /// those of the device.
  Result<void> draw(DrawingDevice& device, const Request& request, const DrawControl& control, StageTimes& times);

  /// Draws a picture as above, but returns these of its planes as they are, with values of passes where there is no
  /// surface. A G-buffer has no such planes: kUsage.
  Result<Image> planes(DrawingDevice& device, const Request& request, const std::vector<std::string>& names,
                       const DrawControl& control, StageTimes& times);

  /// Returns the point of the surface that a request shows at a pixel centre next to (`x`, `y`), both from 0 to 1 from
  /// the upper left corner: in the coordinates of the file. Nothing if there is no surface, or it is a G-buffer.
  /// Errors: those of draw.
  Result<std::optional<glm::dvec3>> surface_at(DrawingDevice& device, const Request& request, double x, double y,
                                               const DrawControl& control, StageTimes& times);

  /// Forgets what a device that is about to be destroyed has captured.
  void forget_captures();

 private:
  /// The last frames of a camera that moves.
  struct Live {
    Plan plan;  ///< of the newest one
    int count = 0;
    std::optional<float> stops = {};
    std::optional<SteadySequence> sequence = {};
  };

  ViewModel() = default;
  Result<const Scene*> complete(Recipe& recipe, const ProgressMonitor& monitor);
  Result<void> prepare(DrawingDevice& device, const ProgressMonitor& monitor) const;
  /// Receives a drawn frame; `averages`: whether the picture is the mean of several.
  using GiveFrame = std::function<Result<void>(const Recipe& recipe, const Frame& frame, int samples, bool averages)>;
  Result<void> draw_scene(DrawingDevice& device, const Request& request, std::span<const std::string_view> besides,
                          const DrawControl& control, StageTimes& times, const GiveFrame& give);
  /// Draws a frame of a camera that moves, joined with those before it that differ in the camera alone.
  Result<Drawn> draw_live(DrawingDevice& device, const Plan& plan, const DrawControl& control, StageTimes& times);
  Result<void> shade(DrawingDevice& device, const Request& request, const DrawControl& control, StageTimes& times);

  bool is_cad_ = false;
  std::string import_key_;
  long loaded_ = 0;
  ModelFacts facts_;
  Scene scene_;  // as loaded
  CompletedScene completed_;
  long number_ = 0;             // of the completed scene, unique in the process
  Hdri hdri_;                   // with its panorama
  KeptCapture capture_;         // of the last picture of full size
  KeptCapture moving_capture_;  // of the last one whose size was chosen to be drawn in time
  const Device* captured_by_ = nullptr;
  std::optional<Camera> moving_camera_;  // of the last such picture
  std::optional<Live> live_;
  std::optional<GBufferFile> gbuffer_;
  std::optional<GBuffer> planes_;  // of gbuffer_
};

}  // namespace umbrage::view
