// The options of the picture, its light, the device, and the files, in the order of the help.
#include "looks/looks.h"
#include "looks/presets.h"
#include "renderer/accumulation.h"
#include "renderer/option_rows.h"
#include "renderer/recipe.h"

namespace umbrage {
namespace {

constexpr double kMaxLightFactor = 100.0;
constexpr unsigned kDeviceCommands = kSceneCommands | kBench | kFigures | kShade;

std::vector<std::string_view> look_names() {
  std::vector<std::string_view> names;
  for (const Look* look : looks()) names.push_back(look->name);
  return names;
}

std::vector<std::string_view> style_names() { return names_of(styles()); }

std::vector<std::string_view> technique_names() { return occlusion_names(external_effects()); }

}  // namespace

std::vector<Option> picture_options() {
  return {
      with_form(with_range(row("Picture", kRender | kTune, "width", "resolution",
                               "width,height in pixels, or one number for a square", "1024,1024", in<&Request::width>),
                           1, kMaxSide),
                OptionForm::kSize, "px"),
      {.field = "height",
       .option = "resolution",
       .group = "",
       .help = "height of the picture, pixels",
       .where = in<&Request::height>,
       .commands = 0,
       .min = 1,
       .max = kMaxSide,
       .unit = "px"},
      {.field = "look",
       .option = "look",
       .group = "Picture",
       .help = "style of the picture: see umbrage list looks",
       .initial = "studio; comp for a file with the renderer's own picture",
       .where = in<&Request::look>,
       .commands = kRender | kTune | kShade,
       .names = look_names},
      {.field = "occlusion",
       .option = "ao",
       .group = "Picture",
       .help = "occlusion technique, or none",
       .initial = "set by the look",
       .where = in<&Request::occlusion>,
       .commands = kRender | kTune | kShade,
       .names = technique_names},
      with_choices(row("Picture", kSceneCommands | kBench | kShade, "occlusion_scale", "ao-scale",
                       "resolution at which occlusion is computed: full, half or quarter", "set by the look",
                       in<&Request::occlusion_scale>),
                   {"full", "half", "quarter"}),
      with_range(row("Picture", kRender, "anti_aliasing", "anti-aliasing",
                     "number of pictures to average, each sampled at different positions within the pixels",
                     "set by the look", in<&Request::anti_aliasing>),
                 1, kMaxAveragedPictures),
      with_choices(
          row("Picture", kRender, "ground", "ground", "a ground that shows the model's shadow: auto, on or off",
              "auto: set by the look", in<&Request::ground>),
          {"auto", "on", "off"}),
      with_form(row("Picture", kRender | kShade, "background", "background-color",
                    "colour of the background: a CSS name, #rrggbb, or red,green,blue from 0 to 1", "set by the look",
                    in<&Request::background>),
                OptionForm::kColor),
      with_range(row("Picture", kRender | kShade, "exposure", "exposure", "brightness, in stops: 1 doubles the light",
                     "0", in<&Request::exposure>),
                 -20.0, 20.0, "stops"),
      with_range(row("Picture", kRender | kShade, "contrast", "contrast",
                     "contrast about middle grey: 1 as it is, 1.5 stronger", "1", in<&Request::contrast>),
                 0.0, 4.0),
      with_choices(row("Picture", kRender, "material", "material",
                       "materials of the model: file, its own; clay, white plaster without textures",
                       "file, unless set by the style", in<&Request::material>),
                   {"file", "clay"}),
      with_form(row("Picture", kRender, "color", "color",
                    "colour of the whole model, as clay: a CSS name, #rrggbb, or red,green,blue from 0 to 1",
                    "that of the materials", in<&Request::color>),
                OptionForm::kColor),
      {.field = "style",
       .option = "style",
       .group = "Picture",
       .help = "colours for a purpose: white, dark, blueprint or clay; other options override them",
       .initial = "none",
       .where = in<&Request::style>,
       .commands = kRender | kShade,
       .names = style_names},
      row("Picture", kRender | kShade, "transparent", "no-background", "transparent where there is no surface", "",
          in<&Request::transparent>),
      row("Light", kRender, "hdri_file", "hdri-file",
          "equirectangular environment image that lights the scene: .hdr, .exr, .png, .jpg, or "
          "the built-in clear sky, sky:",
          "none", in<&Request::hdri_file>),
      row("Light", kRender, "hdri_ambient", "hdri-ambient",
          "light the scene with the image; `hdri_ambient`=false: only show it", "true", in<&Request::hdri_ambient>),
      row("Light", kRender, "hdri_skybox", "hdri-skybox", "show the image as the background", "",
          in<&Request::hdri_skybox>),
      with_range(row("Light", kRender, "hdri_rotation_deg", "hdri-rotation",
                     "rotation of the image about the up direction, degrees", "0", in<&Request::hdri_rotation_deg>),
                 -kAnyAngle, kAnyAngle, "deg"),
      with_range(row("Light", kRender, "hdri_intensity", "hdri-intensity", "factor for the brightness of the image",
                     "1", in<&Request::hdri_intensity>),
                 0.0, 1e6),
      with_range(row("Light", kRender, "light_size_deg", "light-size",
                     "angular diameter of the key light, degrees; larger values give softer shadows",
                     "set by the light", in<&Request::light_size_deg>),
                 0.0, 90.0, "deg"),
      with_form(
          row("Light", kRender, "light_direction", "light-direction",
              "azimuth,elevation of the key light in degrees, as seen from the camera: -50,43 is to the left and above",
              "set by the look or the scene", in<&Request::light_direction>),
          OptionForm::kAngles, "deg"),
      with_range(row("Light", kRender, "key", "key", "factor for the key light, the first of the scene", "1",
                     in<&Request::key>),
                 0.0, kMaxLightFactor),
      with_range(row("Light", kRender, "fill", "fill", "factor for the fill light of the look studio", "1",
                     in<&Request::fill>),
                 0.0, kMaxLightFactor),
      with_range(
          row("Light", kRender, "rim", "rim", "factor for the rim light of the look studio", "1", in<&Request::rim>),
          0.0, kMaxLightFactor),
      with_range(row("Light", kRender | kShade, "shadow_strength", "shadow-strength",
                     "strength of shadows, on the model and on the ground: 0 none, 1 as the look has them", "1",
                     in<&Request::shadow_strength>),
                 0.0, 1.0),
      {.field = "device",
       .option = "device",
       .group = "Device",
       .help = "cpu, vulkan, vulkan:N (see umbrage list devices) or auto (a GPU if there is one)",
       .initial = "auto",
       .where = in<&Request::device>,
       .commands = kDeviceCommands,
       .environment = "UMBRAGE_DEVICE"},
      {.field = "threads",
       .option = "threads",
       .group = "Device",
       .help = "number of threads (0: all)",
       .initial = "0",
       .where = in<&Request::threads>,
       .commands = kDeviceCommands,
       .max = 1024,
       .environment = "UMBRAGE_NUM_THREADS"},
      {.field = "isa",
       .option = "isa",
       .group = "Device",
       .help = "widest instruction set for kernels and ray tracing on the CPU: avx512, avx2, sse4, neon or scalar",
       .initial = "the widest of the machine",
       .commands = kDeviceCommands,
       .environment = "UMBRAGE_ISA"},
      with_form(
          row("Output", kRender, "passes", "passes",
              "planes to write instead of the picture: names such as depth,normal,ao, or all; beauty: the picture, its "
              "parts and geometry, for compositing",
              "", in<&Request::passes>),
          OptionForm::kWords),
      {.field = "bits",
       .option = "bits",
       .group = "Output",
       .help = "bits per channel of a PNG: 8 or 16",
       .initial = "8",
       .choices = {"8", "16"}},
      {.field = "strokes",
       .option = "svg",
       .group = "",
       .help = "return the look's lines as curves",
       .where = in<&Request::strokes>,
       .commands = 0},
      {.field = "model", .option = "MODEL", .group = "", .help = "", .where = in<&Request::model>, .commands = 0},
  };
}

}  // namespace umbrage
