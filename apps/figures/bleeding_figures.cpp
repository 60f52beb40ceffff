// Figures 1 to 16 and table 1 of [Colliander and Törnquist 2015], in the paper's preset and in ours. They show
// scene:atrium in place of the paper's Sponza.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <set>
#include <tuple>

#include "apps/figures/bleeding_diagrams.h"
#include "apps/figures/measure.h"
#include "apps/figures/studio.h"
#include "core/check.h"

namespace umbrage {
namespace {

constexpr const char* kScene = "scene:atrium";
constexpr double kAnything = 1e30;

struct Preset {
  std::string_view look, name, tag;  // tag: suffix of figure ids and file names
};
constexpr Preset kPaper = {"bleeding-paper", "paper preset", ""}, kOurs = {"bleeding", "our own", "-ours"};
constexpr std::array kPresets = {kPaper, kOurs};
bool is_paper(const Preset& preset) { return preset.look == kPaper.look; }

const std::vector<std::string> kPlanes = {"object_id",  "normal.x",   "normal.y",  "normal.z",
                                          "indirect.r", "indirect.g", "indirect.b"};

Framing view(glm::vec3 eye, glm::vec3 target, float angle_deg) {
  return {.position = eye, .focal_point = target, .view_angle_deg = angle_deg};
}

/// The subject of a detail picture: a camera that shows a drape, and the color planes in which cloth and stone differ
/// most.
struct Subject {
  Framing framing;
  const char *cloth, *stone;  // color planes: one that the cloth has, and one that it lacks
};
// The paper's color bleeding is visible only where the sun reaches both surfaces: at the green drape of the left
// arcade, from the sun's side. Ours is most visible in shadow: at the last pillar beside a red drape lit from the other
// side.
Subject pillar_of(const Preset& preset) {
  if (is_paper(preset)) return {view({-2.2f, 1.2f, -3.3f}, {-4.5f, 0.9f, -3.3f}, 40.0f), "color.g", "color.b"};
  return {view({-2.9f, 2.4f, -11.0f}, {-4.6f, 1.6f, -9.2f}, 45.0f), "color.r", "color.g"};
}
Subject floor_of(const Preset& preset) {
  if (is_paper(preset)) return {view({-3.7f, 1.1f, -2.7f}, {-4.6f, 0.15f, -4.2f}, 40.0f), "color.g", "color.b"};
  return {view({-3.1f, 1.1f, -11.3f}, {-4.65f, 0.2f, -9.7f}, 45.0f), "color.r", "color.g"};
}

bool is_cloth(const Mesh& mesh) {
  return mesh.name == "curtain" || mesh.name == "upper curtain" || mesh.name == "banner";
}

/// The cells of a grid of 0.1 m that contain cloth, and the objects that are cloth.
class ClothGrid {
 public:
  explicit ClothGrid(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes) {
      if (!is_cloth(mesh)) continue;
      objects_.insert(mesh.object);
      for (const glm::vec3& p : mesh.positions) cells_.insert(cell(p));
    }
  }
  bool has_object(float object_id) const { return objects_.contains(int(object_id)); }
  /// Returns whether there is cloth within `reach` metres.
  bool near(glm::vec3 p, float reach) const {
    const int steps = int(std::ceil(reach / kCell));
    const auto [x, y, z] = cell(p);
    for (int i = -steps; i <= steps; ++i)
      for (int j = -steps; j <= steps; ++j)
        for (int k = -steps; k <= steps; ++k)
          if (i * i + j * j + k * k <= steps * steps && cells_.contains({x + i, y + j, z + k})) return true;
    return false;
  }

