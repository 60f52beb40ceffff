#include "apps/view/view.h"

#include <chrono>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/view/drawing.h"
#include "apps/view/save.h"
#include "apps/view/server.h"
#include "apps/view/tables.h"
#include "core/version.h"
#include "generators/builtin.h"
#include "io/image_file.h"
#include "renderer/models.h"
#include "renderer/recipe.h"
#include "scene/readers/content.h"
#include "scene/readers/import_parts.h"

namespace umbrage::view {
namespace {

using Clock = std::chrono::steady_clock;

/// A page that is loaded again connects within this time.
constexpr std::chrono::seconds kReloadTime(3);

/// Returns the page: one HTML file with its style sheet and script, UTF-8. It requests nothing from anywhere else.
std::string_view page() {
  static constexpr char kPage[] =
#include "view_page.inc"
      ;
  return {kPage, sizeof kPage - 1};
}

std::string name_of(const std::string& file) {
  const std::string name = std::filesystem::path(file).filename().string();
  return name.empty() ? file : name;
}

/// Checks what can be checked of a file before it is read. Errors: kUsage for an unknown scene; kFile.
Result<void> check_file(const ViewedFile& file) {
  constexpr std::string_view kScene = "scene:";
  if (file.file.starts_with(kScene)) {
    const std::string name = file.file.substr(kScene.size(), file.file.find('?') - kScene.size());
    for (const BuiltinScene& scene : builtin_scenes())
      if (scene.name == name) return {};
    const auto unknown = load_scene(file.file);
    return unknown ? Result<void>() : unknown.error();
  }
  std::error_code ignored;
  if (file.is_gbuffer && std::filesystem::is_regular_file(file.file, ignored)) return {};
  const auto error = check_model_file(file.file, format_of_file(file.file));
  return error ? Result<void>(*error) : Result<void>();
}

}  // namespace

struct Viewer::Parts {
  nlohmann::json tables;  // of the message hello, without the models
  std::mutex lists;       // held while a list of models is made and sent, so that no page keeps an older one
  std::timed_mutex saving;
  std::mutex mutex;  // guards the members up to `sender`
  std::set<PageId> pages;
  bool had_pages = false;
  Clock::time_point last_closed = {};
  Server* sender = nullptr;  // null before the server has started and while it ends
  std::unique_ptr<Drawing> drawing;
  std::unique_ptr<Server> server;

  ~Parts() {
    {
      const std::lock_guard lock(mutex);
      sender = nullptr;
    }
    if (server) server->stop();  // calls the handlers, which use `server` and `drawing`
  }

  void send(PageId page, std::string text) {
    const std::lock_guard lock(mutex);
    if (sender) sender->send_text(page, std::move(text));
  }

  void send_frame(PageId page, std::string bytes) {
    const std::lock_guard lock(mutex);
    if (sender) sender->send_frame(page, std::move(bytes));
  }

  void opened(PageId page) {
    const std::lock_guard order(lists);
    {
      const std::lock_guard lock(mutex);
      pages.insert(page);
      had_pages = true;
    }
    nlohmann::json hello = tables;
    hello["models"] = drawing->models();
    send(page, text_of_json(hello));
  }

  void closed(PageId page) {
    drawing->close(page);
    const std::lock_guard lock(mutex);
    pages.erase(page);
    last_closed = Clock::now();
  }

  void received(PageId page, std::string_view text) {
    auto message = parse_message(text);
    if (!message) return send(page, error_text(message.error().message));
    if (auto* state = std::get_if<State>(&*message)) {
      if (!drawing->has_model(state->model))
        return send(page, error_text(fmt::format("there is no model {}", state->model), state->id));
      for (View& view : state->views) use_upload(view.options);
      drawing->set_state(page, std::move(*state));
    } else if (const auto* ack = std::get_if<Ack>(&*message)) {
      drawing->acknowledge(page, ack->frame);
    } else if (const auto* pick = std::get_if<Pick>(&*message)) {
      drawing->pick(page, *pick);
    } else if (const auto* open = std::get_if<Open>(&*message)) {
      if (auto status = open_upload(page, *open); !status) send(page, error_text(status.error().message));
    }
  }

