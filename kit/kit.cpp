#include "kit/kit.h"

#include <algorithm>
#include <cctype>

#include "core/check.h"
#include "core/lists.h"

namespace umbrage {
namespace {

constexpr std::size_t kMaxOutputs = 4;  // that GLSL ES 3.00 guarantees

std::string capitalized(std::string_view name) {
  std::string text;
  for (std::size_t k = 0; k < name.size(); ++k)
    if (name[k] != '_') text += k == 0 || name[k - 1] == '_' ? char(std::toupper(name[k])) : name[k];
  return text;
}

/// The effects that kits are tested with. Of the others some run on the processor or trace rays; the rest depend on
/// lights and layers that a kit does not have.
constexpr std::string_view kExported[] = {"alchemy",   "antialias", "bitmask", "box",        "composite", "denoise",
                                          "gaussian",  "gooch",     "hbao",    "hemisphere", "normals",   "outline",
                                          "shanmugam", "sphere",    "ssdo",    "toon",       "unsharp",   "upsample"};

bool needs_more_than_shaders(const Dispatch& dispatch) { return dispatch.host || dispatch.rays; }

/// Returns settings with which an effect has shaders only, or an empty text.
std::string other_settings(const Effect& effect) {
  for (const std::string_view variant : effect.variants) {
    ParameterBytes params = initial_parameters(effect.parameters, effect.params_size);
    const std::size_t equals = variant.find('=');
    if (equals == std::string_view::npos || variant.find(' ') != std::string_view::npos) continue;
    const Parameter* row = find_parameter(effect, variant.substr(0, equals));
    if (!row || !set_parameter(effect.name, *row, variant.substr(equals + 1), params)) continue;
    const auto all = dispatches_in_order(effect, params, usual_picture(), PixelSet::kAll);
    if (std::none_of(all.begin(), all.end(), [](const auto& run) { return needs_more_than_shaders(*run.first); }))
      return fmt::format("{}.{}", effect.name, variant);
  }
  return {};
}

Error cannot_be_shader(const Effect& effect, const Dispatch& dispatch) {
  const std::string other = other_settings(effect);
  return usage_error("effect {} cannot be written as shaders: its step '{}' {}{}", effect.name, dispatch.name,
                     dispatch.rays ? "traces rays in the scene" : "runs on the processor",
                     other.empty() ? "" : fmt::format("; with --set {} it can", other));
}

bool is_reduced_plane(const std::string& name) { return name.starts_with(reduced_plane("")); }

/// Returns the name of the plane at full size.
std::string whole_plane(const std::string& name) {
  return is_reduced_plane(name) ? name.substr(reduced_plane("").size()) : name;
}

/// Makes the kit of several effects.
class Maker {
 public:
  Maker(const std::vector<const Effect*>& effects, EffectSettings settings, ShaderLanguage language)
      : effects_(effects), settings_(std::move(settings)) {
    kit_.language = language;
  }

  Result<Kit> make() {
    // Effects from `first` up to `end` run at reduced size.
    std::size_t first = effects_.size(), end = 0;
    for (std::size_t k = effects_.size(); k-- > 0;) {
      if (effects_[k]->set_reduction && end == 0) end = k;
      if (!effects_[k]->set_reduction && writes(*effects_[k], params_of(settings_, effects_[k]->name), "ao")) first = k;
    }
    kit_.factor = factor_of_upsampler();
    for (std::size_t k = 0; k < effects_.size(); ++k) {
      const Effect& effect = *effects_[k];
      ParameterBytes& params = params_of(settings_, effect.name);
      if (effect.set_reduction && writes_reduced_light(k)) set_int(*find_parameter(effect, "indirect"), 1, params);
      kit_.effects.emplace_back(effect.name);
      const ParameterBytes initial = initial_parameters(effect.parameters, effect.params_size);
      for (const Parameter& row : effect.parameters) {
        const std::string value = parameter_text(row, params);
        kit_.settings.push_back(fmt::format("{}.{}={}", effect.name, row.name, value));
        if (value != parameter_text(row, initial)) kit_.changed.push_back(kit_.settings.back());
      }
      if (auto status = add(effect, params, k >= first && k < end); !status) return status.error();
    }
    if (first < end) add_reduction();
    describe_textures();
    return std::move(kit_);
  }

 private:
  /// Returns whether an effect before number `k` writes indirect light.
  bool writes_reduced_light(std::size_t k) const {
    return std::any_of(effects_.begin(), effects_.begin() + long(k), [&](const Effect* effect) {
      return writes(*effect, params_of(settings_, effect->name), "indirect.r");
    });
  }

