#include "apps/view/server.h"

#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <utility>

#include "apps/view/http.h"
#include "apps/view/listen.h"
#include "apps/view/outbox.h"
#include "core/check.h"
#include "core/lowercase.h"

namespace umbrage::view {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds, std::chrono::steady_clock;

/// What a request with the token wants. Each kind has threads of its own, so that none can delay another.
enum Kind { kPage, kFiles, kSave, kSocket };
constexpr int kKinds = 4, kMaxRequests = 8;  // of each kind but kSocket
constexpr int kSparePages = 4;               // for pages that are being refused
constexpr milliseconds kPing(20000);         // between bytes of a page
constexpr int kMaxPings = 6;                 // unanswered
constexpr milliseconds kGoodbye(500);        // for a close message to be sent
constexpr int kHttpPort = 80;                // of a host that names none

// A request holds its head and a chunk; a socket also what FrameReader holds: bytes, a frame, and the parts of a
// message.
constexpr std::size_t kChunkBytes = 16384, kRequestBytes = kMaxHeadBytes + kChunkBytes;
constexpr std::size_t kSocketBytes = kRequestBytes + kChunkBytes + 3 * kMaxMessageBytes;
static_assert(Gate::kMaxClients * kMaxHeadBytes + (kKinds - 1) * kMaxRequests * kRequestBytes +
                  (kMaxPages + kSparePages) * kSocketBytes <=
              kMaxReceivedBytes);

/// A request with the token.
struct Job {
  Kind kind;
  HttpRequest request;
  std::unique_ptr<Connection> connection;
};

/// An answer without a job, in plain text, one sentence. `headers`: as in answer_head.
struct Refusal {
  int status;
  std::string_view sentence;
  std::string headers = {};
};

/// A connected page, which its connection's thread owns.
struct Page {
  Page(PageId id, bool refused, Outbox::Wire wire) : id(id), refused(refused), outbox(std::move(wire)) {}

