// Options that several commands share, and their text forms.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/config.h"
#include "renderer/job.h"

namespace CLI {
class App;
}

namespace umbrage::cli {

/// What the scene, camera, picture and device options hold, as written. Names follow f3d (scene, camera, window) and
/// OIDN (device, threads).
struct CommonOptions {
  std::vector<std::string> models;
  std::string input_format;
  std::string resolution = "1024,1024";
  std::string point_size, point_shape = "auto";
  std::string up, scene_index, crease_angle, position, focal_point, view_up, direction;
  std::string camera_index, view_angle, azimuth = "0", elevation = "0", zoom = "1";
  bool orthographic = false;
  std::string look = "studio", occlusion, occlusion_scale, radius, anti_aliasing, quality, ground = "auto";
  std::vector<std::string> settings;
  std::string layers, extra_views, guard_band = "0%";
  std::string background;
  bool no_background = false;
  std::string hdri_file, hdri_rotation = "0", hdri_intensity = "1", light_size;
  bool hdri_ambient = true, hdri_skybox = false;
  std::string device = "auto", threads = "0", isa;
  bool verbose = false;
};

/// Models and how they are read.
void add_model_options(CLI::App& command, CommonOptions& options);
/// The same, and the camera.
void add_scene_options(CLI::App& command, CommonOptions& options);
void add_technique_options(CLI::App& command, CommonOptions& options);
void add_picture_options(CLI::App& command, CommonOptions& options);
void add_device_options(CLI::App& command, CommonOptions& options);

/// What shines on the scene.
void add_light_options(CLI::App& command, CommonOptions& options);

/// The options, parsed. Errors: kUsage, naming the option and what it takes, also for a picture of more than
/// `most_pixels`.
Result<DrawSettings> draw_settings(const CommonOptions& options, long most_pixels = kMostPixels);
Result<ImportSettings> import_settings(const CommonOptions& options);
Result<std::unique_ptr<Device>> device_of(const CommonOptions& options);

/// "1024,768" or "1024x768".
Result<std::pair<int, int>> parse_resolution(std::string_view text, long most = kMostPixels);

/// "+Y", "-z" or "0,1,0".
Result<glm::vec3> parse_direction(std::string_view option, std::string_view text);

/// A whole number. Errors: kUsage, naming the option.
Result<int> parse_whole(std::string_view option, std::string_view text, int least, int most);
Result<double> parse_number(std::string_view option, std::string_view text, double least, double most);

/// Whether a folder can be made, or these files written into the one that is there, before any work; makes nothing.
Result<void> check_folder(const std::filesystem::path& folder, std::initializer_list<const char*> files);

/// The words of a list parted by commas.
std::vector<std::string> split(const std::string& text);

}  // namespace umbrage::cli
