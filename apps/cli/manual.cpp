// umbrage help, completion and manual: help, shell completion scripts and the manual page, generated from the options.
#include <CLI/CLI.hpp>
#include <array>
#include <cctype>
#include <nlohmann/json.hpp>

#include "apps/cli/commands.h"
#include "apps/cli/options.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "core/version.h"
#include "effects/effects.h"
#include "generators/builtin.h"
#include "kernel/isa.h"
#include "looks/presets.h"

namespace umbrage::cli {
namespace {

using Words = std::vector<std::string>;

struct ManualOptions {
  std::string shell, command;
  bool json = false;  ///< of the manual
};

constexpr std::array<std::string_view, 3> kShells = {"bash", "zsh", "fish"};

Words filter_names() {
  Words names;
  for (const Effect* effect : effects())
    if (effect->kind == EffectKind::kFilter) names.emplace_back(effect->name);
  return names;
}
Words effect_names() {
  Words names = {"capture"};
  for (const Effect* effect : effects()) names.emplace_back(effect->name);
  return names;
}
/// Returns the words that complete --set: each parameter, with its values if it is a choice or a switch.
Words parameter_names() {
  Words names;
  for (const Effect* effect : effects_with_external())
    for (const Parameter& row : effect->parameters) {
      const std::string start = fmt::format("{}.{}=", effect->name, row.name);
      if (row.type == ParameterType::kChoice)
        for (const std::string_view choice : row.choices) names.push_back(start + std::string(choice));
      else if (row.type == ParameterType::kBool)
        names.insert(names.end(), {start + "on", start + "off"});
      else
        names.push_back(start);
    }
  return names;
}
Words scene_names() {
  Words names;
  for (const BuiltinScene& scene : builtin_scenes()) names.push_back(fmt::format("scene:{}", scene.name));
  return names;
}

/// Returns the possible values of an option or positional argument; empty for numbers, files and other open values.
Words values_of(const CLI::App& command, std::string_view option) {
  const std::string& name = command.get_name();
  if (option == "WHAT" && name == "list") return {kListKinds.begin(), kListKinds.end()};
  if (option == "COMMAND") return command_names(*command.get_parent());
  if (option == "SHELL") return {kShells.begin(), kShells.end()};
  if (option == "filter") return filter_names();
  if (option == "effect") return effect_names();
  if (option == "set") return parameter_names();
  if (option == "device") return {"auto", "cpu", "vulkan"};
  if (option == "isa") return {usable_isas().begin(), usable_isas().end()};
  if (option == "up") return {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
  if (option == "paper") return {"unsharp", "cartoon", "bleeding"};
  if (option == "input-format") return import_formats();
  for (const Option& row : options())
    if (row.option == option) {
      const auto words = words_of(row);
      return {words.begin(), words.end()};
    }
  return {};
}

bool is_flag(const CLI::Option& option) { return option.get_type_name().empty(); }

/// Returns the options that are not positional, including --help.
std::vector<const CLI::Option*> named_options(const CLI::App& command) {
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : command.get_options())
    if (!option->get_positional() && !option->get_lnames().empty()) options.push_back(option);
  return options;
}

const CLI::Option* positional_of(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) return option;
  return nullptr;
}

std::string joined(const Words& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : std::string(between)) + word;
  return text;
}

