// Compares the shaders and the formulas of kits with the effects on the CPU.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "core/gbuffer.h"
#include "devices/shared/dispatches.h"
#include "gl_kit.h"
#include "kit/kit.h"
#include "run_effect.h"
#include "run_program.h"
#include "support.h"
#include "system/machine.h"

namespace umbrage {
namespace {

using test::Texels;

struct Case {
  const char* effects;   // separated by commas
  const char* settings;  // separated by spaces
};
constexpr Case kCases[] = {
    {"bitmask", ""},
    {"bitmask", "bitmask.mode=infinite"},
    {"bitmask", "bitmask.mips=on bitmask.noise=hilbert bitmask.radius=30%"},
    {"bitmask", "bitmask.bent=on bitmask.measure=uniform"},
    {"bitmask", "bitmask.bleeding=1 bitmask.bounces=2"},
    {"denoise", "denoise.rounds=2"},
    {"denoise", "denoise.indirect=1"},
    {"bitmask,denoise,upsample", ""},
    {"bitmask,denoise,upsample", "bitmask.bleeding=1 denoise.indirect=1 upsample.factor=4 upsample.indirect=on"},
    {"hemisphere", ""},
    {"hemisphere", "hemisphere.bleeding=1"},
    {"ssdo", ""},
    {"ssdo", "ssdo.bleeding=1"},
    {"unsharp", ""},
    {"sphere", ""},
    {"alchemy", ""},
    {"hbao", ""},
    {"box", ""},
    {"gaussian", ""},
    {"shanmugam", ""},
    {"normals,bitmask,upsample", ""},
    {"composite", "composite.tint=1"},
    {"toon", "toon.smoothness=4"},
    {"toon", "toon.mode=paper"},
    {"gooch", ""},
    {"outline", "outline.mode=paper"},
    {"antialias", ""},
    {"normals", ""},
};

struct Prepared {
  std::vector<const Effect*> effects;
  EffectSettings settings = initial_settings();
};

Prepared prepared(const Case& which) {
  Prepared result;
  std::string names = which.effects;
  std::replace(names.begin(), names.end(), ',', ' ');
  for (const std::string& name : test::words_of(names)) result.effects.push_back(find_effect(name));
  for (const std::string& text : test::words_of(which.settings)) {
    const auto status = apply_setting(result.settings, text);
    EXPECT_TRUE(status) << (status ? "" : status.error().message);
  }
  return result;
}

std::string label(const Case& which) { return fmt::format("{} {}", which.effects, which.settings); }

/// The view of a picture as frame.h has it.
struct View {
  int width, height, orthographic;
  float left, right, bottom, top, scene_radius, depth_min, depth_max, light_x, light_y, light_z;
};

View view_of(const PictureInfo& info) {
  const glm::vec3 light = info.lights.empty() ? glm::vec3(0.0f) : info.lights[0].direction;
  return {info.width,       info.height,       info.camera.projection == Projection::kOrthographic ? 1 : 0,
          info.camera.left, info.camera.right, info.camera.bottom,
          info.camera.top,  info.scene_radius, info.depth_min,
          info.depth_max,   light.x,           light.y,
          light.z};
}

/// The functions of frame.h, compiled by the C compiler.
class FrameFunctions {
 public:
  explicit FrameFunctions(const Kit& kit) {
    const auto made = TemporaryFolder::create();
    if (!made) {
      ADD_FAILURE() << made.error().message;
      return;
    }
    const std::string folder = made->path().string();
    std::ofstream(folder + "/frame.h") << kit_header(kit);
    std::string code =
        "#include \"frame.h\"\n#include <string.h>\n"
        "UmbrageView reduced(UmbrageView v, int factor) { return umbrage_reduced_view(&v, factor); }\n";
    for (const KitBlock& block : kit.blocks)
      code += fmt::format(
          "int fill_{0}(const UmbrageView* v, int round, void* out) {{ {1} f = {0}_frame(v, round); "
          "memcpy(out, &f, sizeof f); return sizeof f; }}\n",
          block.effect, block.name);
    std::ofstream(folder + "/frame.c") << code;
    const std::string command = fmt::format(
        "cc -std=c99 -Wall -Wextra -Wconversion -Werror -O1 -shared -fPIC -o {0}/frame.so {0}/frame.c -lm", folder);
    EXPECT_EQ(std::system(command.c_str()), 0);
    library_ = ::dlopen((folder + "/frame.so").c_str(), RTLD_NOW);
    EXPECT_NE(library_, nullptr);
  }
  ~FrameFunctions() {
    if (library_) ::dlclose(library_);
  }

