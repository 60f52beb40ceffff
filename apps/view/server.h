// The HTTP and WebSocket server of `umbrage view`. Everything is below /TOKEN/, a random word:
//   GET /TOKEN/                           the page
//   POST /TOKEN/files?drop=ID&name=NAME   one file of a drop (uploads.h)
//   POST /TOKEN/save                      answers a picture file (messages.h)
//   WebSocket /TOKEN/socket               messages of a page (messages.h)
// One thread hears clients until they have sent a request with the token, within a second; then a thread of the
// request's kind serves it. Each answer closes its connection. `Host` must be a name of this server, against DNS
// rebinding. Sockets and uploads need one `Origin`, this server; the page is refused to any other one.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/view/messages.h"
#include "apps/view/uploads.h"
#include "core/result.h"

namespace umbrage::view {

/// The max number of pages; the max bytes that all clients together have sent and that are not processed.
inline constexpr int kMaxPages = 16;
inline constexpr std::size_t kMaxReceivedBytes = std::size_t(12) << 20;

/// The number of a page that is connected; never used again.
using PageId = int;

/// The answer to a request: a status, and a body, or a file that is sent in place of it and then removed.
struct HttpAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body = {};
  std::filesystem::path file = {};
  std::string attachment = {};  ///< name of a file to download; empty: none
};

/// Returns an answer in JSON.
HttpAnswer json_answer(const nlohmann::json& value, int status = 200);
/// Returns {"error":"sentence"}.
HttpAnswer error_answer(int status, std::string_view sentence);

struct ServerSettings {
  std::string host = "127.0.0.1";  ///< a name or an IPv4 address of this machine
  int port = 0;                    ///< 0: a free one
  std::string_view page = {};      ///< HTML; must outlive the server
  UploadLimits uploads = {};
  int max_pages = kMaxPages;
  /// A connection that moves no byte for so long while one is due is closed, and one that moves less than 16 KiB/s
  /// after the first of these times.
  int stall_ms = 30000;
  /// NAME or NAME:PORT under which it may be reached besides the loopback names and `host`.
  std::vector<std::string> host_names = {};
};

/// Called on threads of the server. `opened`, `closed` and `received` must not block for long; for one page they are
/// called by one thread. `save` may take long; it should give up soon after `is_wanted` returns false.
struct ServerHandlers {
  std::function<void(PageId)> opened, closed;
  std::function<void(PageId, std::string text)> received;
  std::function<HttpAnswer(const Save&, const std::function<bool()>& is_wanted)> save;
};

class Server {
 public:
  /// Errors: kUsage, about --host, --port and --host-name; kFile for the temporary folder.
  static Result<std::unique_ptr<Server>> start(const ServerSettings& settings, ServerHandlers handlers);
  /// Calls stop(), and removes the uploads.
  ~Server();

  /// Closes all pages and calls `closed` for each; no handler is called afterwards. Takes half a second for
  /// clients that do not close their side. The other functions still may be called.
  void stop();

  /// Returns the address of the page: http://127.0.0.1:8080/TOKEN/
  std::string address() const;
  /// Returns a warning if other machines can reach the server; otherwise an empty text.
  std::string warning() const;

  // These never block: the page's own thread sends. Unknown pages are ignored. A frame replaces an unsent one of the
  // same view, so a page acknowledges the newest frame it has shown, and with it all earlier ones.
  void send_text(PageId page, std::string text);
  void send_frame(PageId page, std::string bytes);

  /// Returns the private folder of uploads, which `save` may use for files too.
  const std::filesystem::path& uploads() const;
  /// Returns the path of an uploaded file "DROP/NAME". Errors: kFile.
  Result<std::filesystem::path> upload(const std::string& file) const;

  class Impl;

 private:
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace umbrage::view