/// Returns the text with a backslash before each character of `which`.
std::string escaped(std::string_view text, std::string_view which) {
  std::string out;
  for (const char c : text) {
    if (which.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

/// A description, and the default that follows it in brackets; empty: none.
struct Described {
  std::string meaning, initial;
};
Described described(const std::string& text) {
  const auto bracket = text.rfind(" [");
  if (bracket == std::string::npos || !text.ends_with(']')) return {text, ""};
  return {text.substr(0, bracket), text.substr(bracket + 2, text.size() - bracket - 3)};
}
std::string without_default(const std::string& text) { return described(text).meaning; }

// ---- bash ----

std::string bash_of(const std::vector<const CLI::App*>& commands) {
  Words names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  std::string options, values;
  for (const CLI::App* command : commands) {
    Words spellings;
    for (const CLI::Option* option : named_options(*command)) {
      for (const std::string& name : option->get_lnames()) spellings.push_back("--" + name);
      for (const std::string& name : option->get_snames()) spellings.push_back("-" + name);
      const Words choices = values_of(*command, option->get_lnames()[0]);
      std::string pattern = fmt::format("{}:--{}", command->get_name(), option->get_lnames()[0]);
      for (const std::string& name : option->get_snames()) pattern += fmt::format("|{}:-{}", command->get_name(), name);
      if (!choices.empty())
        values += fmt::format("    {}) words='{}' ;;\n", pattern, joined(choices, " "));
      else if (!is_flag(*option))
        values += fmt::format("    {}) COMPREPLY=($(compgen -f -- \"$current\")); return ;;\n", pattern);
    }
    const CLI::Option* positional = positional_of(*command);
    const Words choices = positional ? values_of(*command, positional->get_name()) : Words();
    options += fmt::format("    {}) options='{}' words='{}' ;;\n", command->get_name(), joined(spellings, " "),
                           joined(choices, " "));
  }
  return fmt::format(R"(# bash completion for umbrage, made by: umbrage completion bash
_umbrage() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} command=render options words
  # bash takes --name=value apart at the equals sign, and scene:name at the colon.
  if [[ $current == = ]]; then
    current=
  elif [[ $previous == = ]]; then
    previous=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  case ${{COMP_WORDS[1]}} in
    {0}) command=${{COMP_WORDS[1]}} ;;
  esac
  if [[ $previous == : || $current == : ]]; then
    COMPREPLY=($(compgen -W '{1}' -- "${{current#:}}"))
    return
  fi
  case $command in
{2}  esac
  case $command:$previous in
{3}    *)
      if [[ $current == -* ]]; then
        words=$options
      elif [[ $COMP_CWORD -eq 1 ]]; then
        words='{4} scene:'
      fi ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  if [[ ${{#COMPREPLY[@]}} -eq 1 && ${{COMPREPLY[0]}} == *[=:] ]]; then compopt -o nospace 2>/dev/null; fi
  if [[ $current != -* && ( -z $words || $COMP_CWORD -eq 1 ) ]]; then COMPREPLY+=($(compgen -f -- "$current")); fi
}}
complete -o filenames -F _umbrage umbrage
)",
                     joined(names, "|"),
                     [] {
                       Words scenes = scene_names();
                       for (std::string& scene : scenes) scene.erase(0, scene.find(':') + 1);
                       return joined(scenes, " ");
                     }(),
                     options, values, joined(names, " "));
}

// ---- zsh ----

std::string zsh_of(const std::vector<const CLI::App*>& commands) {
  constexpr std::string_view kSpecial = "[]:\\";
  const auto quoted = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('\'', at)) != std::string_view::npos; at += 4)
      text.replace(at, 1, "'\\''");
    return "'" + text + "'";
  };
  std::string out =
      "#compdef umbrage\n# zsh completion for umbrage, made by: umbrage completion zsh\n_umbrage() {\n"
      "  local -a commands\n  commands=(\n";
  Words names;
  for (const CLI::App* command : commands) {
    names.push_back(command->get_name());
    out += "    " + quoted(command->get_name() + ":" + command->get_description()) + "\n";
  }
  out +=
      "  )\n  if (( CURRENT == 2 )) && [[ $words[2] != -* ]]; then\n    _describe command commands\n    _files\n    "
      "return\n  fi\n"
      "  local command=$words[2]\n  if (( ! ${commands[(I)$command:*]} )); then\n    command=render\n  else\n"
      "    shift words\n    (( CURRENT-- ))\n  fi\n  case $command in\n";
  for (const CLI::App* command : commands) {
    out += "    " + command->get_name() + ")\n      _arguments \\\n";
    for (const CLI::Option* option : named_options(*command)) {
      const std::string help = "[" + escaped(without_default(option->get_description()), kSpecial) + "]";
      std::string value;
      if (!is_flag(*option)) {
        const Words choices = values_of(*command, option->get_lnames()[0]);
        value = ":" + option->get_lnames()[0] + ":" +
                (choices.empty() ? "_files" : "(" + escaped(joined(choices, " "), ":\\") + ")");
      }
      const std::string repeat = option->get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll ? "*" : "";
      for (const std::string& name : option->get_lnames())
        out += "        " + quoted(repeat + "--" + name + (value.empty() ? "" : "=") + help + value) + " \\\n";
      for (const std::string& name : option->get_snames())
        out += "        " + quoted(repeat + "-" + name + (value.empty() ? "" : "+") + help + value) + " \\\n";
    }
    const CLI::Option* positional = positional_of(*command);
    const Words choices = positional ? values_of(*command, positional->get_name()) : Words();
    if (!choices.empty())
      out += "        " + quoted(":" + positional->get_name() + ":(" + joined(choices, " ") + ")") + "\n";
    else
      out += "        " + quoted("*:model:_files") + "\n";
    out += "      ;;\n";
  }
  return out + "  esac\n}\n_umbrage \"$@\"\n";
}

// ---- fish ----

