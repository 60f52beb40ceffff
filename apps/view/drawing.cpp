#include "apps/view/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <nlohmann/json.hpp>

#include "core/guarded.h"
#include "core/lists.h"
#include "renderer/devices.h"
#include "system/machine.h"

namespace umbrage::view {
namespace {
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kWatchInterval(500);
constexpr double kMinGain = 1.2;                           // factor of the number of samples between two such pictures
constexpr std::chrono::seconds kMeanInterval(1);           // max time between two pictures of further samples
constexpr std::chrono::milliseconds kStatusInterval(100);  // between two messages on progress
constexpr std::chrono::milliseconds kStatusDelay(500);     // without a picture, before the first such message
constexpr double kSettingFrame_ms = 70.0;                  // max time of moving pictures while only settings change
constexpr const char* kStill = " settings";                // of the key of such pictures
constexpr int kTurnGrowth = 4;  // factor of the number of samples per turn of a view, which begins with the first one
}  // namespace

Result<std::unique_ptr<Drawing>> Drawing::start(DrawingSettings settings, Send send) {
  auto device = make_device(settings.device, settings.threads);
  if (!device) return device.error();
  std::unique_ptr<Drawing> drawing(new Drawing(std::move(settings), std::move(send)));
  drawing->description_ = (*device)->description();
  drawing->devices_[""].device = std::move(*device);
  for (const ModelSource& source : drawing->settings_.models) drawing->models_.add(source);
  drawing->encoder_ = std::make_unique<Encoder>();
  drawing->thread_ = std::thread([d = drawing.get()] {
    std::unique_lock lock(d->mutex_);
    d->draw_until(lock, [d] { return d->stopping_; });
  });
  if (drawing->settings_.watch) drawing->watching_ = std::thread([d = drawing.get()] { d->watch(); });
  return drawing;
}

Drawing::~Drawing() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (watching_.joinable()) watching_.join();
  encoder_.reset();
}

nlohmann::json Drawing::models() const { return models_.as_json(); }

void Drawing::set_state(PageId id, State state) {
  const std::lock_guard lock(mutex_);
  Page& page = pages_[id];
  page.state = std::make_shared<const State>(std::move(state));
  const std::size_t before = page.views.size();
  page.views.resize(page.state->views.size());
  for (std::size_t view = 0; view < page.views.size(); ++view)
    if (view >= before || page.views[view].has_failed || !page.state->views[view].goes_on) begin_view(page, view);
  changed_.notify_all();
}

void Drawing::begin_view(Page& page, std::size_t view) {
  page.views[view] = {.revision = ++page.revision, .next = page.state->moving ? Step::kMoving : Step::kQuick};
}

Drawing::Progress* Drawing::wanted_view(const Task& task) {
  const auto page = pages_.find(task.page);
  if (page == pages_.end() || task.view >= int(page->second.views.size())) return nullptr;
  Progress& view = page->second.views[std::size_t(task.view)];
  return view.revision == task.revision ? &view : nullptr;
}

void Drawing::pick(PageId id, Pick pick) {
  const std::lock_guard lock(mutex_);
  pages_[id].pick = pick;
  changed_.notify_all();
}

void Drawing::close(PageId id) {
  const std::lock_guard lock(mutex_);
  pages_.erase(id);
  changed_.notify_all();
}

/// Returns the most urgent picture, of the page after the one that got the last picture if there are several. Further
/// samples go to the view that took the least time.
std::optional<Drawing::Task> Drawing::next_task() {
  std::optional<Task> best;
  const auto consider = [&](PageId id, const Page& page) {
    if (page.state && reading_.contains(page.state->model)) return;
    if (page.pick && page.state && (!best || best->step != Step::kPick))
      best = Task{.page = id, .state = page.state, .step = Step::kPick, .pick = *page.pick};
    if (page.unacknowledged.size() >= kMaxUnacknowledged) return;
    for (std::size_t view = 0; view < page.views.size(); ++view) {
      const Progress& progress = page.views[view];
      if (progress.next == Step::kDone) continue;
      const bool refines = best && best->step == Step::kRefined && progress.next == Step::kRefined;
      if (!best || progress.next < best->step || (refines && progress.spent < best->spent))
        best = Task{.page = id,
                    .state = page.state,
                    .revision = progress.revision,
                    .view = int(view),
                    .step = progress.next,
                    .samples = progress.samples,
                    .spent = progress.spent};
    }
  };
  for (auto page = pages_.upper_bound(last_page_); page != pages_.end(); ++page) consider(page->first, page->second);
  for (auto page = pages_.begin(); page != pages_.upper_bound(last_page_); ++page) consider(page->first, page->second);
  return best;
}