  /// Adds an uploaded model to the list, selected on the page that asks, or tells the page that an environment is
  /// there.
  Result<void> open_upload(PageId page, const Open& open) {
    const auto path = server->upload(open.file);
    if (!path) return path.error();
    if (open.as == "environment") {
      send(page, environment_text(open.file));
      return {};
    }
    const std::lock_guard order(lists);
    const int id =
        drawing->add_model({.file = path->string(), .name = name_of(open.file), .is_gbuffer = open.as == "gbuffer"});
    nlohmann::json list = {{"type", "models"}, {"models", drawing->models()}};
    std::set<PageId> others;
    {
      const std::lock_guard lock(mutex);
      others = pages;
    }
    for (const PageId other : others) {
      if (other != page) send(other, text_of_json(list));
    }
    list["select"] = id;
    send(page, text_of_json(list));
    return {};
  }

  /// Replaces the name of an uploaded environment by its path.
  void use_upload(ViewOptions& options) const {
    const auto image = options.find("hdri-file");
    if (image == options.end()) return;
    for (std::string& file : image->second)
      if (const auto path = server->upload(file)) file = path->string();
  }

  /// Saves one picture at a time: each takes all cores.
  HttpAnswer save(Save save, const std::function<bool()>& is_wanted) {
    constexpr std::chrono::milliseconds kLook(50);
    std::unique_lock lock(saving, std::defer_lock);
    while (!lock.try_lock_for(kLook))
      if (!is_wanted()) return error_answer(400, "saving was cancelled");
    if (!drawing->has_model(save.model)) return error_answer(400, fmt::format("there is no model {}", save.model));
    use_upload(save.options);
    const ModelSource model = drawing->model_source(save.model);
    const SaveSubject subject{.words = {model.file},
                              .is_gbuffer = model.is_gbuffer,
                              .stem = std::filesystem::path(model.name).stem().string()};
    return save_picture(subject, save, server->uploads(), is_wanted);
  }
};

Viewer::Viewer(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Viewer::~Viewer() = default;

Result<std::unique_ptr<Viewer>> Viewer::start(Settings settings) {
  auto parts = std::make_unique<Parts>();
  Parts& all = *parts;
  DrawingSettings drawing{.models = {},
                          .given = settings.request,
                          .device = settings.request.device,
                          .threads = settings.request.threads,
                          .watch = settings.watch};
  for (ViewedFile& file : settings.models) {
    if (auto status = check_file(file); !status) return status.error();
    if (file.file.starts_with('-')) file.file.insert(0, "./");  // commands would take it for an option
    Request request = settings.request;
    request.model = file.file;
    if (const auto recipe = make_recipe(request); !file.is_gbuffer && !recipe) return recipe.error();
    drawing.models.push_back({.file = file.file, .name = name_of(file.file), .is_gbuffer = file.is_gbuffer});
  }
  auto drawer = Drawing::start(
      std::move(drawing), {.text = [&](PageId page, std::string text) { all.send(page, std::move(text)); },
                           .frame = [&](PageId page, std::string bytes) { all.send_frame(page, std::move(bytes)); }});
  if (!drawer) return drawer.error();
  all.drawing = std::move(*drawer);
  all.tables = hello_tables();
  all.tables["type"] = "hello";
  all.tables["version"] = project_version();
  all.tables["command"] = settings.command;
  all.tables["device"] = all.drawing->device_description();
  all.tables["given"] = settings.given;
  all.tables["picks"] = true;
  auto server = Server::start(
      {.host = settings.host, .port = settings.port, .page = page(), .host_names = settings.host_names},
      {.opened = [&](PageId page) { all.opened(page); },
       .closed = [&](PageId page) { all.closed(page); },
       .received = [&](PageId page, const std::string& text) { all.received(page, text); },
       .save = [&](const Save& save, const std::function<bool()>& is_wanted) { return all.save(save, is_wanted); }});
  if (!server) return server.error();
  all.server = std::move(*server);
  all.sender = all.server.get();
  return std::unique_ptr<Viewer>(new Viewer(std::move(parts)));
}

std::string Viewer::address() const { return parts_->server->address(); }

Result<std::string> Viewer::launcher() const {
  const std::filesystem::path file = parts_->server->uploads() / "open.html";  // no drop has a `.` in its name
  const std::string page = fmt::format(
      "<!doctype html><meta charset=\"utf-8\"><title>Umbrage</title><meta http-equiv=\"refresh\" content=\"0;url={0}\">"
      "<a href=\"{0}\">Open the viewer</a>\n",
      address());
  if (auto written = write_text(file, page); !written) return written.error();
  return file.string();
}

std::vector<std::string> Viewer::warnings() const {
  const std::string warning = parts_->server->warning();
  return warning.empty() ? std::vector<std::string>() : std::vector<std::string>{warning};
}

bool Viewer::was_left() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->had_pages && parts_->pages.empty() && Clock::now() - parts_->last_closed > kReloadTime;
}

}  // namespace umbrage::view
