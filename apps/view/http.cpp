#include "apps/view/http.h"

#include <civetweb.h>
#include <sys/random.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/check.h"

namespace umbrage::view {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTokenBytes = 16;

std::string_view header_of(const mg_connection* connection, const char* name) {
  const char* value = ::mg_get_header(connection, name);
  return value ? std::string_view(value) : std::string_view();
}

bool equal_without_case(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::mg_strncasecmp(a.data(), b.data(), a.size()) == 0;
}

const char* phrase_of(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 308:
      return "Permanent Redirect";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 411:
      return "Length Required";
    case 413:
      return "Content Too Large";
    case 426:
      return "Upgrade Required";
    default:
      return "Internal Server Error";
  }
}

/// Returns a file name with every character that a header cannot hold replaced.
std::string header_name(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
  return name;
}

}  // namespace

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

bool is_foreign(const mg_connection* connection) {
  if (!::mg_get_header(connection, "Origin")) return false;  // not a browser, which always sends it here
  std::string_view origin = header_of(connection, "Origin");
  const std::size_t scheme = origin.find("://");
  if (scheme == std::string_view::npos) return true;
  origin.remove_prefix(scheme + 3);
  return !equal_without_case(origin, header_of(connection, "Host"));
}

bool wants_web_socket(const mg_connection* connection) {
  return equal_without_case(header_of(connection, "Upgrade"), "websocket");
}

std::string query_value(const mg_connection* connection, const char* name) {
  const char* query = ::mg_get_request_info(connection)->query_string;
  if (!query) return {};
  std::string value(std::strlen(query) + 1, '\0');  // decoding shortens
  const int length = ::mg_get_var(query, std::strlen(query), name, value.data(), value.size());
  value.resize(std::size_t(std::max(length, 0)));
  return value;
}

HttpAnswer json_answer(const nlohmann::json& value, int status) {
  return {.status = status, .type = "application/json", .body = text_of_json(value)};
}

HttpAnswer error_answer(int status, std::string_view sentence) { return json_answer({{"error", sentence}}, status); }

int send_answer(mg_connection* connection, const HttpAnswer& answer, std::string_view headers) {
  std::error_code code;
  const auto size = answer.file.empty() ? answer.body.size() : fs::file_size(answer.file, code);
  if (code) return send_answer(connection, error_answer(500, "the file cannot be read"));
  std::string head = fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n"
      "Connection: close\r\n{}",
      answer.status, phrase_of(answer.status), answer.type, size, headers);
  if (!answer.attachment.empty())
    head += fmt::format("Content-Disposition: attachment; filename=\"{}\"\r\n", header_name(answer.attachment));
  head += "\r\n";
  const bool with_body = std::strcmp(::mg_get_request_info(connection)->request_method, "HEAD") != 0;
  if (with_body && answer.file.empty()) head += answer.body;
  ::mg_write(connection, head.data(), head.size());
  if (!answer.file.empty()) {
    if (with_body) ::mg_send_file_body(connection, answer.file.c_str());
    fs::remove(answer.file, code);
  }
  return answer.status;
}

int send_sentence(mg_connection* connection, int status, std::string_view sentence, std::string_view headers) {
  return send_answer(connection, {.status = status, .body = std::string(sentence) + "\n"}, headers);
}

}  // namespace umbrage::view
