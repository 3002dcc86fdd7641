// SPDX-License-Identifier: Apache-2.0
#include "cli/live_kitchen.h"

#include <array>
#include <map>
#include <utility>

#include "cli/driver_processes.h"
#include "cli/interrupt.h"
#include "cli/kitchen_drivers.h"
#include "cli/server_commands.h"
#include "datasets/kitchen/live_body.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "server/access/default_endpoint.h"
#include "server/kitchen/body_client.h"
#include "server/kitchen/body_rpc.h"

namespace engram::cli {

namespace {

using datasets::kitchen::LiveBody;
using server::Endpoint;

constexpr const char* kPokeFooter = R"(Examples:
  engram simulate poke 'chair to 1.0,0.2'       its middle, in m
  engram simulate poke 'person to -0.6,-1,90'   with a heading in degrees
  engram simulate poke 'person away'
  engram simulate poke 'salt to table'

Moves something by hand in the live kitchen that 'engram simulate kitchen --live' runs
(docs/kitchen.md, section "Live").)";

Result<Endpoint> bus_endpoint(const std::string& text) {
  if (text.empty()) return server::default_endpoint("kitchen");
  ENGRAM_ASSIGN_OR_RETURN(Endpoint endpoint, Endpoint::parse(text));
  if (endpoint.kind() == Endpoint::Kind::kUnix) return endpoint;
  return invalid_argument("--bus '{}': needs a Unix socket, as in unix:/run/kitchen.sock", text);
}

/// Shows what happens, in words or as a line of JSON each.
class LiveLog {
 public:
  explicit LiveLog(bool is_json) : is_json_(is_json) {}

  void started(const LiveBody& body, const std::string& bus, double speed) const {
    const auto& about = body.describe();
    if (is_json_)
      return print_now(Json({{"event", "started"},
                             {"bus", bus},
                             {"seed", about.seed},
                             {"width", about.width},
                             {"height", about.height},
                             {"is_stepped", about.is_stepped},
                             {"speed", speed}})
                           .dump());
    print_now(fmt::format(
        "The kitchen of seed {} lives: images of {} x {}, {}; 'engram simulate poke' moves "
        "things; Ctrl-C ends it",
        about.seed, about.width, about.height,
        about.is_stepped ? "in steps" : fmt::format("at speed {:g}", speed)));
  }

  /// A line of a driver: see kitchen_drivers.h.
  void driver_line(const std::string& driver, const std::string& line) {
    Json told = Json::parse(line, nullptr, false);
    if (!told.is_object()) return;
    if (told.contains("figures") && told["figures"].is_object()) {
      add_former(former_[driver], told["figures"]);
      figures_[driver] = told["figures"];
    }
    if (is_json_) {
      told["driver"] = driver;
      print_now(told.dump());
    } else if (told.contains("says") && told["says"].is_string()) {
      log::warning("{} driver: {}", driver, printable(told["says"].get<std::string>()));
    }
  }

  void driver_ended(const std::string& driver, int exit_code, Duration again) {
    // The next one counts from the beginning.
    former_[driver] = figures_[driver];
    if (is_json_)
      return print_now(
          Json({{"event", "driver ended"}, {"driver", driver}, {"exit_code", exit_code}}).dump());
    log::warning("{} driver: ended ({}); it is started again in {}", driver,
                 exit_code > 128 ? fmt::format("signal {}", exit_code - 128)
                                 : fmt::format("exit code {}", exit_code),
                 to_string(again));
  }

  /// Says when the machine is too slow for the body, not more than once a minute.
  void looked(const LiveBody::Counters& counters) {
    constexpr double kFarBehind_s = 1;
    constexpr std::chrono::minutes kBetween{1};
    if (counters.behind_s < kFarBehind_s || steady_now() < next_word_) return;
    next_word_ = steady_now() + kBetween;
    if (is_json_)
      return print_now(Json({{"event", "behind"}, {"seconds", counters.behind_s}}).dump());
    log::warning("the kitchen is {:.1f} s behind its clock; needs a lower --speed, or fewer pixels",
                 counters.behind_s);
  }

  void ended(const LiveBody::Counters& counters) const {
    // The first sample is that of the beginning.
    const double seconds =
        (static_cast<double>(counters.samples) - 1) / datasets::kitchen::RobotBus::kRate_hz;
    if (is_json_)
      return print_now(Json({{"event", "ended"},
                             {"seconds", seconds},
                             {"pictures", counters.pictures},
                             {"figures", figures_}})
                           .dump());
    const auto figure = [this](const char* driver, const char* name) {
      const auto found = figures_.find(driver);
      return found == figures_.end() ? 0.0 : found->second.value(name, 0.0);
    };
    print_now(fmt::format(
        "{:.1f} s: {:.0f} stereo images ({:.0f} of the 20 a second were not drawn in time, {:.0f} "
        "were lost), {:.0f} samples of the state ({:.0f} were lost)",
        seconds, figure("camera", "images"), figure("camera", "skipped"), figure("camera", "lost"),
        figure("state", "samples"), figure("state", "lost")));
  }

