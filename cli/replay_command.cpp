// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include "cli/interrupt.h"
#include "cli/remote.h"
#include "cli/replay_keys.h"
#include "cli/served_text.h"
#include "cli/server_commands.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "ltm/idf/json.h"
#include "memory/model_loader.h"
#include "memory/replay_control.h"
#include "reports/plain/text.h"
#include "server/robot/replayed_robot.h"
#include "server/robot/robot.h"

namespace engram::cli {

namespace {

constexpr const char* kReplayFooter =
    R"(Serves a store as the memory that it was: 'latest' is the last before the replayed moment, who watches
is told what came, in the recorded order, and '+200ms' predicts although the future is known. What
programs commit is there until the replay ends; nothing is written to the store. The entity
SystemState/Replay/engram/clock says that this is a replay. With --config the servers of a
robot.yaml, on one clock.

Keys in its terminal: space pauses and goes on, the arrows seek 5 s back and forth, + and - double and
halve the speed, q ends it.

With --server a replay that runs is told what to do:
  play, pause, status
  step                   to the next commit that was recorded, and pause
  seek TIME
  speed X                replayed seconds per second, 0.001 to 1000
  loop TIME..TIME        repeat a part; 'loop off' ends it

Examples:
  engram replay robot.engram --at '2022-02-18 13:06:56'
  engram replay robot.engram --speed 2 --paused --listen unix:/run/replay.sock
  engram replay --config robot.yaml --at '2022-02-18 13:06:56' --loop '2022-02-18 13:06..2022-02-18 13:07'
  engram replay --server unix:/run/replay.sock seek '2022-02-18 13:07:10'
  engram replay --server unix:/run/replay.sock step)";

struct ReplayArguments {
  std::vector<std::string> words;
  RemoteArguments remote;
  std::string config;
  std::string at;
  double speed = 1;
  bool is_paused = false;
  std::string loop;
  std::vector<std::string> listen;
  std::string name = "engram";
  bool is_json = false;
  std::vector<std::string> starting;  ///< The options that were given and say how a replay begins.
};

Result<ReplayLoop> loop_of(const std::string& text) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Selector selector, ltm::parse_selector(text));
  const auto* range = std::get_if<ltm::select::TimeRange>(&selector);
  if (range == nullptr) return invalid_argument("found the loop '{}', needs TIME..TIME", text);
  return ReplayLoop{range->first, range->last};
}

Result<ReplayOptions> options_of(const ReplayArguments& arguments) {
  ReplayOptions options{.speed = arguments.speed, .is_paused = arguments.is_paused};
  if (!arguments.at.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.at, parse_time(arguments.at));
  }
  if (!arguments.loop.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.loop, loop_of(arguments.loop));
  }
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return options;
}

Result<server::RobotConfig> config_of(const ReplayArguments& arguments) {
  if (!arguments.config.empty()) return server::read_robot_config(arguments.config);
  std::string text = "servers:\n  - name: " + quoted_yaml(arguments.name) +
                     "\n    store: " + quoted_yaml(arguments.words.front()) + "\n";
  if (!arguments.listen.empty()) text += "    listen: " + quoted_yaml(arguments.listen) + "\n";
  return server::parse_robot_config(text, "arguments", "");
}

/// Until a key or a signal ends it.
void wait_for_keys(memory::Replay& replay) {
  log::info(
      "keys: space pauses and goes on, the arrows seek 5 s back and forth, + and - change the "
      "speed, q ends");
  if (!control_by_keys(STDIN_FILENO, replay, interrupt_token(),
                       [](const std::string& done) { log::info("{}", done); }))
    wait_for_the_end();
}

ExitCode serve_replay(const ReplayArguments& arguments) {
  const auto options = options_of(arguments);
  if (!options.ok()) return wrong_usage(options.status());
  auto config = config_of(arguments);
  if (!config.ok()) return wrong_usage(config.status());
  finish_after_interrupt();
  const auto replay = server::replay_robot(*config, model_loader(), *options);
  if (!replay.ok()) return fail(replay.status());
  server::Robot::Options serving;
  serving.loader = model_loader();
  auto robot = server::Robot::start(*config, std::move(serving));
  if (!robot.ok()) return fail(robot.status());
  tell_served(**robot, arguments.is_json);
  const ReplayState state = (*replay)->state();
  log::info("replays {}: {}", fmt::join(state.stores, ", "), state_text(state));
  if (has_keys(STDIN_FILENO))
    wait_for_keys(**replay);
  else
    wait_for_the_end();
  (*robot)->stop();
  return ExitCode::kDone;
}

