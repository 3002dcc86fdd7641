// SPDX-License-Identifier: Apache-2.0

#include "cli/interrupt.h"
#include "cli/learning_module.h"
#include "cli/remote.h"
#include "cli/served_text.h"
#include "cli/server_commands.h"
#include "ltm/core/log.h"
#include "ltm/core/mutex.h"
#include "ltm/core/printable.h"
#include "memory/model_loader.h"
#include "reports/plain/text.h"
#include "server/robot/robot.h"

namespace engram::cli {

using server::Endpoint;
using server::Robot;
using server::RobotConfig;

namespace {

constexpr const char* kServeFooter =
    R"(Serves what a store holds, and what comes, until Ctrl-C or SIGTERM; then everything that is in
memory goes to the store. A second Ctrl-C ends it at once. What is served, where, and with which
limits, is that of robot.yaml (docs/server.md), or of one server of all memories.

Examples:
  engram serve robot.engram
  engram serve robot.engram --listen 127.0.0.1:50051 --durability journal
  engram serve robot.engram --prior prior --bytes 2GiB --mode everything
  engram serve --config robot.yaml --log json
Then, elsewhere:
  engram commit Objects/Things/kitchen/cup --data '{"height": 0.11}'
  engram query 'Objects @ latest'
  engram info)";

constexpr const char* kMnsFooter =
    R"(Tells which server has which memory, until Ctrl-C or SIGTERM. Servers of other processes find it
with 'names: {at: ENDPOINT}' in their robot.yaml, programs and commands with --names ENDPOINT.

Examples:
  engram mns --listen unix:/run/engram/names.sock
  engram mns --listen 0.0.0.0:50050 --certificate server.pem --key server.key --tokens tokens.yaml
  engram info --names unix:/run/engram/names.sock)";

struct ServeArguments {
  std::string store;
  std::string config;
  std::vector<std::string> listen;
  std::vector<std::string> memories;
  std::string name = "engram";
  std::string mode = "what-leaves";
  std::string durability = "memory";
  std::string bytes;
  std::string recording;
  std::string preset;
  std::string prior;
  server::ListenPolicy::Options security;
  std::filesystem::path audit;
  bool has_no_system_state = false;
  bool is_json = false;
};

std::string security_yaml(const server::ListenPolicy::Options& security,
                          const std::filesystem::path& audit) {
  std::string text;
  const auto add = [&text](const char* key, const std::filesystem::path& value) {
    if (!value.empty()) text += fmt::format("  {}: {}\n", key, quoted_yaml(value.string()));
  };
  add("certificate", security.certificate);
  add("key", security.key);
  add("client_ca", security.client_ca);
  add("tokens", security.tokens);
  add("audit", audit);
  return text.empty() ? "" : "security:\n" + text;
}

/// Returns the arguments as the text of a robot.yaml, so that both are checked by the same parser.
std::string yaml_of(const ServeArguments& arguments) {
  std::string text = security_yaml(arguments.security, arguments.audit);
  if (arguments.has_no_system_state) text += "system_state: false\n";
  text += "servers:\n  - name: " + quoted_yaml(arguments.name) + "\n";
  const auto add = [&text](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("    {}: {}\n", key, quoted_yaml(value));
  };
  add("store", arguments.store);
  add("mode", arguments.mode);
  add("durability", arguments.durability);
  add("recording", arguments.recording);
  add("preset", arguments.preset);
  add("prior", arguments.prior);
  if (!arguments.bytes.empty())
    text += fmt::format("    working_memory: {{bytes: {}}}\n", quoted_yaml(arguments.bytes));
  if (!arguments.listen.empty()) text += "    listen: " + quoted_yaml(arguments.listen) + "\n";
  if (!arguments.memories.empty())
    text += "    memories: " + quoted_yaml(arguments.memories) + "\n";
  return text;
}

/// Logs how a server stopped. Returns false if data is lost.
bool tell_ended(const Robot::StoppedServer& ended) {
  const ltm::MemoryCounters& memory = ended.counters.memory;
  log::info("server '{}' stopped: {} snapshots came{}, the store was given {}", ended.server,
            reports::count_text(memory.committed),
            memory.superseded > 0 ? fmt::format(", {} of them in place of others",
                                                reports::count_text(memory.superseded))
                                  : "",
            reports::count_text(memory.stored));
  if (memory.dropped > 0)
    log::warning("server '{}': {} snapshots left memory and were not stored, as its mode says",
                 ended.server, reports::count_text(memory.dropped));
  if (!ended.status.ok()) log::warning("server '{}': {}", ended.server, ended.status.message());
  return ended.status.ok();
}

ExitCode run_robot(const RobotConfig& config, bool is_json) {
  finish_after_interrupt();
  Robot::Options options;
  options.loader = model_loader();
  options.erasing = {code_anew, ready_for_models};
  auto robot = Robot::start(config, std::move(options));
  if (!robot.ok()) return fail(robot.status());
  tell_served(**robot, is_json);
  wait_for_the_end();
  log::info("stopping");
  bool is_whole = true;
  for (const Robot::StoppedServer& ended : (*robot)->stop())
    is_whole = tell_ended(ended) && is_whole;
  return is_whole ? ExitCode::kDone : ExitCode::kDoneWithLoss;
}

