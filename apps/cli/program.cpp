// The command line of umbrage and umbrage-lab: parses it, runs a command and reports errors.
#include <CLI/CLI.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "apps/cli/commands.h"
#include "apps/cli/config.h"
#include "apps/cli/lab_options.h"
#include "apps/cli/options.h"
#include "apps/cli/signals.h"
#include "core/guarded.h"
#include "core/lists.h"
#include "core/suggest.h"
#include "io/layers.h"

namespace umbrage::cli {
namespace {

constexpr std::string_view kDashes = "--";
constexpr const char* kSummary =
    "Screen-space shading: ambient occlusion and more, for any 3D model.\n"
    "umbrage MODEL -o out.png is short for umbrage render MODEL -o out.png,\n"
    "umbrage IMAGE -o out.png for umbrage shade IMAGE -o out.png.";
constexpr const char* kLabSummary =
    "The commands of umbrage that measure techniques and reproduce papers.\n"
    "umbrage starts this program for them: umbrage compare is umbrage-lab compare.";

/// Returns the long option names of a command, without dashes, for suggestions.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  return names;
}

/// Returns the command that the user named; the program itself if there is none.
const CLI::App& parsed(const CLI::App& app) {
  return app.get_subcommands().empty() ? app : *app.get_subcommands().front();
}

/// Returns the command line that prints the help of the command that the user named.
std::string help_of(const CLI::App& app) {
  return (&parsed(app) == &app ? app.get_name() : "umbrage " + parsed(app).get_name()) + " --help";
}

Error unknown_option(const CLI::App& app, std::string word) {
  if (const std::size_t equals = word.find('='); equals != std::string::npos) word.resize(equals);
  if (!word.starts_with('-')) return usage_error("'{}' is one argument too many", word);
  const auto names = option_names(parsed(app));
  // Compare names without dashes, which would make all long names similar.
  const bool is_long = word.starts_with(kDashes);
  const auto near = nearest_name(is_long ? word.substr(kDashes.size()) : word, names);
  return usage_error("there is no option '{}'{}", word,
                     near.empty() ? "; see " + help_of(app) : did_you_mean(fmt::format("{}{}", kDashes, near)));
}

/// Converts an error of CLI11 to a message of this program.
Error parse_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::string help = help_of(app);
  std::string text = error.what();
  std::replace(text.begin(), text.end(), '\n', ' ');
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
    const std::string option = text.substr(0, text.find(':'));
    if (text.ends_with("missing")) return usage_error("{} needs a value; see {}", option, help);
    if (text.find("At Most") != std::string::npos) return usage_error("{} is given twice; give it once", option);
  }
  if (dynamic_cast<const CLI::ValidationError*>(&error))  // "--option: " and the message of a Check
    return Error{ErrorKind::kUsage, text.substr(std::min(text.find(": ") + 2, text.size()))};
  if (dynamic_cast<const CLI::ConversionError*>(&error)) {
    // "Could not convert: --option = value". Only flags cause this error, since all other options are texts.
    const std::size_t start = text.find("--"), equals = text.find(" = ");
    if (start != std::string::npos && equals != std::string::npos && start < equals) {
      return usage_error("{} cannot be '{}': it takes true or false", text.substr(start, equals - start),
                         text.substr(equals + 3));
    }
  }
  return usage_error("{}; see {}", text, help);
}

/// Inserts the command render, or shade for an image file, if none is named: `umbrage MODEL ...` is short for
/// `umbrage render MODEL ...`.
std::vector<std::string> with_command(std::vector<std::string> words, const std::vector<std::string>& commands) {
  const bool has_command = !words.empty() && contains(commands, words[0]);
  const bool wants_help = !words.empty() && (words[0] == "--help" || words[0] == "-h" || words[0] == "--version");
  if (!words.empty() && !has_command && !wants_help)
    words.insert(words.begin(), has_image_extension(words[0]) ? "shade" : "render");
  return words;
}

/// Returns an error if the first word is a misspelt command rather than a model.
std::optional<Error> misspelt_command(const std::vector<std::string>& words, const std::vector<std::string>& commands) {
  if (words.size() < 2 || words[0] != "render") return std::nullopt;
  const std::string& word = words[1];
  std::error_code ignored;
  if (word.find_first_of("./:-") != std::string::npos || std::filesystem::exists(word, ignored)) return std::nullopt;
  const std::string_view near = nearest_name(word, commands);
  if (near.empty()) return std::nullopt;
  return usage_error("there is no command and no file '{}'{}", word, did_you_mean(near));
}

/// Returns an error if an option has an empty value. An option that is not given is no error.
std::optional<Error> empty_option(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands())
    for (const CLI::Option* option : command->get_options())
      for (const std::string& value : option->results())
        // Empty file names are reported in more detail where files are read and written.
        if (value.empty() && !option->get_positional() && option->get_name() != "--output")
          return usage_error("{} needs a value; see umbrage {} --help", option->get_name(), command->get_name());
  return std::nullopt;
}

/// Returns an error for `--name=`, to which CLI11 would assign the next word as value.
std::optional<Error> option_without_value(const std::vector<std::string>& words) {
  for (const std::string& word : words)
    if (word.starts_with(kDashes) && word.size() > kDashes.size() + 1 && word.find('=') == word.size() - 1)
      return usage_error("{} needs a value after its '='", word.substr(0, word.size() - 1));
  return std::nullopt;
}

