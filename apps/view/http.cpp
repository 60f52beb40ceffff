#include "apps/view/http.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/view/messages.h"
#include "core/check.h"
#include "core/lowercase.h"
#include "core/printable.h"

namespace umbrage::view {
namespace {

constexpr std::size_t kTokenBytes = 16;
constexpr std::string_view kNameCharacters =  // of methods and headers
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789!#$%&'*+-.^_`|~";
constexpr std::string_view kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Returns a file name with every character that a header cannot hold replaced.
std::string header_name(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
  return name;
}

bool is_header_name(std::string_view text) {
  return !text.empty() && text.find_first_not_of(kNameCharacters) == std::string_view::npos;
}

/// Removes a part up to `end` from the start of a text and returns it, without `end`; nothing if the text has no `end`.
std::optional<std::string_view> take_until(std::string_view& text, std::string_view end) {
  const std::size_t at = text.find(end);
  if (at == std::string_view::npos) return {};
  const std::string_view part = text.substr(0, at);
  text.remove_prefix(at + end.size());
  return part;
}

/// Returns a text with %XX and + decoded.
std::string decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned code = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, code, 16).ptr == digits + 2) {
      result += char(code);
      i += 2;
    } else {
      result += text[i] == '+' ? ' ' : text[i];
    }
  }
  return result;
}

/// SHA-1, which the RFC demands for the handshake. Nothing here relies on its strength.
std::array<std::uint32_t, 5> sha1(std::string text) {
  constexpr std::size_t kBlock = 64, kLength = 8;
  const std::uint64_t bits = std::uint64_t(text.size()) * 8;
  text += char(0x80);
  text.resize((text.size() + kLength + kBlock - 1) / kBlock * kBlock - kLength);
  for (int shift = 56; shift >= 0; shift -= 8) text += char(bits >> shift);
  std::array<std::uint32_t, 5> sum = {0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476, 0xc3d2e1f0};
  for (std::size_t begin = 0; begin < text.size(); begin += kBlock) {
    std::array<std::uint32_t, 80> words{};
    for (std::size_t i = 0; i < kBlock; ++i)
      words[i / 4] = words[i / 4] << 8 | static_cast<unsigned char>(text[begin + i]);
    for (std::size_t i = 16; i < words.size(); ++i)
      words[i] = std::rotl(words[i - 3] ^ words[i - 8] ^ words[i - 14] ^ words[i - 16], 1);
    auto [a, b, c, d, e] = sum;
    for (std::size_t i = 0; i < words.size(); ++i) {
      constexpr std::uint32_t kRound[] = {0x5a827999, 0x6ed9eba1, 0x8f1bbcdc, 0xca62c1d6};
      const std::uint32_t parity = b ^ c ^ d, choice = (b & c) | (~b & d), majority = (b & c) | (b & d) | (c & d);
      const std::uint32_t mixed = i < 20 ? choice : i >= 40 && i < 60 ? majority : parity;
      const std::uint32_t next = std::rotl(a, 5) + mixed + e + kRound[i / 20] + words[i];
      e = std::exchange(d, std::exchange(c, std::rotl(std::exchange(b, std::exchange(a, next)), 30)));
    }
    const std::uint32_t added[] = {a, b, c, d, e};
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += added[i];
  }
  return sum;
}

bool is_utf8(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0) return false;
    at += length;
  }
  return true;
}

/// Returns whether a client may close a WebSocket with a code: those that the RFC or its registry names, or 3000 to
/// 4999.
bool is_close_code(int code) {
  return (code >= 1000 && code <= 1014 && (code < 1004 || code > 1006)) || (code >= 3000 && code <= 4999);
}

}  // namespace

std::string_view HttpRequest::header(std::string_view name) const {
  const auto at = headers.find(name);
  return at == headers.end() ? std::string_view() : at->second;
}

std::int64_t HttpRequest::content_length() const {
  const std::string_view text = header("content-length");
  std::int64_t size = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), size);
  const bool valid = failed == std::errc() && end == text.data() + text.size() && text[0] != '-';
  return valid && headers.count("transfer-encoding") == 0 ? size : -1;
}

bool HttpRequest::wants_web_socket() const {
  constexpr std::size_t kKeyLength = 24;  // 16 bytes in base64
  const std::string_view key = header("sec-websocket-key");
  return lowercase(header("upgrade")) == "websocket" &&
         lowercase(header("connection")).find("upgrade") != std::string::npos &&
         header("sec-websocket-version") == "13" && key.size() == kKeyLength && key.ends_with("==") &&
         key.find_first_not_of(kBase64) == kKeyLength - 2;
}

