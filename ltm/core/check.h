// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string_view>

namespace engram::internal {

/// Prints where, what and the values to stderr, then aborts.
[[noreturn]] void check_failed(const char* file, int line, const char* condition,
                               std::string_view message);

}  // namespace engram::internal

/// Aborts with a formatted message if `condition` is false: for bugs of ours, in every build.
/// What the world can cause (callers, disks, peers) is a Status instead.
#define ENGRAM_CHECK(condition, ...)                                        \
  do {                                                                      \
    if (!(condition)) [[unlikely]]                                          \
      ::engram::internal::check_failed(__FILE__, __LINE__, #condition,      \
                                       ::fmt::format(__VA_ARGS__));         \
  } while (false)
