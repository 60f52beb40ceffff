// Shades G-buffers of other renderers: planes as a whole picture, and image files whole or in strips.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gbuffers/gbuffer_file.h"
#include "renderer/draw.h"
#include "renderer/recipe.h"
#include "renderer/strips.h"
#include "renderer/times.h"

namespace umbrage {

/// Resolves a request for the planes of a file. Without a look in the request: `comp` if the file has a beauty, else
/// `studio`. Errors: kUsage.
Result<Recipe> make_file_recipe(const Request& request, const GBufferFile& file);

/// What later frames of a sequence take from the first one, so that the picture does not change from frame to frame.
struct SequenceStart {
  float scene_radius = 0.0f;                            ///< see GBufferSettings::scene_radius
  std::optional<float> stops;                           ///< exposure by metering
  float depth_min = 0.0f, depth_max = 0.0f;             ///< see PictureInfo; both 0: of the frame itself
  std::shared_ptr<const Conventions> conventions = {};  ///< for GBufferFile::open; null: of the frame itself
};

/// Sets what a later frame takes from the first one. Returns `info` unchanged if `start` is empty.
PictureInfo started(PictureInfo info, const std::optional<SequenceStart>& start);
/// Returns what later frames take from this one, with the exposure `stops`.
SequenceStart start_of(const PictureInfo& info, float stops);

/// A file that was shaded whole.
struct ShadedFile {
  Frame frame;  ///< not reduced
  SequenceStart start;
};

/// Shades a file as a whole. `start`: as for shade_file. Errors: those of shade_file.
Result<ShadedFile> shade_whole_file(Device& device, const GBufferFile& file, const Recipe& recipe,
                                    const std::optional<SequenceStart>& start, StageTimes& times,
                                    const ProgressMonitor& monitor = {});

/// Shades a file and passes finished rows with `planes`, from top to bottom, to `take`: all at once, or in strips if
/// the picture does not fit in memory; both are bitwise identical. The rows are reduced as the request says.
/// Returns what later frames take. `start`: of the first frame; empty for it. Errors: kUsage; kFile; kInterrupted.
Result<SequenceStart> shade_file(Device& device, const GBufferFile& file, const Recipe& recipe,
                                 const std::vector<std::string>& planes, const TakeRows& take,
                                 const std::optional<SequenceStart>& start, StageTimes& times,
                                 const ProgressMonitor& monitor = {});

/// Plans the shading of a file as plan_strips does, for `memory` bytes; empty: the memory with which the file was
/// opened. `recipe`: from make_file_recipe. Errors: kUsage if the picture is too large for the device.
Result<StripSizes> plan_file_strips(const Device& device, const GBufferFile& file, const Recipe& recipe,
                                    std::optional<double> memory = {});

/// Internal to renderer/. Shades a file in strips of `rows` rows, a multiple of 4. The result is bitwise identical to
/// that of shade_planes. Errors: as shade_file.
Result<SequenceStart> shade_strips(Device& device, const GBufferFile& file, const Recipe& recipe, int rows,
                                   const std::vector<std::string>& planes, const TakeRows& take,
                                   const std::optional<SequenceStart>& start, StageTimes& times,
                                   const ProgressMonitor& monitor = {});

/// Returns a recipe from make_shading_recipe with its radius in scene units. If `info` of a G-buffer has no lights, a
/// look gets the default lights, placed relative to the camera as for a model without lights. Errors: kUsage for a
/// radius larger than the scene.
Result<Recipe> complete_shading(const Recipe& recipe, PictureInfo& info);

/// Shades a G-buffer of another renderer with a recipe from make_shading_recipe. Missing normals are reconstructed from
/// depth. `stops`: exposure of another picture, used in place of metering. Errors: kUsage for missing planes; those of
/// complete_shading; kInterrupted.
Result<Drawn> shade_planes(Device& device, GBuffer gbuffer, const Recipe& recipe, StageTimes& times,
                           const ProgressMonitor& monitor = {}, std::optional<float> stops = {});

/// Shades a G-buffer up to its occlusion technique, as draw_technique, and the rest, as draw_after_technique.
/// `completed`: from complete_shading, which has added the lights to the G-buffer. Errors: as shade_planes.
Result<Frame> shade_technique(Device& device, GBuffer gbuffer, const Recipe& completed, StageTimes& times,
                              const ProgressMonitor& monitor = {});
Result<Drawn> shade_after_technique(Device& device, const Frame& technique, const Recipe& completed, StageTimes& times,
                                    const ProgressMonitor& monitor = {}, std::optional<float> stops = {});

}  // namespace umbrage
