// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"

#include <cstdio>

#include "ltm/core/log.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::cli {

namespace {

/// CLI11 takes an empty text for "valid".
std::string problem(const Status& status) { return status.ok() ? "" : status.message(); }

}  // namespace

ExitCode fail(const Status& status) {
  log::write(log::Level::kError, status.message());
  return ExitCode::kFailed;
}

ExitCode wrong_usage(const Status& status) {
  log::write(log::Level::kError, status.message());
  return ExitCode::kWrongUsage;
}

void print(const std::string& text) { fmt::print("{}\n", text); }

void print_json(const Json& json) { print(json.dump(2)); }

CLI::Validator duration_text() {
  return {[](const std::string& text) { return problem(parse_duration(text).status()); }, "DURATION"};
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
