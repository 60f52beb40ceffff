// Figures 1 to 6, appendix B and the times of [Lajzer and Nottingham], in the paper's preset and in ours. Figures 1 to
// 6 show scene:pink in place of the paper's model.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "apps/figures/cartoon_samples.h"
#include "apps/figures/measure.h"
#include "effects/effects.h"

namespace umbrage {
namespace {

constexpr double kAnything = 1e30;

constexpr std::array kPresets = {kCartoonPaper, kCartoonOurs};
bool is_paper(const CartoonPreset& preset) { return preset.look == kCartoonPaper.look; }

/// Selects a preset without anti-aliasing, since passes are measured per pixel.
void select_without_anti_aliasing(Studio& studio, const CartoonPreset& preset) {
  studio.draw.look = std::string(preset.look);
  studio.draw.anti_aliasing = is_paper(preset) ? std::nullopt : std::optional<int>(1);
}

const std::string kNoOutlines = "outline.opacity=0", kNoBlur = "gaussian.rounds=0";

constexpr int kDenoiseRounds = 2;  // denoise.rounds of our preset, up to 724 rows

/// Regions of the picture of figure 1.
struct Parts {
  Mask background, surface;
  Mask silhouette;  // pixels of the character that touch the background
  Mask overlap;     // pixels of the character that touch a surface far behind it
  Mask beside;      // ground within the sample radius of the character, where the character is nearer
  Mask open;        // ground with no other surface within the paper's sample radius plus blur
};

Parts parts_of(const Studio& studio, const Shot& shot) {
  constexpr float kFar = std::numeric_limits<float>::infinity();  // background depth
  constexpr float kWellBehind = 0.3f;                             // metres: a third of the character's width
  const Image& image = shot.image;
  // The ids of the character's parts are lower.
  const float ground_id = float(mesh_named(*studio.scene, "grass").object);
  const Plane &depth = image.plane("depth"), &id = image.plane("object_id");
  Parts parts;
  parts.surface = mask_of(image, [&](int x, int y) { return depth.at(x, y) < kFar; });
  parts.background = mask_of(image, [&](int x, int y) { return depth.at(x, y) == kFar; });
  const auto character = mask_of(image, [&](int x, int y) { return depth.at(x, y) < kFar && id.at(x, y) < ground_id; });
  const auto ground = mask_of(image, [&](int x, int y) { return id.at(x, y) == ground_id; });
  Plane character_depth(image.width, image.height, kFar), negative_depth(image.width, image.height);
  for_each_pixel(image, &character, [&](int x, int y) { character_depth.at(x, y) = depth.at(x, y); });
  for_each_pixel(image, nullptr, [&](int x, int y) { negative_depth.at(x, y) = -depth.at(x, y); });
  const Plane beside = min_near(character_depth, cartoon_radius_px(image), cartoon_radius_px(image));
  // max_depth_near: the max depth of a pixel and its four neighbours.
  const Plane across = min_near(negative_depth, 1, 0), along = min_near(negative_depth, 0, 1);
  const auto max_depth_near = [&](int x, int y) { return -std::min(across.at(x, y), along.at(x, y)); };
  const auto subset = [&](const Mask& mask, const auto& test) {
    return mask_of(image, [&](int x, int y) { return mask[std::size_t(y) * image.width + x] && test(x, y); });
  };
  parts.silhouette = subset(character, [&](int x, int y) { return max_depth_near(x, y) == kFar; });
  parts.overlap = subset(character, [&](int x, int y) {
    return max_depth_near(x, y) < kFar && max_depth_near(x, y) - depth.at(x, y) > kWellBehind;
  });
  parts.beside = subset(ground, [&](int x, int y) { return beside.at(x, y) < depth.at(x, y); });
  parts.open = eroded(image, ground, cartoon_radius_px(image) + kCartoonBlurRounds);
  return parts;
}

/// Returns the noise of `ao`: root mean square of the residual after a plane is fitted to each tile of 4 x 4 pixels,
/// the tile size of the random vectors. Only tiles that are entirely in the mask count.
double noise(const Image& image, const Mask& mask) {
  constexpr int kTile = 4;
  constexpr double kPixels = kTile * kTile, kMiddle = (kTile - 1) / 2.0;
  constexpr double kSpread = 20.0;  // sum of squared distances of the pixels from the tile's middle along one axis
  const Plane& plane = image.plane("ao");
  double sum = 0.0;
  long count = 0;
  for (int y = 0; y + kTile <= image.height; y += kTile)
    for (int x = 0; x + kTile <= image.width; x += kTile) {
      double total = 0.0, squares = 0.0, across = 0.0, along = 0.0;
      bool inside = true;
      for (int v = 0; v < kTile; ++v)
        for (int u = 0; u < kTile; ++u) {
          const double value = plane.at(x + u, y + v);
          inside = inside && mask[std::size_t(y + v) * image.width + x + u];
          total += value;
          squares += value * value;
          across += (u - kMiddle) * value;
          along += (v - kMiddle) * value;
        }
      if (!inside) continue;
      const double residual = squares - total * total / kPixels - (across * across + along * along) / kSpread;
      sum += std::max(residual, 0.0) / kPixels;
      ++count;
    }
  return count > 0 ? std::sqrt(sum / double(count)) : std::nan("");
}

/// Returns the standard deviation of unit white noise after `denoise_rounds` of the kernel [1 2 2 2 1]/8, with spacing
/// doubled in each round, and `gaussian_rounds` of [1 2 1]/4, both along x and y. It equals the sum of squared weights
/// along one axis: each axis contributes the square root of that sum.
double blurred_noise(int gaussian_rounds, int denoise_rounds = 0) {
  std::vector<double> kernel = {1.0};
  const auto blur = [&](std::initializer_list<double> weights, int spacing) {
    std::vector<double> next(kernel.size() + (weights.size() - 1) * spacing, 0.0);
    std::size_t from = 0;
    for (const double weight : weights) {
      for (std::size_t i = 0; i < kernel.size(); ++i) next[from + i] += weight * kernel[i];
      from += spacing;
    }
    kernel = next;
  };
  for (int k = 0; k < denoise_rounds; ++k) blur({0.125, 0.25, 0.25, 0.25, 0.125}, 1 << k);
  for (int k = 0; k < gaussian_rounds; ++k) blur({0.25, 0.5, 0.25}, 1);
  double sum = 0.0;
  for (const double weight : kernel) sum += weight * weight;
  return sum;
}

/// Returns whether v is a multiple of 1/4, up to rounding.
bool is_multiple_of_quarter(double v) { return std::abs(4.0 * v - std::round(4.0 * v)) < 1e-3; }

double display_from_linear(double v) { return v > 0.0031308 ? 1.055 * std::pow(v, 1.0 / 2.4) - 0.055 : 12.92 * v; }
double linear_from_display(double v) { return v > 0.04045 ? std::pow((v + 0.055) / 1.055, 2.4) : v / 12.92; }

/// The five possible values of listing 1: 1 - (n/8)^2 for n = 0 and n = 5 to 8 of 8 samples.
constexpr std::array kRawValues = {1.0, 1.0 - 25.0 / 64.0, 1.0 - 36.0 / 64.0, 1.0 - 49.0 / 64.0, 0.0};

/// Number of tone steps of the look `cartoon`, green value of the darkest one on white, and distance between two steps.
constexpr int kOurSteps = 5;
constexpr double kDarkestStep = 0.16, kStepSize = (1.0 - kDarkestStep) / (kOurSteps - 1);
/// Returns whether a green value is that of a tone step on white, up to rounding.
bool is_on_tone_step(double green) {
  const double step = (green - kDarkestStep) / kStepSize;
  return step > -0.5 && step < kOurSteps - 0.5 && std::abs(step - std::round(step)) < 1e-3;
}

const std::vector<std::string> kPlanes = {"object_id", "normal.x", "normal.y", "normal.z", "albedo.g", "ao", "outline"};

Figure four_ways(const CartoonPreset& preset, const Parts& parts, const Shot& plain, const Shot& occluded,
                 const Shot& outlined, const Shot& both) {
  const Image &a = plain.image, &b = occluded.image, &c = outlined.image, &d = both.image;
  const std::string tag(preset.tag);
  Figure figure{"1" + tag,
                fmt::format("One scene, scene:pink, four ways ({})", preset.name),
                {plain.picture("cartoon-1a" + tag + ".png", "a) neither"),
                 occluded.picture("cartoon-1b" + tag + ".png", "b) occlusion"),
                 outlined.picture("cartoon-1c" + tag + ".png", "c) outlines"),
                 both.picture("cartoon-1d" + tag + ".png", "d) both")},
                {}};
  // Min darkening of the ground beside the body. The paper's preset darkens a halo: half a tone step on average, where
  // a tone step is a quarter of the meadow's brightness 0.58. Ours: a quarter of a tone step of 0.08, since half of
  // that ground is in the character's shadow already.
  const double min_drop = is_paper(preset) ? 0.07 : 0.02;
  const double min_lines = is_paper(preset) ? 1.0 : 0.9;  // ours: less, since some fringes are thinner than the line
  constexpr double kMaxBlack = 0.005;                     // fringes that occlude each other may be black
  // Our lines are centred on an edge and cover pixels on both sides.
  const auto line_fraction = [&](const Image& image, const Mask& mask) {
    constexpr float kQuarter = 0.25f;
    if (is_paper(preset)) return black_fraction(image, mask);
    const Plane& lines = image.plane("outline");
    const auto is_line = [&](int x, int y) {
      return lines.at(std::clamp(x, 0, lines.width - 1), std::clamp(y, 0, lines.height - 1)) >= kQuarter;
    };
    return mean(image, mask, [&](int x, int y) {
      return is_line(x, y) || is_line(x - 1, y) || is_line(x + 1, y) || is_line(x, y - 1) || is_line(x, y + 1);
    });
  };
  const char* condition = is_paper(preset) ? "that is black" : "at least a quarter under a line, or beside one";
  figure.numbers = {
      {"a to b: fall of the ground beside the body", brightness_drop(a, b, parts.beside), min_drop, kAnything},
      {"c to d: fall of the ground beside the body", brightness_drop(c, d, parts.beside), min_drop, kAnything},
      {"a to b: fraction of the background that changes", changed_fraction(a, b, parts.background), 0.0, 0.0},
      {"a: fraction of the silhouette that is black", black_fraction(a, parts.silhouette), 0.0, 0.0},
      {"b: fraction of the silhouette that is black", black_fraction(b, parts.silhouette), 0.0, kMaxBlack},
      {fmt::format("c: fraction of the silhouette {}", condition), line_fraction(c, parts.silhouette), min_lines, 1.0},
      {fmt::format("d: fraction of the silhouette {}", condition), line_fraction(d, parts.silhouette), min_lines, 1.0},
      {fmt::format("d: fraction of the body's edge before what is behind {}", condition),
       line_fraction(d, parts.overlap), min_lines, 1.0}};
  if (is_paper(preset))
    figure.numbers.push_back(
        {"a to b: fraction of the open ground that changes", changed_fraction(a, b, parts.open), 0.0, 0.05});
  return figure;
}

Figure buffers(const CartoonPreset& preset, const Parts& parts, const Shot& raw, const Shot& lighting,
               const Shot& both) {
  const Image& image = both.image;
  const std::string tag(preset.tag);
  Figure figure{"2-6" + tag,
                fmt::format("Planes between the dispatches ({})", preset.name),
                {both.pass("normal", "cartoon-2-normals" + tag + ".png", "2: normals"),
                 raw.pass("ao", "cartoon-3-raw" + tag + ".png", "3: raw occlusion"),
                 both.pass("ao", "cartoon-4-blurred" + tag + ".png", "4: blurred"),
                 lighting.picture("cartoon-5-lighting" + tag + ".png", "5: lighting"),
                 both.picture("cartoon-6-composite" + tag + ".png", "6: composite")},
                {}};
  figure.pictures[1].detail = figure.pictures[2].detail = true;  // downsampling would hide the noise
  const auto dark_background = [&](const Shot& shot) {
    return mean(image, parts.background, [&](int x, int y) { return shot.value("ao", x, y) < 1.0f; });
  };
  const auto off_lines =
      mask_of(image, [&](int x, int y) { return both.surface(x, y) && both.value("outline", x, y) == 0.0f; });
  const auto normal_error = mean(image, parts.surface, [&](int x, int y) {
    return std::abs(
        std::hypot(both.value("normal.x", x, y), both.value("normal.y", x, y), both.value("normal.z", x, y)) - 1.0f);
  });
  figure.numbers = {{"2: mean deviation of a normal's length from 1", normal_error, 0.0, 1e-3}};
  if (is_paper(preset)) {
    std::set<int> seen;
    long others = 0;
    for_each_pixel(image, nullptr, [&](int x, int y) {
      const double v = raw.value("ao", x, y);
      const auto at =
          std::find_if(kRawValues.begin(), kRawValues.end(), [&](double w) { return std::abs(v - w) < 1e-6; });
      if (at == kRawValues.end())
        ++others;
      else
        seen.insert(int(at - kRawValues.begin()));
    });
    const double noise_left = noise(image, parts.beside) / noise(raw.image, parts.beside);
    const auto shaded = [&](int x, int y) {
      return is_multiple_of_quarter(both.value("color.g", x, y) / display_from_linear(both.value("albedo.g", x, y)));
    };
    figure.numbers.insert(
        figure.numbers.end(),
        {{"3: pixels other than 1 - (n/8)^2 for n = 0, 5 to 8", double(others), 0.0, 0.0},
         {"3: of these five values, how many occur", double(seen.size()), 5.0, 5.0},
         {"4: noise left beside the body; of white noise 4 rounds leave 0.196", noise_left, 0.0,
          blurred_noise(kCartoonBlurRounds)},
         {"4: fraction of the background that occlusion creeps onto", dark_background(both), 1e-3, 1.0},
         {"5: fraction of the surface on a step of a quarter",
          mean(image, parts.surface,
               [&](int x, int y) { return is_multiple_of_quarter(lighting.value("color.g", x, y)); }),
          0.0, 0.1},
         {"6: fraction of the surface off the lines on a step of a quarter", mean(image, off_lines, shaded), 1.0,
          1.0}});
  } else {
    const auto step_fraction = [&](const Shot& shot, bool clay) {
      return mean(image, off_lines, [&](int x, int y) {
        return is_on_tone_step(linear_from_display(shot.value("color.g", x, y)) /
                               (clay ? 1.0 : shot.value("albedo.g", x, y)));
      });
    };
    figure.numbers.insert(
        figure.numbers.end(),
        {{"4: noise left on the open ground; of white noise 0.089",
          noise(image, parts.open) / noise(raw.image, parts.open), 0.0,
          blurred_noise(kCartoonBlurRounds, kDenoiseRounds)},
         {"4: fraction of the background that occlusion creeps onto", dark_background(both), 0.0, 0.0},
         {"5: fraction of the surface in one of five tone steps", step_fraction(lighting, true), 0.0, 0.1},
         {"6: fraction of the surface off the lines in one of five tone steps", step_fraction(both, false), 0.8, 1.0}});
  }
  return figure;
}

/// Draws figure 1 a to d, and figures 2 to 6, which show the planes of d.
Result<std::vector<Figure>> pink_figures(Studio& studio, const CartoonPreset& preset) {
  select_without_anti_aliasing(studio, preset);
  const auto plain = studio.shoot({kNoOutlines}, "none", kPlanes);
  const auto occluded = studio.shoot({kNoOutlines}, "", kPlanes);
  const auto outlined = studio.shoot({}, "none", kPlanes);
  const auto both = studio.shoot({}, "", kPlanes);
  std::vector<std::string> no_blur = {kNoBlur};
  if (!is_paper(preset)) no_blur.push_back("denoise.rounds=0");
  const auto raw = studio.shoot(no_blur, "", kPlanes);
  const auto lighting = studio.shoot({kNoOutlines, "toon.steps=256", "toon.albedo=clay"}, "none", kPlanes);
  for (const auto* shot : {&plain, &occluded, &outlined, &both, &raw, &lighting})
    if (!*shot) return shot->error();
  const Parts parts = parts_of(studio, *both);
  return std::vector<Figure>{four_ways(preset, parts, *plain, *occluded, *outlined, *both),
                             buffers(preset, parts, *raw, *lighting, *both)};
}

/// Draws raw occlusion with each of the shortcuts that section 5 of the paper names undone in turn.
Result<Figure> shortcuts_figure(Studio& studio) {
  select_without_anti_aliasing(studio, kCartoonPaper);
  struct Shortcut {
    const char *setting, *file, *caption;
  };
  constexpr Shortcut kShortcuts[] = {
      {"sphere.threshold=0", "no-threshold", "no threshold of 5"},
      {"sphere.range=hard", "range", "range limit"},
      {"sphere.shape=hemisphere", "hemisphere", "hemisphere"},
      {"sphere.sample_z=on", "depth", "samples with z"},
  };
  auto shot = studio.shoot({kNoBlur}, "", kPlanes);
  if (!shot) return shot.error();
  const Parts parts = parts_of(studio, *shot);
  Figure figure{"S5", "The shortcuts that section 5 names, undone one by one (paper preset, raw occlusion)", {}, {}};
  figure.pictures.push_back(shot->pass("ao", "cartoon-s5-paper.png", "all, as figure 3"));
  const auto occlusion = [&](const Mask& mask) {
    return mean(shot->image, mask, [&](int x, int y) { return 1.0 - shot->value("ao", x, y); });
  };
  struct Means {
    double beside, open, surface;
  };
  std::array<Means, 1 + std::size(kShortcuts)> means;
  means[0] = {occlusion(parts.beside), occlusion(parts.open), occlusion(parts.surface)};
  for (std::size_t k = 0; k < std::size(kShortcuts); ++k) {
    const Shortcut& shortcut = kShortcuts[k];
    std::vector<std::string> settings = {kNoBlur, shortcut.setting};
    if (std::string_view(shortcut.file) == "range") settings.push_back("sphere.range_factor=4");
    shot = studio.shoot(settings, "", kPlanes);
    if (!shot) return shot.error();
    figure.pictures.push_back(shot->pass("ao", fmt::format("cartoon-s5-{}.png", shortcut.file), shortcut.caption));
    means[k + 1] = {occlusion(parts.beside), occlusion(parts.open), occlusion(parts.surface)};
  }
  const auto& [paper, threshold, range, hemisphere, depth] = means;
  constexpr double kHalfSquared = 0.25;  // (4/8)^2: half of the 8 samples are behind any plane
  figure.numbers = {
      {"open ground without the threshold: samples behind the surface", threshold.open, 0.15, kHalfSquared},
      {"open ground with it: \"our value mapping technique eliminates this\"", paper.open, 0.0, 0.02},
      {"open ground, hemisphere", hemisphere.open, 0.0, 1e-3},
      {"beside the body, what a range limit takes away", paper.beside - range.beside, 0.1, kAnything},
      {"change of the mean by the samples' z: not \"a very significant impact\"",
       std::abs(depth.surface - paper.surface), 0.0, 0.01}};
  return figure;
}

}  // namespace

Result<std::vector<Figure>> cartoon_figures(Device& device, const FigureSettings& settings) {
  std::vector<Figure> figures;
  auto studio = open_studio(device, "scene:pink", std::string(kCartoonPaper.look), settings.size);
  if (!studio) return studio.error();
  for (const CartoonPreset& preset : kPresets) {
    settings.progress(fmt::format("figures 1 to 6, {}", preset.name));
    auto made = pink_figures(*studio, preset);
    if (!made) return made.error();
    figures.insert(figures.end(), made->begin(), made->end());
  }
  std::vector<FigurePart> parts = {{"section 5", [&] { return shortcuts_figure(*studio); }}};
  for (int number = 1; number <= kCartoonSamples; ++number)
    parts.emplace_back(fmt::format("appendix B, sample {}", number),
                       [&, number] { return cartoon_sample(device, number, settings.size); });
  auto rest = figures_of(parts, settings);
  if (!rest) return rest;
  figures.insert(figures.end(), rest->begin(), rest->end());
  return figures;
}

Result<std::vector<FigureTable>> cartoon_tables(Device& device, const FigureSettings& settings) {
  constexpr const char* kScene = "scene:pink";
  std::vector<FigureTable> tables;
  auto studio = open_studio(device, kScene, std::string(kCartoonPaper.look), settings.size);
  if (!studio) return studio.error();
  for (const CartoonPreset& preset : kPresets) {
    settings.progress(fmt::format("time of every pass, {}", preset.name));
    select_without_anti_aliasing(*studio, preset);
    const auto recipe = make_recipe(studio->draw);
    if (!recipe) return recipe.error();
    StageTimes first;
    auto frame = umbrage::draw(device, *studio->scene, studio->draw, first);
    if (!frame) return frame.error();
    FigureTable table{
        "passes" + std::string(preset.tag), fmt::format("Time of every pass ({}, {})", kScene, preset.name), {}};
    std::vector<double> captures;
    for (int i = 0; i < settings.runs; ++i) {
      StageTimes times;
      const auto again = umbrage::draw(device, *studio->scene, studio->draw, times);
      if (!again) return again.error();
      captures.push_back(times.stages.front().ms);
    }
    table.rows.push_back({"capture", median(captures)});
    for (std::string_view name : recipe->look->effects) {
      if (name == "occlusion") name = recipe->occlusion;
      const auto ms = time_of(device, *find_effect(name), recipe->settings, *frame, settings.runs);
      if (!ms) return ms.error();
      table.rows.push_back({std::string(name), *ms});
    }
    double total = 0.0;
    for (const TableRow& row : table.rows) total += row.ms;
    table.rows.push_back({"all", total});
    tables.push_back(std::move(table));
  }

  settings.progress("time against the number of triangles");
  FigureTable triangles{
      "triangles", "Time of the occlusion against the number of triangles (scene:terrain, paper preset)", {}};
  for (const char* detail : {"1000", "58000", "1000000"}) {
    auto terrain = open_studio(device, fmt::format("scene:terrain?detail={}", detail), std::string(kCartoonPaper.look),
                               settings.size);
    if (!terrain) return terrain.error();
    StageTimes first;
    auto frame = umbrage::draw(device, *terrain->scene, terrain->draw, first);
    if (!frame) return frame.error();
    const auto recipe = make_recipe(terrain->draw);
    if (!recipe) return recipe.error();
    const auto ms = time_of(device, *find_effect(recipe->occlusion), recipe->settings, *frame, settings.runs);
    if (!ms) return ms.error();
    triangles.rows.push_back({fmt::format("{} triangles", terrain->scene->triangle_count()), *ms});
  }
  tables.push_back(std::move(triangles));
  return tables;
}

}  // namespace umbrage
