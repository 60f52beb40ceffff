// The pairs of pictures of appendix B of [Lajzer and Nottingham], in the paper's preset and in ours.
#include "apps/figures/cartoon_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "apps/figures/measure.h"
#include "core/check.h"

namespace umbrage {
namespace {

constexpr double kAnything = 1e30;
constexpr double kOneStep = 1.0 / 255.0;  // one step of an 8-bit picture

/// A sample's scene. The paper's lines are two pixels wide, and all of a thing is black if its normals turn by 18
/// degrees from pixel to pixel. The paper's scenes have no things that small; ours are drawn `finer` times as large and
/// reduced.
struct Sample {
  std::string name;
  int finer;
  std::string_view thin;  // meshes with thin parts
  Framing framing = {};   // from near, if not the scene's own
};
const std::array<Sample, kCartoonSamples> kSamples = {{
    {"terrain",
     5,
     "wood",
     {.position = glm::vec3(-60.0f, 110.0f, 400.0f),
      .focal_point = glm::vec3(-70.0f, 20.0f, 0.0f),
      .view_angle_deg = 40.0f}},
    {"room", 3, "chair"},
    {"solids", 3, "spring"},
    {"pink", 4, "blades"},
}};

/// Returns the pixels of the flat table top of scene:solids that the key light reaches, with no other object within the
/// reach of our occlusion and no other surface visible within `margin` pixels.
Mask open_table(const Studio& studio, const Shot& shot, int margin) {
  // kReach: occlusion radius of the look `cartoon`, relative to the bounding-sphere radius. kSmoothed: factor by which
  // smoothing extends it. kFlat: max height above the table top, metres.
  constexpr float kReach = 0.04f, kSmoothed = 1.25f, kFlat = 1e-3f;
  const float reach = kReach * kSmoothed * studio.scene->radius();
  const Mesh& table = mesh_named(*studio.scene, "table");
  struct Box {
    glm::vec3 low{1e30f}, high{-1e30f};
  };
  std::vector<Box> boxes;
  for (const Mesh& mesh : studio.scene->meshes) {
    if (mesh.object == table.object) continue;
    Box& box = boxes.emplace_back();
    for (const glm::vec3& p : mesh.positions) box.low = glm::min(box.low, p), box.high = glm::max(box.high, p);
  }
  const Plane &id = shot.image.plane("object_id"), &shadow = shot.image.plane("shadow");
  const Mask lit_top = mask_of(shot.image, [&](int x, int y) {
    return id.at(x, y) == float(table.object) && shadow.at(x, y) >= 1.0f && std::abs(shot.world(x, y).y) < kFlat;
  });
  const Mask alone = eroded(shot.image, lit_top, margin);
  return mask_of(shot.image, [&](int x, int y) {
    if (!alone[std::size_t(y) * shot.image.width + x]) return false;
    const glm::vec3 p = shot.world(x, y);
    return std::none_of(boxes.begin(), boxes.end(), [&](const Box& box) {
      const glm::vec3 offset = glm::max(glm::max(box.low - p, p - box.high), glm::vec3(0.0f));
      return std::hypot(offset.x, offset.z) < reach;
    });
  });
}

/// Returns the number of different 8-bit colours in a mask.
double colors(const Image& image, const Mask& mask) {
  std::set<std::array<long, 3>> seen;
  for_each_pixel(image, &mask, [&](int x, int y) {
    std::array<long, 3> color;
    for (int k = 0; k < 3; ++k) {
      constexpr std::array kChannels = {"color.r", "color.g", "color.b"};
      color[k] = std::lround(255.0f * image.plane(kChannels[k]).at(x, y));
    }
    seen.insert(color);
  });
  return double(seen.size());
}

/// Returns the fraction of their light that things in the picture keep with lines.
double light_kept(const Studio& studio, const Shot& lines, const Shot& no_lines, std::string_view mesh_name) {
  std::set<float> ids;
  for (const Mesh& mesh : studio.scene->meshes)
    if (mesh.name == mesh_name) ids.insert(float(mesh.object));
  const Mask mask = mask_of(lines.image, [&](int x, int y) { return ids.contains(lines.value("object_id", x, y)); });
  return mean_brightness(lines.image, mask) / mean_brightness(no_lines.image, mask);
}

FigurePicture reduced(FigurePicture picture, int factor) {
  picture.image = downsample(picture.image, factor);
  return picture;
}

}  // namespace

int cartoon_radius_px(const Image& image) { return std::max(1, image.width / 32); }

const Mesh& mesh_named(const Scene& scene, std::string_view name) {
  for (const Mesh& mesh : scene.meshes)
    if (mesh.name == name) return mesh;
  fail_check(fmt::format("{} has no mesh '{}'", scene.name, name));
}

Result<Figure> cartoon_sample(Device& device, int number, int size) {
  const Sample& sample = kSamples.at(std::size_t(number - 1));
  auto studio = open_studio(device, "scene:" + sample.name, std::string(kCartoonPaper.look), size);
  if (!studio) return studio.error();
  studio->framing = sample.framing;
  Figure figure{fmt::format("B{}", number),
                fmt::format("Appendix B, sample {}: scene:{} (paper preset, our own)", number, sample.name),
                {},
                {}};
  for (const CartoonPreset& preset : {kCartoonPaper, kCartoonOurs}) {
    const bool paper = preset.look == kCartoonPaper.look;
    const int finer = paper ? sample.finer : 1;
    studio->draw.look = std::string(preset.look);
    studio->draw.width = studio->draw.height = finer * size;
    const std::vector<std::string> planes = {"object_id", "ao", "shadow"};
    const auto without = studio->shoot({}, "none", planes);
    const auto with = studio->shoot({}, "", planes);
    const auto no_lines = studio->shoot({"outline.opacity=0"}, "", planes);
    if (const auto error = error_of(without, with, no_lines)) return *error;
    const std::string file = fmt::format("cartoon-b{}-{}", number, sample.name);
    const auto picture = [&](const Shot& shot, const char* name) {
      return reduced(
          shot.picture(fmt::format("{}-{}{}.png", file, name, preset.tag), fmt::format("{} ({})", name, preset.name)),
          finer);
    };
    figure.pictures.push_back(picture(*without, "without"));
    figure.pictures.push_back(picture(*with, "with"));
    const Mask surface = mask_of(with->image, [&](int x, int y) { return with->surface(x, y); });
    figure.numbers.push_back({fmt::format("fall of the mean with occlusion ({})", preset.name),
                              brightness_drop(without->image, with->image, surface), kOneStep, kAnything});
    figure.numbers.push_back({fmt::format("light that {} keeps under lines ({})", sample.thin, preset.name),
                              light_kept(*studio, *with, *no_lines, sample.thin), 0.3, 1.0});
    // Paper's preset: reach of the samples and the blur. Ours: a shadow's smoothed edge, twice a line of size / 256,
    // and size / 32, over which the look smooths light along the surface.
    const int margin = paper ? cartoon_radius_px(with->image) + kCartoonBlurRounds : 1 + size / 128 + size / 32;
    if (sample.name == "solids")
      figure.numbers.push_back({fmt::format("colours of the table away from contacts ({})", preset.name),
                                colors(with->image, open_table(*studio, *with, margin)), 1.0, 1.0});
  }
  return figure;
}

}  // namespace umbrage