bool Drawing::is_model_wanted(const Task& task) {
  const std::lock_guard lock(mutex_);
  const auto page = pages_.find(task.page);
  return !stopping_ && page != pages_.end() && page->second.state && page->second.state->model == task.state->model;
}

bool Drawing::is_wanted(const Task& task) {
  const std::lock_guard lock(mutex_);
  if (stopping_ || !pages_.contains(task.page)) return false;
  // Each moving picture and point is finished, since newer states may arrive faster than any can be drawn.
  return task.step <= Step::kMoving || wanted_view(task);
}

bool Drawing::is_urgent_elsewhere(Step limit) {
  const std::lock_guard lock(mutex_);
  const auto next = next_task();
  return next && next->step < limit;
}

bool Drawing::is_turn_over(const Task& task) {
  const std::lock_guard lock(mutex_);
  Progress* view = wanted_view(task);
  if (!view) return true;
  view->spent = task.spent + (Clock::now() - task_begin_);
  const auto next = next_task();
  return next && (next->page != task.page || next->view != task.view);
}

void Drawing::read_aside(int model, const std::function<void()>& read) {
  bool is_read = false;
  std::packaged_task<void()> reading(read);
  std::unique_lock lock(mutex_);
  std::jthread reader([&] {
    reading();
    const std::lock_guard own(mutex_);
    is_read = true;
    changed_.notify_all();
  });
  reading_.insert(model);
  const auto begin = task_begin_;
  draw_until(lock, [&] { return is_read; });
  task_begin_ = begin;
  reading_.erase(model);
  reading.get_future().get();  // throws what `read` threw
}

void Drawing::draw_until(std::unique_lock<std::mutex>& lock, const std::function<bool()>& ends) {
  for (;;) {
    std::optional<Task> task;
    changed_.wait(lock, [&] { return ends() || (!stopping_ && (task = next_task())); });
    if (ends()) return;
    last_page_ = task->page;
    if (task->step == Step::kPick) pages_[task->page].pick.reset();
    lock.unlock();
    task_begin_ = Clock::now();
    const auto purpose = [&] {
      return fmt::format("a picture of {} x {} pixels", task->state->width, task->state->height);
    };
    const auto status = guarded(purpose, [&] { return perform(*task); });
    // An error text is lost for lack of memory.
    static_cast<void>(guarded(purpose, [&] { return finish(*task, status), Result<void>(); }));
    ++drawn_;
    lock.lock();
    if (task->step <= Step::kMoving || next_task()) continue;
    lock.unlock();  // the pictures have come to rest: free memory would stay resident until the next move
    for (auto& [key, device] : devices_) device.kept.reset();
    release_free_memory();
    lock.lock();
  }
}

void Drawing::finish(const Task& task, const Result<void>& status) {
  const bool interrupted = !status && status.error().kind == ErrorKind::kInterrupted;
  if (std::exchange(has_status_, false)) send_.text(task.page, status_text(task.state->id, ""));
  if (!status && !interrupted)
    send_.text(task.page, error_text(with_option_names(status.error().message), task.state->id, task.view));
  const std::lock_guard lock(mutex_);
  Progress* view = task.step == Step::kPick ? nullptr : wanted_view(task);
  if (!view) return;
  view->spent = task.spent + (Clock::now() - task_begin_);
  view->has_failed = !status && !interrupted;
  if (view->has_failed)
    view->next = Step::kDone;
  else if (view->samples > 0)
    view->next = view->is_final ? Step::kDone : Step::kRefined;
  else if (!interrupted)
    view->next = task.step == Step::kMoving ? Step::kDone : Step::kExact;
}

ProgressMonitor Drawing::monitor_of(const Task& task, Step limit) {
  return [this, &task, limit](double progress) {
    report(task, progress);
    return is_wanted(task) && !is_urgent_elsewhere(limit);
  };
}

