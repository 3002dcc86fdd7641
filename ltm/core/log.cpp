// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <string>

#include "ltm/core/printable.h"
#include "ltm/core/time.h"

namespace engram::log {

namespace {

std::atomic<Form> form{Form::kText};

spdlog::logger& logger() {
  static const auto instance = [] {
    auto made = spdlog::stderr_color_mt("engram");
    made->set_pattern("%^%l%$: %v");
    return made;
  }();
  return *instance;
}

spdlog::level::level_enum spdlog_level(Level level) {
  switch (level) {
    case Level::kDebug:
      return spdlog::level::debug;
    case Level::kInfo:
      return spdlog::level::info;
    case Level::kWarning:
      return spdlog::level::warn;
    case Level::kError:
      return spdlog::level::err;
    case Level::kOff:
      break;
  }
  return spdlog::level::off;
}

std::string_view name_of(Level level) {
  switch (level) {
    case Level::kDebug:
      return "debug";
    case Level::kInfo:
      return "info";
    case Level::kWarning:
      return "warning";
    default:
      return "error";
  }
}

/// Escapes a text for JSON.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out;
}

/// Names in a message come from anywhere. What looks like another message is not one: all lines but
/// the first are indented.
std::string text_lines(std::string_view message) {
  std::string text = printable_lines(message);
  for (size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
    text.insert(at + 1, "  ");
  return text;
}

std::string json_line(Level level, std::string_view message) {
  std::string time = to_string(system_now());
  time[time.find(' ')] = 'T';
  return fmt::format(R"({{"time":"{}Z","level":"{}","message":"{}"}})", time, name_of(level),
                     escaped(message));
}

}  // namespace

void set_form(Form wanted) {
  form = wanted;
  logger().set_pattern(wanted == Form::kJson ? "%v" : "%^%l%$: %v");
}

void set_level(Level level) {
  logger().set_level(spdlog_level(level));
}

Level level() {
  switch (logger().level()) {
    case spdlog::level::trace:
    case spdlog::level::debug:
      return Level::kDebug;
    case spdlog::level::info:
      return Level::kInfo;
    case spdlog::level::warn:
      return Level::kWarning;
    case spdlog::level::err:
      return Level::kError;
    default:
      return Level::kOff;
  }
}

void write(Level level, std::string_view message) {
  if (form == Form::kJson)
    logger().log(spdlog_level(level), "{}", json_line(level, message));
  else
    logger().log(spdlog_level(level), "{}", text_lines(message));
}

}  // namespace engram::log
