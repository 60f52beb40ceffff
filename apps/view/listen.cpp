#include "apps/view/listen.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <vector>

#include "apps/view/http.h"
#include "core/check.h"

namespace umbrage::view {
namespace {

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;
using std::chrono::steady_clock;

constexpr std::int64_t kMinRate = 16384;              // bytes per second
constexpr std::chrono::milliseconds kDrain(500);      // for a client to close its side
constexpr std::chrono::milliseconds kHeadTime(1000);  // for the head of a request

/// Returns the time that is left, as poll() takes it.
int milliseconds_until(TimePoint deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
  return int(std::max<std::int64_t>(left, 0));
}

Addresses resolve(const std::string& host, int port, int& failed) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = AI_PASSIVE;
  addrinfo* found = nullptr;
  failed = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found);
  return {failed == 0 ? found : nullptr, &::freeaddrinfo};
}

/// Returns the numeric form of an IPv4 address.
std::string numeric(const sockaddr_in& address) {
  char text[NI_MAXHOST] = {};
  ::getnameinfo(reinterpret_cast<const sockaddr*>(&address), sizeof address, text, sizeof text, nullptr, 0,
                NI_NUMERICHOST);
  return text;
}

sockaddr_in own_socket_address(int file) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
  return address;
}

/// Starts to listen. Returns 0 or an errno value.
int start_listening(const addrinfo& address, Listening& listening) {
  listening.socket = Descriptor(::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int file = listening.socket.file(), on = 1;
  if (file < 0) return errno;
  ::setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(file, address.ai_addr, address.ai_addrlen) != 0 || ::listen(file, SOMAXCONN) != 0) return errno;
  const sockaddr_in own = own_socket_address(file);
  const std::uint32_t ip = ntohl(own.sin_addr.s_addr);
  constexpr std::uint32_t kLoopbackNet = 127;
  listening.address = numeric(own);
  listening.port = ntohs(own.sin_port);
  listening.loopback = ip >> 24 == kLoopbackNet;
  listening.any = ip == INADDR_ANY;
  return 0;
}

}  // namespace

Result<Listening> listen_at(const std::string& host, int port) {
  int failed = 0;
  const Addresses found = resolve(host, port, failed);
  if (!found && host.find(':') != std::string::npos)
    return field_error("--host", host, "{} '{}' must be a name or an IPv4 address, such as 127.0.0.1");
  if (!found) return field_error("--host", host, "{} '{}' is not known: {}", ::gai_strerror(failed));
  for (const addrinfo* each = found.get(); each; each = each->ai_next) {
    Listening listening;
    failed = start_listening(*each, listening);
    if (failed == 0) return listening;
  }
  if (failed == EADDRINUSE)
    return field_error("--port", port, "{} {} is in use on {}; choose another one, or 0 for a free one", host);
  if (failed == EACCES) return field_error("--port", port, "{} {} is reserved for the system; choose one from 1024");
  if (failed == EADDRNOTAVAIL) return field_error("--host", host, "{} '{}' is not an address of this machine");
  return field_error("--host", host, "{} '{}' cannot be listened at: {}", std::strerror(failed));
}

std::string own_address(int socket) { return numeric(own_socket_address(socket)); }

Gate::Gate(Descriptor listening, Admit admit)
    : listening_(std::move(listening)), admit_(std::move(admit)), wake_(::eventfd(0, EFD_CLOEXEC)) {
  check_less(-1, wake_.file(), "descriptor of an event");
  thread_ = std::thread([this] { run(); });
}

Gate::~Gate() {
  constexpr std::uint64_t kOnce = 1;
  check_equal(::write(wake_.file(), &kOnce, sizeof kOnce), ssize_t(sizeof kOnce), "bytes of an event");
  thread_.join();
}

void Gate::run() {
  std::vector<pollfd> states = {{listening_.file(), POLLIN, 0}, {wake_.file(), POLLIN, 0}};
  const std::size_t others = states.size();
  while (states[1].revents == 0) try {
      states.resize(others);
      for (const Client& client : clients_) states.push_back({client.socket.file(), POLLIN, 0});
      ::poll(states.data(), states.size(), clients_.empty() ? -1 : milliseconds_until(clients_.front().until));
      const TimePoint now = steady_clock::now();
      auto state = states.begin() + std::ptrdiff_t(others);
      for (auto client = clients_.begin(); client != clients_.end(); ++state) {
        const bool stays = (state->revents == 0 || hear(*client)) && now < client->until;
        client = stays ? std::next(client) : clients_.erase(client);
      }
      if (states[0].revents != 0) let_in();
    } catch (...) {
      clients_.clear();  // for lack of memory
    }
}

