// SPDX-License-Identifier: Apache-2.0
#include "cli/interrupt.h"
#include "cli/remote.h"
#include "cli/server_commands.h"
#include "cli/skill_text.h"
#include "ltm/idf/json.h"
#include "server/navigation/why.h"
#include "server/skills/skill_call.h"

namespace engram::cli {

namespace {

constexpr const char* kSkillFooter =
    R"(Skills are what programs of the robot can do: they register with the server that has the memory
Skill, which starts them, watches over them, and keeps what became of them (docs/skills.md).

Examples:
  engram skill ls
  engram skill show grasp
  engram skill run grasp object=Objects/Instances/kitchen/salt_1 hand=left --wait 5s
  engram skill why grasp object=Objects/Instances/kitchen/salt_1
  engram skill why Navigation/Event/robot/drive      # why it drove there: up to the words that were said
  engram skill stop grasp
  engram skill disable arm/grasp
  engram skill ls --db robot.engram)";

struct SkillArguments {
  RemoteArguments remote;
  std::string store;
  std::string skill;
  std::vector<std::string> given;
  std::string parameters;
  std::string wait = "0s";
  std::string version;
  std::vector<std::string> causes;
  bool is_json = false;
};

/// "NAME=VALUE" arguments, and --parameters. A value is JSON if it can be read so, else a text.
Result<std::optional<std::string>> parameters_of(const SkillArguments& arguments) {
  if (arguments.parameters.empty() && arguments.given.empty()) return std::optional<std::string>();
  idf::Data all = idf::Dict();
  if (!arguments.parameters.empty()) {
    auto parsed = idf::from_json_text(arguments.parameters);
    if (!parsed.ok()) return parsed.status().with_context("--parameters");
    all = *std::move(parsed);
  }
  auto* dict = all.get_if<idf::Dict>();
  if (dict == nullptr)
    return invalid_argument("--parameters: found {}, needs an object", all.kind_name());
  for (const std::string& text : arguments.given) {
    const size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      return invalid_argument("found '{}', needs NAME=VALUE", text);
    const std::string value = text.substr(equals + 1);
    auto parsed = idf::from_json_text(value);
    dict->set(text.substr(0, equals), parsed.ok() ? *std::move(parsed) : idf::Data(value));
  }
  ENGRAM_ASSIGN_OR_RETURN(std::string json, idf::to_json_text(all));
  return std::optional(std::move(json));
}

Result<std::unique_ptr<Memory>> memory_of(const SkillArguments& arguments) {
  if (!arguments.store.empty())
    ENGRAM_RETURN_IF_ERROR(check_source(arguments.store, arguments.remote));
  return open_memory(arguments.store, {.is_read_only = true, .notes_reads = false},
                     arguments.remote);
}

Status list_all(const SkillArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, memory_of(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const auto all, skills::list_skills(*memory));
  if (!arguments.is_json) {
    print(skills_text(all));
    return {};
  }
  Json list = Json::array();
  for (const auto& [id, skill] : all) list.push_back(skill_json(id, skill));
  print_json({{"skills", std::move(list)}});
  return {};
}

Status explain(const SkillArguments& arguments) {
  ENGRAM_ASSIGN_OR_RETURN(const auto given, parameters_of(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, memory_of(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const auto now, skills::explain_skill(*memory, arguments.skill, given));
  if (arguments.is_json)
    print_json(skill_now_json(now));
  else
    print(skill_now_text(now));
  return {};
}

/// What led to a snapshot, where one is named in place of a skill: an ID has more names than a
/// skill.
std::optional<ltm::MemoryId> told_snapshot(const SkillArguments& arguments) {
  const auto id = ltm::MemoryId::parse(arguments.skill);
  if (!id.ok() || !id->has_entity()) return {};
  return *id;
}

Status explain_snapshot(const SkillArguments& arguments, const ltm::MemoryId& id) {
  if (!arguments.given.empty() || !arguments.parameters.empty())
    return invalid_argument("'{}' is a snapshot, which has no parameters; needs none",
                            id.printable());
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, memory_of(arguments));
  ENGRAM_ASSIGN_OR_RETURN(const auto steps, navigation::why(*memory, id));
  if (!arguments.is_json) {
    std::string text = navigation::why_text(steps);
    text.pop_back();  // print() ends the last line.
    print(text);
    return {};
  }
  Json list = Json::array();
  for (const navigation::WhyStep& step : steps)
    list.push_back({{"id", step.id.to_string()}, {"member", step.member}, {"says", step.says}});
  print_json({{"why", std::move(list)}});
  return {};
}

Status explain_why(const SkillArguments& arguments) {
  if (const auto id = told_snapshot(arguments)) return explain_snapshot(arguments, *id);
  return explain(arguments);
}

Result<skills::SkillRequest> request_of(const SkillArguments& arguments) {
  skills::SkillRequest request{
      .skill = arguments.skill, .requester = "cli", .version = arguments.version};
  ENGRAM_ASSIGN_OR_RETURN(const auto given, parameters_of(arguments));
  request.parameters_json = given.value_or("{}");
  ENGRAM_ASSIGN_OR_RETURN(request.wait, parse_duration(arguments.wait));
  for (const std::string& cause : arguments.causes) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId id, ltm::MemoryId::parse(cause));
    request.causes.push_back(std::move(id));
  }
  return request;
}

