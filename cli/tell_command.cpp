// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/speech_options.h"
#include "speech/telling/tell_period.h"

namespace engram::cli {

namespace {

constexpr const char* kTellFooter =
    R"(Tells in a few sentences what the robot did: first the whole time, then each plan with what became
of it, and below it what failed or was stopped, each with links to the snapshots that it was read
from. Where there is too much, failures come before what went well, and the rest is counted.
TIME of --since and --until: yesterday, today/morning, 3_days_ago, monday, 2026-01-02, 08:05,
yesterday/08:05:12, now-10m, or what --now takes. Days and clock times are UTC, or those of TZ where
that is set.

Examples:
  engram tell kitchen.engram
  engram tell kitchen.engram --since yesterday
  engram tell kitchen.engram --since 2026-01-01/08:00 --until 2026-01-01/12:00 --sentences 5
  engram tell kitchen.engram --since yesterday --json)";

struct TellArguments {
  SpeechArguments memory;
  std::string since = "today";
  std::string until = "now";
  size_t sentences = 10;
  bool is_json = false;
};

std::string narration_text(const std::vector<speech::NarrationSentence>& narration) {
  std::string text;
  for (const speech::NarrationSentence& told : narration) {
    const std::string indent(2 * static_cast<size_t>(told.level), ' ');
    text += fmt::format("{}{}\n", indent, told.text);
    for (const ltm::MemoryId& id : told.links)
      text += fmt::format("{}    {}\n", indent, id.printable());
  }
  if (text.empty()) return "I remember nothing of that time.";
  text.pop_back();
  return text;
}

Json narration_json(const std::vector<speech::NarrationSentence>& narration,
                    speech::Period period) {
  Json sentences = Json::array();
  for (const speech::NarrationSentence& told : narration) {
    Json links = Json::array();
    for (const ltm::MemoryId& id : told.links) links.push_back(id.to_string());
    sentences.push_back(
        {{"level", speech::name_of(told.level)}, {"text", told.text}, {"links", links}});
  }
  return {{"from", to_string(period.from)}, {"to", to_string(period.to)}, {"sentences", sentences}};
}

Status tell(const TellArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const std::unique_ptr<Memory> memory, open_to_ask(arguments.memory));
  ENGRAM_ASSIGN_OR_RETURN(const std::unique_ptr<speech::KnownFacts> facts,
                          speech::KnownFacts::read(*memory));
  ENGRAM_ASSIGN_OR_RETURN(const Time now, now_of(arguments.memory, *facts));
  ENGRAM_ASSIGN_OR_RETURN(const speech::Period since,
                          speech::resolve_period(arguments.since, now, day_zone()));
  ENGRAM_ASSIGN_OR_RETURN(const speech::Period until,
                          speech::resolve_period(arguments.until, now, day_zone()));
  if (until.to < since.from)
    return invalid_argument("--until {} is before --since {}", to_string(until.to),
                            to_string(since.from));
  const speech::Period period{since.from, until.to};
  ENGRAM_ASSIGN_OR_RETURN(const auto narration, speech::tell_period(*facts, period, now, day_zone(),
                                                                    arguments.sentences));
  if (arguments.is_json)
    print_json(narration_json(narration, period));
  else
    print(narration_text(narration));
  return {};
}

ExitCode run(const TellArguments& arguments) {
  if (const Status named = check_source(arguments.memory.store, arguments.memory.remote);
      !named.ok())
    return wrong_usage(named);
  for (const std::string& time : {arguments.since, arguments.until})
    if (const auto period = speech::resolve_period(time, Time{}, speech::DayZone::kUtc);
        !period.ok())
      return wrong_usage(period.status());
  return done_or_failed(tell(arguments));
}

}  // namespace

void add_tell_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<TellArguments>();
  CLI::App* command = app.add_subcommand("tell", "Tell what the robot did in a few sentences");
  command->footer(kTellFooter);
  command->add_option("store", arguments->memory.store, "Store; none where a server is asked");
  command->add_option("--since", arguments->since, "From when on")->capture_default_str();
  command->add_option("--until", arguments->until, "Until when")->capture_default_str();
  command->add_option("--sentences", arguments->sentences, "At most so many sentences")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add_speech_options(*command, arguments->memory);
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
