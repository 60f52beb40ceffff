// Runs a shader kit on an OpenGL context without a window.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"
#include "kit/kit.h"

namespace umbrage::test {

/// A texture: `channels` floats per pixel, row 0 at the top.
struct Texels {
  int width = 0, height = 0, channels = 1;
  std::vector<float> values;
};

/// A context of OpenGL 4.3, or of OpenGL ES 3.0 for kits in GLSL ES.
class GlContext {
 public:
  /// Returns null, with a reason in `reason`, if there is no driver.
  static std::unique_ptr<GlContext> make(bool is_es, std::string& reason);
  ~GlContext();

  /// Draws all passes. `textures` has the inputs, and afterwards all textures that passes have written. `blocks`: the
  /// content of the uniform block of an effect, by pass. Returns the first error of the driver, or an empty text.
  std::string run(const Kit& kit, const std::vector<std::vector<std::byte>>& blocks,
                  std::map<std::string, Texels>& textures);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace umbrage::test
