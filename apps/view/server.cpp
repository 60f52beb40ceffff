#include "apps/view/server.h"

#include <civetweb.h>
#include <sys/socket.h>

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "apps/view/http.h"
#include "apps/view/listen.h"
#include "apps/view/outbox.h"
#include "apps/view/uploads.h"
#include "core/check.h"

namespace umbrage::view {
namespace {

constexpr int kHttpThreads = 16;                    // besides the pages: each open connection keeps a thread
constexpr int kSparePageThreads = 4;                // for pages that are being refused
constexpr int kPingMs = 20000;                      // after 6 unanswered pings a page is closed
constexpr std::chrono::milliseconds kGoodbye(500);  // for a close message to be sent

enum Opcode { kContinuation = 0, kText = 1, kBinary = 2, kClose = 8 };
constexpr int kFinal = 0x80, kReserved = 0x70, kOpcodeMask = 0x0f;

/// A connected page. Its connection's thread owns it, and reads `message` alone.
struct Page {
  Page(PageId id, int socket, bool refused, Outbox::Wire wire)
      : id(id), socket(socket), refused(refused), outbox(std::move(wire)) {}

  const PageId id;
  const int socket;
  const bool refused;   ///< one too many: it gets an error and is closed
  std::string message;  ///< what has arrived of the current message
  bool is_text = true, is_too_long = false;
  Outbox outbox;
};

/// Calls a handler for civetweb, a C library, through which no exception may pass. Returns `failed` after one, such as
/// for lack of memory.
template <class Work>
std::invoke_result_t<Work> without_exceptions(const Work& work, std::invoke_result_t<Work> failed) noexcept {
  try {
    return work();
  } catch (...) {
    return failed;
  }
}

}  // namespace

class Server::Impl {
 public:
  Impl(const ServerSettings& settings, ServerHandlers handlers, TemporaryFolder folder)
      : settings_(settings),
        handlers_(std::move(handlers)),
        token_(make_token()),
        folder_(std::move(folder)),
        uploads_(folder_.path(), settings.uploads) {}
  ~Impl() { stop(); }

  Result<void> start();
  void stop();

  // Called by civetweb.
  int answer(mg_connection* connection);
  void open_page(mg_connection* connection);
  bool receive(Page& page, int bits, std::string_view data);
  void close_page(Page& page);

  void send(PageId id, const std::function<void(Outbox&)>& add) {
    const std::lock_guard lock(mutex_);
    if (const auto at = pages_.find(id); at != pages_.end()) add(at->second->outbox);
  }

  std::string address() const;
  const Listening& listening() const { return listening_; }
  const Uploads& uploads() const { return uploads_; }

 private:
  int answer_files(mg_connection* connection);
  int answer_save(mg_connection* connection);
  void finish_pages();
  void disconnect_pages();

