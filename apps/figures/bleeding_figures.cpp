// Figures 1 to 16 and table 1 of [Colliander and Törnquist 2015], in the paper's preset and in ours. They show
// scene:atrium in place of the paper's Sponza.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>
#include <tuple>

#include "apps/figures/bleeding.h"
#include "apps/figures/measure.h"
#include "apps/figures/studio.h"
#include "core/check.h"

namespace umbrage {
namespace {

constexpr double kAnything = 1e30;

constexpr std::array kPresets = {kBleedingPaper, kBleedingOurs};
bool is_paper(const BleedingPreset& preset) { return preset.look == kBleedingPaper.look; }

// The paper's color bleeding is visible only where the sun reaches both surfaces, and where the cloth is brighter than
// the surface beside it. Hence a low sun across the court: it reaches a red drape steeply and the floor at a grazing
// angle, but not the side of the pier beside the drape. Ours is most visible in shadow: at the last pillar beside a red
// drape lit from the other side.
Framing pillar_of(const BleedingPreset& preset) {
  if (!is_paper(preset)) return unlit_drape_view();
  return bleeding_view({-2.3f, 1.25f, 10.0f}, {-3.8f, 0.75f, 12.0f}, 44.0f, glm::vec2(28.7f, 18.9f));
}
Framing floor_of(const BleedingPreset& preset) {
  if (!is_paper(preset)) return bleeding_view({-3.1f, 1.1f, -11.3f}, {-4.65f, 0.2f, -9.7f}, 45.0f);
  return bleeding_view({-2.7f, 0.95f, 10.7f}, {-3.75f, 0.3f, 12.0f}, 40.0f, glm::vec2(29.3f, 10.5f));
}
// The paper gives neither the strength of the light nor that of one occluder. These make both visible.
const std::vector<std::string> kVisible = {"hemisphere.samples=256", "hemisphere.bleeding=0.12",
                                           "hemisphere.weight=1.2"};
constexpr float kVisibleKey = 0.8f;

/// Returns the mean difference of red, which the drapes of the details have, and green, which they lack.
double mean_tint(const Image& image, const Mask& mask) {
  const glm::dvec3 color = mean_color(image, mask);
  return color.x - color.y;
}

/// Pictures of one view without occlusion and bleeding, with each alone, and with both.
struct FourWays {
  Shot neither, occlusion, bleeding, both;
};
Result<FourWays> shoot_four(Studio& studio, const std::vector<std::string>& settings = {}) {
  const auto with = [&](const char* setting) {
    std::vector<std::string> all = settings;
    all.push_back(setting);
    return all;
  };
  auto neither = studio.shoot({}, "none", bleeding_planes());
  auto occlusion = studio.shoot(with("hemisphere.bleeding=0"), "", bleeding_planes());
  auto bleeding = studio.shoot(with("hemisphere.occlusion=off"), "", bleeding_planes());
  auto both = studio.shoot(settings, std::string(find_look(studio.draw.look)->occlusion), bleeding_planes());
  for (const auto* shot : {&neither, &occlusion, &bleeding, &both})
    if (!*shot) return shot->error();
  return FourWays{std::move(*neither), std::move(*occlusion), std::move(*bleeding), std::move(*both)};
}

std::vector<FigurePicture> pictures_of(const FourWays& four, const std::string& file, const std::string& tag,
                                       std::array<const char*, 4> captions) {
  return {four.neither.picture(fmt::format("bleeding-{}-neither{}.png", file, tag), captions[0]),
          four.occlusion.picture(fmt::format("bleeding-{}-occlusion{}.png", file, tag), captions[1]),
          four.bleeding.picture(fmt::format("bleeding-{}-bleeding{}.png", file, tag), captions[2]),
          four.both.picture(fmt::format("bleeding-{}-both{}.png", file, tag), captions[3])};
}

/// Draws figures 1, 7 and 8.
Result<Figure> overview(Studio& studio, const BleedingPreset& preset) {
  studio.framing = {};
  const auto four = shoot_four(studio);
  if (!four) return four.error();
  const Image& image = four->both.image;
  const std::string tag(preset.tag);
  Figure figure{"1,7,8" + tag,
                fmt::format("Overview of {} ({})", kAtrium, preset.name),
                pictures_of(*four, "7-overview", tag,
                            {"1, 7: neither", "occlusion alone", "bleeding alone", "8: occlusion and bleeding"}),
                {}};
  const Mask surface = mask_of(image, [&](int x, int y) { return four->both.surface(x, y); });
  const Mask background = mask_of(image, [&](int x, int y) { return !four->both.surface(x, y); });
  // The floor of the court between the fountain and the camera, with no object within one metre.
  constexpr float kMaxX = 1.5f, kMaxHeight = 0.02f;  // metres
  const Mask open = mask_of(image, [&](int x, int y) {
    if (!four->both.surface(x, y)) return false;
    const glm::vec3 p = four->both.world(x, y);
    return std::abs(p.y) < kMaxHeight && std::abs(p.x) < kMaxX && p.z > 4.0f && p.z < 9.0f;
  });
  figure.numbers = {{"fall of the mean with occlusion",
                     brightness_drop(four->neither.image, four->occlusion.image, surface), 0.002, 0.1},
                    {"rise of the mean with bleeding",
                     brightness_drop(four->bleeding.image, four->neither.image, surface), 0.002, 0.1},
                    {"fraction of the background that changes",
                     changed_fraction(four->neither.image, four->both.image, background), 0.0, 0.0},
                    {"open floor: change with both",
                     std::abs(brightness_drop(four->neither.image, four->both.image, open)), 0.0, 0.002}};
  return figure;
}

/// Returns what the eye sees of a detail in the paper's preset: the drape's color on the floor below it, and occlusion
/// on the side of the pillar.
std::vector<FigureNumber> visible_effects(Studio& studio, const FourWays& four, const ClothGrid& cloths) {
  constexpr float kBelow = 0.25f, kAway = 0.7f;  // metres from the drape
  const Image &both = four.both.image, &occlusion = four.occlusion.image;
  const float floor = object_of(studio, "gallery floors"), stone = object_of(studio, "mouldings and balustrade");
  const auto is_floor = [&](int x, int y) { return four.both.value("object_id", x, y) == floor; };
  const Mask below =
      mask_of(both, [&](int x, int y) { return is_floor(x, y) && cloths.near(four.both.world(x, y), kBelow); });
  const Mask away =
      mask_of(both, [&](int x, int y) { return is_floor(x, y) && !cloths.near(four.both.world(x, y), kAway); });
  const Mask cloth = mask_of(both, [&](int x, int y) { return cloths.has_object(four.both.value("object_id", x, y)); });
  // The side of the corner pier that faces +x, beside the drape, above its foot.
  const Mask side = mask_of(both, [&](int x, int y) {
    if (four.both.value("object_id", x, y) != stone) return false;
    const glm::vec3 p = four.both.world(x, y);
    return std::abs(p.x + 4.08f) < 0.01f && p.y > 0.5f && p.z > 11.75f && p.z < 12.0f;
  });
  const auto added = [&](const Mask& mask) { return mean_color(both, mask) - mean_color(occlusion, mask); };
  const auto added_tint = [&](const Mask& mask) { return mean_tint(both, mask) - mean_tint(occlusion, mask); };
  return {{"floor below the drape: angle of the added light's hue to the drape's, degrees",
           hue_difference_deg(added(below), mean_color(occlusion, cloth)), 0.0, 20.0},
          {"floor below the drape: added red, less the added green", added_tint(below), 0.08, kAnything},
          {"the same, times that of the floor away from it", added_tint(below) / std::max(added_tint(away), 1e-3), 4.0,
           kAnything},
          {"side of the pillar beside the drape: fall of the mean with occlusion",
           brightness_drop(four.neither.image, occlusion, side), 0.04, kAnything},
          {"sparks, above 8 times the median of 5 x 5", spark_count(four.both), 0.0, 0.0}};
}

/// Draws figures 9 to 12, or 13 and 14.
Result<Figure> detail(Studio& studio, const BleedingPreset& preset, const ClothGrid& cloths, const Framing& framing,
                      const std::string& id, const std::string& file, const std::string& title,
                      std::array<const char*, 4> captions) {
  studio.framing = framing;
  if (is_paper(preset)) studio.draw.key = kVisibleKey;
  const auto four = shoot_four(studio, is_paper(preset) ? kVisible : std::vector<std::string>{});
  studio.draw.key = 1.0f;
  if (!four) return four.error();
  const Image& image = four->both.image;
  const std::string tag(preset.tag);
  Figure figure{id + tag, fmt::format("{} ({})", title, preset.name), pictures_of(*four, file, tag, captions), {}};
  constexpr float kReach = 0.4f;  // metres
  const Mask near = mask_of(image, [&](int x, int y) {
    return four->both.surface(x, y) && !cloths.has_object(four->both.value("object_id", x, y)) &&
           cloths.near(four->both.world(x, y), kReach);
  });
  const double none = mean_tint(four->neither.image, near);
  figure.numbers = {
      {"near the drape: fall of the mean with occlusion",
       brightness_drop(four->neither.image, four->occlusion.image, near), 0.005, kAnything},
      {"near the drape: rise of its colour with bleeding", mean_tint(four->bleeding.image, near) - none, 0.005,
       kAnything},
      {"near the drape: the same with occlusion alone", mean_tint(four->occlusion.image, near) - none, -0.02, 0.001},
  };
  if (is_paper(preset))
    for (FigureNumber& number : visible_effects(studio, *four, cloths)) figure.numbers.push_back(std::move(number));
  return figure;
}

/// Returns the middle of a picture enlarged by `factor`, without interpolation.
Image enlarged_middle(const Image& image, int factor) {
  Image out(image.width, image.height);
  for (const char* name : {"color.r", "color.g", "color.b"}) {
    Plane& plane = out.add(name);
    const int left = (image.width - image.width / factor) / 2, top = (image.height - image.height / factor) / 2;
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) plane.at(x, y) = image.plane(name).at(left + x / factor, top + y / factor);
  }
  return out;
}

/// Draws figure 5: the tangents that rotate the sample points, as colours.
Result<Figure> tangents(Studio& studio) {
  constexpr int kTile = 4;  // hemisphere.noise
  const std::vector<std::string> planes = {"normal.x", "normal.y", "normal.z", "tangent.x", "tangent.y", "tangent.z"};
  Figure figure{"5", "Tangent vectors as colours, not blurred (middle, enlarged eight times)", {}, {}};
  for (const BleedingPreset& preset : kPresets) {
    studio.draw.look = std::string(preset.look);
    studio.framing = unlit_drape_view();
    const auto shot = studio.shoot({"hemisphere.tangents=on"}, "", planes);
    if (!shot) return shot.error();
    FigurePicture picture = shot->pass("tangent", fmt::format("bleeding-5-tangents{}.png", preset.tag),
                                       fmt::format("5: tangents ({})", preset.name));
    picture.image = enlarged_middle(picture.image, 8);
    figure.pictures.push_back(std::move(picture));
    const Image& image = shot->image;
    const VectorPlanes normal(image, "normal"), tangent(image, "tangent");
    // Returns whether a pixel is on a flat face: normals are equal over two tiles in x and y.
    const auto flat = [&](int x, int y) {
      for (int j = 0; j < 2 * kTile; ++j)
        for (int i = 0; i < 2 * kTile; ++i)
          if (normal.at(x + i, y + j) != normal.at(x, y)) return false;
      return shot->surface(x, y);
    };
    long repeated = 0, all = 0;
    double deviation = 0.0;
    std::set<std::tuple<float, float, float>> max_seen;
    for (int y = 0; y + 2 * kTile < image.height; y += kTile)
      for (int x = 0; x + 2 * kTile < image.width; x += kTile) {
        if (!flat(x, y)) continue;
        std::set<std::tuple<float, float, float>> seen;
        for (int j = 0; j < kTile; ++j)
          for (int i = 0; i < kTile; ++i) {
            const glm::vec3 t = tangent.at(x + i, y + j);
            seen.insert({t.x, t.y, t.z});
            repeated += t == tangent.at(x + i + kTile, y + j) && t == tangent.at(x + i, y + j + kTile);
            deviation = std::max({deviation, double(std::abs(glm::length(t) - 1.0f)),
                                  double(std::abs(glm::dot(t, normal.at(x + i, y + j))))});
            ++all;
          }
        if (seen.size() > max_seen.size()) max_seen = seen;
      }
    figure.numbers.insert(
        figure.numbers.end(),
        {{fmt::format("flat faces: fraction that repeats after four pixels ({})", preset.name),
          all ? double(repeated) / double(all) : 0.0, 1.0, 1.0},
         {fmt::format("different tangents in a tile of 4 x 4 ({})", preset.name), double(max_seen.size()), 16.0, 16.0},
         {fmt::format("largest deviation from a unit vector in the surface ({})", preset.name), deviation, 0.0, 1e-5}});
  }
  return figure;
}

}  // namespace