ExitCode serve(const ServeArguments& arguments) {
  if (arguments.config.empty() && arguments.store.empty())
    return wrong_usage(invalid_argument("needs a store, or --config robot.yaml"));
  const auto config = arguments.config.empty()
                          ? server::parse_robot_config(yaml_of(arguments), "arguments", "")
                          : server::read_robot_config(arguments.config);
  if (!config.ok()) return wrong_usage(config.status());
  return run_robot(*config, arguments.is_json);
}

ExitCode serve_names(const ServeArguments& arguments) {
  const auto config =
      server::parse_robot_config(security_yaml(arguments.security, "") +
                                     "names: {listen: " + quoted_yaml(arguments.listen) + "}",
                                 "arguments", "");
  if (!config.ok()) return wrong_usage(config.status());
  return run_robot(*config, arguments.is_json);
}

void add_log_option(CLI::App& command) {
  command
      .add_option_function<std::string>(
          "--log",
          [](const std::string& form) {
            log::set_form(form == "json" ? log::Form::kJson : log::Form::kText);
          },
          "Form of messages on stderr: text, or a line of JSON each")
      ->check(CLI::IsMember({"text", "json"}));
}

void add_security_options(CLI::App& command, server::ListenPolicy::Options& security) {
  const auto add = [&command](const char* name, std::filesystem::path& file, const char* help) {
    command.add_option(name, file, help)->group("Needed to listen to the network (docs/access.md)");
  };
  add("--certificate", security.certificate, "PEM file");
  add("--key", security.key, "PEM file of the certificate's key");
  add("--client-ca", security.client_ca, "PEM file: who vouches for clients");
  add("--tokens", security.tokens, "Who may do what (YAML)");
}

/// Returns an option that was given although robot.yaml already sets it.
std::string said_twice(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (option->count() > 0 && name != "--config" && name != "--log" && name != "--json")
      return name;
  }
  return "";
}

}  // namespace

void add_serve_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ServeArguments>();
  CLI::App* command = app.add_subcommand("serve", "Serve a store to programs, until it is stopped");
  command->footer(kServeFooter);
  command->add_option("store", arguments->store, "Store; made where there is none");
  command->add_option("--config", arguments->config,
                      "robot.yaml: one or several servers, in place of all that is said here");
  const auto add = [command](const char* name, auto& value, const char* help) {
    return command->add_option(name, value, help);
  };
  add("--listen", arguments->listen,
      "Endpoint: HOST:PORT (port 0: any) or unix:PATH, may be said several times; else a socket of "
      "this user")
      ->allow_extra_args(false);
  add("--memory", arguments->memories,
      "Name of a memory that it takes, may be said several times; else any")
      ->allow_extra_args(false);
  add("--name", arguments->name, "Of the server")->capture_default_str();
  add("--mode", arguments->mode, "What the store gets")
      ->check(CLI::IsMember({"what-leaves", "everything", "latest"}))
      ->capture_default_str();
  add("--durability", arguments->durability,
      "When commits count as done that do not say: in memory, or when they survive kill -9")
      ->check(CLI::IsMember({"memory", "journal"}))
      ->capture_default_str();
  add("--bytes", arguments->bytes, "Max size of working memory, such as 2GiB; by default 512MiB");
  add("--recording", arguments->recording, "Filters and codecs (docs/recording.md)");
  add("--preset", arguments->preset, "The same, by name: recorder, balanced, small");
  add("--prior", arguments->prior, "Directory of prior knowledge (docs/prior.md)");
  command->add_flag("--no-system-state", arguments->has_no_system_state,
                    "Do not note how busy the machine is");
  add_security_options(*command, arguments->security);
  add("--audit", arguments->audit,
      "Log of who asked what, which 'engram audit create' makes (docs/access.md)");
  add_log_option(*command);
  command->add_flag("--json", arguments->is_json, "Tell as JSON where it listens");
  command->callback([arguments, command, &exit_code] {
    const std::string twice = arguments->config.empty() ? "" : said_twice(*command);
    exit_code = twice.empty() ? serve(*arguments)
                              : wrong_usage(invalid_argument(
                                    "found {} beside --config, needs it in that file", twice));
  });
}

void add_mns_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ServeArguments>();
  CLI::App* command = app.add_subcommand("mns", "Run a Memory Name System, until it is stopped");
  command->footer(kMnsFooter);
  command
      ->add_option("--listen", arguments->listen,
                   "Endpoint: HOST:PORT or unix:PATH, may be said several times")
      ->allow_extra_args(false)
      ->required();
  add_security_options(*command, arguments->security);
  add_log_option(*command);
  command->add_flag("--json", arguments->is_json, "Tell as JSON where it listens");
  command->callback([arguments, &exit_code] { exit_code = serve_names(*arguments); });
}

}  // namespace engram::cli