  Result<void> add(const Effect& effect, const ParameterBytes& params, bool is_reduced) {
    const auto runs = effect.constants ? dispatches_in_order(effect, params, usual_picture(), PixelSet::kAll)
                                       : std::vector<std::pair<const Dispatch*, int>>();
    if (runs.empty()) return usage_error("effect {} does nothing with these settings", effect.name);
    for (const auto& [dispatch, round] : runs)
      if (needs_more_than_shaders(*dispatch)) return cannot_be_shader(effect, *dispatch);
    if (std::find(std::begin(kExported), std::end(kExported), effect.name) == std::end(kExported))
      return usage_error("effect {} is not written as shaders; these are: {}", effect.name, fmt::join(kExported, ", "));
    const KernelText& any = kernel_text(runs[0].first->kernel);
    const auto fields = effect_fields(effect, params, any.header, any.constants, is_reduced ? kit_.factor : 1);
    const auto absent = absent_planes(effect, runs);
    std::map<const Dispatch*, ShaderParts> parts;
    KitBlock block{std::string(effect.name), capitalized(effect.name) + "Frame", {}};
    std::set<std::string> members;
    for (const auto& [dispatch, round] : runs) {
      if (parts.count(dispatch)) continue;
      const bool is_first_round_alone = std::none_of(
          runs.begin(), runs.end(), [&](const auto& run) { return run.first == dispatch && run.second > 0; });
      ShaderParts& made = parts[dispatch] =
          shader_parts(kernel_text(dispatch->kernel), fields, absent, is_first_round_alone, kit_.language);
      made.about = fmt::format("// {}\n//\n{}", effect.summary, made.about);
      members.insert(made.frame.begin(), made.frame.end());
      if (made.outputs.size() > kMaxOutputs)
        return usage_error(
            "effect {} cannot be written as shaders with these settings: its step '{}' writes {} planes, "
            "and WebGL guarantees {}",
            effect.name, dispatch->name, made.outputs.size(), kMaxOutputs);
    }
    for (const FrameField& field : fields.frame)
      if (members.count(field.member)) block.fields.push_back(field);
    for (const FrameField& field : block.fields)
      if (field.formula.empty())
        return usage_error(
            "effect {} cannot be written as shaders with these settings: its constant '{}' has no formula", effect.name,
            field.field.name);
    for (const auto& [dispatch, round] : runs) add_pass(effect, *dispatch, round, is_reduced, parts[dispatch]);
    for (const auto& [dispatch, made] : parts) {
      const ShaderHead head{fmt::format("{}, step {}", effect.name, dispatch->name), block.name,
                            capitalized(effect.name) + "Settings", block.fields};
      kit_.shaders.push_back({file_of(effect, *dispatch), shader_text(made, fields, head, kit_.language)});
    }
    kit_.blocks.push_back(std::move(block));
    return {};
  }

  int factor_of_upsampler() const {
    for (const Effect* effect : effects_) {
      const Parameter* row = effect->set_reduction ? find_parameter(*effect, "factor") : nullptr;
      if (!row) continue;
      const std::string text = parameter_text(*row, params_of(settings_, effect->name));
      return text == "4" ? 4 : 2;
    }
    return 1;
  }

  static std::string file_of(const Effect& effect, const Dispatch& dispatch) {
    std::string name(dispatch.name);
    std::replace(name.begin(), name.end(), ' ', '_');
    if (name != effect.name && !name.starts_with(fmt::format("{}_", effect.name)))
      name = fmt::format("{}_{}", effect.name, name);
    return name + ".frag";
  }

  /// Returns the planes that the effect would write with other settings, with the value that they then have.
  static std::map<std::string, float> absent_planes(const Effect& effect,
                                                    const std::vector<std::pair<const Dispatch*, int>>& runs) {
    std::map<std::string, float> absent;
    for (const Dispatch& dispatch : effect.dispatches)
      for (const std::string_view plane : dispatch.outputs)
        if (const auto value = neutral_value(plane)) absent[pass_of(plane)] = *value;
    for (const auto& [dispatch, round] : runs)
      for (const std::string_view plane : dispatch->outputs) absent.erase(pass_of(plane));
    return absent;
  }

  static std::string texture_of(const std::string& plane, bool is_reduced) {
    return is_reduced ? reduced_plane(plane) : plane;
  }

  KitTexture& texture(const std::string& name, int channels, bool is_reduced) {
    for (KitTexture& each : kit_.textures) {
      if (each.name != name) continue;
      each.channels = std::max(each.channels, channels);
      return each;
    }
    return kit_.textures.emplace_back(KitTexture{.name = name, .channels = channels, .is_reduced = is_reduced});
  }