Result<std::vector<Figure>> bleeding_figures(Device& device, const FigureSettings& settings) {
  auto studio = open_studio(device, kAtrium, std::string(kBleedingPaper.look), settings.size);
  if (!studio) return studio.error();
  studio->draw.anti_aliasing = 1;  // numbers are measured per pixel
  const ClothGrid cloths(*studio->scene);
  std::vector<FigurePart> parts;
  for (const BleedingPreset& preset : kPresets) {
    parts.emplace_back(fmt::format("figures 1, 7 and 8, {}", preset.name), [&, preset] {
      studio->draw.look = std::string(preset.look);  // also of the parts after it
      return overview(*studio, preset);
    });
    parts.emplace_back(fmt::format("figures 9 to 12, {}", preset.name), [&, preset] {
      return detail(*studio, preset, cloths, pillar_of(preset), "9-12", "9-pillar", "A pillar beside a drape",
                    {"9: neither", "10: occlusion", "11: bleeding", "12: both"});
    });
    parts.emplace_back(fmt::format("figures 13 and 14, {}", preset.name), [&, preset] {
      return detail(*studio, preset, cloths, floor_of(preset), "13,14", "13-floor", "The floor below a drape",
                    {"13: neither", "occlusion", "bleeding", "14: both"});
    });
  }
  parts.emplace_back("figure 5", [&] { return tangents(*studio); });
  parts.emplace_back("figures 15 and 16", [&] { return bleeding_range(*studio); });
  parts.emplace_back("behind a drape", [&] { return bleeding_behind_drape(*studio, cloths); });
  parts.emplace_back("diagrams 2, 3, 4 and 6", [&] {
    return bleeding_diagrams(*studio, bleeding_view({-2.2f, 1.2f, -3.3f}, {-4.5f, 0.9f, -3.3f}, 40.0f));
  });
  return figures_of(parts, settings);
}