  const PageId id;
  const bool refused;  ///< one too many: it gets an error and is closed
  Outbox outbox;
};

Opcode opcode_of(Outbox::Kind kind) {
  constexpr Opcode kOpcodes[] = {Opcode::kText, Opcode::kBinary, Opcode::kPing, Opcode::kPong, Opcode::kClose};
  return kOpcodes[int(kind)];
}

/// Sends an answer, and removes its file.
void send_answer(Connection& connection, const HttpRequest& request, const HttpAnswer& answer,
                 std::string_view headers = {}) {
  std::error_code code;
  const auto size = answer.file.empty() ? answer.body.size() : fs::file_size(answer.file, code);
  if (code) return send_answer(connection, request, error_answer(500, "the file cannot be read"));
  const bool with_body = request.method != "HEAD";
  bool sent = connection.write(answer_head(answer, size, headers) + (with_body ? answer.body : ""));
  if (answer.file.empty()) return;
  std::ifstream file(answer.file, std::ios::binary);
  std::string bytes(kChunkBytes, '\0');
  while (sent && with_body && (file.read(bytes.data(), std::streamsize(bytes.size())), file.gcount() > 0))
    sent = connection.write(std::string_view(bytes).substr(0, std::size_t(file.gcount())));
  fs::remove(answer.file, code);
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

  void send(PageId id, const std::function<void(Outbox&)>& add) {
    const std::lock_guard lock(mutex_);
    if (const auto at = pages_.find(id); at != pages_.end()) add(at->second->outbox);
  }

  std::string address() const;
  const Listening& listening() const { return listening_; }
  const Uploads& uploads() const { return uploads_; }

 private:
  // Clients without the token, in the thread of the gate.
  std::string admit(Descriptor& socket, std::string_view head, std::string_view body);
  std::optional<Refusal> check(const HttpRequest& request, int socket, Kind& kind) const;
  bool add_job(Kind kind, HttpRequest request, Descriptor& socket, std::string_view body);

  // Clients with the token: a thread for each.
  void work();
  void serve(Job& job);
  HttpAnswer answer_files(Connection& connection, const HttpRequest& request);
  HttpAnswer answer_save(Connection& connection, const HttpRequest& request);
  void serve_page(Connection& connection, const HttpRequest& request);
  Page& open_page(Connection& connection);
  void listen_to(Page& page, Connection& connection);
  bool receive(Page& page, FrameReader::Received message);
  void close_page(Page& page);

  int max_jobs(Kind kind) const { return kind == kSocket ? settings_.max_pages + kSparePages : kMaxRequests; }

  const ServerSettings settings_;
  const ServerHandlers handlers_;
  const std::string token_;
  const TemporaryFolder folder_;
  Uploads uploads_;
  Listening listening_;          ///< without its socket, which the gate has
  std::set<std::string> hosts_;  ///< NAME:PORT of this server
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;
  std::condition_variable job_added_, job_ended_;
  std::deque<Job> jobs_;
  std::set<Connection*> served_;
  int counts_[kKinds] = {};  ///< of jobs, served or not
  std::map<PageId, std::unique_ptr<Page>> pages_;
  PageId last_page_ = 0;
  std::vector<std::thread> threads_;
  std::optional<Gate> gate_;  // last: calls admit() until it ends
};

Result<void> Server::Impl::start() {
  check_less(settings_.max_pages, kMaxPages + 1, "number of pages");
  auto listening = listen_at(settings_.host, settings_.port);
  if (!listening) return listening.error();
  listening_ = std::move(*listening);
  const std::string address = this->address(), shown = address.substr(std::string_view("http://").size());
  std::vector<std::string> names = settings_.host_names;
  for (const std::string& name : names)
    if (!is_host(name))
      return field_error("--host-name", name, "{} '{}' must be a name, such as viewer.example.org, or NAME:PORT");
  names.insert(names.end(), {"127.0.0.1", "localhost", "[::1]", settings_.host, listening_.address,
                             shown.substr(0, shown.find('/'))});
  for (const std::string& name : names) hosts_.insert(with_port(name, listening_.port));
  for (const Kind kind : {kPage, kFiles, kSave, kSocket})
    for (int i = 0; i < max_jobs(kind); ++i) threads_.emplace_back([this] { work(); });
  gate_.emplace(std::move(listening_.socket), [this](Descriptor& socket, std::string_view head, std::string_view body) {
    return admit(socket, head, body);
  });
  return {};
}

void Server::Impl::stop() {
  gate_.reset();
  {
    std::unique_lock lock(mutex_);
    stopping_ = true;
    for (auto& [id, page] : pages_) page->outbox.finish(close_data(CloseCode::kGone, ""));
    job_ended_.wait_for(lock, kGoodbye, [this] { return served_.empty(); });
    for (Connection* connection : served_) connection->shut(true);
  }
  job_added_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

/// Gives a client to a thread, or returns the answer that refuses it.
std::string Server::Impl::admit(Descriptor& socket, std::string_view head, std::string_view body) {
  auto request = parse_head(head);
  Kind kind = kPage;
  std::optional<Refusal> refusal = Refusal{400, "The request is malformed."};
  if (head.empty()) refusal = Refusal{431, "The head of the request is too long."};
  if (request) refusal = check(*request, socket.file(), kind);
  const bool with_body = !request || request->method != "HEAD";
  if (!refusal && add_job(kind, std::move(*request), socket, body)) return {};
  if (!refusal) refusal = Refusal{503, "The viewer has too many such requests at once."};
  const HttpAnswer answer{.status = refusal->status, .body = std::string(refusal->sentence) + "\n"};
  return answer_head(answer, answer.body.size(), refusal->headers) + (with_body ? answer.body : "");
}

/// Returns why a request is refused, or sets its kind.
std::optional<Refusal> Server::Impl::check(const HttpRequest& request, int socket, Kind& kind) const {
  const std::string host = lowercase(request.header("host"));
  const bool is_address = listening_.any && host == fmt::format("{}:{}", own_address(socket), listening_.port);
  if (!is_address && hosts_.count(with_port(host, kHttpPort)) == 0)
    return Refusal{403, "The viewer is not served at this host name. Option --host-name adds one."};
  const auto path = path_after_token(request.path, token_);
  if (!path) return Refusal{404, "The address lacks the token that the viewer printed when it started."};
  if (path->empty() || *path == "/")
    kind = kPage;
  else if (*path == "/socket")
    kind = kSocket;
  else if (*path == "/files" || *path == "/save")
    kind = *path == "/save" ? kSave : kFiles;
  else
    return Refusal{404, "The viewer has no such file."};
  const bool is_post = kind == kFiles || kind == kSave;
  if (is_post && request.method != "POST") return Refusal{405, "Only POST is possible here.", "Allow: POST\r\n"};
  if (!is_post && request.method != "GET" && (kind == kSocket || request.method != "HEAD"))
    return Refusal{405, "Only GET is possible here.", kind == kSocket ? "Allow: GET\r\n" : "Allow: GET, HEAD\r\n"};
  // A browser sends it with each socket and upload.
  const bool needs_origin = kind != kPage || request.headers.count("origin") > 0;
  if (needs_origin && lowercase(request.header("origin")) != "http://" + host)
    return Refusal{403, "A page of another server must not use the viewer."};
  if (path->empty()) return Refusal{308, "The page is one level lower.", fmt::format("Location: {}/\r\n", token_)};
  if (kind == kSocket && !request.wants_web_socket())
    return Refusal{426, "A WebSocket is needed here.", "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"};
  if (is_post && request.content_length() < 0) return Refusal{411, "The size of the body is missing."};
  return {};
}

/// Gives a client to a thread; returns false if there are too many of the kind.
bool Server::Impl::add_job(Kind kind, HttpRequest request, Descriptor& socket, std::string_view body) {
  const std::lock_guard lock(mutex_);
  if (counts_[kind] >= max_jobs(kind)) return false;
  auto connection =
      std::make_unique<Connection>(std::move(socket), std::string(body), milliseconds(settings_.stall_ms));
  jobs_.push_back({kind, std::move(request), std::move(connection)});
  ++counts_[kind];
  job_added_.notify_one();
  return true;
}

void Server::Impl::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    job_added_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
    if (stopping_) return;
    Job job = std::move(jobs_.front());
    jobs_.pop_front();
    const auto served = served_.insert(job.connection.get()).first;
    lock.unlock();
    try {
      serve(job);
    } catch (...) {  // for lack of memory: the client loses its connection
    }
    lock.lock();
    served_.erase(served);
    job.connection.reset();
    --counts_[job.kind];
    job_ended_.notify_all();
  }
}

