// Figures 1 to 6 and the claims about cost of [Chamberlin 2011].
#include <algorithm>
#include <cmath>

#include "apps/figures/figures.h"
#include "apps/figures/measure.h"
#include "apps/figures/studio.h"
#include "effects/unsharp/unsharp.h"

namespace umbrage {
namespace {

/// Opens a model in the look `unsharp`. Numbers are measured per pixel: edges keep their stair steps, as in the paper.
Result<Studio> open_unsharp(Device& device, const std::string& model, int size) {
  auto studio = open_studio(device, model, "unsharp", size);
  if (studio) studio->draw.anti_aliasing = 1;
  return studio;
}

float gray(const Shot& shot, int x, int y) { return shot.value("color.g", x, y); }

/// Returns the mean absolute difference of two pictures over the pixels for which `belongs` is true.
template <class Test>
double mean_change(const Shot& a, const Shot& b, const Test& belongs) {
  double sum = 0.0;
  long count = 0;
  for (int y = 0; y < a.image.height; ++y)
    for (int x = 0; x < a.image.width; ++x)
      if (belongs(x, y)) sum += std::abs(gray(a, x, y) - gray(b, x, y)), ++count;
  return count > 0 ? sum / double(count) : std::nan("");
}

template <class Test>
double mean_gray(const Shot& shot, const Test& belongs) {
  double sum = 0.0;
  long count = 0;
  for (int y = 0; y < shot.image.height; ++y)
    for (int x = 0; x < shot.image.width; ++x)
      if (belongs(x, y)) sum += std::clamp(gray(shot, x, y), 0.0f, 1.0f), ++count;
  return count > 0 ? sum / double(count) : std::nan("");
}

constexpr double kAnything = 1e30;
constexpr double kOneStep = 1.0 / 255.0;  // one step of an 8-bit picture
constexpr double kPaperSize = 1024.0;     // side of the paper's pictures, pixels

/// Returns the setting of a kernel window of the paper, scaled to `size` pixels.
std::string window(int k, int size) {
  return fmt::format("unsharp.kernel={}", std::max(1, int(std::lround(k * size / kPaperSize))));
}

Result<Figure> tank_figure(Device& device, int size) {
  auto studio = open_unsharp(device, "scene:tank", size);
  if (!studio) return studio.error();
  const auto without = studio->shoot({}, "none");
  const auto with = studio->shoot({window(40, size), "unsharp.threshold=0.1"});
  if (const auto error = error_of(without, with)) return *error;
  // The region where tracks and hull meet the ground at the rear, up to half a metre high.
  const auto lower_rear = [&](int x, int y) {
    if (!with->surface(x, y)) return false;
    const glm::vec3 p = with->world(x, y);
    return p.z < -2.0f && p.z > -3.7f && p.y < 0.5f && std::abs(p.x) < 1.9f;
  };
  return Figure{
      "1, 6",
      "A tank without and with the unsharp mask",
      {without->picture("unsharp-6-without.png", "without"), with->picture("unsharp-6-with.png", "with, k = 40")},
      {{"fall of the mean over the tank's lower rear", mean_gray(*without, lower_rear) - mean_gray(*with, lower_rear),
        0.03, kAnything}}};
}

Result<Figure> border_figure(Device& device, const std::string& bunny, int size) {
  auto studio = open_unsharp(device, bunny, size);
  if (!studio) return studio.error();
  studio->framing.zoom = 3.6f;  // the flank extends beyond the picture's sides
  const std::string kernel = window(40, size);
  const auto off = studio->shoot({kernel, "unsharp.threshold=0", "unsharp.border=zero"});
  const auto on = studio->shoot({kernel, "unsharp.threshold=0", "unsharp.border=skip"});
  const auto none = studio->shoot({}, "none");
  if (const auto error = error_of(off, on, none)) return *error;
  const int reach = std::max(1, int(std::lround(20 * size / kPaperSize)));  // k / 2
  // Measure only below the silhouette of the back, since its white edge is the subject of figure 4.
  const auto side = [&](const Shot& shot) {
    return mean_gray(shot, [&](int x, int y) {
      const int from_side = std::min(x, shot.image.width - 1 - x);
      return from_side < reach && y > shot.image.height / 3 && y < shot.image.height - reach && shot.surface(x, y);
    });
  };
  return Figure{
      "2",
      "Border check off: the sides darken",
      {none->picture("unsharp-2-without.png", "without"), off->picture("unsharp-2-off.png", "check off, threshold off"),
       on->picture("unsharp-2-on.png", "check on, threshold off")},
      {{"darker within k/2 of the sides, check off", side(*none) - side(*off), 0.05, kAnything},
       {"darker within k/2 of the sides, check on", side(*none) - side(*on), -0.02, 0.02}}};
}

Result<Figure> bunny_figure(Device& device, const std::string& bunny, int size) {
  auto studio = open_unsharp(device, bunny, size);
  if (!studio) return studio.error();
  // From the front, where the chin is in front of the chest.
  studio->framing.azimuth_deg = -55.0f;
  studio->framing.elevation_deg = -10.0f;
  const auto gouraud = studio->shoot({}, "none");
  const auto small = studio->shoot({window(15, size)});
  const auto large = studio->shoot({window(40, size)});
  if (const auto error = error_of(gouraud, small, large)) return *error;
  // The chest directly under the chin, in fractions of the picture.
  const auto under_chin = [&](int x, int y) {
    const double u = (x + 0.5) / size, v = (y + 0.5) / size;
    return u > 0.22 && u < 0.32 && v > 0.522 && v < 0.542 && large->surface(x, y);
  };
  const double none = mean_gray(*gouraud, under_chin), k15 = mean_gray(*small, under_chin),
               k40 = mean_gray(*large, under_chin);
  return Figure{"3",
                "The bunny with Gouraud shading, k = 15 and k = 40",
                {gouraud->picture("unsharp-3-gouraud.png", "Gouraud"), small->picture("unsharp-3-k15.png", "k = 15"),
                 large->picture("unsharp-3-k40.png", "k = 40")},
                {{"under the chin, k = 15 darker than without", none - k15, kOneStep, kAnything},
                 {"under the chin, k = 40 darker than k = 15", k15 - k40, kOneStep, kAnything}}};
}

/// Opens scene:claw as figures 4 and 5 show it: the claw and the mouth from near, with one camera range.
Result<Studio> open_claw(Device& device, int size) {
  auto studio = open_unsharp(device, "scene:claw", size);
  if (!studio) return studio;
  studio->framing = {.position = glm::vec3(0.25f, 2.15f, 8.2f),
                     .focal_point = glm::vec3(-0.15f, 1.75f, 1.5f),
                     .view_angle_deg = 15.0f};
  // With a light at the camera, silhouettes are dark, so white silhouettes come from the unsharp mask. The far plane is
  // so far away that the depths of claw and body differ by 0.02 to 0.1.
  studio->draw.settings = {window(40, size), "unsharp.near=2", "unsharp.far=100", "lighting.rig=head"};
  return studio;
}

Result<Figure> threshold_figure(Device& device, int size) {
  auto studio = open_claw(device, size);
  if (!studio) return studio.error();
  const auto plain = studio->shoot({}, "none");
  const auto open = studio->shoot({"unsharp.threshold=0"});
  const auto checked = studio->shoot({"unsharp.threshold=0.1"});
  if (const auto error = error_of(plain, open, checked)) return *error;
  const int reach = std::max(1, int(std::lround(20 * size / kPaperSize)));  // k / 2
  constexpr float kClawInFront = 1.5f;                                      // world z; the body is behind
  // Returns whether the window of a pixel contains background and otherwise only the claw.
  const auto claw_before_background = [&](int x, int y) {
    bool background = false;
    for (int v = std::max(y - reach, 0); v < std::min(y + reach, size); ++v)
      for (int u = std::max(x - reach, 0); u < std::min(x + reach, size); ++u) {
        if (!open->surface(u, v))
          background = true;
        else if (open->world(u, v).z < kClawInFront)
          return false;
      }
    return background;
  };
  const auto blown_out = [&](const Shot& shot) {
    constexpr float kFarFromWhite = 0.8f;
    long count = 0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        count += shot.surface(x, y) && gray(*plain, x, y) < kFarFromWhite && gray(shot, x, y) >= 1.0f &&
                 shot.world(x, y).z > kClawInFront && claw_before_background(x, y);
    return double(count);
  };
  const auto mouth = [&](int x, int y) {
    const double u = (x + 0.5) / size, v = (y + 0.5) / size;
    return std::abs(u - 0.62) < 0.055 && std::abs(v - 0.30) < 0.08 && open->surface(x, y);
  };
  const double min_pixels = 500.0 * (size / kPaperSize);  // pixels of a line along the claw's outline
  return Figure{
      "4",
      "The claw before the far plane: no threshold, and a threshold of 0.1",
      {plain->picture("unsharp-4-without.png", "without"),
       open->picture("unsharp-4-threshold-none.png", "threshold none"),
       checked->picture("unsharp-4-threshold-0.1.png", "threshold 0.1")},
      {{"claw's silhouette pixels at 1.0, threshold none", blown_out(*open), min_pixels, kAnything},
       {"claw's silhouette pixels at 1.0, threshold 0.1", blown_out(*checked), 0.0, 0.0},
       {"change of the mouth's shade from threshold none to 0.1", mean_change(*open, *checked, mouth), 0.0, 0.01},
       {"the mouth's shade, threshold 0.1", mean_change(*plain, *checked, mouth), 0.02, kAnything}}};
}

Result<Figure> claw_figure(Device& device, int size) {
  auto studio = open_claw(device, size);
  if (!studio) return studio.error();
  const auto plain = studio->shoot({}, "none");
  const auto wide = studio->shoot({"unsharp.threshold=0.1"});
  const auto narrow = studio->shoot({"unsharp.threshold=0.02"});
  if (const auto error = error_of(plain, wide, narrow)) return *error;
  constexpr float kClawInFront = 1.5f;  // world z; the chest is behind
  Studio without_claw = *studio;
  Scene rest = *studio->scene;
  std::erase_if(rest.meshes, [&](const Mesh& mesh) {
    return std::all_of(mesh.positions.begin(), mesh.positions.end(), [&](glm::vec3 p) { return p.z > kClawInFront; });
  });
  if (auto status = without_claw.show(std::move(rest)); !status) return status.error();
  const auto alone = without_claw.shoot({"unsharp.threshold=0.02"});
  if (!alone) return alone.error();
  // The body along the claw's outline: pixels of the chest with the claw a quarter of the window to their left.
  const int reach = std::max(1, int(std::lround(10 * size / kPaperSize)));
  const auto along_outline = [&](int x, int y) {
    if (x < reach || !wide->surface(x, y) || !wide->surface(x - reach, y)) return false;
    const double u = (x + 0.5) / size, v = (y + 0.5) / size;
    if (u < 0.44 || u > 0.56 || v < 0.44 || v > 0.62) return false;
    return wide->world(x, y).z < kClawInFront && wide->world(x - reach, y).z > kClawInFront;
  };
  const double lit = mean_gray(*plain, along_outline);
  return Figure{
      "5",
      "The claw before the body: threshold 0.1 and 0.02",
      {wide->picture("unsharp-5-threshold-0.1.png", "threshold 0.1"),
       narrow->picture("unsharp-5-threshold-0.02.png", "threshold 0.02")},
      {{"body along the claw's outline, darker with 0.1", lit - mean_gray(*wide, along_outline), 0.05, kAnything},
       {"body along the claw's outline, darker with 0.02 than without the claw",
        mean_gray(*alone, along_outline) - mean_gray(*narrow, along_outline), -0.005, 0.005}}};
}

}  // namespace

Result<std::vector<Figure>> unsharp_figures(Device& device, const FigureSettings& settings) {
  return figures_of({{"figures 1 and 6", [&] { return tank_figure(device, settings.size); }},
                     {"figure 2", [&] { return border_figure(device, settings.bunny, settings.size); }},
                     {"figure 3", [&] { return bunny_figure(device, settings.bunny, settings.size); }},
                     {"figure 4", [&] { return threshold_figure(device, settings.size); }},
                     {"figure 5", [&] { return claw_figure(device, settings.size); }}},
                    settings);
}

Result<std::vector<FigureTable>> unsharp_tables(Device& device, const FigureSettings& settings) {
  const auto time_with = [&](Frame& frame, const std::string& kernel) -> Result<double> {
    EffectSettings with = look_settings(*find_look("unsharp"));
    if (auto status = apply_setting(with, "unsharp.kernel=" + kernel); !status) return status.error();
    return time_of(device, effect_with<UnsharpParams>(), with, frame, settings.runs);
  };
  const auto frame_of = [&](const Studio& studio) -> Result<Frame> {
    StageTimes times;
    return umbrage::draw(device, *studio.scene, studio.draw, times);
  };

  settings.progress("time against the window");
  FigureTable windows{"window", "Time of unsharp against the window (bunny)", {}};
  {
    auto studio = open_unsharp(device, settings.bunny, settings.size);
    if (!studio) return studio.error();
    auto frame = frame_of(*studio);
    if (!frame) return frame.error();
    for (const int k : {15, 40, 121}) {
      const auto ms = time_with(*frame, std::to_string(k));
      if (!ms) return ms.error();
      windows.rows.push_back({fmt::format("k = {}", k), *ms});
    }
  }
  settings.progress("time against the number of triangles");
  FigureTable triangles{"triangles", "Time of unsharp against the number of triangles (scene:terrain, k = 40)", {}};
  for (const char* detail : {"1000", "58000", "1000000"}) {
    auto studio = open_unsharp(device, fmt::format("scene:terrain?detail={}", detail), settings.size);
    if (!studio) return studio.error();
    auto frame = frame_of(*studio);
    if (!frame) return frame.error();
    const auto ms = time_with(*frame, "40");
    if (!ms) return ms.error();
    triangles.rows.push_back({fmt::format("{} triangles", studio->scene->triangle_count()), *ms});
  }
  return std::vector<FigureTable>{windows, triangles};
}

}  // namespace umbrage