std::string HttpRequest::parameter(std::string_view name) const {
  for (std::string_view rest = query; !rest.empty();) {
    std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(pair.size() + 1, rest.size()));
    if (take_until(pair, "=") == name) return decoded(pair);
  }
  return {};
}

std::optional<HttpRequest> parse_head(std::string_view head) {
  auto line = take_until(head, "\r\n");
  if (!line || has_control(*line)) return {};
  HttpRequest request;
  const auto method = take_until(*line, " "), target = take_until(*line, " ");
  if (!method || !is_header_name(*method) || !target || !target->starts_with('/')) return {};
  if (*line != "HTTP/1.1" && *line != "HTTP/1.0") return {};
  request.method = *method;
  std::string_view query = *target;
  request.path = take_until(query, "?").value_or(*target);
  if (request.path != *target) request.query = query;
  while ((line = take_until(head, "\r\n")) && !line->empty()) {
    const auto name = take_until(*line, ":");
    if (!name || !is_header_name(*name) || has_control(*line)) return {};
    const std::size_t begin = std::min(line->find_first_not_of(' '), line->size());
    const std::string_view value = line->substr(begin, line->find_last_not_of(' ') + 1 - begin);
    const auto [at, added] = request.headers.emplace(lowercase(*name), value);
    if (!added) at->second.append(", ").append(value);
  }
  return line && head.empty() ? std::optional(std::move(request)) : std::nullopt;
}

