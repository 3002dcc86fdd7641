// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/status.h"

#include <cstdio>
#include <cstdlib>

namespace engram {

namespace internal {

void check_failed(const char* file, int line, const char* condition, std::string_view message) {
  fmt::print(stderr, "engram: bug at {}:{}: {} does not hold: {}\n", file, line, condition,
             message);
  std::fflush(stderr);
  std::abort();
}

}  // namespace internal

std::string_view to_string(StatusCode code) {
  switch (code) {
    case StatusCode::kOk: return "ok";
    case StatusCode::kInvalidArgument: return "invalid argument";
    case StatusCode::kNotFound: return "not found";
    case StatusCode::kAlreadyExists: return "already exists";
    case StatusCode::kFailedPrecondition: return "failed precondition";
    case StatusCode::kDataLoss: return "data loss";
    case StatusCode::kResourceExhausted: return "resource exhausted";
    case StatusCode::kUnavailable: return "unavailable";
    case StatusCode::kCancelled: return "cancelled";
  }
  return "unknown";
}

std::string Status::to_string() const {
  if (ok()) return "ok";
  return fmt::format("{}: {}", engram::to_string(code_), message_);
}

Status Status::with_context(std::string_view context) const {
  if (ok()) return *this;
  return Status(code_, fmt::format("{}: {}", context, message_));
}

}  // namespace engram