void Drawing::report(const Task& task, double progress) {
  const auto now = Clock::now();
  if (task.samples > 0 || now - task_begin_ < kStatusDelay || now - last_status_ < kStatusInterval) return;
  last_status_ = now;
  has_status_ = true;
  send_.text(task.page, status_text(task.state->id, "drawing", progress));
}

std::string Drawing::device_key(const Task& task) const {
  const std::string key = task.shown().device == settings_.device ? "" : task.shown().device;
  return failed_devices_.contains(key) ? "cpu" : key;
}

Result<DrawingDevice*> Drawing::device_of(const Task& task) {
  const std::string key = device_key(task);
  DrawingDevice& slot = devices_[key];
  if (slot.device) return &slot;
  auto device = make_device(key, settings_.threads);
  if (!device) return device.error();
  slot.device = std::move(*device);
  return &slot;
}

Result<void> Drawing::perform(const Task& task) {
  const State& state = *task.state;
  if (!models_.has(state.model)) return usage_error("there is no model {}", state.model);
  const auto request = request_of(task.shown(), state.width, state.height, models_.source(state.model).is_gbuffer);
  if (!request) return request.error();
  const auto loaded = load(task, *request);
  if (!loaded) return loaded.error();
  if (auto sent = send_model(task, *loaded, *request); !sent) return sent;
  const auto device = device_of(task);
  auto status = device ? draw(task, *loaded->model, **device, *request) : Result<void>(device.error());
  if (status || status.error().kind != ErrorKind::kDevice) return status;
  const std::string key = device_key(task);
  if (key == "cpu" || (device && (*device)->device->name() == "cpu")) return status;
  // A device that fails, such as one whose driver was reset, is not used again.
  models_.forget_captures();
  devices_.erase(key);
  failed_devices_.insert(key);
  // Without a view: it stays on the page when the next frame comes.
  send_.text(task.page,
             error_text(fmt::format("the device {} has failed, the CPU goes on: {}",
                                    key.empty() ? settings_.device : key, with_option_names(status.error().message))));
  if (const auto other = device_of(task))
    send_.text(task.page, text_of_json({{"type", "device"}, {"device", (*other)->device->description()}}));
  return perform(task);
}

Result<ModelList::Loaded> Drawing::load(const Task& task, const Request& request) {
  const std::string name = models_.source(task.state->model).name;
  Clock::time_point last;
  const auto report = [&](double progress) {
    if (Clock::now() - last >= kStatusInterval) {
      last = Clock::now();
      send_.text(task.page, status_text(task.state->id, "reading " + name, progress));
    }
    return is_model_wanted(task);
  };
  const auto keep = [&](const Error& error) {
    // Without a view: it stays on the page when the next frame comes.
    send_.text(task.page, error_text(with_option_names(error.message) + "; the model that was read before is shown"));
  };
  bool has_read = false;
  const auto aside = [&](const std::function<void()>& read) {
    has_read = true;
    report(0.0);
    read_aside(task.state->model, read);
  };
  auto loaded = models_.loaded(task.state->model, request, keep, report, aside);
  if (has_read) send_.text(task.page, status_text(task.state->id, ""));
  return loaded;
}

Result<void> Drawing::send_model(const Task& task, const ModelList::Loaded& loaded, const Request& request) {
  {
    const std::lock_guard lock(mutex_);
    const auto page = pages_.find(task.page);
    if (page == pages_.end()) return interrupted();
    long& known = page->second.versions[task.state->model];
    if (std::exchange(known, loaded.version) == loaded.version) return {};
  }
  Request first = request;
  first.camera = settings_.given.camera;
  std::optional<ViewCamera> camera;
  if (!loaded.model->is_gbuffer()) {
    const auto found = loaded.model->camera(first);
    if (!found) return found.error();
    camera = *found;
  }
  send_.text(task.page, model_text(task.state->model, loaded.model->facts(), camera, loaded.version));
  return {};
}

/// Returns a key of what the time of a picture depends on most.
std::string Drawing::control_key(const Task& task, const Request& request) const {
  return fmt::format("{} {} {} {}", task.state->model, request.look, task.shown().show, task.shown().device);
}

void Drawing::remember_draft(const Task& task, std::pair<int, int> size) {
  moving_page_ = task.page;
  moving_camera_ = camera_text(task.shown());
  moving_size_ = size;
}

