// A small HTTP and WebSocket client for tests of the server.
#pragma once
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace umbrage::view {

/// A connection to a server on this machine. Reads end after 10 s.
class TestClient {
 public:
  /// `receive_buffer`: bytes, 0: that of the system.
  explicit TestClient(int port, int receive_buffer = 0)
      : host_("127.0.0.1:" + std::to_string(port)), file_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval limit{.tv_sec = 10, .tv_usec = 0};
    ::setsockopt(file_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    ::setsockopt(file_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    if (receive_buffer > 0) ::setsockopt(file_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(std::uint16_t(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(file_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  TestClient(TestClient&& other) noexcept
      : host_(std::move(other.host_)), file_(std::exchange(other.file_, -1)), buffer_(std::move(other.buffer_)) {}
  ~TestClient() { close(); }

  void close() {
    if (file_ >= 0) ::close(std::exchange(file_, -1));
  }

  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(std::size_t(sent));
    }
    return true;
  }

  /// Returns all until the server closes the connection.
  std::string rest() {
    while (receive()) continue;
    return std::exchange(buffer_, {});
  }

  /// Returns the bytes up to and with `end`; fewer if the connection ends.
  std::string until(std::string_view end) {
    std::size_t at = 0;
    while ((at = buffer_.find(end)) == std::string::npos)
      if (!receive()) return std::exchange(buffer_, {});
    return take(at + end.size());
  }

  /// The headers that a browser sends from a page of this server.
  std::string origin() const { return "Host: " + host_ + "\r\nOrigin: http://" + host_ + "\r\n"; }

  /// Asks for a WebSocket. `origin`: Host and Origin. Returns the head of the answer.
  std::string open_web_socket(const std::string& path, const std::string& origin) {
    send("GET " + path + " HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n" + origin + "\r\n");
    return until("\r\n\r\n");
  }
  std::string open_web_socket(const std::string& path) { return open_web_socket(path, origin()); }

  static constexpr int kContinuation = 0, kText = 1, kBinary = 2, kClose = 8, kPing = 9, kLost = -1;

  static constexpr int kFinal = 0x80, kMasked = 0x80;

  /// Returns a frame. `start`: opcode, kFinal and reserved bits.
  static std::string frame(int start, std::string_view data, int masked = kMasked) {
    constexpr int kShort = 126, kLong = 127;
    constexpr std::string_view kMask = "mask";
    std::string bytes = {char(start)};
    const bool is_long = data.size() > 0xffff;
    bytes += char(masked | (data.size() < kShort ? int(data.size()) : is_long ? kLong : kShort));
    if (data.size() >= kShort)
      for (int shift = is_long ? 56 : 8; shift >= 0; shift -= 8) bytes += char(data.size() >> shift);
    if (!masked) return bytes.append(data);
    bytes += kMask;
    for (std::size_t i = 0; i < data.size(); ++i) bytes += char(data[i] ^ kMask[i % 4]);
    return bytes;
  }

  bool send_message(int opcode, std::string_view data, bool is_final = true) {
    return send(frame(opcode | (is_final ? kFinal : 0), data));
  }

  struct Received {
    int opcode = kLost;
    std::string data;
  };

  /// Returns the next message of the server; kLost if the connection ends or nothing comes.
  Received message() {
    if (!have(2)) return {};
    const int opcode = buffer_[0] & 0x0f;
    std::size_t size = static_cast<unsigned char>(buffer_[1]), head = 2;
    if (const std::size_t extra = size == 126 ? 2 : size == 127 ? 8 : 0; extra > 0) {
      head += extra;
      if (!have(head)) return {};
      size = 0;
      for (std::size_t i = 2; i < head; ++i) size = size << 8 | static_cast<unsigned char>(buffer_[i]);
    }
    if (!have(head + size)) return {};
    take(head);
    return {opcode, take(size)};
  }

 private:
  bool have(std::size_t size) {
    while (buffer_.size() < size)
      if (!receive()) return false;
    return true;
  }
  std::string take(std::size_t size) {
    std::string taken = buffer_.substr(0, size);
    buffer_.erase(0, size);
    return taken;
  }
  bool receive() {
    char bytes[65536];
    const ssize_t size = ::recv(file_, bytes, sizeof bytes, 0);
    if (size > 0) buffer_.append(bytes, std::size_t(size));
    return size > 0;
  }

  std::string host_;  ///< with its port
  int file_;
  std::string buffer_;
};

}  // namespace umbrage::view
