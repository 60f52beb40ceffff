// An image around a scene: lights it, and lies behind it.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/band.h"
#include "core/gbuffer.h"
#include "core/progress.h"
#include "core/result.h"
#include "scene/environment.h"

namespace umbrage {

/// Names as of the request's fields.
struct Hdri {
  std::string file;  ///< empty: none. "sky:" is the one that is built in
  bool ambient = true, skybox = false;
  float rotation_deg = 0.0f;
  float intensity = 1.0f;
  std::shared_ptr<const Panorama> panorama;  ///< what the file holds, once read_hdri has read it

  bool lights() const { return !file.empty() && ambient; }
  bool shown() const { return !file.empty() && skybox; }
};

/// Reads the file of `hdri`, if there is one: EXR, PNG and PFM by io/, others in a process of their own. Gives
/// sentences for people who may have meant another one. Errors: kFile.
Result<std::vector<std::string>> read_hdri(Hdri& hdri, const ProgressMonitor& monitor = {});

/// The light of the image, which must have been read, over a scene with that upward direction.
Lighting image_lighting(const Hdri& hdri, glm::vec3 up);

/// The planes sky.r, sky.g and sky.b of a picture: the image's radiance, times `gain`, as each pixel's ray sees it.
/// Those rows of them alone.
Image sky_planes(const Hdri& hdri, glm::vec3 up, float gain, const PictureInfo& info, const Rows& rows);

}  // namespace umbrage