void Server::Impl::serve(Job& job) {
  Connection& connection = *job.connection;
  const std::int64_t size = std::max<std::int64_t>(job.request.content_length(), 0);
  if (job.kind == kSocket) return serve_page(connection, job.request);
  if (lowercase(job.request.header("expect")) == "100-continue") connection.write("HTTP/1.1 100 Continue\r\n\r\n");
  if (job.kind == kPage)
    send_answer(connection, job.request, {.type = "text/html; charset=utf-8", .body = std::string(settings_.page)},
                kPageHeaders);
  else
    send_answer(connection, job.request,
                job.kind == kFiles ? answer_files(connection, job.request) : answer_save(connection, job.request));
  connection.drain(size);
}

HttpAnswer Server::Impl::answer_files(Connection& connection, const HttpRequest& request) {
  Pace pace(connection.stall());
  std::string file;
  const auto refusal = uploads_.add(
      request.parameter("drop"), request.parameter("name"), request.content_length(),
      [&](char* buffer, std::size_t size) { return connection.read(buffer, size, pace); }, file);
  if (!refusal) return json_answer({{"file", file}});
  constexpr int kStatus[] = {400, 413, 409, 500};  // in the order of Failure
  return error_answer(kStatus[int(refusal->failure)], refusal->sentence);
}