  const ServerSettings settings_;
  const ServerHandlers handlers_;
  const std::string token_;
  const TemporaryFolder folder_;
  Uploads uploads_;
  Listening listening_;
  int port_ = 0;
  std::string log_;  ///< the last message of civetweb while it starts
  mg_context* context_ = nullptr;
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;
  std::map<PageId, std::unique_ptr<Page>> pages_;
  PageId last_page_ = 0;
};

Result<void> Server::Impl::start() {
  auto listening = check_listening(settings_.host, settings_.port);
  if (!listening) return listening.error();
  listening_ = *listening;
  static const bool initialized = ::mg_init_library(0) == 0;
  static_cast<void>(initialized);
  const std::string port = fmt::format("{}:{}", listening_.address, settings_.port);
  const std::string threads = std::to_string(settings_.max_pages + kSparePageThreads + kHttpThreads);
  const std::string stall = std::to_string(settings_.stall_ms), ping = std::to_string(kPingMs);
  // There is no document root: only begin_request answers. Paths are compared as they are, without decoding.
  const char* options[] = {"listening_ports",
                           port.c_str(),
                           "num_threads",
                           threads.c_str(),
                           "request_timeout_ms",
                           stall.c_str(),
                           "websocket_timeout_ms",
                           ping.c_str(),
                           "enable_websocket_ping_pong",
                           "yes",
                           "tcp_nodelay",
                           "1",
                           "enable_keep_alive",
                           "no",
                           "enable_directory_listing",
                           "no",
                           "decode_url",
                           "no",
                           "access_control_allow_origin",
                           "",
                           "access_control_allow_methods",
                           "",
                           nullptr};
  mg_callbacks callbacks{};
  callbacks.begin_request = [](mg_connection* connection) {
    constexpr int kAnswered = 1;
    return without_exceptions(
        [&] { return static_cast<Impl*>(::mg_get_user_context_data(connection))->answer(connection); }, kAnswered);
  };
  callbacks.log_message = [](const mg_connection*, const char*) { return 1; };
  context_ = ::mg_start(&callbacks, this, options);
  mg_server_port ports[1] = {};
  if (!context_ || ::mg_get_server_ports(context_, 1, ports) != 1)
    return usage_error("--host '{}' and --port {} cannot be used", settings_.host, settings_.port);
  port_ = ports[0].port;
  ::mg_set_websocket_handler(
      context_, fmt::format("/{}/socket$", token_).c_str(), nullptr,
      [](mg_connection* connection, void* server) {
        const auto open = [&] { return static_cast<Impl*>(server)->open_page(connection), true; };
        if (!without_exceptions(open, false)) ::shutdown(socket_of(connection), SHUT_RDWR);
      },
      [](mg_connection* connection, int bits, char* data, std::size_t size, void* server) {
        auto* page = static_cast<Page*>(::mg_get_user_connection_data(connection));
        const auto receive = [&] { return page && static_cast<Impl*>(server)->receive(*page, bits, {data, size}); };
        return int(without_exceptions(receive, false));
      },
      [](const mg_connection* connection, void* server) {
        auto* page = static_cast<Page*>(::mg_get_user_connection_data(connection));
        if (page) without_exceptions([&] { return static_cast<Impl*>(server)->close_page(*page), true; }, false);
      },
      this);
  return {};
}

void Server::Impl::finish_pages() {
  constexpr std::chrono::milliseconds kStep(5);
  bool ended = false;
  for (auto waited = kStep; !ended && waited < kGoodbye; waited += kStep) {
    {
      const std::lock_guard lock(mutex_);
      ended = true;
      for (auto& [id, page] : pages_) {
        page->outbox.finish();
        ended &= page->outbox.wait_until_ended(std::chrono::milliseconds(0));
      }
    }
    if (!ended) std::this_thread::sleep_for(kStep);
  }
}

void Server::Impl::disconnect_pages() {
  const std::lock_guard lock(mutex_);
  for (auto& [id, page] : pages_) ::shutdown(page->socket, SHUT_RDWR);
}

void Server::Impl::stop() {
  if (!context_) return;
  stopping_ = true;
  finish_pages();  // before civetweb stops, which sends nothing more then
  // civetweb notices only after up to 2 s that it should stop, unless its threads are woken.
  std::atomic<bool> stopped = false;
  std::thread waker([&] {
    constexpr std::chrono::milliseconds kStep(20);
    for (auto waited = kStep; !stopped; waited += kStep) {
      std::this_thread::sleep_for(kStep);
      knock(listening_.address, port_);
      if (waited >= kGoodbye) disconnect_pages();
    }
  });
  ::mg_stop(std::exchange(context_, nullptr));
  stopped = true;
  waker.join();
}

int Server::Impl::answer(mg_connection* connection) {
  const mg_request_info* info = ::mg_get_request_info(connection);
  const std::string_view method = info->request_method;
  const auto path = path_after_token(info->local_uri_raw ? info->local_uri_raw : "", token_);
  if (!path) {
    ::mg_disable_connection_keep_alive(connection);  // its body is not read
    return send_sentence(connection, 404, "The address lacks the token that the viewer printed when it started.");
  }
  const bool is_page = path->empty() || *path == "/", is_socket = *path == "/socket";
  if (!is_page && !is_socket && *path != "/files" && *path != "/save")
    return send_sentence(connection, 404, "The viewer has no such file.");
  if (is_page || is_socket) {
    if (method != "GET" && (is_socket || method != "HEAD"))
      return send_sentence(connection, 405, "Only GET is possible here.",
                           is_socket ? "Allow: GET\r\n" : "Allow: GET, HEAD\r\n");
    if (path->empty())
      return send_sentence(connection, 308, "The page is one level lower.", fmt::format("Location: {}/\r\n", token_));
    if (is_page)
      return send_answer(connection, {.type = "text/html; charset=utf-8", .body = std::string(settings_.page)},
                         kPageHeaders);
  } else if (method != "POST") {
    return send_sentence(connection, 405, "Only POST is possible here.", "Allow: POST\r\n");
  }
  if (is_foreign(connection)) {
    ::mg_disable_connection_keep_alive(connection);
    return send_sentence(connection, 403, "A page of another server must not use the viewer.");
  }
  if (is_socket)
    return wants_web_socket(connection)
               ? 0
               : send_sentence(connection, 426, "A WebSocket is needed here.", "Upgrade: websocket\r\n");
  if (info->content_length < 0) {
    ::mg_disable_connection_keep_alive(connection);
    return send_answer(connection, error_answer(411, "the size of the body is missing"));
  }
  return *path == "/files" ? answer_files(connection) : answer_save(connection);
}

int Server::Impl::answer_files(mg_connection* connection) {
  std::string file;
  const auto refusal = uploads_.add(
      query_value(connection, "drop"), query_value(connection, "name"),
      ::mg_get_request_info(connection)->content_length,
      [&](char* buffer, std::size_t size) { return long(::mg_read(connection, buffer, size)); }, file);
  if (!refusal) return send_answer(connection, json_answer({{"file", file}}));
  constexpr int kStatus[] = {400, 413, 409, 500};  // in the order of Failure
  return send_answer(connection, error_answer(kStatus[int(refusal->failure)], refusal->sentence));
}

int Server::Impl::answer_save(mg_connection* connection) {
  const long long size = ::mg_get_request_info(connection)->content_length;
  if (size > static_cast<long long>(kMaxMessageBytes))
    return send_answer(connection,
                       error_answer(413, fmt::format("a message has {} bytes; the max is {}", size, kMaxMessageBytes)));
  std::string text(std::size_t(size), '\0');
  if (size > 0 && ::mg_read(connection, text.data(), text.size()) != size)
    return send_answer(connection, error_answer(400, "the message arrived incomplete"));
  const auto save = parse_save(text);
  if (!save) return send_answer(connection, error_answer(400, save.error().message));
  const int socket = socket_of(connection);
  return send_answer(connection, handlers_.save(*save, [&] { return !stopping_ && !is_closed_by_peer(socket); }));
}

void Server::Impl::open_page(mg_connection* connection) {
  const int socket = socket_of(connection);
  Page* page = nullptr;
  {
    const std::lock_guard lock(mutex_);
    int open = 0;
    for (const auto& [id, each] : pages_) open += each->refused ? 0 : 1;
    const PageId id = ++last_page_;
    Outbox::Wire wire;
    wire.write = [connection](Outbox::Kind kind, std::string_view bytes) {
      const int opcode = kind == Outbox::Kind::kText ? kText : kind == Outbox::Kind::kFrame ? kBinary : kClose;
      const int sent = ::mg_websocket_write(connection, opcode, bytes.data(), bytes.size());
      return sent > 0 && std::size_t(sent) >= bytes.size();
    };
    // After the last message the page closes its side; otherwise nothing more is exchanged.
    wire.end = [socket](bool finished) { ::shutdown(socket, finished ? SHUT_WR : SHUT_RDWR); };
    auto owned = std::make_unique<Page>(id, socket, open >= settings_.max_pages, std::move(wire));
    page = pages_.emplace(id, std::move(owned)).first->second.get();
    ::mg_set_user_connection_data(connection, page);
  }
  if (page->refused) {
    page->outbox.add_text(
        error_text(fmt::format("the viewer has {} pages open, the max; close one", settings_.max_pages)));
    page->outbox.finish();
  } else {
    handlers_.opened(page->id);
    if (stopping_) page->outbox.finish();
  }
}

bool Server::Impl::receive(Page& page, int bits, std::string_view data) {
  const int opcode = bits & kOpcodeMask;
  if (opcode == kClose) page.outbox.finish();
  if (page.refused || opcode == kClose) return true;
  if ((bits & kReserved) != 0 || opcode > kBinary) return false;
  if (opcode != kContinuation) {
    page.message.clear();
    page.is_text = opcode == kText;
    page.is_too_long = false;
  }
  page.is_too_long |= page.message.size() + data.size() > kMaxMessageBytes;
  if (page.is_text && !page.is_too_long) page.message += data;
  if ((bits & kFinal) == 0) return true;
  if (!page.is_text)
    page.outbox.add_text(error_text("a message of a page must be a text, not binary"));
  else if (page.is_too_long)
    page.outbox.add_text(error_text(fmt::format("a message has more than {} bytes", kMaxMessageBytes)));
  else
    handlers_.received(page.id, std::exchange(page.message, {}));
  return true;
}

void Server::Impl::close_page(Page& page) {
  std::unique_ptr<Page> owned;
  {
    const std::lock_guard lock(mutex_);
    owned = std::move(pages_.extract(page.id).mapped());
  }
  if (!owned->refused) handlers_.closed(owned->id);
  owned->outbox.finish();
  owned->outbox.wait_until_ended(kGoodbye);
}

std::string Server::Impl::address() const {
  std::string host = listening_.address;
  if (listening_.any) {
    char name[256] = {};
    if (::gethostname(name, sizeof name - 1) == 0) host = name;
  }
  return fmt::format("http://{}:{}/{}/", host, port_, token_);
}

Result<std::unique_ptr<Server>> Server::start(const ServerSettings& settings, ServerHandlers handlers) {
  auto folder = TemporaryFolder::create();
  if (!folder) return folder.error();
  auto impl = std::make_unique<Impl>(settings, std::move(handlers), std::move(*folder));
  if (auto started = impl->start(); !started) return started.error();
  return std::unique_ptr<Server>(new Server(std::move(impl)));
}

Server::Server(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Server::~Server() = default;

void Server::stop() { impl_->stop(); }

std::string Server::address() const { return impl_->address(); }

std::string Server::warning() const {
  if (impl_->listening().loopback) return {};
  return fmt::format(
      "--host lets other machines reach the viewer at {}, unencrypted; all who have the address can use it",
      impl_->listening().address);
}

void Server::send_text(PageId page, std::string text) {
  impl_->send(page, [&](Outbox& outbox) { outbox.add_text(std::move(text)); });
}

void Server::send_frame(PageId page, std::string bytes) {
  const int view = view_of_frame(bytes);
  impl_->send(page, [&](Outbox& outbox) { outbox.add_frame(view, std::move(bytes)); });
}

const std::filesystem::path& Server::uploads() const { return impl_->uploads().folder(); }

Result<std::filesystem::path> Server::upload(const std::string& file) const { return impl_->uploads().path_of(file); }

}  // namespace umbrage::view
