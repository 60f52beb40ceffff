// HTTP and WebSockets (RFC 9110, 9112 and 6455) as the server uses them: what clients send is parsed and checked, and
// answers are written as bytes. Nothing here knows a socket.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "apps/view/server.h"

namespace umbrage::view {

/// The max bytes of the head of a request: its first line and its headers.
inline constexpr std::size_t kMaxHeadBytes = 16384;

/// The head of a request. Names of headers are in lower case; values of equal names are joined by ", ", so that no
/// header that must be there once has a valid value twice.
struct HttpRequest {
  std::string method, path, query;
  std::map<std::string, std::string, std::less<>> headers;

  /// Returns the value of a header; empty if it is missing.
  std::string_view header(std::string_view name) const;
  /// Returns the size of the body; -1 if it is missing or has another form.
  std::int64_t content_length() const;
  /// Returns whether it asks for a WebSocket, in the way that the RFC demands.
  bool wants_web_socket() const;
  /// Returns a decoded parameter of the query; empty if it is missing.
  std::string parameter(std::string_view name) const;
};

/// Returns the head of a request, from its first byte to the empty line; nothing if it is malformed.
std::optional<HttpRequest> parse_head(std::string_view head);

/// Returns the part of a path after /TOKEN, or nothing if the token is another one. Takes the same time for every
/// token.
std::optional<std::string_view> path_after_token(std::string_view path, std::string_view token);

/// Returns a random token: 32 hexadecimal digits, 128 bits.
std::string make_token();

/// Returns whether a text is NAME or NAME:PORT; [ADDRESS] of IPv6 is a name.
bool is_host(std::string_view text);

/// Returns a host as NAME:PORT, in lower case; with this port if it has none.
std::string with_port(std::string_view host, int port);

/// Returns the first bytes of an answer, up to its body of `size` bytes. `headers`: more lines, each ending in "\r\n".
std::string answer_head(const HttpAnswer& answer, std::uint64_t size, std::string_view headers = {});

/// Returns the answer that opens a WebSocket; `key`: of the request.
std::string web_socket_head(std::string_view key);

/// Headers of the page: it may load and reach nothing but this server.
inline constexpr std::string_view kPageHeaders =
    "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; form-action 'none'\r\n";

enum class Opcode { kContinuation = 0, kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10 };

/// Why a WebSocket is closed: codes of RFC 6455.
enum class CloseCode {
  kNone = 0,
  kGone = 1001,
  kProtocol = 1002,
  kUnsupported = 1003,
  kNotUtf8 = 1007,
  kTooLarge = 1009
};

/// Returns the data of a close message: a code and a sentence of at most 123 bytes.
std::string close_data(CloseCode code, std::string_view sentence);

/// Returns the bytes before the data of a message that the server sends in one frame.
std::string frame_head(Opcode opcode, std::size_t size);

/// Takes the bytes of a WebSocket that a client sends apart. A message has at most kMaxMessageBytes and is a text in
/// UTF-8. Call next() until it returns nothing, then add() the next bytes: so it holds little more than
/// kMaxMessageBytes and what was added last.
class FrameReader {
 public:
  struct Received {
    Opcode opcode;  ///< kText, kClose, kPing or kPong
    std::string data;
  };

  void add(std::string_view bytes);
  /// Returns the next message; nothing if it is incomplete, or after an error or a close message.
  std::optional<Received> next();
  /// Returns the code with which the connection must be closed, or kNone; `sentence` says why.
  CloseCode error() const { return error_; }
  const std::string& sentence() const { return sentence_; }

 private:
  bool fail(CloseCode code, std::string sentence);
  bool check_start(Opcode opcode, bool final, unsigned first, unsigned second);
  bool parse_frame();
  bool take(Opcode opcode, bool final, std::string data);

  std::string bytes_;      ///< what was added
  std::size_t begin_ = 0;  ///< of the next frame in it
  std::string message_;    ///< of earlier frames
  bool in_message_ = false, ended_ = false;
  std::optional<Received> ready_;
  CloseCode error_ = CloseCode::kNone;
  std::string sentence_;
};

}  // namespace umbrage::view
