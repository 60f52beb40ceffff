// Sockets of the server: where it listens, the gate where clients come in, and connections whose reads and writes end.
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "core/result.h"
#include "system/child_process.h"

namespace umbrage::view {

using TimePoint = std::chrono::steady_clock::time_point;

/// A socket that listens at an IPv4 address of this machine, without blocking.
struct Listening {
  Descriptor socket;
  std::string address;  ///< numeric: "127.0.0.1"
  int port = 0;
  bool loopback = true, any = false;
};

/// Listens at a host, at any free port for 0. Errors: kUsage, naming --host or --port.
Result<Listening> listen_at(const std::string& host, int port);

/// Returns the numeric address of this machine to which a client is connected.
std::string own_address(int socket);

/// Hears clients, all in one thread, until the head of their request has arrived. A client whose head has not arrived
/// after a second is closed; if there are too many, the oldest is.
class Gate {
 public:
  static constexpr std::size_t kMaxClients = 256;
  /// Takes the socket of a client whose head has arrived, and returns nothing; or leaves the socket and returns an
  /// answer. `head`: empty if it is too long. `body`: the bytes after it that have arrived.
  using Admit = std::function<std::string(Descriptor& socket, std::string_view head, std::string_view body)>;

  Gate(Descriptor listening, Admit admit);
  ~Gate();

 private:
  struct Client {
    Descriptor socket;
    TimePoint until;
    std::string received = {};
    bool is_answered = false;
  };
  void run();
  void let_in();
  bool hear(Client& client);

  const Descriptor listening_;
  const Admit admit_;
  std::list<Client> clients_;  ///< the oldest first
  Descriptor wake_;            ///< readable at the end
  std::thread thread_;         // last, so that it starts when all else exists
};

/// The least speed of a request or an answer: some bytes within every `stall`, and a rate after the first `stall`.
class Pace {
 public:
  explicit Pace(std::chrono::milliseconds stall) : stall_(stall), start_(std::chrono::steady_clock::now()) {}
  void moved(std::size_t bytes) { bytes_ += std::int64_t(bytes); }
  /// Returns when the next byte must have moved.
  TimePoint deadline() const;

 private:
  const std::chrono::milliseconds stall_;
  const TimePoint start_;
  std::int64_t bytes_ = 0;
};

/// A client. One thread may read while another writes.
class Connection {
 public:
  /// `received`: what has already been read.
  Connection(Descriptor socket, std::string received, std::chrono::milliseconds stall)
      : socket_(std::move(socket)), received_(std::move(received)), stall_(stall) {}

  /// Returns the number of bytes that were read; 0 at the end or after an error, -1 if none came until `deadline`.
  long read(char* buffer, std::size_t size, TimePoint deadline);
  /// As above; -1 if the client is slower than its pace.
  long read(char* buffer, std::size_t size, Pace& pace);
  /// Returns false if the connection is lost or slower than its pace.
  bool write(std::string_view bytes);
  /// Ends what is sent, and with `all` also what is received. Wakes threads that wait for it. Any thread may call it.
  void shut(bool all);
  /// Ends what is sent and discards what comes, up to `max` bytes, until the client closes. A connection that is closed
  /// with unread bytes loses what was sent last.
  void drain(std::int64_t max);
  bool is_closed_by_peer() const;
  std::chrono::milliseconds stall() const { return stall_; }

 private:
  bool wait(short events, TimePoint deadline) const;

  const Descriptor socket_;
  std::string received_;
  const std::chrono::milliseconds stall_;
};

}  // namespace umbrage::view