  std::vector<std::byte> block(const KitBlock& of, const View& view, int round) const {
    std::vector<std::byte> bytes(1024);
    const auto fill =
        reinterpret_cast<int (*)(const View*, int, void*)>(::dlsym(library_, ("fill_" + of.effect).c_str()));
    bytes.resize(std::size_t(fill(&view, round, bytes.data())));
    return bytes;
  }
  View reduced(const View& view, int factor) const {
    return reinterpret_cast<View (*)(View, int)>(::dlsym(library_, "reduced"))(view, factor);
  }

 private:
  void* library_ = nullptr;
};

const KitBlock& block_of(const Kit& kit, const std::string& effect) {
  return *std::find_if(kit.blocks.begin(), kit.blocks.end(), [&](auto& block) { return block.effect == effect; });
}

/// A picture with bumps, background and everything that effects read.
GBuffer input_of(const std::vector<const Effect*>& effects, bool orthographic) {
  GBuffer g = test::bumpy_gbuffer(150, 110, 7);
  if (orthographic) g.info.camera = orthographic_camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 3.0f, 1.5f);
  g.info.ambient_shape = {};
  g.info.occluders = nullptr;
  g.info.lights = {Light{.direction = glm::normalize(glm::vec3(0.4f, 0.7f, 0.6f)), .casts_shadow = true}};
  for (const Effect* effect : effects)
    for (const Dispatch& dispatch : effect->dispatches)
      for (const std::string_view name : dispatch.inputs) {
        if (g.layers[0].find(name) || layer_of_plane(name) > 0 || name.starts_with("reduced_")) continue;
        Plane& plane = g.layers[0].add(name);
        for (int y = 0; y < plane.height; ++y)
          for (int x = 0; x < plane.width; ++x)
            plane.at(x, y) = float(test::hash(x + 4099u * y + unsigned(name.size() + name.back())) >> 8) * 0x1.4p-24f;
      }
  return g;
}

/// Returns every `factor`th pixel of every `factor`th row.
GBuffer reduced(const GBuffer& whole, int factor) {
  GBuffer g{.info = reduced_info(whole.info, factor), .layers = {}};
  Image& image = g.layers.emplace_back(g.info.width, g.info.height);
  for (std::size_t k = 0; k < whole.layers[0].planes.size(); ++k) {
    Plane& plane = image.add(whole.layers[0].names[k]);
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) plane.at(x, y) = whole.layers[0].planes[k].at(x * factor, y * factor);
  }
  return g;
}

const std::vector<std::string> kChannels[] = {{""}, {"x", "y", "z"}, {"r", "g", "b", "a"}};

/// Returns the names of the planes of a texture in an image; empty if it has none.
std::vector<std::string> planes_of(const Image& image, const std::string& name) {
  for (const auto& channels : kChannels) {
    std::vector<std::string> names;
    for (const std::string& channel : channels) {
      const std::string plane = channel.empty() ? name : name + "." + channel;
      if (image.find(plane)) names.push_back(plane);
    }
    if (!names.empty()) return names;
  }
  return {};
}

