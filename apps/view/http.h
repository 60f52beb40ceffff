// HTTP as the server uses it: checks of requests and writing of answers, without state.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "apps/view/server.h"

struct mg_connection;

namespace umbrage::view {

/// Returns the part of a path after /TOKEN, or nothing if the token is another one. Takes the same time for every
/// token.
std::optional<std::string_view> path_after_token(std::string_view path, std::string_view token);

/// Returns a random token: 32 hexadecimal digits, 128 bits.
std::string make_token();

/// Returns whether a request comes from a page of another server: its `Origin` has another host and port than `Host`.
bool is_foreign(const mg_connection* connection);

/// Returns whether a request asks for a WebSocket.
bool wants_web_socket(const mg_connection* connection);

/// Returns a decoded parameter of the query string; empty if it is missing.
std::string query_value(const mg_connection* connection, const char* name);

/// Sends an answer. `headers`: more lines, each ending in "\r\n". Returns the status.
int send_answer(mg_connection* connection, const HttpAnswer& answer, std::string_view headers = {});

/// Sends an answer in plain text, one sentence. Returns the status.
int send_sentence(mg_connection* connection, int status, std::string_view sentence, std::string_view headers = {});

/// Headers of the page: it may load and reach nothing but this server.
inline constexpr std::string_view kPageHeaders =
    "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; form-action 'none'\r\n";

}  // namespace umbrage::view
