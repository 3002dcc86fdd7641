// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string_view>

namespace engram::internal {

/// Prints the place, the condition and the message to stderr, then aborts.
[[noreturn]] void check_failed(const char* file, int line, const char* condition,
                               std::string_view message);

}  // namespace engram::internal

/// Aborts with a formatted message if `condition` is false, in every build. For bugs in this
/// program only: failures that callers, disks or peers can cause are a Status.
#define ENGRAM_CHECK(condition, ...)                                        \
  do {                                                                      \
    if (!(condition)) [[unlikely]]                                          \
      ::engram::internal::check_failed(__FILE__, __LINE__, #condition,      \
                                       ::fmt::format(__VA_ARGS__));         \
  } while (false)
