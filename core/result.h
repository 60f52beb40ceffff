// Result: a value, or an error caused by input or environment as one sentence for the user.
#pragma once
#include <fmt/core.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace umbrage {

/// The kinds of failure, numbered as the exit codes of the command line.
enum class ErrorKind {
  kInternal = 1,
  kUsage = 2,   ///< wrong option, value or name
  kFile = 3,    ///< a file that cannot be read, used or written
  kDevice = 4,  ///< a missing or insufficient device, or too little memory
  kInterrupted = 130,
};

/// A field of a request (renderer/options.h), or an option that only the command line has: "--memory"; and its value as
/// the user wrote it, or one word of a list; empty: any.
struct FieldValue {
  std::string field, value{};
};

/// A failure: its kind, one sentence that names file, field, value and remedy, and the fields to blame.
struct Error {
  ErrorKind kind = ErrorKind::kInternal;
  std::string message;
  std::vector<FieldValue> fields{};  ///< empty: the failure is not about fields. Remedies are not among them
};

template <class... Args>
Error usage_error(fmt::format_string<Args...> text, Args&&... args) {
  return {ErrorKind::kUsage, fmt::format(text, std::forward<Args>(args)...)};
}
template <class... Args>
Error file_error(fmt::format_string<Args...> text, Args&&... args) {
  return {ErrorKind::kFile, fmt::format(text, std::forward<Args>(args)...)};
}
template <class... Args>
Error device_error(fmt::format_string<Args...> text, Args&&... args) {
  return {ErrorKind::kDevice, fmt::format(text, std::forward<Args>(args)...)};
}

/// Returns the error with another field to blame.
inline Error with_field(Error error, std::string_view field, std::string_view value = {}) {
  error.fields.push_back({std::string(field), std::string(value)});
  return error;
}

/// Returns the error for a value of a field. The first two arguments of `text` are the field, which sentences have in
/// backquotes, and the value: "`{}` cannot be '{}'". Another field in `text` is in backquotes, too.
template <class Value, class... Args>
Error field_error(std::string_view field, const Value& value,
                  fmt::format_string<std::string_view&, const Value&, Args...> text, Args&&... args) {
  return with_field({ErrorKind::kUsage, fmt::format(text, field, value, std::forward<Args>(args)...)}, field,
                    fmt::format("{}", value));
}

/// A value or an Error. Check `if (!result)`, then read `*result` or `result.error()`.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}
  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() { return std::get<0>(state_); }
  const T& operator*() const { return std::get<0>(state_); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }
  Error& error() { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Nothing, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}
  explicit operator bool() const { return !error_; }
  const Error& error() const { return *error_; }
  Error& error() { return *error_; }

 private:
  std::optional<Error> error_;
};

}  // namespace umbrage
