// SPDX-License-Identifier: Apache-2.0
#include "cli/kitchen_drivers.h"

#include <memory>

#include "cli/interrupt.h"
#include "cli/kitchen_skill_driver.h"
#include "cli/remote.h"
#include "cli/server_commands.h"
#include "datasets/kitchen/drivers.h"
#include "server/kitchen/body_client.h"

namespace engram::cli {

namespace {

namespace kitchen = datasets::kitchen;

struct DriverArguments {
  std::string name;
  std::string bus;
  RemoteArguments remote;
};

/// The memory of a driver, which connects when it is first used: a robot may be switched on before
/// its memory.
class DriverMemory {
 public:
  explicit DriverMemory(const RemoteArguments& remote) : remote_(remote) {}

  Status commit(const ltm::Commit& commit) {
    ENGRAM_RETURN_IF_ERROR(connect());
    return memory_->commit(commit);
  }

  Status declare_types() {
    ENGRAM_RETURN_IF_ERROR(connect());
    for (const auto& [segment, type] : datasets::kitchen_types())
      ENGRAM_RETURN_IF_ERROR(memory_->declare(segment, type));
    return {};
  }

 private:
  Status connect() {
    if (memory_) return {};
    ENGRAM_ASSIGN_OR_RETURN(memory_, connect_memory(remote_));
    return {};
  }

  const RemoteArguments& remote_;
  std::unique_ptr<Memory> memory_;
};

ExitCode run_driver(DriverArguments arguments) {
  // A short time, after which what is sensed meanwhile is lost.
  arguments.remote.timeout = "1s";
  const auto endpoint = server::Endpoint::parse(arguments.bus);
  if (!endpoint.ok()) return wrong_usage(endpoint.status());
  const auto body = server::connect_body(*endpoint, arguments.name);
  if (!body.ok()) return wrong_usage(body.status());
  DriverMemory memory(arguments.remote);
  const kitchen::DriverOptions options{
      .commit = [&memory](const ltm::Commit& commit) { return memory.commit(commit); },
      .declare = [&memory] { return memory.declare_types(); },
      .say =
          [](const std::string& words) {
            print_now(Json({{"says", words}}).dump());
          },
      .tell =
          [](const auto& figures) {
            print_now(Json({{"figures", figures}}).dump());
          }};
  const std::stop_token stop = interrupt_token();
  if (arguments.name == "skills") {
    // What runs is stopped, and the server told that it is gone.
    finish_after_interrupt();
    return done_or_failed(provide_kitchen_skills(*endpoint, arguments.remote, options.say, stop));
  }
  return done_or_failed(arguments.name == "camera" ? kitchen::drive_camera(**body, options, stop)
                                                   : kitchen::drive_state(**body, options, stop));
}

}  // namespace

void add_kitchen_driver_command(CLI::App& simulate, ExitCode& exit_code) {
  const auto arguments = std::make_shared<DriverArguments>();
  CLI::App* command = simulate.add_subcommand(kDriverCommand, "Run a driver of a live kitchen");
  command->group("");  // Only 'engram simulate kitchen --live' starts it.
  command->add_option("name", arguments->name, "camera, state or skills")
      ->check(CLI::IsMember({"camera", "state", "skills"}))
      ->required();
  command->add_option("--bus", arguments->bus, "Endpoint of the body")->required();
  add_remote_options(*command, arguments->remote);
  command->callback([arguments, &exit_code] { exit_code = run_driver(*arguments); });
}

}  // namespace engram::cli