/// Exits with 0 only if the skill succeeded, for scripts.
ExitCode run_one(const SkillArguments& arguments) {
  const auto request = request_of(arguments);
  if (!request.ok()) return wrong_usage(request.status());
  const auto memory = connect_memory(arguments.remote);
  if (!memory.ok()) return fail(memory.status());
  // Ctrl-C stops the skill, and its end is worth waiting for: it says how the robot came to rest.
  finish_after_interrupt();
  const auto tell = [&](const ::skill::Event& event) {
    if (event.stage == ::skill::Stage::ENDED) return;
    print_now(arguments.is_json ? event_json(event).dump() : event_text(event));
  };
  const auto result = skills::run_skill(**memory, *request, tell, interrupt_token());
  if (!result.ok()) return fail(result.status());
  if (arguments.is_json)
    print_now(
        (result->is_refused ? refusal_json(result->refusal) : event_json(result->end)).dump());
  else
    print_now(result->is_refused ? refusal_text(result->refusal) : event_text(result->end));
  const bool is_success = !result->is_refused && result->end.outcome == ::skill::Outcome::SUCCESS;
  return is_success ? ExitCode::kDone : ExitCode::kFailed;
}

Status ask(const SkillArguments& arguments, ::skill::Wish wish) {
  ENGRAM_ASSIGN_OR_RETURN(const auto memory, connect_memory(arguments.remote));
  // Whether there is such a skill is better said at once.
  ENGRAM_RETURN_IF_ERROR(skills::explain_skill(*memory, arguments.skill, {}).status());
  ENGRAM_ASSIGN_OR_RETURN(const ltm::MemoryId id,
                          skills::ask_skill(*memory, arguments.skill, wish, "cli"));
  if (arguments.is_json)
    print_json({{"request", id.to_string()}});
  else
    print(id.printable());
  return {};
}

CLI::App* add_one(CLI::App& skill, const std::string& name, const std::string& help,
                  const std::shared_ptr<SkillArguments>& arguments,
                  const std::string& what = "SKILL, or PROVIDER/SKILL") {
  CLI::App* command = skill.add_subcommand(name, help);
  if (name != "ls") command->add_option("skill", arguments->skill, what)->required();
  command->add_flag("--json", arguments->is_json, "JSON");
  add_remote_options(*command, arguments->remote);
  return command;
}

void add_parameters(CLI::App& command, SkillArguments& arguments) {
  command.add_option("parameters", arguments.given, "NAME=VALUE: a text, or JSON");
  command.add_option("--parameters", arguments.parameters, "All of them as a JSON object");
}

}  // namespace

void add_skill_command(CLI::App& app, ExitCode& exit_code) {
  CLI::App* skill = app.add_subcommand("skill", "What the robot can do: list, run, stop, explain");
  skill->require_subcommand(1);
  skill->footer(kSkillFooter);
  const auto made = [] { return std::make_shared<SkillArguments>(); };

  auto arguments = made();
  CLI::App* command = add_one(*skill, "ls", "The skills that are known", arguments);
  command->add_option("--db", arguments->store, "Of a store, in place of a server");
  command->callback([arguments, &exit_code] { exit_code = done_or_failed(list_all(*arguments)); });

  for (const auto& [name, help, what, answer] :
       {std::tuple{"show", "A skill: its parameters, conditions and last execution",
                   "SKILL, or PROVIDER/SKILL", &explain},
        std::tuple{"why",
                   "Why a skill would not start now, and why it was refused last; or why something "
                   "happened: what led to a snapshot",
                   "SKILL, PROVIDER/SKILL, or the ID of a snapshot; of an entity its last one",
                   &explain_why}}) {
    arguments = made();
    command = add_one(*skill, name, help, arguments, what);
    add_parameters(*command, *arguments);
    command->add_option("--db", arguments->store, "Of a store, in place of a server");
    command->callback([arguments, &exit_code, answer = answer] {
      exit_code = done_or_failed(answer(*arguments));
    });
  }

  arguments = made();
  command = add_one(*skill, "run", "Run a skill and wait for its end; Ctrl-C stops it", arguments);
  add_parameters(*command, *arguments);
  command
      ->add_option("--wait", arguments->wait,
                   "How long it may wait for its conditions and resources")
      ->check(duration_text());
  command->add_option("--version", arguments->version, "Only in this version");
  command->add_option("--cause", arguments->causes, "ID of why it is wanted, for links");
  command->callback([arguments, &exit_code] { exit_code = run_one(*arguments); });

  for (const auto& [name, help, wish] :
       {std::tuple{"stop", "Stop what runs of a skill", ::skill::Wish::STOP},
        std::tuple{"enable", "Let it be executed again", ::skill::Wish::ENABLE},
        std::tuple{"disable", "Let nobody execute it", ::skill::Wish::DISABLE}}) {
    arguments = made();
    command = add_one(*skill, name, help, arguments);
    command->callback([arguments, &exit_code, wish = wish] {
      exit_code = done_or_failed(ask(*arguments, wish));
    });
  }
}

}  // namespace engram::cli