  void add_pass(const Effect& effect, const Dispatch& dispatch, int round, bool is_reduced, const ShaderParts& parts) {
    KitPass pass{.file = file_of(effect, dispatch), .effect = std::string(effect.name), .round = round};
    pass.is_reduced = is_reduced;
    for (const ShaderPlane& plane : parts.inputs) {
      const std::string name = texture_of(plane.name, is_reduced);
      pass.samplers.push_back(plane.name + "_texture");
      pass.inputs.push_back(name);
      texture(name, plane.channels, is_reduced || is_reduced_plane(name));
    }
    const bool packs = std::any_of(parts.items.begin(), parts.items.end(),
                                   [](const KernelItem& item) { return item.names[0] == "packed_pair"; });
    for (const ShaderPlane& plane : parts.outputs) {
      const std::string name = texture_of(plane.name, is_reduced);
      pass.outputs.push_back(name);
      texture(name, plane.channels, is_reduced).is_exact |= packs && plane.channels == 1 && plane.name != "ao";
    }
    kit_.passes.push_back(std::move(pass));
  }

  /// Adds a pass for each reduced plane that nothing writes, which makes it from the plane of full size.
  void add_reduction() {
    for (const std::string& name : read_before_written()) {
      if (!is_reduced_plane(name)) continue;
      const std::string whole = whole_plane(name);
      texture(whole, texture(name, 1, true).channels, false);
      const auto reader = std::find_if(kit_.passes.begin(), kit_.passes.end(),
                                       [&](const KitPass& pass) { return contains(pass.inputs, name); });
      kit_.passes.insert(reader, {.file = "reduce.frag",
                                  .effect = "",
                                  .is_reduced = true,
                                  .samplers = {"plane_texture"},
                                  .inputs = {whole},
                                  .outputs = {name}});
    }
    kit_.shaders.push_back({"reduce.frag", reduction_shader(kit_.language, kit_.factor)});
  }

  std::vector<std::string> read_before_written() const {
    std::vector<std::string> read;
    std::set<std::string> written;
    for (const KitPass& pass : kit_.passes) {
      for (const std::string& name : pass.inputs)
        if (!written.count(name) && !contains(read, name) && !is_written_later_only(name)) read.push_back(name);
      written.insert(pass.outputs.begin(), pass.outputs.end());
    }
    return read;
  }

  /// Whether only later rounds read what the first pass that names a plane would read: a step that runs again.
  bool is_written_later_only(const std::string& name) const {
    if (std::none_of(kit_.passes.begin(), kit_.passes.end(),
                     [&](const KitPass& pass) { return contains(pass.outputs, name); }))
      return false;
    for (const KitPass& pass : kit_.passes) {
      if (!contains(pass.inputs, name) && !contains(pass.outputs, name)) continue;
      const Effect* effect = find_effect(pass.effect);
      if (!effect || contains(pass.outputs, name)) return false;
      const std::string plane = pass.is_reduced ? whole_plane(name) : name;
      return std::any_of(effect->dispatches.begin(), effect->dispatches.end(), [&](const Dispatch& dispatch) {
        return file_of(*effect, dispatch) == pass.file &&
               std::any_of(dispatch.later_inputs.begin(), dispatch.later_inputs.end(),
                           [&](std::string_view later) { return pass_of(later) == plane; });
      });
    }
    return false;
  }

  void describe_textures() {
    const auto read = read_before_written();
    for (KitTexture& each : kit_.textures) {
      using Role = KitTexture::Role;
      bool written = false, read_later = false;
      for (const KitPass& pass : kit_.passes) {
        read_later = read_later || (written && contains(pass.inputs, each.name));
        if (!contains(pass.outputs, each.name)) continue;
        written = true;
        read_later = false;
      }
      each.role = contains(read, each.name) ? written && !read_later ? Role::kInOut : Role::kInput
                  : written && !read_later  ? Role::kOutput
                                            : Role::kIntermediate;
      const auto value = neutral_value(whole_plane(each.name));
      each.has_neutral = (each.role == Role::kInput || each.role == Role::kInOut) && value.has_value();
      if (each.has_neutral) each.neutral = *value;
    }
  }

  std::vector<const Effect*> effects_;
  EffectSettings settings_;
  Kit kit_;
};

}  // namespace

Result<Kit> make_kit(const std::vector<const Effect*>& effects, EffectSettings settings, ShaderLanguage language) {
  return Maker(effects, std::move(settings), language).make();
}

}  // namespace umbrage
