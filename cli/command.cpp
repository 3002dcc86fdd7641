// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>

#include "cli/old_words.h"
#include "ltm/core/log.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::cli {

namespace {

/// CLI11 treats an empty text as valid.
std::string problem(const Status& status) {
  return status.ok() ? "" : status.message();
}

}  // namespace

CLI::Validator old_value(const std::string& old, const std::string& now) {
  return {[old, now](std::string& value) {
            if (value != old) return std::string();
            log::warning("{}", is_now(old, now));
            value = now;
            return std::string();
          },
          ""};
}

ExitCode run_command(CLI::App& app, int argc, char** argv, const ExitCode& exit_code) {
  try {
    const std::vector<std::string> given(argv + std::min(argc, 1), argv + argc);
    auto [arguments, old] = with_todays_words(given);
    for (const std::string& told : old) log::warning("{}", told);
    std::ranges::reverse(arguments);  // CLI11 takes the arguments in reverse order.
    app.parse(std::move(arguments));
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ExitCode::kDone : ExitCode::kWrongUsage;
  }
  return exit_code;
}

std::vector<std::string> arguments_of(const CLI::App& command,
                                      const std::vector<std::string>& but) {
  std::vector<std::string> arguments;
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || std::ranges::find(but, name) != but.end()) continue;
    if (option->get_expected_max() == 0) {
      arguments.push_back(name);
      continue;
    }
    const bool is_positional = !name.starts_with("-");
    for (const std::string& value : option->results())
      arguments.push_back(is_positional ? value : name + "=" + value);
  }
  return arguments;
}

int exit_code_of(const std::function<ExitCode()>& program) {
  try {
    return static_cast<int>(program());
  } catch (const std::bad_alloc&) {
    log::write(log::Level::kError, "out of memory");
  } catch (const std::exception& error) {
    log::write(log::Level::kError, error.what());
  }
  return static_cast<int>(ExitCode::kFailed);
}

ExitCode fail(const Status& status) {
  log::write(log::Level::kError, status.message());
  return ExitCode::kFailed;
}

ExitCode done_or_failed(const Status& status) {
  return status.ok() ? ExitCode::kDone : fail(status);
}

ExitCode wrong_usage(const Status& status) {
  log::write(log::Level::kError, status.message());
  return ExitCode::kWrongUsage;
}

CLI::Validator duration_text() {
  return {[](const std::string& text) { return problem(parse_duration(text).status()); },
          "DURATION"};
}

CLI::Validator time_text() {
  return {[](const std::string& text) { return problem(parse_time(text).status()); }, "TIME"};
}

CLI::Validator entity_text() {
  return {[](const std::string& text) -> std::string {
            const auto id = ltm::MemoryId::parse(text);
            if (!id.ok()) return id.status().message();
            if (id->is_entity()) return "";
            return "'" + text + "' is no entity: needs four names, Memory/Core/Provider/Entity";
          },
          "ENTITY"};
}

}  // namespace engram::cli