 private:
  /// Adds what the former drivers of a name counted. Lengths and rates are of the last one alone.
  static void add_former(const Json& former, Json& figures) {
    for (const char* count : {"images", "skipped", "samples", "lost", "away"})
      if (former.is_object() && former.contains(count) && former[count].is_number() &&
          (!figures.contains(count) || figures[count].is_number()))
        figures[count] = figures.value(count, 0.0) + former[count].get<double>();
  }

  bool is_json_;
  std::map<std::string, Json> figures_;
  std::map<std::string, Json> former_;  ///< Of the drivers of a name that have ended.
  SteadyTime next_word_{};
};

ExitCode poke(const std::string& what, const std::string& bus, bool is_json) {
  const auto endpoint = bus_endpoint(bus);
  if (!endpoint.ok()) return wrong_usage(endpoint.status());
  const auto body = server::connect_body(*endpoint, "poke");
  if (!body.ok()) return wrong_usage(body.status());
  const auto words = (*body)->poke(what);
  if (words.status().code() == StatusCode::kInvalidArgument) return wrong_usage(words.status());
  if (!words.ok()) return fail(words.status());
  if (is_json)
    print_now(Json({{"poked", what}, {"words", *words}}).dump());
  else
    print(*words);
  return ExitCode::kDone;
}

LiveBody::Options body_options(const datasets::KitchenOptions& options,
                               const LiveKitchenArguments& arguments) {
  LiveBody::Options body;
  body.kitchen = options;
  body.speed = arguments.speed;
  body.is_stepped = arguments.is_stepped;
  body.is_held = arguments.is_held;
  body.clients = {"state", "camera"};
  body.awaits_skills = arguments.is_stepped;
  body.seconds = arguments.seconds;
  if (!arguments.chair.empty()) body.pokes.push_back("chair to " + arguments.chair);
  if (!arguments.person.empty()) body.pokes.push_back("person to " + arguments.person);
  return body;
}

/// Reads what a live kitchen takes of the options of recordings.
Status read_given(const std::vector<uint64_t>& seeds, const CLI::App& given,
                  datasets::KitchenOptions& options, LiveKitchenArguments& arguments) {
  if (seeds.size() != 1) return invalid_argument("--live: found {} seeds, needs one", seeds.size());
  for (const char* batch : {"store", "--folder", "--plain", "--depth", "--no-images", "--colours",
                            "--jobs", "--preset", "--config", "--progress"})
    if (given.get_option(batch)->count() > 0)
      return invalid_argument(
          "found --live and {}, which is of recordings: a live kitchen commits to a server "
          "(--server)",
          batch);
  const bool is_timed = given.get_option("--seconds")->count() > 0;
  if (arguments.is_held && !arguments.is_stepped)
    return invalid_argument("--held: needs --stepped: a clock cannot be held");
  if (arguments.is_stepped && given.get_option("--speed")->count() > 0)
    return invalid_argument("found --stepped and --speed: it knows no clock that has a speed");
  if (arguments.is_stepped && !arguments.is_held && !(is_timed && options.seconds > 0))
    return invalid_argument(
        "--stepped: needs --seconds of more than 0, because it knows no clock, or --held");
  options.seed = seeds.front();
  if (is_timed) arguments.seconds = std::exchange(options.seconds, 1);
  return {};
}

constexpr std::array kServerOptions{"--server", "--names", "--token", "--ca"};

/// The words that run a driver of the body at `bus`.
std::vector<std::string> driver_words(const std::string& name, const Endpoint& bus,
                                      const CLI::App& given) {
  std::vector<std::string> words{"/proc/self/exe", "simulate", kDriverCommand, name,
                                 "--bus=" + bus.to_string()};
  for (const char* option : kServerOptions)
    for (const std::string& value : given.get_option(option)->results())
      words.push_back(option + ("=" + value));
  return words;
}

}  // namespace

