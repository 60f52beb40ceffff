// Environment image: lights a scene, is its background, or both.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/gbuffer.h"
#include "core/progress.h"
#include "core/result.h"
#include "core/strip.h"
#include "scene/environment.h"

namespace umbrage {

/// An environment image and how it is used. The fields correspond to the hdri_ fields of Request.
struct Hdri {
  std::string file;  ///< empty: none; "sky:": the built-in sky
  bool ambient = true, skybox = false;
  float rotation_deg = 0.0f;
  float intensity = 1.0f;
  std::shared_ptr<const Panorama> panorama;  ///< pixels of the file; set by read_hdri

  bool lights() const { return !file.empty() && ambient; }
  bool shown() const { return !file.empty() && skybox; }
};

/// Reads the file of `hdri`, if any: EXR, PNG and PFM with the readers of io/, other formats in a separate process.
/// Returns warnings. Errors: kFile.
Result<std::vector<std::string>> read_hdri(Hdri& hdri, const ProgressMonitor& monitor = {});

/// Returns the light of an image that has been read, for a scene whose upward direction is `up`; with `reflects`,
/// including what rough and mirroring surfaces reflect.
Lighting image_lighting(const Hdri& hdri, glm::vec3 up, bool reflects);

/// Returns the planes sky.r, sky.g and sky.b of a picture: the image's radiance times `gain` along each pixel's ray.
/// The planes contain only `rows`.
Image sky_planes(const Hdri& hdri, glm::vec3 up, float gain, const PictureInfo& info, const Rows& rows);

}  // namespace umbrage