std::string fish_of(const std::vector<const CLI::App*>& commands) {
  const auto quoted = [](const std::string& text) { return "'" + escaped(text, "'\\") + "'"; };
  Words names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  const std::string all = joined(names, " ");
  std::string out = "# fish completion for umbrage, made by: umbrage completion fish\n";
  for (const CLI::App* command : commands)
    out += fmt::format("complete -c umbrage -n 'not __fish_seen_subcommand_from {}' -a {} -d {}\n", all,
                       command->get_name(), quoted(command->get_description()));
  out += fmt::format("complete -c umbrage -n 'not __fish_seen_subcommand_from {}' -a {}\n", all,
                     quoted(joined(scene_names(), " ")));
  for (const CLI::App* command : commands) {
    const bool is_default = command->get_name() == "render";  // umbrage MODEL is short for umbrage render MODEL
    Words others = names;
    std::erase(others, command->get_name());
    const std::string when = is_default ? "not __fish_seen_subcommand_from " + joined(others, " ")
                                        : "__fish_seen_subcommand_from " + command->get_name();
    for (const CLI::Option* option : named_options(*command)) {
      const Words choices = is_flag(*option) ? Words() : values_of(*command, option->get_lnames()[0]);
      out += "complete -c umbrage -n " + quoted(when);
      for (const std::string& name : option->get_snames()) out += " -s " + name;
      for (const std::string& name : option->get_lnames()) out += " -l " + name;
      if (!choices.empty())
        out += " -x -a " + quoted(joined(choices, " "));
      else if (!is_flag(*option))
        out += " -r";
      out += " -d " + quoted(without_default(option->get_description())) + "\n";
    }
    const CLI::Option* positional = positional_of(*command);
    if (const Words choices = positional ? values_of(*command, positional->get_name()) : Words(); !choices.empty())
      out += "complete -c umbrage -f -n " + quoted(when) + " -a " + quoted(joined(choices, " ")) + "\n";
  }
  return out;
}

// ---- man ----

/// Escapes the characters of a text that roff would interpret.
std::string roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
      out += std::string("\\&") + c;
    else
      out += c;
  }
  return out;
}