HttpAnswer Server::Impl::answer_save(Connection& connection, const HttpRequest& request) {
  const std::int64_t size = request.content_length();
  if (size > std::int64_t(kMaxMessageBytes))
    return error_answer(413, fmt::format("a message has {} bytes; the max is {}", size, kMaxMessageBytes));
  std::string text(std::size_t(size), '\0');
  Pace pace(connection.stall());
  for (std::size_t at = 0; at < text.size();) {
    const long count = connection.read(text.data() + at, text.size() - at, pace);
    if (count <= 0) return error_answer(400, "the message arrived incomplete");
    at += std::size_t(count);
  }
  const auto save = parse_save(text);
  if (!save) return error_answer(400, save.error().message);
  return handlers_.save(*save, [&] { return !stopping_ && !connection.is_closed_by_peer(); });
}

void Server::Impl::serve_page(Connection& connection, const HttpRequest& request) {
  if (!connection.write(web_socket_head(request.header("sec-websocket-key")))) return;
  Page& page = open_page(connection);
  try {
    if (!page.refused) {
      handlers_.opened(page.id);
      listen_to(page, connection);
    }
  } catch (...) {  // for lack of memory
  }
  close_page(page);
  connection.drain(std::int64_t(kMaxMessageBytes));
}

Page& Server::Impl::open_page(Connection& connection) {
  Outbox::Wire wire;
  wire.write = [&connection](Outbox::Kind kind, std::string_view bytes) {
    return connection.write(frame_head(opcode_of(kind), bytes.size()).append(bytes));
  };
  // After the last message the page closes its side; otherwise nothing more is exchanged.
  wire.end = [&connection](bool finished) { connection.shut(!finished); };
  const std::lock_guard lock(mutex_);
  int open = 0;
  for (const auto& [id, each] : pages_) open += each->refused ? 0 : 1;
  const PageId id = ++last_page_;
  auto owned = std::make_unique<Page>(id, open >= settings_.max_pages, std::move(wire));
  Page& page = *pages_.emplace(id, std::move(owned)).first->second;
  if (page.refused)
    page.outbox.add_text(
        error_text(fmt::format("the viewer has {} pages open, the max; close one", settings_.max_pages)));
  if (stopping_) page.outbox.finish(close_data(CloseCode::kGone, ""));
  return page;
}

/// Receives messages until the page or the connection ends.
void Server::Impl::listen_to(Page& page, Connection& connection) {
  FrameReader reader;
  char bytes[kChunkBytes];
  for (int pings = 0;;) {
    const long count = connection.read(bytes, sizeof bytes, steady_clock::now() + kPing);
    if (count == 0 || (count < 0 && pings == kMaxPings)) return;
    if (count < 0) {
      ++pings;
      page.outbox.add_control(Outbox::Kind::kPing, {});
      continue;
    }
    pings = 0;
    reader.add({bytes, std::size_t(count)});
    while (auto message = reader.next())
      if (!receive(page, std::move(*message))) return;
    if (reader.error() != CloseCode::kNone) return page.outbox.finish(close_data(reader.error(), reader.sentence()));
  }
}

/// Returns false for the last message.
bool Server::Impl::receive(Page& page, FrameReader::Received message) {
  if (message.opcode == Opcode::kText) handlers_.received(page.id, std::move(message.data));
  if (message.opcode == Opcode::kPing) page.outbox.add_control(Outbox::Kind::kPong, std::move(message.data));
  if (message.opcode == Opcode::kClose) page.outbox.finish(message.data.substr(0, 2));  // its code
  return message.opcode != Opcode::kClose;
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
  return fmt::format("http://{}:{}/{}/", host, listening_.port, token_);
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
