// Addresses and sockets of the server, as far as civetweb does not handle them.
#pragma once
#include <string>

#include "core/result.h"

struct mg_connection;

namespace umbrage::view {

/// An address of this machine to listen at.
struct Listening {
  std::string address;  ///< numeric, IPv6 in brackets: "127.0.0.1", "[::1]"
  bool loopback = true, any = false;
};

/// Returns the numeric address of a host, after a test that a server can listen there. Errors: kUsage, naming --host or
/// --port.
Result<Listening> check_listening(const std::string& host, int port);

/// Returns the socket of a connection of the server, -1 if it is not found. civetweb keeps it to itself, but only the
/// socket can wake a thread that waits for a page, or tell that a client has left.
int socket_of(const mg_connection* connection);

/// Returns whether the other side of a socket has closed it.
bool is_closed_by_peer(int socket);

/// Connects to an address and closes at once: wakes a thread that waits for connections.
void knock(const std::string& address, int port);

}  // namespace umbrage::view