/// Returns a texture of an image's planes. Background has depth 0.
std::optional<Texels> texels_of(const Image& image, const std::string& name) {
  const auto names = planes_of(image, name);
  if (names.empty()) return std::nullopt;
  Texels texels{image.width, image.height, int(names.size()), {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (const std::string& plane : names) {
        const float value = image.plane(plane).at(x, y);
        texels.values.push_back(name == "depth" && !std::isfinite(value) ? 0.0f : value);
      }
  return texels;
}

/// Runs effects on the CPU; those before `upsample` at reduced size, from the first on that writes occlusion.
Image on_cpu(const Prepared& p, const GBuffer& whole, int factor) {
  const auto device = make_cpu_device(CpuSettings{});
  std::optional<Frame> frame;
  const std::size_t reduced_effects =
      p.effects.size() > 1 && p.effects.back()->set_reduction ? p.effects.size() - 1 : 0;
  GBuffer input = whole;
  if (reduced_effects > 0) {
    std::size_t first = 0;  // that writes occlusion; those before it run at full size
    auto full = device->upload(whole);
    for (; !writes(*p.effects[first], params_of(p.settings, p.effects[first]->name), "ao"); ++first)
      EXPECT_TRUE(device->run(*p.effects[first], params_of(p.settings, p.effects[first]->name), *full));
    input.layers[0] = *device->download_all(*full);
    auto small = device->upload(reduced(input, factor));
    for (std::size_t k = first; k < reduced_effects; ++k)
      EXPECT_TRUE(device->run(*p.effects[k], params_of(p.settings, p.effects[k]->name), *small));
    const auto planes = device->download_all(*small);
    for (std::size_t k = 0; k < planes->planes.size(); ++k) {
      const std::string name = planes->names[k];
      if (name != "ao" && !name.starts_with("indirect.")) continue;
      Plane& corner = input.layers[0].add(reduced_plane(name));
      for (int y = 0; y < planes->height; ++y)
        for (int x = 0; x < planes->width; ++x) corner.at(x, y) = planes->planes[k].at(x, y);
    }
  }
  frame = *device->upload(input);
  for (std::size_t k = reduced_effects; k < p.effects.size(); ++k)
    EXPECT_TRUE(device->run(*p.effects[k], params_of(p.settings, p.effects[k]->name), *frame));
  return *device->download_all(*frame);
}

class KitTest : public testing::TestWithParam<Case> {};

TEST_P(KitTest, FormulasAreThoseOfTheEffect) {
  const Prepared p = prepared(GetParam());
  const auto kit = make_kit(p.effects, p.settings, ShaderLanguage::kGlsl);
  ASSERT_TRUE(kit) << kit.error().message;
  const FrameFunctions functions(*kit);
  for (unsigned trial = 0; trial < 12; ++trial) {
    const auto random = [&](unsigned k) { return float(test::hash(977u * trial + k) >> 8) * 0x1p-24f; };
    PictureInfo info = usual_picture();
    info.width = 40 + int(random(1) * 2000.0f);
    info.height = 40 + int(random(2) * 1500.0f);
    info.camera.projection = trial % 3 == 0 ? Projection::kOrthographic : Projection::kPerspective;
    info.camera.left = -0.2f - random(3);
    info.camera.right = 0.3f + random(4);
    info.camera.bottom = -0.1f - random(5);
    info.camera.top = 0.2f + random(6);
    info.scene_radius = 0.1f + 10.0f * random(7);
    info.depth_min = 0.5f + random(8);
    info.depth_max = 3.0f + 20.0f * random(9);
    info.lights[0].direction = glm::normalize(glm::vec3(random(10) - 0.5f, random(11), random(12)));
    for (const Effect* effect : p.effects) {
      const KitBlock& block = block_of(*kit, std::string(effect->name));
      const bool is_reduced = std::any_of(kit->passes.begin(), kit->passes.end(), [&](const KitPass& pass) {
        return pass.effect == effect->name && pass.is_reduced;
      });
      const PictureInfo used = is_reduced ? reduced_info(info, kit->factor) : info;
      const View whole = view_of(info), view = is_reduced ? functions.reduced(whole, kit->factor) : whole;
      const auto bytes = functions.block(block, view, int(trial));
      ASSERT_EQ(int(bytes.size()), block.size());
      const FrameConstants common = frame_constants(used, used.width, int(trial));
      std::vector<std::uint32_t> words(effect->constants_size / 4);
      ParameterBytes params = params_of(p.settings, effect->name);
      effect->constants(params, used, words.data());
      const KernelText& text = kernel_text(dispatches_in_order(*effect, params, used, PixelSet::kAll)[0].first->kernel);
      for (std::size_t k = 0; k < block.fields.size(); ++k) {
        const FrameField& field = block.fields[k];
        std::uint32_t expected = 0, found = 0;
        std::memcpy(&found, bytes.data() + 4 * k, 4);
        int at = 0;
        bool is_own = false;
        for (const ConstantField& each : constant_fields(text.header, text.constants)) {
          if (each.name == field.field.name && (field.member != each.name || each.is_array || !is_own)) {
            expected = words[std::size_t(at)];
            is_own = true;
          }
          at += each.count;
        }
        at = 0;
        for (const ConstantField& each : constant_fields("kernel/frame_constants.h", "FrameConstants")) {
          if (each.name == field.field.name && field.member == each.name)
            std::memcpy(&expected, reinterpret_cast<const std::byte*>(&common) + 4 * at, 4);
          ++at;
        }
        if (field.field.type == "int") {
          EXPECT_EQ(std::int32_t(found), std::int32_t(expected)) << effect->name << "." << field.member;
        } else {
          float a = 0.0f, b = 0.0f;
          std::memcpy(&a, &found, 4);
          std::memcpy(&b, &expected, 4);
          EXPECT_NEAR(a, b, 4e-5f * std::abs(b) + 1e-12f)
              << effect->name << "." << field.member << " = " << field.formula;
        }
      }
    }
  }
}

/// The fraction of pixels that may differ by more than the bound: GPUs round differently, and single samples flip.
constexpr double kMaxDiffering = 1e-3;
constexpr float kMaxDifference = 4e-3f;

void expect_as_on_cpu(const Case& which, ShaderLanguage language) {
  std::string reason;
  const auto context = test::GlContext::make(language == ShaderLanguage::kGlslEs, reason);
  if (!context && std::getenv("CI")) FAIL() << reason;
  if (!context) GTEST_SKIP() << reason;
  for (const bool orthographic : {false, true}) {
    const Prepared p = prepared(which);
    const auto kit = make_kit(p.effects, p.settings, language);
    ASSERT_TRUE(kit) << kit.error().message;
    const FrameFunctions functions(*kit);
    const GBuffer input = input_of(p.effects, orthographic);
    const Image expected = on_cpu(p, input, kit->factor);
    const View whole = view_of(input.info), small = functions.reduced(whole, kit->factor);
    std::map<std::string, Texels> textures;
    textures["size"] = {whole.width, whole.height, 1, std::vector<float>(std::size_t(whole.width * whole.height))};
    textures["reduced size"] = {small.width, small.height, 1,
                                std::vector<float>(std::size_t(small.width * small.height))};
    for (const KitTexture& texture : kit->textures)
      if (texture.role == KitTexture::Role::kInput || texture.role == KitTexture::Role::kInOut)
        if (auto texels = texels_of(input.layers[0], texture.name)) textures[texture.name] = std::move(*texels);
    std::vector<std::vector<std::byte>> blocks;
    for (const KitPass& pass : kit->passes)
      blocks.push_back(pass.effect.empty()
                           ? std::vector<std::byte>()
                           : functions.block(block_of(*kit, pass.effect), pass.is_reduced ? small : whole, pass.round));
    ASSERT_EQ(context->run(*kit, blocks, textures), "") << label(which);
    int compared = 0;
    for (const KitTexture& texture : kit->textures) {
      if (texture.role != KitTexture::Role::kOutput && texture.role != KitTexture::Role::kInOut) continue;
      const auto cpu = texels_of(expected, texture.name);
      ASSERT_TRUE(cpu) << texture.name;
      const Texels& gpu = textures[texture.name];
      ASSERT_EQ(gpu.values.size(), cpu->values.size()) << texture.name;
      long over = 0;
      float max = 0.0f;
      for (std::size_t k = 0; k < gpu.values.size(); ++k) {
        const float difference = std::abs(gpu.values[k] - cpu->values[k]) / std::max(1.0f, std::abs(cpu->values[k]));
        over += !(difference <= kMaxDifference);
        max = std::max(max, difference);
      }
      EXPECT_LE(double(over), kMaxDiffering * double(gpu.values.size()))
          << label(which) << ", " << texture.name << (orthographic ? ", orthographic" : "") << ": largest " << max;
      ++compared;
    }
    EXPECT_GT(compared, 0);
  }
}

TEST_P(KitTest, OpenGlDrawsWhatTheCpuDoes) { expect_as_on_cpu(GetParam(), ShaderLanguage::kGlsl); }
TEST_P(KitTest, OpenGlEsDrawsWhatTheCpuDoes) { expect_as_on_cpu(GetParam(), ShaderLanguage::kGlslEs); }

INSTANTIATE_TEST_SUITE_P(Effects, KitTest, testing::ValuesIn(kCases), [](const auto& info) {
  std::string name = label(info.param);
  for (char& c : name)
    if (!std::isalnum(c)) c = '_';
  return name;
});

class ShadersProgram : public test::ProgramTest {};

/// Returns the files of a folder with an extension.
std::vector<test::fs::path> files_with(const test::fs::path& folder, std::string_view extension) {
  std::vector<test::fs::path> files;
  for (const auto& entry : test::fs::directory_iterator(folder))
    if (entry.path().extension() == extension) files.push_back(entry.path());
  EXPECT_FALSE(files.empty()) << folder;
  return files;
}

int code_of(const std::string& command) { return std::system((command + " > /dev/null").c_str()); }

TEST_F(ShadersProgram, WritesValidSpirv) {
  for (const Case& which : kCases) {
    std::string line = fmt::format("shaders {} -o kit --language spirv", which.effects);
    for (const std::string& setting : test::words_of(which.settings)) line += " --set " + setting;
    ASSERT_EQ(run(line).code, 0) << line;
    for (const auto& file : files_with(folder_ / "kit", ".spv"))
      EXPECT_EQ(code_of("spirv-val --target-env vulkan1.1 " + file.string()), 0) << line << ": " << file;
  }
}

TEST_F(ShadersProgram, WritesHlslAndMsl) {
  for (const std::string effects : {"bitmask,denoise,upsample", "toon", "antialias", "normals"}) {
    ASSERT_EQ(run(fmt::format("shaders {} -o hlsl --language hlsl", effects)).code, 0);
    ASSERT_EQ(run(fmt::format("shaders {} -o msl --language msl", effects)).code, 0);
    for (const auto& file : files_with(folder_ / "hlsl", ".hlsl"))
      EXPECT_EQ(code_of(fmt::format("glslangValidator -D -V -e main -S {} -o /dev/null {}",
                                    file.stem() == "screen_vertex" ? "vert" : "frag", file.string())),
                0)
          << file;
    for (const auto& file : files_with(folder_ / "msl", ".metal"))
      EXPECT_NE(test::text_of(file).find("main0"), std::string::npos) << file;
  }
}

TEST_F(ShadersProgram, NamesTheErrorsOfTheDocumentation) {
  const std::string docs = test::text_of(test::fs::path(test::kSourceFolder) / "docs/shaders.md");
  const std::pair<const char*, const char*> rows[] = {
      {"bitmask,denoise", "| `bitmask,denoise` | **{}**"},
      {"bitmask,denoise,upsample", "| `bitmask,denoise,upsample` | {} "},
      {"hemisphere,denoise", "| `hemisphere,denoise` | {} "},
      {"unsharp", "| `unsharp` | {} "},
  };
  for (const auto& [effects, row] : rows) {
    ASSERT_EQ(run(fmt::format("shaders {} -o kit", effects)).code, 0);
    const std::string readme = test::text_of(folder_ / "kit/README.md"), before = "over eight scenes: ";
    const std::size_t at = readme.find(before);
    ASSERT_NE(at, std::string::npos) << effects;
    EXPECT_NE(docs.find(fmt::format(fmt::runtime(row), readme.substr(at + before.size(), 4))), std::string::npos)
        << effects;
  }
}

TEST_F(ShadersProgram, ReplacesItsOwnFilesAlone) {
  EXPECT_EQ(run("shaders bitmask,denoise -o kit").code, 0);
  EXPECT_EQ(run("shaders bitmask -o kit --set bitmask.mode=infinite").code, 0);
  EXPECT_TRUE(test::fs::exists(folder_ / "kit/bitmask_horizon.frag"));
  EXPECT_FALSE(test::fs::exists(folder_ / "kit/denoise_ao_down.frag"));
  write("kit/own.frag", "void main() {}");
  const auto outcome = run("shaders sphere -o kit");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("'own.frag'"), std::string::npos) << outcome.err;
  EXPECT_TRUE(test::fs::exists(folder_ / "kit/bitmask_horizon.frag"));
}

TEST_F(ShadersProgram, DoesNotReplaceFilesOfOthers) {
  for (const std::string name : {"README.md", "pass.json"}) {
    test::fs::create_directory(folder_ / "own");
    write("own/" + name, "mine");
    EXPECT_EQ(run("shaders bitmask -o own").code, 2) << name;
    EXPECT_EQ(test::text_of(folder_ / "own" / name), "mine");
    test::fs::remove_all(folder_ / "own");
  }
  EXPECT_EQ(run("shaders bitmask -o kit --language msl", "TMPDIR=/nonexistent").code, 3);
}

TEST_F(ShadersProgram, RefusesByName) {
  const std::pair<const char*, const char*> cases[] = {
      {"shaders hatching -o kit",
       "effect hatching cannot be written as shaders: its step 'hatching_strokes' runs on the processor"},
      {"shaders traced -o kit", "'rays' traces rays in the scene"},
      {"shaders outline -o kit", "with --set outline.mode=paper it can"},
      {"shaders bitmask -o kit --language cg", "--language cannot be 'cg': it is glsl, glsl-es, hlsl, msl or spirv"},
      {"shaders bitmask -o kit --set denoise.rounds=2", "effect denoise is not among those to write, bitmask"},
      {"shaders lighting -o kit", "effect lighting is not written as shaders; these are: alchemy"},
      {"shaders bitmask,bitmask -o kit", "effect bitmask is given twice"},
      {"shaders bitmask -o tri.obj", "'tri.obj' is a file"},
  };
  for (const auto& [line, message] : cases) {
    const auto outcome = run(line);
    EXPECT_EQ(outcome.code, 2) << line;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << line << ": " << outcome.err;
    EXPECT_FALSE(test::fs::exists(folder_ / "kit")) << line;
  }
}

}  // namespace
}  // namespace umbrage