const CLI::App* command_of(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    if (command->get_name() == name) return command;
  return nullptr;
}

/// Returns an error for an option whose value is missing, so that CLI11 would take the option after it as the value.
std::optional<Error> option_as_value(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* command = words.empty() ? nullptr : command_of(app, words[0]);
  if (!command) return std::nullopt;
  for (std::size_t k = 1; k + 1 < words.size(); ++k) {
    const std::string next = words[k + 1].substr(0, words[k + 1].find('='));
    if (!words[k].starts_with('-') || !next.starts_with('-') || next.size() < 2) continue;
    const CLI::Option* option = command->get_option_no_throw(words[k]);
    if (option && option->get_items_expected_min() > 0 && command->get_option_no_throw(next))
      return usage_error("{} needs a value: the word after it, {}, is an option", words[k], next);
  }
  return std::nullopt;
}

/// Quotes a word of a command line if a shell requires it.
std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-+=.,:/%@") == std::string::npos;
  if (plain) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

int report(const Error& error) {
  // fmt::print would throw if standard error cannot be written.
  std::fputs(("umbrage: " + with_option_names(error.message) + "\n").c_str(), stderr);
  return int(error.kind);
}

/// Flushes standard output and returns the exit code of a successful run.
int finish_output() {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return 0;
  return report(file_error("standard output cannot be written"));
}

bool is_of_lab(const std::string& command) { return contains(kLabCommands, command); }

/// Returns an error if the first word is not a command of umbrage-lab.
std::optional<Error> foreign_command(const std::vector<std::string>& words) {
  if (words.empty()) return usage_error("name a command; see umbrage-lab --help");
  if (words[0].starts_with('-') || is_of_lab(words[0])) return std::nullopt;
  return usage_error("umbrage-lab has no command '{}'{}", words[0], suggestion(words[0], kLabCommands));
}

/// Adds all commands in the order of the help. The help of umbrage-lab shows only its own; the configuration file may
/// name others.
void add_commands(CLI::App& app, std::function<Result<void>()>& command, const LabActions& actions, bool is_lab) {
  for (const AddCommand add : {add_render, add_shade, add_view, add_thumbnails}) add(app, command);
  add_lab(app, command, actions);
  for (const AddCommand add : {add_shaders, add_info, add_list, add_manual}) add(app, command);
  for (CLI::App* each : app.get_subcommands({}))
    if (is_lab && !is_of_lab(each->get_name())) each->group("");  // hidden
}

int run(int argc, char** argv, const LabActions& actions, bool is_lab) {
  command_line = "umbrage";
  for (int i = 1; i < argc; ++i) command_line += " " + quoted(argv[i]);
  CLI::App app{is_lab ? kLabSummary : kSummary, is_lab ? "umbrage-lab" : "umbrage"};
  app.set_version_flag("--version", version_text, "Print the version, the commit, instruction sets and devices");
  app.require_subcommand(1);
  app.fallthrough(false);
  std::function<Result<void>()> command;
  add_commands(app, command, actions, is_lab);
  const std::vector<std::string> commands = command_names(app);

  std::vector<std::string> words(argv + 1, argv + argc);
  if (is_lab) {
    if (const auto error = foreign_command(words)) return report(*error);
  } else {
    words = with_command(std::move(words), commands);
  }
  if (const auto error = misspelt_command(words, commands)) return report(*error);
  if (const auto error = option_without_value(words)) return report(*error);
  if (const auto error = option_as_value(app, words)) return report(*error);
  auto configured = with_config(app, std::move(words));
  if (!configured) return report(configured.error());
  words = std::move(configured->words);
  std::reverse(words.begin(), words.end());  // the order that CLI11 expects
  try {
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    const CLI::App& requested = parsed(app);
    std::fputs((&requested == &app ? app.help() : requested.help("umbrage")).c_str(), stdout);
    return finish_output();
  } catch (const CLI::CallForVersion& version) {
    std::fputs(version.what(), stdout);
    return finish_output();
  } catch (const CLI::ExtrasError&) {
    return report(unknown_option(app, app.remaining(true).front()));
  } catch (const CLI::ParseError& error) {
    if (argc < 2)
      return report(usage_error("name a model, such as umbrage bunny.obj -o bunny.png; see umbrage --help"));
    return report(parse_error(app, error));
  }
  if (const auto error = empty_option(app)) return report(*error);
  try {
    if (const Result<void> status = command(); !status) return report(with_place(status.error(), configured->values));
  } catch (const std::system_error&) {
    if (!std::ferror(stdout)) throw;  // fmt::print failed to write; finish_output() reports it
  }
  return finish_output();
}

/// Returns an error if the stack is too small: threads get as much as the limit says.
std::optional<Error> stack_error() {
  constexpr rlim_t kMinStack = rlim_t(256) << 10;
  rlimit limit{};
  if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= kMinStack) return std::nullopt;
  return device_error("the limit of the stack is {} KiB; set it to {} or more (ulimit -s)", limit.rlim_cur >> 10,
                      kMinStack >> 10);
}

}  // namespace

std::string command_line;

int run_program(int argc, char** argv, const LabActions& actions, bool is_lab) {
  end_on_signals();
  if (const auto error = stack_error()) return report(*error);
  const auto code =
      guarded([] { return command_line + "; try a smaller picture or model, or a smaller --memory of render"; },
              [&]() -> Result<int> { return run(argc, argv, actions, is_lab); });
  return code ? *code : report(code.error());
}

}  // namespace umbrage::cli
