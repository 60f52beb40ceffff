// umbrage shaders: writes effects as shaders for other engines.
#include <CLI/CLI.hpp>

#include "apps/cli/commands.h"
#include "apps/cli/options.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "kit/kit.h"

namespace umbrage::cli {
namespace {

struct ShadersOptions {
  std::vector<std::string> effects, settings;
  std::string folder, language = "glsl";
};

constexpr ShaderLanguage kLanguages[] = {ShaderLanguage::kGlsl, ShaderLanguage::kGlslEs, ShaderLanguage::kHlsl,
                                         ShaderLanguage::kMsl, ShaderLanguage::kSpirv};

Result<ShaderLanguage> language_of(const std::string& name) {
  std::vector<std::string_view> names;
  for (const ShaderLanguage language : kLanguages) {
    if (language_name(language) == name) return language;
    names.push_back(language_name(language));
  }
  return usage_error("--language cannot be '{}': it is {}", name, joined_by_or(names));
}

Result<void> run_shaders(const ShadersOptions& options) {
  const auto language = language_of(options.language);
  if (!language) return language.error();
  std::vector<const Effect*> chosen;
  for (const std::string& name : options.effects) {
    const auto effect = require_named<Effect>("effect", effects(), name);
    if (!effect) return effect.error();
    if (contains(chosen, *effect)) return usage_error("effect {} is given twice", name);
    chosen.push_back(*effect);
  }
  EffectSettings settings = initial_settings();
  for (const std::string& text : options.settings) {
    const auto setting = parse_setting(text);
    if (!setting) return setting.error();
    if (!contains(chosen, setting->effect))
      return usage_error("--set {}: effect {} is not among those to write, {}", text, setting->effect->name,
                         fmt::join(options.effects, ", "));
    if (auto status = apply_setting(settings, text); !status) return status;
  }
  const auto kit = make_kit(chosen, std::move(settings), *language);
  if (!kit) return kit.error();
  return write_kit(*kit, options.folder);
}

}  // namespace

void add_shaders(CLI::App& app, std::function<Result<void>()>& run) {
  CLI::App* command = app.add_subcommand("shaders", "write effects as shaders for other engines");
  auto options = std::make_shared<ShadersOptions>();
  command->add_option("EFFECT", options->effects, "effects in the order in which they run, such as bitmask,denoise")
      ->required()
      ->delimiter(',');
  command->add_option("-o,--output", options->folder, "folder for the shaders, which is created")
      ->type_name("DIR")
      ->required();
  command->add_option("--language", options->language, "glsl, glsl-es (WebGL 2), hlsl, msl or spirv [glsl]")
      ->type_name("NAME");
  command->add_option("--set", options->settings, "effect.parameter=value; see umbrage list effects")
      ->type_name("SETTING");
  command->callback([options, &run] { run = [options] { return run_shaders(*options); }; });
}

}  // namespace umbrage::cli
