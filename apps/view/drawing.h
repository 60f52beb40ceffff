// Drawing: draws the states of all pages, one picture at a time, on its own thread.
//
// A page's newest state alone counts. A moving state gets a draft whose resolution is chosen so that it is drawn in
// time. A state at rest gets a draft of full resolution if that is quick, then exactly the picture that the command
// line draws, then the means of further samples. Pages take turns: moving states come first, then those at rest, then
// further samples, which any other work interrupts. Views that are refined get equal times. The ray-traced reference is
// slow: its first pictures have few rays per pixel, and the means add up to many.
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "apps/view/draw_messages.h"
#include "apps/view/encoder.h"
#include "apps/view/error_map.h"
#include "apps/view/messages.h"
#include "apps/view/model_list.h"
#include "apps/view/quality.h"

namespace umbrage::view {

using PageId = int;

/// Max number of frames that are sent to a page before it acknowledges one.
inline constexpr std::size_t kMaxUnacknowledged = 2;
/// Number of samples to which a picture at rest is refined: more would not change it visibly.
inline constexpr int kMaxRefinedSamples = 128;

struct DrawingSettings {
  std::vector<ModelSource> models;
  Request given;  ///< of the command line: its camera is the first one of each model
  std::string device = "auto";
  int threads = 0;     ///< 0: one per hardware thread
  bool watch = false;  ///< load a model again when its file changes
};

/// Sends to a page; must not block. Called on any thread.
struct Send {
  std::function<void(PageId, std::string)> text, frame;
};

/// All functions may be called on any thread and return at once.
class Drawing {
 public:
  /// Creates the device. Errors: those of make_device.
  static Result<std::unique_ptr<Drawing>> start(DrawingSettings settings, Send send);
  ~Drawing();

  /// Sets the newest state of a page.
  void set_state(PageId page, State state);
  /// Answers which point of the surface the newest state shows: see pick_text.
  void pick(PageId page, Pick pick);
  void acknowledge(PageId page, std::int64_t frame) { forget_frames(page, 0, frame); }
  void close(PageId page);
  /// Adds a file to those that pages can choose and returns its id.
  int add_model(ModelSource source) { return models_.add(std::move(source)); }
  /// Returns the list of models as pages get it.
  nlohmann::json models() const;
  ModelSource model_source(int id) const { return models_.source(id); }
  bool has_model(int id) const { return models_.has(id); }
  const std::string& device_description() const { return description_; }
  /// Returns the number of pictures drawn so far.
  long drawn() const { return drawn_; }

 private:
  /// What a view of a state still needs, the most urgent first; a page may also ask for a point.
  enum class Step { kPick, kMoving, kQuick, kExact, kRefined, kDone };
  struct Progress {
    long revision = 0;  ///< grows with each state that changes the view
    Step next = Step::kDone;
    int samples = 0;  ///< of the last picture at rest that was sent; 0: none
    bool is_final = false, has_failed = false;
    std::chrono::steady_clock::duration spent{};  ///< time of all pictures of this state and view
  };
  struct Page {
    std::shared_ptr<const State> state;
    long revision = 0;  ///< the last one of any view
    std::vector<Progress> views;
    std::optional<Pick> pick;
    std::set<std::int64_t> unacknowledged;
    std::map<int, long> versions;  ///< of the models that the page knows
  };
  /// A picture to draw.
  struct Task {
    PageId page = 0;
    std::shared_ptr<const State> state;
    long revision = 0;  ///< of the view
    int view = 0;
    Step step = Step::kDone;
    int samples = 0;
    std::chrono::steady_clock::duration spent{};  ///< as in Progress, before this picture
    Pick pick = {};
    const View& shown() const { return state->views[std::size_t(view)]; }
  };

  Drawing(DrawingSettings settings, Send send) : settings_(std::move(settings)), send_(std::move(send)) {}
  /// Draws pictures until `ends` holds. `lock` is of `mutex_`, under which `ends` is called.
  void draw_until(std::unique_lock<std::mutex>& lock, const std::function<bool()>& ends);
  /// Runs `read`, the reading of a model, on a thread of its own; meanwhile draws pictures of other models.
  void read_aside(int model, const std::function<void()>& read);
  void watch();
  std::optional<Task> next_task();
  /// Begins to draw a view of a page. `mutex_` must be locked.
  static void begin_view(Page& page, std::size_t view);
  /// Returns the view of a task as its page has it, or null if the page no longer wants it. `mutex_` must be locked.
  Progress* wanted_view(const Task& task);
  bool is_wanted(const Task& task);
  /// Returns whether the page still wants the model of the task, so that reading it goes on.
  bool is_model_wanted(const Task& task);
  /// Returns whether there is work more urgent than this.
  bool is_urgent_elsewhere(Step limit);
  /// Returns whether another view is due for further samples.
  bool is_turn_over(const Task& task);
  bool wait_for_page(const Task& task);
  void forget_frames(PageId id, std::int64_t first, std::int64_t last);
  void finish(const Task& task, const Result<void>& status);

  Result<void> perform(const Task& task);
  Result<void> draw(const Task& task, ViewModel& model, DrawingDevice& device, const Request& request);
  Result<void> draw_draft(const Task& task, ViewModel& model, DrawingDevice& device, const Request& request);
  Result<void> draw_error(const Task& task, ViewModel& model, DrawingDevice& device, const Request& request);
  Result<void> find_point(const Task& task, ViewModel& model, DrawingDevice& device, const Request& request);
  Result<ModelList::Loaded> load(const Task& task, const Request& request);
  Result<void> send_model(const Task& task, const ModelList::Loaded& loaded, const Request& request);
  /// Returns the key in devices_ of the device that a task uses; empty: that of the program.
  std::string device_key(const Task& task) const;
  Result<DrawingDevice*> device_of(const Task& task);
  /// Hands a picture to the encoder. Of the header, the samples, the error and the times are given.
  void send_picture(const Task& task, const Image& picture, FrameHeader header);
  std::string control_key(const Task& task, const Request& request) const;
  /// Keeps the camera of a draft, and the size of the last moving picture, for moving_size.
  void remember_draft(const Task& task, std::pair<int, int> size);
  std::pair<int, int> moving_size(const Task& task, const std::string& key);
  /// Returns a monitor that reports, and ends a picture that is not wanted, or for work more urgent than `limit`.
  ProgressMonitor monitor_of(const Task& task, Step limit = Step::kPick);
  /// Tells the page of the progress of a first picture that takes long.
  void report(const Task& task, double progress);

  const DrawingSettings settings_;
  const Send send_;
  std::string description_;
  ModelList models_;

  std::mutex mutex_;  // guards pages_, reading_, last_page_, last_frame_ and stopping_
  std::condition_variable changed_;
  std::map<PageId, Page> pages_;
  std::set<int> reading_;  // models that are being read
  PageId last_page_ = 0;   // that got the last picture
  std::int64_t last_frame_ = 0;
  bool stopping_ = false;
  std::atomic<long> drawn_ = 0;

  // Only the drawing thread uses these.
  std::map<std::string, DrawingDevice> devices_;
  std::set<std::string> failed_devices_;
  ResolutionControl control_;
  PageId moving_page_ = 0;                 // of the last draft
  std::string moving_camera_;              // and its camera
  std::pair<int, int> moving_size_{0, 0};  // of the last moving picture, pixels
  ErrorMap errors_;
  std::chrono::steady_clock::time_point task_begin_, last_status_;
  bool has_status_ = false;  // the page shows a status on the current task

  std::unique_ptr<Encoder> encoder_;
  std::thread thread_, watching_;
};

}  // namespace umbrage::view