 private:
  static constexpr float kCell = 0.1f;
  using Cell = std::tuple<int, int, int>;
  static Cell cell(glm::vec3 p) {
    p = glm::floor(p / kCell);
    return {int(p.x), int(p.y), int(p.z)};
  }
  std::set<Cell> cells_;
  std::set<int> objects_;
};

/// Returns the mean difference of the cloth's color plane and the plane that the cloth lacks.
double mean_tint(const Image& image, const Mask& mask, const Subject& subject) {
  const auto value = [&](const char* name, int x, int y) {
    return double(std::clamp(image.plane(name).at(x, y), 0.0f, 1.0f));
  };
  return mean(image, mask, [&](int x, int y) { return value(subject.cloth, x, y) - value(subject.stone, x, y); });
}

/// Pictures of one view without occlusion and bleeding, with each alone, and with both.
struct FourWays {
  Shot neither, occlusion, bleeding, both;
};
Result<FourWays> shoot_four(Studio& studio) {
  auto neither = studio.shoot({}, "none", kPlanes);
  auto occlusion = studio.shoot({"hemisphere.bleeding=0"}, "", kPlanes);
  auto bleeding = studio.shoot({"hemisphere.occlusion=off"}, "", kPlanes);
  auto both = studio.shoot({}, std::string(find_look(studio.draw.look)->occlusion), kPlanes);
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
Result<Figure> overview(Studio& studio, const Preset& preset) {
  studio.framing = {};
  const auto four = shoot_four(studio);
  if (!four) return four.error();
  const Image& image = four->both.image;
  const std::string tag(preset.tag);
  Figure figure{"1,7,8" + tag,
                fmt::format("Overview of {} ({})", kScene, preset.name),
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

/// Draws figures 9 to 12, or 13 and 14.
Result<Figure> detail(Studio& studio, const Preset& preset, const ClothGrid& cloths, const Subject& subject,
                      const std::string& id, const std::string& file, const std::string& title,
                      std::array<const char*, 4> captions) {
  studio.framing = subject.framing;
  const auto four = shoot_four(studio);
  if (!four) return four.error();
  const Image& image = four->both.image;
  const std::string tag(preset.tag);
  Figure figure{id + tag, fmt::format("{} ({})", title, preset.name), pictures_of(*four, file, tag, captions), {}};
  constexpr float kReach = 0.4f;  // metres
  const Mask near = mask_of(image, [&](int x, int y) {
    return four->both.surface(x, y) && !cloths.has_object(four->both.value("object_id", x, y)) &&
           cloths.near(four->both.world(x, y), kReach);
  });
  const double none = mean_tint(four->neither.image, near, subject);
  figure.numbers = {
      {"near the drape: fall of the mean with occlusion",
       brightness_drop(four->neither.image, four->occlusion.image, near), 0.005, kAnything},
      {"near the drape: rise of its colour with bleeding", mean_tint(four->bleeding.image, near, subject) - none, 0.005,
       kAnything},
      {"near the drape: the same with occlusion alone", mean_tint(four->occlusion.image, near, subject) - none, -0.02,
       0.001},
  };
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
  for (const Preset& preset : kPresets) {
    studio.draw.look = std::string(preset.look);
    studio.framing = pillar_of(kOurs).framing;
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

/// Returns the mean distance in pixels from a drape's silhouette to the first pixel on its left that receives red
/// indirect light. A distance is at most an eighth of the picture. Only silhouette pixels with a surface near the drape
/// on their left count.
double uncolored_distance_px(const Shot& shot, const ClothGrid& cloths) {
  constexpr float kReach = 0.3f;              // metres
  constexpr float kMin = 0.05f, kRed = 1.5f;  // min red light, and min ratio of red to green
  const Image& image = shot.image;
  const Plane &red = image.plane("indirect.r"), &green = image.plane("indirect.g"), &id = image.plane("object_id");
  long edges = 0, pixels = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 1; x < image.width; ++x) {
      if (!cloths.has_object(id.at(x, y)) || cloths.has_object(id.at(x - 1, y))) continue;
      if (!shot.surface(x - 1, y) || !cloths.near(shot.world(x - 1, y), kReach)) continue;
      ++edges;
      for (int k = 1; k <= image.width / 8 && k <= x; ++k) {
        const float r = red.at(x - k, y);
        if (r > kMin && r > kRed * green.at(x - k, y)) break;
        ++pixels;
      }
    }
  return edges > 0 ? double(pixels) / double(edges) : std::nan("");
}

/// Draws figures 15 and 16, and pictures in our preset: strengthened bleeding near the edge of a drape.
Result<Figure> drape_edge(Studio& studio, const ClothGrid& cloths) {
  struct Variant {
    const char *file, *caption;
    std::string_view look;
    std::vector<std::string> settings;
    std::optional<int> extra_views;
  };
  const std::vector<std::string> strong = {"hemisphere.bleeding=3", "hemisphere.range_factor=0.25",
                                           "composite.damping=0"};
  const std::vector<Variant> variants = {
      {"15-quadratic", "15: quadratic range", kPaper.look, strong, {}},
      {"16-smoothstep",
       "16: smoothstep",
       kPaper.look,
       {strong[0], strong[1], strong[2], "hemisphere.range=smoothstep", "hemisphere.range_depth=view"},
       {}},
      {"beyond-1-one-layer", "ours, first layer", kOurs.look, {"hemisphere.bleeding=3", "hemisphere.layers=1"}, {}},
      {"beyond-2-layers", "ours, layers and back sides", kOurs.look, {"hemisphere.bleeding=3"}, {}},
      {"beyond-3-views", "two further cameras", kOurs.look, {"hemisphere.bleeding=3"}, 2}};
  std::vector<double> distances_px;
  Figure figure{"15,16", "Near a drape whose lit side faces away; bleeding strengthened", {}, {}};
  studio.framing = pillar_of(kOurs).framing;
  for (const Variant& variant : variants) {
    studio.draw.look = std::string(variant.look);
    studio.draw.extra_views = variant.extra_views;
    const auto shot = studio.shoot(variant.settings, "", kPlanes);
    studio.draw.extra_views.reset();
    if (!shot) return shot.error();
    figure.pictures.push_back(shot->picture(fmt::format("bleeding-{}.png", variant.file), variant.caption));
    distances_px.push_back(uncolored_distance_px(*shot, cloths));
  }
  // With the paper's quadratic range, at least 2 % of the picture's width beside the drape receives none of its colour.
  const double quadratic = distances_px[0], smoothstep = distances_px[1];
  figure.numbers = {{"15: pixels beside the drape without its colour", quadratic, 0.02 * studio.draw.width, kAnything},
                    {"16: the same, smoothstep", smoothstep, 0.0, quadratic},
                    {"the same, ours with the first layer alone", distances_px[2], 0.02 * studio.draw.width, kAnything},
                    {"the same, ours with layers and back sides", distances_px[3], 0.0, 0.25 * smoothstep},
                    {"the same, ours with two further cameras too", distances_px[4], 0.0, 0.25 * smoothstep}};
  return figure;
}

}  // namespace

Result<std::vector<Figure>> bleeding_figures(Device& device, int size,
                                             const std::function<void(const std::string&)>& progress) {
  std::vector<Figure> figures;
  auto studio = open_studio(device, kScene, std::string(kPaper.look), size);
  if (!studio) return studio.error();
  studio->draw.anti_aliasing = 1;  // numbers are measured per pixel
  const ClothGrid cloths(*studio->scene);
  for (const Preset& preset : kPresets) {
    studio->draw.look = std::string(preset.look);
    progress(fmt::format("figures 1, 7 and 8, {}", preset.name));
    auto made = overview(*studio, preset);
    if (!made) return made.error();
    figures.push_back(std::move(*made));
    progress(fmt::format("figures 9 to 12, {}", preset.name));
    made = detail(*studio, preset, cloths, pillar_of(preset), "9-12", "9-pillar", "A pillar beside a drape",
                  {"9: neither", "10: occlusion", "11: bleeding", "12: both"});
    if (!made) return made.error();
    figures.push_back(std::move(*made));
    progress(fmt::format("figures 13 and 14, {}", preset.name));
    made = detail(*studio, preset, cloths, floor_of(preset), "13,14", "13-floor", "The floor below a drape",
                  {"13: neither", "occlusion", "bleeding", "14: both"});
    if (!made) return made.error();
    figures.push_back(std::move(*made));
  }
  progress("figure 5");
  auto made = tangents(*studio);
  if (!made) return made.error();
  figures.push_back(std::move(*made));
  progress("figures 15 and 16");
  made = drape_edge(*studio, cloths);
  if (!made) return made.error();
  figures.push_back(std::move(*made));
  progress("diagrams 2, 3, 4 and 6");
  made = bleeding_diagrams(*studio, pillar_of(kPaper).framing);
  if (!made) return made.error();
  figures.push_back(std::move(*made));
  return figures;
}

Result<std::vector<FigureTable>> bleeding_tables(Device& device, int size, int runs,
                                                 const std::function<void(const std::string&)>& progress) {
  constexpr std::array kSamples = {8, 16, 32, 64};
  std::vector<FigureTable> tables;
  auto studio = open_studio(device, kScene, std::string(kPaper.look), size);
  if (!studio) return studio.error();
  for (const Preset& preset : kPresets) {
    progress(fmt::format("table 1, {}", preset.name));
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
    for (int run = -1; run < runs; ++run)  // run -1 warms up and does not count
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