/// Returns the size of a moving picture. While only settings change, its captures are kept, so that a larger picture is
/// in time; but a change of the size needs new ones.
std::pair<int, int> Drawing::moving_size(const Task& task, const std::string& key) {
  const int width = task.state->width, height = task.state->height;
  const bool is_still = task.page == moving_page_ && camera_text(task.shown()) == moving_camera_;
  const bool keeps_captures = is_still && moving_size_.first > 0;
  if (!keeps_captures || control_.expected_ms(key + kStill, width, height) == 0.0)
    return keeps_captures ? moving_size_ : control_.size(key, width, height);
  const auto size = control_.size(key + kStill, width, height);
  if (size.first <= moving_size_.first) return size;
  return control_.expected_ms(key, size.first, size.second) > kSettingFrame_ms ? moving_size_ : size;
}

Result<void> Drawing::draw(const Task& task, ViewModel& model, DrawingDevice& device, const Request& request) {
  if (task.step == Step::kPick) return find_point(task, model, device, request);
  if (task.shown().show == "error") return draw_error(task, model, device, request);
  if (task.step <= Step::kQuick) return draw_draft(task, model, device, request);
  auto last_sent = Clock::now();
  int sent = task.samples;
  DrawControl control{.max_samples = kMaxRefinedSamples};
  control.monitor = [&](double progress) {
    if (sent == 0) report(task, progress);
    return is_wanted(task) && !is_urgent_elsewhere(sent == 0 ? Step::kMoving : Step::kRefined);
  };
  bool ends = false;
  control.wants_mean = [&](int samples) {
    ends = samples >= kTurnGrowth * task.samples && is_turn_over(task);
    const bool is_better =
        samples >= 2 * sent || (samples >= kMinGain * sent && Clock::now() - last_sent > kMeanInterval);
    return samples > sent && (sent == 0 || is_better || ends);
  };
  control.wants_another = [&](int) {
    return !ends && is_wanted(task) && !is_urgent_elsewhere(Step::kRefined) && wait_for_page(task);
  };
  Request refined = averages_few_rays(request) ? with_few_rays(request) : request;
  const bool is_averaged = gets_averaged(request, model.is_gbuffer());
  if (is_averaged && task.step == Step::kRefined) refined.anti_aliasing = kFirstAveraged;
  const bool is_averaged_later = is_averaged && task.step == Step::kExact;
  StageTimes times;
  control.take = [&](const Image& picture, int samples, bool is_final) -> Result<void> {
    send_picture(task, picture, {.samples = samples, .is_final = is_final && !is_averaged_later, .times = times});
    sent = samples;
    last_sent = Clock::now();
    times = {};
    return {};
  };
  return model.draw(device, refined, control, times);
}

Result<void> Drawing::draw_error(const Task& task, ViewModel& model, DrawingDevice& device, const Request& request) {
  if (task.step == Step::kQuick) return {};
  const bool is_moving = task.step == Step::kMoving;
  const std::string key = control_key(task, request);
  Request sized = request;
  const Step limit = task.step == Step::kRefined ? Step::kRefined : Step::kMoving;
  DrawControl control{.moving = is_moving, .monitor = monitor_of(task, limit)};
  control.aspect = double(request.width) / request.height;
  // While only settings change, the ground truth of this camera and size stays as it is.
  if (is_moving) std::tie(sized.width, sized.height) = moving_size(task, key);
  remember_draft(task, is_moving ? std::pair(sized.width, sized.height) : moving_size_);
  StageTimes times;
  const std::string name = fmt::format("{} {}", task.state->model, model.number());
  auto error_map = errors_.draw(model, device, sized, name, task.samples + 1, control, times);
  if (!error_map) return error_map.error();
  if (is_moving) control_.add(key, sized.width, sized.height, times.total());
  send_picture(task, error_map->picture,
               {.samples = is_moving ? 0 : error_map->runs,
                .is_final = !is_moving && error_map->runs >= kMaxReferenceRuns,
                .error = error_map->error,
                .times = times});
  return {};
}

