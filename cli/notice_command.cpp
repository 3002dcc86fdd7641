// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "ltm/core/printable.h"
#include "memory/memory.h"
#include "speech/noticing/notice_deeds.h"
#include "speech/noticing/noticed_json.h"

namespace engram::cli {

namespace {

constexpr const char* kNoticeFooter =
    R"(Finds what the robot took and let go in the joints of its hands, for recordings in which nobody
told of it, such as those of LeRobot. A hand that closes and stays so for a second took something;
what it was is read from the task of the episode: "Pick up the yellow bottle on the table."
With --commit it is written into the store as executions of the provider 'noticed', each with links
to the joints that show it, and the store can be asked: "When did you grasp the bottle?" What was
committed before is not committed again, so a nightly job may run it each night.
Grippers, and fingers whose numbers never leave 0..1 and that no description of the robot names, are
taken for open where the numbers are large; other fingers for angles, which are large where they bend.
--open says it otherwise.

Examples:
  engram import --from g1 robot.engram
  engram notice robot.engram
  engram notice robot.engram --commit && engram ask robot.engram 'When did you grasp the bottle?'
  engram notice robot.engram --joints RobotState/Proprioception/robot/state --open low
  engram notice robot.engram --json | jq '.deeds[].thing')";

struct NoticeArguments {
  std::string store;
  std::string joints;
  std::string open = "auto";
  bool is_committed = false;
  bool is_json = false;
};

std::string deed_text(const speech::NoticedDeed& deed) {
  std::string text = fmt::format("{}  {:<7}  {}", to_string(*deed.close_ended.time()), deed.hand,
                                 deed.thing.empty() ? "something" : printable(deed.thing));
  if (!deed.place.empty()) text += ", " + printable(deed.place);
  if (deed.open_began)
    text += fmt::format("; let go after {:.1f} s",
                        to_seconds(*deed.open_began->time() - *deed.close_ended.time()));
  return text;
}

Status notice(const NoticeArguments& arguments) {
  speech::NoticeOptions options;
  ENGRAM_ASSIGN_OR_RETURN(options.open, speech::open_hand_named(arguments.open));
  if (!arguments.joints.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.joints, ltm::MemoryId::parse(arguments.joints));
  }
  OpenOptions opened;
  opened.is_read_only = !arguments.is_committed;
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, Memory::open(arguments.store, opened));
  ProgressLine progress;
  auto found = speech::notice_deeds(*memory, options, progress.sink(), interrupt_token());
  progress.finish();
  ENGRAM_RETURN_IF_ERROR(found.status());
  size_t committed = 0;
  if (arguments.is_committed) {
    ENGRAM_ASSIGN_OR_RETURN(committed, speech::remember_deeds(*memory, found->deeds));
    ENGRAM_RETURN_IF_ERROR(memory->close());
  }
  if (arguments.is_json) {
    print_json(speech::to_json(*found, committed));
    return {};
  }
  for (const speech::NoticedDeed& deed : found->deeds) print(deed_text(deed));
  print(fmt::format("{} deed{} in {} snapshots of joints, {} episodes{}", found->deeds.size(),
                    found->deeds.size() == 1 ? "" : "s", found->snapshots, found->episodes,
                    arguments.is_committed ? fmt::format("; {} committed", committed) : ""));
  return {};
}

}  // namespace

void add_notice_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<NoticeArguments>();
  CLI::App* command =
      app.add_subcommand("notice", "Find what hands took and let go in recorded joints");
  command->footer(kNoticeFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--joints", arguments->joints,
                      "Entity of the joints; else each below RobotState that has a hand");
  command
      ->add_option("--open", arguments->open,
                   "Numbers of an open hand, beside those of a closed one")
      ->check(CLI::IsMember({"auto", "high", "low"}))
      ->capture_default_str();
  command->add_flag("--commit", arguments->is_committed, "Write what was found into the store");
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = done_or_failed(notice(*arguments)); });
}

}  // namespace engram::cli