Result<std::vector<FigureTable>> bleeding_tables(Device& device, const FigureSettings& settings) {
  constexpr std::array kSamples = {8, 16, 32, 64};
  std::vector<FigureTable> tables;
  auto studio = open_studio(device, kAtrium, std::string(kBleedingPaper.look), settings.size);
  if (!studio) return studio.error();
  for (const BleedingPreset& preset : kPresets) {
    settings.progress(fmt::format("table 1, {}", preset.name));
    // Interleave the runs of all settings, so that other load on the machine affects them alike.
    struct Case {
      std::string name;
      std::string_view look;
      std::string occlusion;
      std::vector<std::string> settings;
      std::string scale = {};
      std::vector<double> ms = {};
    };
    // Without occlusion, the first layer without a filter suffices: the look `lit`.
    std::vector<Case> cases = {{"no occlusion", is_paper(preset) ? preset.look : "lit", "none", {}}};
    for (const int samples : kSamples)
      for (const bool has_bleeding : {false, true}) {
        cases.push_back({fmt::format("{} samples, {}", samples, has_bleeding ? "occlusion and bleeding" : "occlusion"),
                         preset.look,
                         "",
                         {fmt::format("hemisphere.samples={}", samples)}});
        if (!has_bleeding) cases.back().settings.push_back("hemisphere.bleeding=0");
      }
    cases.push_back({"64 samples, both, at half resolution", preset.look, "", {"hemisphere.samples=64"}, "half"});
    for (int run = -1; run < settings.runs; ++run)  // run -1 warms up and does not count
      for (Case& item : cases) {
        Request with = studio->draw;
        with.look = std::string(item.look);
        with.occlusion = item.occlusion;
        with.settings = item.settings;
        with.occlusion_scale = item.scale;
        StageTimes times;
        const auto frame = umbrage::draw(device, *studio->scene, with, times);
        if (!frame) return frame.error();
        if (run >= 0) item.ms.push_back(times.total());
      }
    FigureTable table{"1" + std::string(preset.tag), fmt::format("Table 1: time of a picture ({})", preset.name), {}};
    const double none = median(cases[0].ms);
    double before = none;
    for (std::size_t k = 0; k < cases.size(); ++k) {
      const double ms = median(cases[k].ms);
      std::string note = k == 0 ? "" : fmt::format("{:+.1f} %", 100.0 * (ms / none - 1.0));
      if (k > 0 && k % 2 == 0)  // the previous case is the same without bleeding
        note += fmt::format(", bleeding {:.1f} % of the picture", 100.0 * (1.0 - before / ms));
      before = ms;
      table.rows.push_back({cases[k].name, ms, std::move(note)});
    }
    tables.push_back(std::move(table));
  }
  return tables;
}

}  // namespace umbrage