void Gate::let_in() {
  constexpr int kMaxAtOnce = 16, kOn = 1;  // few, so that those who wait are heard meanwhile
  for (int i = 0; i < kMaxAtOnce; ++i) {
    Descriptor socket(::accept4(listening_.file(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    const bool failed = socket.file() < 0;
    if (failed && (errno == EAGAIN || errno == EINTR || errno == ECONNABORTED)) return;
    if (clients_.size() >= kMaxClients || (failed && !clients_.empty()))
      clients_.pop_front();
    else if (failed)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // until a connection frees a descriptor
    if (failed) return;
    ::setsockopt(socket.file(), IPPROTO_TCP, TCP_NODELAY, &kOn, sizeof kOn);
    clients_.push_back({std::move(socket), steady_clock::now() + kHeadTime});
  }
}

/// Reads what a client sent. Returns whether it goes on waiting.
bool Gate::hear(Client& client) {
  char bytes[kMaxHeadBytes];
  const ssize_t count = ::recv(client.socket.file(), bytes, sizeof bytes - client.received.size(), 0);
  if (count < 0) return errno == EAGAIN || errno == EINTR;
  if (count == 0) return false;
  if (client.is_answered) return true;  // a connection that is closed with unread bytes loses the answer
  constexpr std::string_view kEnd = "\r\n\r\n";
  const std::size_t searched = client.received.size() - std::min(client.received.size(), kEnd.size() - 1);
  client.received.append(bytes, std::size_t(count));
  std::size_t end = client.received.find(kEnd, searched);
  if (end == std::string::npos && client.received.size() < kMaxHeadBytes) return true;
  end = end == std::string::npos ? 0 : end + kEnd.size();
  const std::string received = std::exchange(client.received, {}),
                    answer = admit_(client.socket, received.substr(0, end), received.substr(end));
  if (answer.empty()) return false;
  static_cast<void>(::send(client.socket.file(), answer.data(), answer.size(), MSG_NOSIGNAL));  // it has room
  ::shutdown(client.socket.file(), SHUT_WR);
  return client.is_answered = true;
}

TimePoint Pace::deadline() const {
  const std::chrono::seconds of_rate(bytes_ / kMinRate);
  return std::min(start_ + stall_ + of_rate, steady_clock::now() + stall_);
}

bool Connection::wait(short events, TimePoint deadline) const {
  pollfd state{.fd = socket_.file(), .events = events, .revents = 0};
  for (;;) {
    const int ready = ::poll(&state, 1, milliseconds_until(deadline));
    if (ready >= 0 || errno != EINTR) return ready > 0;
  }
}

long Connection::read(char* buffer, std::size_t size, TimePoint deadline) {
  if (!received_.empty()) {
    const std::size_t count = received_.copy(buffer, size);
    received_.erase(0, count);
    return long(count);
  }
  for (;;) {
    const ssize_t count = ::recv(socket_.file(), buffer, size, 0);
    if (count >= 0) return count;
    if (errno == EAGAIN && !wait(POLLIN, deadline)) return -1;
    if (errno != EAGAIN && errno != EINTR) return 0;
  }
}

long Connection::read(char* buffer, std::size_t size, Pace& pace) {
  const long count = read(buffer, size, pace.deadline());
  pace.moved(std::size_t(std::max(count, 0L)));
  return count;
}

bool Connection::write(std::string_view bytes) {
  Pace pace(stall_);
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_.file(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      pace.moved(std::size_t(sent));
      bytes.remove_prefix(std::size_t(sent));
    } else if (errno == EAGAIN ? !wait(POLLOUT, pace.deadline()) : errno != EINTR) {
      return false;
    }
  }
  return true;
}

void Connection::shut(bool all) { ::shutdown(socket_.file(), all ? SHUT_RDWR : SHUT_WR); }

void Connection::drain(std::int64_t max) {
  shut(false);
  char bytes[16384];
  Pace pace(stall_);
  while (max >= 0) {
    const long count = read(bytes, sizeof bytes, std::min(pace.deadline(), steady_clock::now() + kDrain));
    if (count <= 0) return;
    pace.moved(std::size_t(count));
    max -= count;
  }
}

bool Connection::is_closed_by_peer() const { return wait(POLLRDHUP, steady_clock::now()); }

}  // namespace umbrage::view