void add_live_options(CLI::App& kitchen, LiveKitchenArguments& arguments) {
  constexpr const char* kGroup = "Live";
  kitchen
      .add_flag("--live", arguments.is_live,
                "Let it live beside a server until Ctrl-C: the robot's drivers are programs of "
                "their own")
      ->group(kGroup);
  kitchen.add_option("--speed", arguments.speed, "How much faster than the clock time passes")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str()
      ->group(kGroup);
  kitchen
      .add_flag("--stepped", arguments.is_stepped,
                "Time passes when all drivers are done: equal options, equal snapshots")
      ->group(kGroup);
  kitchen
      .add_flag("--held", arguments.is_held,
                "With --stepped: time passes only while the skill kitchen/pass runs")
      ->group(kGroup);
  kitchen.add_option("--chair", arguments.chair, "Where a chair stands: X,Y or X,Y,DEGREES")
      ->group(kGroup);
  kitchen.add_option("--person", arguments.person, "Where a person stands")->group(kGroup);
  kitchen
      .add_option("--bus", arguments.bus,
                  "Endpoint of the robot's body for its drivers: unix:PATH; else a socket of this "
                  "user")
      ->group(kGroup);
  kitchen.add_flag("--json", arguments.is_json, "A line of JSON for each thing that happens")
      ->group(kGroup);
  add_remote_options(kitchen, arguments.remote);
}

Status check_recorded(const CLI::App& given) {
  std::vector<std::string> live{"--speed",  "--stepped", "--held", "--chair",
                                "--person", "--bus",     "--json"};
  live.insert(live.end(), kServerOptions.begin(), kServerOptions.end());
  live.emplace_back("--timeout");
  for (const std::string& option : live)
    if (given.get_option(option)->count() > 0)
      return invalid_argument("found {} without --live: it is of a live kitchen", option);
  return {};
}

ExitCode run_live_kitchen(datasets::KitchenOptions options, LiveKitchenArguments arguments,
                          const std::vector<uint64_t>& seeds, const CLI::App& given) {
  if (const Status status = read_given(seeds, given, options, arguments); !status.ok())
    return wrong_usage(status);
  LiveBody::Options wanted = body_options(options, arguments);
  if (given.get_option("--start")->count() == 0 && !arguments.is_stepped)
    wanted.start = [] { return std::chrono::floor<std::chrono::milliseconds>(system_now()); };
  if (const Status status = wanted.validate(); !status.ok()) return wrong_usage(status);
  const auto endpoint = bus_endpoint(arguments.bus);
  if (!endpoint.ok()) return wrong_usage(endpoint.status());
  if (const Status status = server::prepare_folder(*endpoint); !status.ok()) return fail(status);
  // Ctrl-C is the usual way to end it, and drivers need a moment.
  finish_after_interrupt();
  auto body = LiveBody::start(wanted);
  if (body.status().code() == StatusCode::kInvalidArgument) return wrong_usage(body.status());
  if (!body.ok()) return fail(body.status());
  const auto bus = server::BodyServer::start(**body, *endpoint);
  if (!bus.ok()) return fail(bus.status());
  LiveLog log(arguments.is_json);
  log.started(**body, endpoint->to_string(), arguments.speed);

  std::vector<DriverProcess> drivers;
  for (const std::string& name : wanted.clients)
    drivers.push_back({name, driver_words(name, *endpoint, given), true});
  drivers.push_back({"skills", driver_words("skills", *endpoint, given)});
  // Where time may stand still, what runs would not see the stop.
  const std::stop_callback ends(interrupt_token(), [&] {
    if (wanted.is_stepped) (*body)->end();
  });
  const Status status = run_drivers(
      drivers,
      {.on_line = [&](const auto& driver, const auto& line) { log.driver_line(driver, line); },
       .on_end = [&](const auto& driver, int code,
                     Duration again) { log.driver_ended(driver, code, again); },
       .is_over = [&] { return (*body)->has_ended(); },
       .on_look = [&] { log.looked((*body)->counters()); }},
      interrupt_token());
  log.ended((*body)->counters());
  return done_or_failed(status);
}

void add_live_kitchen_commands(CLI::App& simulate, ExitCode& exit_code) {
  struct PokeArguments {
    std::string what;
    std::string bus;
    bool is_json = false;
  };
  const auto arguments = std::make_shared<PokeArguments>();
  CLI::App* command = simulate.add_subcommand("poke", "Move something by hand in a live kitchen");
  command->footer(kPokeFooter);
  command->add_option("what", arguments->what, "What goes where, in words")->required();
  command->add_option("--bus", arguments->bus,
                      "Endpoint of the body: unix:PATH; else the usual one");
  command->add_flag("--json", arguments->is_json, "Tell as JSON what happened");
  command->callback([arguments, &exit_code] {
    exit_code = poke(arguments->what, arguments->bus, arguments->is_json);
  });
  add_kitchen_driver_command(simulate, exit_code);
}

}  // namespace engram::cli