/// The value that tells a replay this.
Result<idf::Dict> told_by(const std::vector<std::string>& words) {
  const std::string& word = words.front();
  const bool has_value = word == "seek" || word == "speed" || word == "loop";
  if (words.size() != (has_value ? 2u : 1u))
    return invalid_argument("found {} words after '{}', needs {}", words.size() - 1, word,
                            has_value ? 1 : 0);
  idf::Dict told{{"command", word}};
  if (word == "seek") told.set("time", words[1]);
  if (word == "speed") {
    char* end = nullptr;
    told.set("speed", std::strtod(words[1].c_str(), &end));
    if (end == words[1].c_str() || *end != '\0')
      return invalid_argument("found the speed '{}', needs a number", words[1]);
  }
  if (word == "loop" && words[1] != "off") {
    ENGRAM_ASSIGN_OR_RETURN(const ReplayLoop loop, loop_of(words[1]));
    told.set("first", to_ns(loop.first));
    told.set("last", to_ns(loop.last));
  }
  return told;
}

/// Nothing for 'status'.
Result<std::optional<ReplayCommand>> command_of(const std::vector<std::string>& words) {
  ENGRAM_ASSIGN_OR_RETURN(const idf::Dict told, told_by(words));
  if (words.front() == "status") return std::optional<ReplayCommand>();
  ENGRAM_ASSIGN_OR_RETURN(const ReplayCommand command, ReplayCommand::from_data(told));
  return std::optional(command);
}

ExitCode control(const ReplayArguments& arguments) {
  const auto command = command_of(arguments.words);
  if (!command.ok()) return wrong_usage(command.status());
  const auto memory = connect_memory(arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  if (*command)
    if (const Status done = control_replay(**memory, **command); !done.ok()) return fail(done);
  const auto state = replay_state(**memory);
  if (!state.ok()) return fail(state.status());
  if (!arguments.is_json) {
    print(state_text(*state));
    return ExitCode::kDone;
  }
  const auto json = idf::to_json(state->to_data());
  if (!json.ok()) return fail(json.status());
  print_json(*json);
  return ExitCode::kDone;
}

ExitCode run(const ReplayArguments& arguments) {
  const bool is_control = !arguments.remote.server.empty() || !arguments.remote.names.empty();
  if (is_control) {
    if (arguments.words.empty())
      return wrong_usage(invalid_argument("needs what the replay is to do, such as 'pause'"));
    if (!arguments.starting.empty())
      return wrong_usage(invalid_argument(
          "found {} beside {}: says how a replay begins, and the one there runs already; needs a "
          "command such as 'seek', 'speed' or 'loop'",
          fmt::join(arguments.starting, ", "),
          arguments.remote.server.empty() ? "--names" : "--server"));
    return control(arguments);
  }
  if (arguments.words.size() + (arguments.config.empty() ? 0 : 1) != 1)
    return wrong_usage(invalid_argument("needs a store, or --config robot.yaml, or --server"));
  if (!arguments.config.empty() && !arguments.listen.empty())
    return wrong_usage(invalid_argument("found --listen beside --config, needs it in that file"));
  return serve_replay(arguments);
}

}  // namespace

void add_replay_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ReplayArguments>();
  CLI::App* command = app.add_subcommand("replay", "Serve a store as the memory that it was");
  command->footer(kReplayFooter);
  command->add_option("words", arguments->words, "Store; with --server what the replay is to do");
  const std::vector<CLI::Option*> starting{
      command->add_option("--config", arguments->config, "robot.yaml, whose servers are replayed"),
      command->add_option("--at", arguments->at,
                          "Moment to begin with; else that of the first snapshot"),
      command->add_option("--speed", arguments->speed, "Replayed seconds per second")
          ->capture_default_str(),
      command->add_flag("--paused", arguments->is_paused, "Stand still at first"),
      command->add_option("--loop", arguments->loop, "TIME..TIME: repeat this part"),
      command
          ->add_option("--listen", arguments->listen,
                       "Endpoint, as of serve, may be said several times; else a socket of this "
                       "user")
          ->allow_extra_args(false),
      command->add_option("--name", arguments->name, "Of the server")->capture_default_str()};
  command->add_flag("--json", arguments->is_json, "Tell as JSON");
  add_remote_options(*command, arguments->remote);
  command->callback([arguments, starting, &exit_code] {
    for (const CLI::Option* option : starting)
      if (option->count() > 0) arguments->starting.push_back(option->get_name());
    exit_code = run(*arguments);
  });
}

}  // namespace engram::cli
