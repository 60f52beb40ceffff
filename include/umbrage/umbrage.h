// Umbrage's public interface: a model in, a picture out.
//
// This header needs nothing but the standard library. It grows with the project; what it holds stays.
#pragma once
#include <memory>
#include <string>
#include <vector>

namespace umbrage {

/// What to draw. Everything but the model has a value that serves.
struct RenderRequest {
  std::string model;                  ///< a file (OBJ, PLY, STL, glTF/GLB, 3DS, DAE, FBX, OFF) or "scene:NAME?detail=N"
  std::string look = "studio";        ///< a recipe: see `umbrage list looks`
  std::string occlusion;              ///< an occlusion technique, or "none"; empty: the look's own
  std::vector<std::string> settings;  ///< "effect.parameter=value": see `umbrage list effects`
  int width = 1024, height = 1024;    ///< pixels, 1 to 16384 each
  int threads = 0;                    ///< 0: as many as the machine has
};

/// A picture as it would be written to an 8-bit file: row 0 at the top, red, green, blue, alpha from 0 to 1.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgba;  ///< width * height * 4
};

/// How it went. `code` is 0, or the exit code that the command line would give: 1 internal, 2 a wrong request, 3 a file
/// that cannot be used, 4 a device that cannot do it; `message` is then one sentence for people.
struct Outcome {
  int code = 0;
  std::string message;
  std::vector<std::string> warnings;  ///< such as missing textures
};

/// Draws one picture on the CPU. On failure the picture is left as it was. Does not throw, except std::bad_alloc.
Outcome render(const RenderRequest& request, Picture& picture);

/// A camera of one frame. Where `placed` is false the model is framed as `render` does.
struct FrameCamera {
  bool placed = false;
  float eye[3] = {0, 0, 1}, target[3] = {0, 0, 0}, up[3] = {0, 1, 0};
  float angle_deg = 30.0f;  ///< vertical field of view
};

/// Draws one model again and again: it is read and made ready once, then each frame is captured and shaded, and the
/// memory of the one before is used again. Not for several threads at once.
class FrameRenderer {
 public:
  FrameRenderer();
  ~FrameRenderer();
  FrameRenderer(FrameRenderer&&) noexcept;
  FrameRenderer& operator=(FrameRenderer&&) noexcept;

  /// `device`: "cpu", "vulkan", "vulkan:N", or "auto", a GPU if there is one. Errors: as of render. On failure what was
  /// open stays.
  Outcome open(const RenderRequest& request, const std::string& device = "auto");
  /// One picture. A model without lights is lit as its first frame's camera stands. Errors: code 4 where memory is
  /// short or the device is lost; the picture is then left as it was, and other frames may be tried.
  Outcome draw(const FrameCamera& camera, Picture& picture);
  /// "vulkan:0: NVIDIA ..."; empty: nothing is open.
  std::string device() const;
  /// Bytes of the GPU's memory that it holds; 0 on the CPU.
  unsigned long long device_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// "0.1.0"
const char* version();

}  // namespace umbrage
