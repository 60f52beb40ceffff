#include "apps/view/listen.h"

#include <civetweb.h>
#include <dirent.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <string_view>

namespace umbrage::view {
namespace {

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Addresses resolve(const std::string& host, int port, int flags, int& failed) {
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_STREAM;
  wanted.ai_flags = flags;
  addrinfo* found = nullptr;
  failed = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found);
  return {failed == 0 ? found : nullptr, &::freeaddrinfo};
}

/// Returns 0 if a server can listen at the address, or an errno value.
int try_to_listen(const addrinfo& address) {
  const int file = ::socket(address.ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (file < 0) return errno;
  const int on = 1;
  ::setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool listens = ::bind(file, address.ai_addr, address.ai_addrlen) == 0 && ::listen(file, 1) == 0;
  const int failed = listens ? 0 : errno;
  ::close(file);
  return failed;
}

Listening description(const addrinfo& address) {
  char text[NI_MAXHOST] = {};
  ::getnameinfo(address.ai_addr, address.ai_addrlen, text, sizeof text, nullptr, 0, NI_NUMERICHOST);
  const std::uint32_t ip = ntohl(reinterpret_cast<const sockaddr_in*>(address.ai_addr)->sin_addr.s_addr);
  constexpr std::uint32_t kLoopbackNet = 127;
  return {.address = text, .loopback = ip >> 24 == kLoopbackNet, .any = ip == INADDR_ANY};
}

/// Returns whether a socket address has this port and, if given, this numeric address.
bool is_at(const sockaddr_storage& address, socklen_t size, int port, std::string_view numeric) {
  char host[NI_MAXHOST] = {}, service[NI_MAXSERV] = {};
  const int failed = ::getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host, sizeof host, service,
                                   sizeof service, NI_NUMERICHOST | NI_NUMERICSERV);
  return failed == 0 && std::to_string(port) == service && (numeric.empty() || numeric == host);
}

}  // namespace

Result<Listening> check_listening(const std::string& host, int port) {
  int failed = 0;
  const Addresses found = resolve(host, port, AI_PASSIVE, failed);
  if (!found && host.find(':') != std::string::npos)
    return field_error("--host", host, "{} '{}' must be a name or an IPv4 address, such as 127.0.0.1");
  if (!found) return field_error("--host", host, "{} '{}' is not known: {}", ::gai_strerror(failed));
  for (const addrinfo* each = found.get(); each; each = each->ai_next) {
    failed = try_to_listen(*each);
    if (failed == 0) return description(*each);
  }
  if (failed == EADDRINUSE)
    return field_error("--port", port, "{} {} is in use on {}; choose another one, or 0 for a free one", host);
  if (failed == EACCES) return field_error("--port", port, "{} {} is reserved for the system; choose one from 1024");
  if (failed == EADDRNOTAVAIL) return field_error("--host", host, "{} '{}' is not an address of this machine");
  return field_error("--host", host, "{} '{}' cannot be listened at: {}", std::strerror(failed));
}

int socket_of(const mg_connection* connection) {
  const mg_request_info* info = ::mg_get_request_info(connection);
  const std::unique_ptr<DIR, int (*)(DIR*)> files(::opendir("/proc/self/fd"), &::closedir);
  if (!files || !info) return -1;
  while (const dirent* entry = ::readdir(files.get())) {
    const std::string_view name = entry->d_name;
    int file = -1;
    if (std::from_chars(name.data(), name.data() + name.size(), file).ec != std::errc()) continue;
    sockaddr_storage peer{}, own{};
    socklen_t peer_size = sizeof peer, own_size = sizeof own;
    if (::getpeername(file, reinterpret_cast<sockaddr*>(&peer), &peer_size) == 0 &&
        ::getsockname(file, reinterpret_cast<sockaddr*>(&own), &own_size) == 0 &&
        is_at(peer, peer_size, info->remote_port, info->remote_addr) && is_at(own, own_size, info->server_port, {}))
      return file;
  }
  return -1;
}

bool is_closed_by_peer(int socket) {
  pollfd state{.fd = socket, .events = POLLRDHUP, .revents = 0};
  return ::poll(&state, 1, 0) != 0;
}

void knock(const std::string& address, int port) {
  int failed = 0;
  const Addresses found = resolve(address, port, AI_NUMERICHOST, failed);
  if (!found) return;
  const int file = ::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (file < 0) return;
  static_cast<void>(::connect(file, found->ai_addr, found->ai_addrlen));
  ::close(file);
}

}  // namespace umbrage::view
