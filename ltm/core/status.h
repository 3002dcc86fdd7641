// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "ltm/core/check.h"

namespace engram {

/// The kind of a failure that the world can cause. Bugs of this program abort (ltm/core/check.h).
enum class StatusCode {
  kOk,
  kInvalidArgument,  ///< The caller or its configuration asks for the impossible.
  kNotFound,            ///< The named thing does not exist.
  kAlreadyExists,       ///< The named thing exists and must not.
  kFailedPrecondition,  ///< A right request in the wrong state (locked store, newer format, ...).
  kDataLoss,            ///< Bytes are damaged, truncated or contradict themselves.
  kResourceExhausted,  ///< Disk, memory or a configured bound is used up.
  kUnavailable,  ///< The operating system or a peer refused; it may work later.
  kCancelled,  ///< A stop was requested.
};

[[nodiscard]] std::string_view to_string(StatusCode code);

/// The outcome of an operation that can fail: ok, or a code with a message.
///
/// The message names the object, what was found and what was needed.
/// Threading: immutable except for assignment.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(StatusCode code, std::string message) : code_(code), message_(std::move(message)) {
    ENGRAM_CHECK(code != StatusCode::kOk, "an error needs an error code");
  }

  [[nodiscard]] bool ok() const { return code_ == StatusCode::kOk; }
  [[nodiscard]] StatusCode code() const { return code_; }
  [[nodiscard]] const std::string& message() const { return message_; }

  /// Prints "data loss: journal/000001.log: ..."; "ok" if ok.
  [[nodiscard]] std::string to_string() const;

  /// The same failure, reported by an outer object: `context` + ": " + message.
  [[nodiscard]] Status with_context(std::string_view context) const;

 private:
  StatusCode code_ = StatusCode::kOk;
  std::string message_;
};

/// A value, or the Status that says why there is none.
///
/// Errors: reading the value of a failed result is a bug and aborts.
template <typename T>
class [[nodiscard]] Result {
 public:
  // Implicit on purpose: `return value;` and `return status;` both read well.
  Result(T value) : value_(std::move(value)) {}
  Result(Status status) : status_(std::move(status)) {
    ENGRAM_CHECK(!status_.ok(), "a result without a value needs an error");
  }

  [[nodiscard]] bool ok() const { return status_.ok(); }
  [[nodiscard]] const Status& status() const { return status_; }

  [[nodiscard]] T& value() & { return check(), *value_; }
  [[nodiscard]] const T& value() const& { return check(), *value_; }
  [[nodiscard]] T&& value() && { return check(), *std::move(value_); }
  [[nodiscard]] T value_or(T fallback) const { return ok() ? *value_ : std::move(fallback); }

  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

 private:
  void check() const { ENGRAM_CHECK(ok(), "no value: {}", status_.to_string()); }

  Status status_;
  std::optional<T> value_;
};

/// Makes an error; `text` is a fmt format string. There is one function per code, named after it.
#define ENGRAM_STATUS_MAKER(function, code)                              \
  template <typename... Args>                                            \
  [[nodiscard]] Status function(fmt::format_string<Args...> text, Args&&... args) { \
    return Status(StatusCode::code, fmt::format(text, std::forward<Args>(args)...)); \
  }
ENGRAM_STATUS_MAKER(invalid_argument, kInvalidArgument)
ENGRAM_STATUS_MAKER(not_found, kNotFound)
ENGRAM_STATUS_MAKER(already_exists, kAlreadyExists)
ENGRAM_STATUS_MAKER(failed_precondition, kFailedPrecondition)
ENGRAM_STATUS_MAKER(data_loss, kDataLoss)
ENGRAM_STATUS_MAKER(resource_exhausted, kResourceExhausted)
ENGRAM_STATUS_MAKER(unavailable, kUnavailable)
ENGRAM_STATUS_MAKER(cancelled, kCancelled)
#undef ENGRAM_STATUS_MAKER

}  // namespace engram

#define ENGRAM_CONCAT_INNER(a, b) a##b
#define ENGRAM_CONCAT(a, b) ENGRAM_CONCAT_INNER(a, b)

/// If `expression` (a Status) is an error, returns it from the enclosing function.
#define ENGRAM_RETURN_IF_ERROR(expression) \
  ENGRAM_RETURN_IF_ERROR_INNER(ENGRAM_CONCAT(engram_status_, __COUNTER__), expression)
#define ENGRAM_RETURN_IF_ERROR_INNER(status, expression)                    \
  do {                                                                      \
    if (::engram::Status status = (expression); !status.ok()) return status; \
  } while (false)

/// `ENGRAM_ASSIGN_OR_RETURN(auto x, f())` assigns the value of a Result, or returns its error from
/// the enclosing function.
#define ENGRAM_ASSIGN_OR_RETURN(target, expression) \
  ENGRAM_ASSIGN_OR_RETURN_INNER(ENGRAM_CONCAT(engram_result_, __COUNTER__), target, expression)
#define ENGRAM_ASSIGN_OR_RETURN_INNER(result, target, expression) \
  auto result = (expression);                                     \
  if (!result.ok()) return result.status();                       \
  target = std::move(result).value()
