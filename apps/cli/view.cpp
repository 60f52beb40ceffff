// umbrage view: shows models or a G-buffer on a page in a browser.
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "apps/cli/commands.h"
#include "apps/cli/options.h"
#include "apps/cli/signals.h"
#include "apps/view/view.h"
#include "io/layers.h"
#include "renderer/devices.h"
#include "system/child_process.h"

namespace umbrage::cli {
namespace {

struct ViewCommand : CommonOptions {
  std::string host = "127.0.0.1";
  std::vector<std::string> host_names;
  int port = 0;
  bool stays_closed = false;  ///< no browser is started
  bool once = false, watch = false;
};

/// Shows a file in the user's browser. Returns whether a desktop that can show one exists.
bool open_in_browser(const std::string& file) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return false;
  const ChildProgram opener{.program = "xdg-open",
                            .words = {file},
                            .files = {{STDIN_FILENO}, {STDOUT_FILENO}, {STDERR_FILENO}},
                            .own_group = true};
  pid_t child = 0;
  return start_child(opener, child) == 0;
}

/// Returns the options of the command line and the configuration file, as the page keeps them: name and texts.
view::ViewOptions given_options(const ViewCommand& o) {
  view::ViewOptions given;
  for (const auto& [name, text] : o.texts)
    if (!text.empty()) given[std::string(name)] = {text};
  for (const auto& [name, texts] : o.lists)
    if (!texts.empty()) given[std::string(name)] = texts;
  for (const Option& row : options()) {
    const auto* of = std::get_if<FieldOf<bool>>(&row.where);
    const auto flag = o.flags.find(row.option);
    Request initial;
    if (of && flag != o.flags.end() && flag->second != (*of)(initial))
      given[std::string(row.option)] = {flag->second ? "true" : "false"};
  }
  return given;
}

/// Returns the signals that end the program: not those that its parent process ignores, as nohup does. A blocked signal
/// would be received even if it is ignored.
sigset_t awaited_signals() {
  sigset_t signals = ending_signals();
  for (int signal = 1; signal < NSIG; ++signal) {
    struct sigaction action {};
    if (sigismember(&signals, signal) == 1 && ::sigaction(signal, nullptr, &action) == 0 &&
        action.sa_handler == SIG_IGN)
      sigdelset(&signals, signal);
  }
  return signals;
}

/// Waits for Ctrl-C and the signals that end programs or, if `ended` is not null, until it returns true.
void wait_for_end(const std::function<bool()>& ended) {
  constexpr timespec kInterval{.tv_sec = 0, .tv_nsec = 500'000'000};
  const sigset_t signals = awaited_signals();
  while (!ended || !ended())
    if ((ended ? ::sigtimedwait(&signals, nullptr, &kInterval) : ::sigwaitinfo(&signals, nullptr)) > 0) return;
}

Result<void> run_view(const ViewCommand& o) {
  view::Settings settings{.request = o.request,
                          .given = given_options(o),
                          .command = command_line,
                          .host = o.host,
                          .port = o.port,
                          .host_names = o.host_names,
                          .watch = o.watch};
  for (const std::string& file : o.models) settings.models.push_back({file, has_image_extension(file)});
  const bool has_gbuffer = std::any_of(settings.models.begin(), settings.models.end(),
                                       [](const view::ViewedFile& file) { return file.is_gbuffer; });
  for (const Option& row : options())
    if (row.group == "Files" && o.is_given(row.option) && !has_gbuffer)
      return field_error(row.field, "", "`{0}` is for a G-buffer, and '{2}' is a model", o.models[0]);
  const BlockSignals blocked;  // threads inherit it, so that wait_for_end receives all signals
  if (o.is_given("isa"))
    if (auto valid = use_isa(o.text_of("isa")); !valid) return valid.error();
  auto viewer = view::Viewer::start(std::move(settings));
  if (!viewer) return viewer.error();
  for (const std::string& warning : (*viewer)->warnings()) print_warning(warning);
  const std::string address = (*viewer)->address();
  fmt::print("{}\n", address);
  std::fflush(stdout);
  // Command lines are public: the browser gets the name of a private file instead of the address.
  const auto launcher = o.stays_closed ? Result<std::string>("") : (*viewer)->launcher();
  if (!launcher) return launcher.error();
  const bool shown = !o.stays_closed && open_in_browser(*launcher);
  fmt::print(stderr, "{} Ctrl-C ends the program.\n",
             shown ? "The page opens in a browser." : "Open this address in a browser.");
  if (o.once)
    wait_for_end([&] { return (*viewer)->was_left(); });
  else
    wait_for_end(nullptr);
  return {};
}

}  // namespace

void add_view(CLI::App& app, std::function<Result<void>()>& run) {
  const auto [command, options] = add_model_command(app, run, "view", "show models or a G-buffer in a browser",
                                                    OptionCommand(kRender | kShade), run_view);
  command->get_option("MODEL")->description("models or G-buffers, of which the page shows one at a time");
  for (const char* group : {"Files", "G-buffer", "Technique", "Picture", "Light"})
    add_group(*command, *options, OptionCommand(kRender | kShade), group);
  const auto page = "Page";
  add_number(*command, "--port", options->port, {0, 65535, NumberKind::kInteger}, "port of the page", "a free one")
      ->group(page);
  command
      ->add_option("--host", options->host,
                   "address to serve the page on [127.0.0.1, which only this computer reaches]")
      ->type_name("ADDRESS")
      ->group(page);
  command
      ->add_option(
          "--host-name", options->host_names,
          "another name for which the page is served, or NAME:PORT as for a tunnel; may be given several times")
      ->type_name("NAME")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)
      ->group(page);
  command->add_flag("--no-open", options->stays_closed, "only print the address, start no browser")->group(page);
  command->add_flag("--once", options->once, "end when the last page is closed")->group(page);
  command->add_flag("--watch", options->watch, "load a file again when it changes")->group(page);
  add_device_options(*command, *options, kRender);
}

}  // namespace umbrage::cli