Result<void> Drawing::draw_draft(const Task& task, ViewModel& model, DrawingDevice& device, const Request& request) {
  const std::string key = control_key(task, request);
  Request draft = moving_request(request);
  const bool is_quick = task.step == Step::kQuick, traced = is_traced(request);
  const bool is_slow = !traced && control_.expected_ms(key, draft.width, draft.height) > kQuickFrame_ms;
  if (is_quick && (model.is_gbuffer() || is_slow)) return {};
  if (traced) draft = with_few_rays(std::move(draft));
  DrawControl control{.moving = true, .monitor = monitor_of(task)};
  // The reference is too slow for a draft of full resolution.
  if ((!is_quick || traced) && !model.is_gbuffer()) {
    control.aspect = double(draft.width) / draft.height;
    std::tie(draft.width, draft.height) = moving_size(task, key);
  }
  StageTimes times;
  control.take = [&](const Image& picture, int, bool) -> Result<void> {
    const bool has_captured = std::ranges::count(times.stages, "capture", &StageTimes::Stage::name) > 0;
    control_.add(has_captured ? key : key + kStill, draft.width, draft.height, times.total());
    send_picture(task, picture, {.times = times});
    return {};
  };
  remember_draft(task, !is_quick || traced ? std::pair(draft.width, draft.height) : moving_size_);
  return model.draw(device, draft, control, times);
}

Result<void> Drawing::find_point(const Task& task, ViewModel& model, DrawingDevice& device, const Request& request) {
  constexpr int kMaxWidth = 512;  // pixels
  Request small = moving_request(request);
  small.width = std::min(request.width, kMaxWidth);
  small.height = std::max(int(std::lround(double(request.height) * small.width / request.width)), 1);
  DrawControl control{.moving = true, .aspect = double(request.width) / request.height, .monitor = monitor_of(task)};
  StageTimes times;
  const auto point = model.surface_at(device, small, task.pick.x, task.pick.y, control, times);
  if (!point) return point.error();
  send_.text(task.page, pick_text(*point));
  return {};
}

/// Waits until the page has acknowledged enough frames. Returns false if there is other work first.
bool Drawing::wait_for_page(const Task& task) {
  std::unique_lock lock(mutex_);
  bool goes_on = false;
  changed_.wait(lock, [&] {
    if (stopping_ || !wanted_view(task)) return true;
    goes_on = pages_[task.page].unacknowledged.size() < kMaxUnacknowledged;
    return goes_on || next_task();  // of another page: this one has no room for a frame
  });
  return goes_on;
}

void Drawing::send_picture(const Task& task, const Image& picture, FrameHeader header) {
  const bool is_draft = task.step <= Step::kQuick;
  header.id = task.state->id, header.view = task.view, header.model = task.state->model;
  header.width = picture.width, header.height = picture.height;
  header.is_moving = task.step == Step::kMoving;
  {
    const std::lock_guard lock(mutex_);
    const auto page = pages_.find(task.page);
    if (page == pages_.end()) return;
    header.frame = ++last_frame_;
    page->second.unacknowledged.insert(header.frame);
    if (Progress* view = is_draft ? nullptr : wanted_view(task)) {
      view->samples = header.samples;
      view->is_final = header.is_final;
      view->next = Step::kRefined;  // what follows is less urgent than other pictures
    }
  }
  EncodeJob job{.picture = picture, .exact = !is_draft};
  job.is_wanted = [this, task, frame = header.frame] {
    const bool wanted = is_wanted(task);
    if (!wanted) forget_frames(task.page, frame, frame);
    return wanted;
  };
  job.done = [this, page = task.page, header](Result<Encoded> encoded, double ms) {
    if (!encoded) {
      forget_frames(page, header.frame, header.frame);
      return send_.text(page, error_text(encoded.error().message, header.id, header.view));
    }
    send_.frame(page, frame_text(header, *encoded, ms));
  };
  encoder_->add(std::move(job));
}

void Drawing::forget_frames(PageId id, std::int64_t first, std::int64_t last) {
  const std::lock_guard lock(mutex_);
  const auto page = pages_.find(id);
  if (page == pages_.end()) return;
  auto& frames = page->second.unacknowledged;
  frames.erase(frames.lower_bound(first), frames.upper_bound(last));
  changed_.notify_all();
}

void Drawing::watch() {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kWatchInterval, [&] { return stopping_; })) {
    lock.unlock();
    const std::vector<int> models = models_.find_changed();
    lock.lock();
    for (auto& [id, page] : pages_) {
      if (!page.state || !contains(models, page.state->model)) continue;
      for (std::size_t view = 0; view < page.views.size(); ++view) begin_view(page, view);
    }
    if (!models.empty()) changed_.notify_all();
  }
}

}  // namespace umbrage::view