std::string make_token() {
  unsigned char bytes[kTokenBytes];
  check_equal(::getrandom(bytes, sizeof bytes, 0), ssize_t(sizeof bytes), "number of random bytes");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

std::optional<std::string_view> path_after_token(std::string_view path, std::string_view token) {
  if (path.size() < token.size() + 1 || path[0] != '/') return {};
  unsigned difference = 0;
  for (std::size_t i = 0; i < token.size(); ++i)
    difference |= unsigned(static_cast<unsigned char>(path[i + 1]) ^ static_cast<unsigned char>(token[i]));
  if (difference != 0) return {};
  path.remove_prefix(token.size() + 1);
  if (!path.empty() && path[0] != '/') return {};
  return path;
}

bool is_host(std::string_view text) {
  constexpr int kMaxPort = 65535;
  const std::string host = with_port(text, kMaxPort);
  const std::string_view name = std::string_view(host).substr(0, host.rfind(':')),
                         port = host.c_str() + name.size() + 1;
  int number = 0;
  const auto [end, failed] = std::from_chars(port.data(), port.data() + port.size(), number);
  const bool in_brackets = name.size() > 2 && name[0] == '[' && name.back() == ']';
  const bool is_name = !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.-_") == name.npos;
  const bool is_address =
      in_brackets && name.substr(1, name.size() - 2).find_first_not_of("0123456789abcdef:.") == name.npos;
  return (is_name || is_address) && failed == std::errc() && end == port.data() + port.size() && number > 0 &&
         number <= kMaxPort;
}

std::string with_port(std::string_view host, int port) {
  const std::size_t colon = host.rfind(':'), bracket = host.rfind(']');
  const bool has_port = colon != host.npos && (bracket == host.npos || bracket < colon);
  return has_port ? lowercase(host) : fmt::format("{}:{}", lowercase(host), port);
}

HttpAnswer json_answer(const nlohmann::json& value, int status) {
  return {.status = status, .type = "application/json", .body = text_of_json(value)};
}

HttpAnswer error_answer(int status, std::string_view sentence) { return json_answer({{"error", sentence}}, status); }

std::string answer_head(const HttpAnswer& answer, std::uint64_t size, std::string_view headers) {
  std::string head = fmt::format(
      "HTTP/1.1 {} \r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n"
      "Connection: close\r\n{}",
      answer.status, answer.type, size, headers);
  if (!answer.attachment.empty())
    head += fmt::format("Content-Disposition: attachment; filename=\"{}\"\r\n", header_name(answer.attachment));
  return head + "\r\n";
}

std::string web_socket_head(std::string_view key) {
  std::string accept;
  std::uint64_t bits = 0;
  int count = 0;
  for (const std::uint32_t word : sha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11")) {
    bits = bits << 32 | word;
    for (count += 32; count >= 6; count -= 6) accept += kBase64[bits >> (count - 6) & 63];
  }
  accept += kBase64[bits << (6 - count) & 63];
  return fmt::format(
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: "
      "{}=\r\n\r\n",
      accept);
}

std::string close_data(CloseCode code, std::string_view sentence) {
  return std::string{char(int(code) >> 8), char(code)}.append(sentence);
}

std::string frame_head(Opcode opcode, std::size_t size) {
  constexpr std::size_t kShort = 126, kLong = 127, kFinal = 0x80;
  std::string head = {char(kFinal | std::size_t(opcode)), char(size < kShort ? size : size > 0xffff ? kLong : kShort)};
  if (size >= kShort)
    for (int shift = size > 0xffff ? 56 : 8; shift >= 0; shift -= 8) head += char(std::uint64_t(size) >> shift);
  return head;
}

void FrameReader::add(std::string_view bytes) { bytes_.erase(0, std::exchange(begin_, 0)).append(bytes); }

std::optional<FrameReader::Received> FrameReader::next() {
  while (!ended_ && !ready_ && parse_frame()) continue;
  return std::exchange(ready_, {});
}

bool FrameReader::fail(CloseCode code, std::string sentence) {
  ended_ = true;
  error_ = code;
  sentence_ = std::move(sentence);
  return false;
}

/// Checks the first two bytes of a frame.
bool FrameReader::check_start(Opcode opcode, bool final, unsigned first, unsigned second) {
  constexpr unsigned kReserved = 0x70, kMasked = 0x80, kSize = 0x7f, kMaxControl = 125;
  if (first & kReserved) return fail(CloseCode::kProtocol, "a frame has reserved bits");
  if (!(second & kMasked)) return fail(CloseCode::kProtocol, "a frame is not masked");
  if (opcode > Opcode::kPong || (opcode > Opcode::kBinary && opcode < Opcode::kClose))
    return fail(CloseCode::kProtocol, "a frame has an unknown opcode");
  if (opcode >= Opcode::kClose) {
    if (final && (second & kSize) <= kMaxControl) return true;
    return fail(CloseCode::kProtocol, "a control frame has more than 125 bytes or is a fragment");
  }
  if (in_message_ != (opcode == Opcode::kContinuation))
    return fail(CloseCode::kProtocol, "the fragments of a message are out of order");
  if (opcode == Opcode::kBinary) return fail(CloseCode::kUnsupported, "a message must be a text, not binary");
  return true;
}

/// Parses the next frame. Returns false if it is incomplete or wrong.
bool FrameReader::parse_frame() {
  const std::string_view rest = std::string_view(bytes_).substr(begin_);
  constexpr std::size_t kStart = 2, kMask = 4, kShort = 126, kLong = 127;
  if (rest.size() < kStart) return false;
  const auto byte = [&](std::size_t i) { return unsigned(static_cast<unsigned char>(rest[i])); };
  const bool final = (byte(0) & 0x80) != 0;
  const Opcode opcode = Opcode(byte(0) & 0x0f);
  if (!check_start(opcode, final, byte(0), byte(1))) return false;
  std::uint64_t size = byte(1) & 0x7f;
  const std::size_t mask = kStart + (size == kShort ? 2 : size == kLong ? 8 : 0);
  if (rest.size() < mask) return false;
  if (mask > kStart) {
    const std::uint64_t min = size == kShort ? kShort : 0x10000;
    size = 0;
    for (std::size_t i = kStart; i < mask; ++i) size = size << 8 | byte(i);
    if (size < min) return fail(CloseCode::kProtocol, "the size of a frame has too many bytes");
  }
  if (opcode < Opcode::kClose && size > kMaxMessageBytes - message_.size())
    return fail(CloseCode::kTooLarge, fmt::format("a message has more than {} bytes", kMaxMessageBytes));
  if (rest.size() < mask + kMask + size) return false;
  std::string data(rest.substr(mask + kMask, std::size_t(size)));
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = char(data[i] ^ rest[mask + i % kMask]);
  begin_ += mask + kMask + data.size();
  return take(opcode, final, std::move(data));
}

/// Takes a whole frame: makes a message `ready_` if it is the last one.
bool FrameReader::take(Opcode opcode, bool final, std::string data) {
  if (opcode == Opcode::kClose) {
    ended_ = true;
    const auto byte = [&](std::size_t i) { return int(static_cast<unsigned char>(data[i])); };
    if (data.size() == 1 || (data.size() > 1 && !is_close_code(byte(0) << 8 | byte(1))))
      return fail(CloseCode::kProtocol, "a close message has an invalid code");
    if (data.size() > 2 && !is_utf8(std::string_view(data).substr(2)))
      return fail(CloseCode::kNotUtf8, "a text is not UTF-8");
  }
  if (opcode >= Opcode::kClose) {
    ready_ = Received{opcode, std::move(data)};
    return true;
  }
  message_ += data;
  in_message_ = !final;
  if (!final) return true;
  if (!is_utf8(message_)) return fail(CloseCode::kNotUtf8, "a text is not UTF-8");
  ready_ = Received{Opcode::kText, std::exchange(message_, {})};
  return true;
}

}  // namespace umbrage::view