std::string upper(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string man_options(const CLI::App& command) {
  std::string out;
  for (const CLI::Option* option : named_options(command)) {
    std::string names;
    for (const std::string& name : option->get_snames())
      names += (names.empty() ? "" : ", ") + ("\\fB\\-" + name) + "\\fR";
    for (const std::string& name : option->get_lnames())
      names += (names.empty() ? "" : ", ") + ("\\fB\\-\\-" + roff(name)) + "\\fR";
    if (!is_flag(*option)) names += " \\fI" + roff(option->get_type_name()) + "\\fR";
    out += ".TP\n" + names + "\n" + roff(option->get_description()) + "\n";
  }
  return out;
}

std::string man_of(const CLI::App& app, const std::vector<const CLI::App*>& commands) {
  std::string out = fmt::format(".TH UMBRAGE 1 \"\" \"umbrage {}\" \"User Commands\"\n", project_version());
  out += ".SH NAME\numbrage \\- screen\\-space shading for 3D models\n.SH SYNOPSIS\n";
  out += ".B umbrage\n.I MODEL\n.B \\-o\n.I FILE\n.RI [ OPTION ]...\n";
  for (const CLI::App* command : commands) {
    const CLI::Option* positional = positional_of(*command);
    out += ".br\n.B umbrage " + command->get_name() + "\n";
    if (positional) out += ".I " + positional->get_name() + "\n";
    out += ".RI [ OPTION ]...\n";
  }
  out += ".SH DESCRIPTION\n" + roff(app.get_description()) + "\n.PP\n" +
         roff(
             "MODEL is a file (umbrage list formats), - for standard input, or a built-in scene, scene:NAME or "
             "scene:NAME?detail=TRIANGLES. Options are written --name value or --name=value.") +
         "\n";
  for (const CLI::App* command : commands)
    out += ".SH " + upper("umbrage " + command->get_name()) + "\n" + roff(command->get_description()) + "\n" +
           man_options(*command);
  out += ".SH PARAMETERS\n" + roff("Parameters of --set, as effect.parameter=value.") + "\n";
  for (const Effect* effect : effects_with_external()) {
    const ParameterBytes initial = initial_parameters(effect->parameters, effect->params_size);
    out += ".SS " + std::string(effect->name) + "\n" + roff(effect->summary) + "\n";
    for (const Parameter& row : effect->parameters)
      out += fmt::format(".TP\n\\fB{}.{}\\fR\n{}\n", effect->name, roff(row.name),
                         roff(with_option_names(fmt::format("{}: {} [{}]", row.help, parameter_range(row),
                                                            parameter_text(row, initial)))));
  }
  out += ".SH EXIT STATUS\n";
  const std::pair<int, const char*> codes[] = {{0, "done"},
                                               {1, "internal error, or a score or figure out of bounds"},
                                               {2, "wrong usage: an option, value or name"},
                                               {3, "a file that cannot be read, used or written"},
                                               {4, "a missing or insufficient device, or too little memory"},
                                               {130, "interrupted"}};
  for (const auto& [code, text] : codes) out += fmt::format(".TP\n.B {}\n{}\n", code, roff(text));
  out += ".SH ENVIRONMENT\n";
  Words seen;
  for (const CLI::App* command : commands)
    for (const CLI::Option* option : named_options(*command)) {
      const std::string& variable = option->get_envname();
      if (variable.empty() || contains(seen, variable)) continue;
      seen.push_back(variable);
      out += fmt::format(".TP\n.B {}\n{}\n", variable, roff("default of --" + option->get_lnames()[0]));
    }
  out += ".SH FILES\n.TP\n.I $XDG_CONFIG_HOME/umbrage/config, ~/.config/umbrage/config\n" +
         roff(
             "lines option = value, and headings [command]; options before the first heading apply to every command "
             "that has them. The environment and the command line take precedence.") +
         "\n";
  return out;
}

// ---- JSON ----

/// Returns all commands with their arguments and options.
nlohmann::json json_of(const std::vector<const CLI::App*>& commands) {
  const auto record_of = [](const CLI::Option& option) {
    const auto [meaning, initial] = described(option.get_description());
    return nlohmann::json{{"meaning", meaning}, {"default", initial}, {"required", option.get_required()}};
  };
  nlohmann::json records = nlohmann::json::array();
  for (const CLI::App* command : commands) {
    nlohmann::json arguments = nlohmann::json::array(), options = nlohmann::json::array();
    for (const CLI::Option* option : command->get_options()) {
      if (!option->get_positional()) continue;
      arguments.push_back(record_of(*option));
      arguments.back()["name"] = option->get_name();
      arguments.back()["several"] = option->get_items_expected_max() > 1;
    }
    for (const CLI::Option* option : named_options(*command)) {
      Words names;
      for (const std::string& name : option->get_snames()) names.push_back("-" + name);
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
      options.push_back(record_of(*option));
      options.back().update({{"names", names},
                             {"value", option->get_type_name()},
                             {"group", option->get_group()},
                             {"environment", option->get_envname()}});
    }
    records.push_back({{"name", command->get_name()},
                       {"summary", command->get_description()},
                       {"arguments", arguments},
                       {"options", options}});
  }
  return records;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands(std::function<bool(const CLI::App*)>());
}

Result<void> completion(const CLI::App& app, const ManualOptions& o) {
  const auto commands = commands_of(app);
  if (o.shell == "bash")
    fmt::print("{}", bash_of(commands));
  else if (o.shell == "zsh")
    fmt::print("{}", zsh_of(commands));
  else if (o.shell == "fish")
    fmt::print("{}", fish_of(commands));
  else
    return usage_error("there is no completion for '{}'{}", o.shell, suggestion(o.shell, kShells));
  return {};
}

/// Prints the help of a command, or that of the program if none is named.
Result<void> help(const CLI::App& app, const ManualOptions& o) {
  if (o.command.empty()) {
    // CLI::App::help would print the help of the command that was parsed.
    fmt::print("{}", app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::Normal));
    return {};
  }
  const Words names = command_names(app);
  if (!contains(names, o.command)) return unknown_name("command", o.command, names);
  fmt::print("{}", app.get_subcommand(o.command)->help(app.get_name()));
  return {};
}

}  // namespace

void add_manual(CLI::App& app, std::function<Result<void>()>& run) {
  auto options = std::make_shared<ManualOptions>();
  CLI::App* helper = app.add_subcommand("help", "print the help of a command, as --help does");
  helper->add_option("COMMAND", options->command, "a command; without one, all are listed");
  helper->callback([&app, options, &run] { run = [&app, options] { return help(app, *options); }; });
  CLI::App* shell = app.add_subcommand("completion", "print the completion script of a shell");
  shell->add_option("SHELL", options->shell, "bash, zsh or fish")->required();
  shell->callback([&app, options, &run] { run = [&app, options] { return completion(app, *options); }; });
  CLI::App* manual = app.add_subcommand("manual", "print the manual page, for man -l");
  manual->add_flag("--json", options->json, "print the commands and their options as JSON");
  manual->callback([&app, options, &run] {
    run = [&app, options]() -> Result<void> {
      if (options->json)
        fmt::print("{}\n", json_of(commands_of(app)).dump(2));
      else
        fmt::print("{}", man_of(app, commands_of(app)));
      return {};
    };
  });
}

}  // namespace umbrage::cli
