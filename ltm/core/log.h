// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace engram::log {

enum class Level { kDebug, kInfo, kWarning, kError, kOff };

/// Drops messages below `level`. Default: kInfo.
/// Threading: thread-safe.
void set_level(Level level);

[[nodiscard]] Level level();

/// kText: "error: ..." for people. kJson: an object of time, level and message for programs.
enum class Form { kText, kJson };

/// Sets the form of messages. Default: kText. Threading: thread-safe.
void set_form(Form form);

/// Writes one line to stderr. stdout is for results.
/// Threading: thread-safe.
void write(Level level, std::string_view message);

template <typename... Args>
void debug(fmt::format_string<Args...> text, Args&&... args) {
  write(Level::kDebug, fmt::format(text, std::forward<Args>(args)...));
}
template <typename... Args>
void info(fmt::format_string<Args...> text, Args&&... args) {
  write(Level::kInfo, fmt::format(text, std::forward<Args>(args)...));
}
template <typename... Args>
void warning(fmt::format_string<Args...> text, Args&&... args) {
  write(Level::kWarning, fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace engram::log
