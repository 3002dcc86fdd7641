// SPDX-License-Identifier: Apache-2.0
#include "cli/served_text.h"

#include "cli/interrupt.h"
#include "cli/remote.h"
#include "cli/server_commands.h"
#include "ltm/core/mutex.h"
#include "ltm/core/printable.h"

namespace engram::cli {

using server::Robot;

namespace {

Json served_json(const Robot& robot) {
  Json servers = Json::array();
  for (const Robot::ServerSummary& served : robot.servers())
    servers.push_back({{"server", served.name},
                       {"memories", served.memories},
                       {"endpoints", served.endpoints},
                       {"store", served.store.string()}});
  return {{"servers", std::move(servers)}, {"names", robot.names()}};
}

}  // namespace

std::string quoted_yaml(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "''" : std::string(1, c);
  return out + "'";
}

std::string quoted_yaml(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += (out.empty() ? "" : ", ") + quoted_yaml(text);
  return "[" + out + "]";
}

void tell_served(const Robot& robot, bool is_json) {
  if (is_json) {
    print_now(printable_json(served_json(robot).dump()));
    return;
  }
  if (!robot.names().empty())
    print_now(fmt::format("Name system listens at {}", fmt::join(robot.names(), ", ")));
  for (const Robot::ServerSummary& served : robot.servers())
    print_now(fmt::format(
        "Server {} listens at {}: {}, {}", served.name, fmt::join(served.endpoints, ", "),
        memories_text(served.memories),
        served.store.empty() ? "no store" : fmt::format("store {}", served.store.string())));
}

void wait_for_the_end() {
  Mutex mutex;  // `wake` needs a mutex; this one guards nothing.
  StoppableCondition wake;
  const MutexLock lock(mutex);
  wake.wait(mutex, interrupt_token(), [] { return false; });
}

}  // namespace engram::cli
