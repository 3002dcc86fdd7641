// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "ltm/reflection/record_reflection.h"
#include "ltm/reflection/reflect.h"
#include "reports/plain/reflection_text.h"

namespace engram::cli {

namespace {

constexpr const char* kReflectFooter = R"(What is looked at:
  gap, rate          snapshots that are missing, or come slower or faster than usual
  out-of-bounds      numbers outside of their type's bounds, or of limits that a description gives
  not-finite         NaN and infinity
  frozen, duplicate  values that stand still while there was motion, or come again
  spike, jump        steps that are larger than the entity moves
  drift              members that leave what their velocity says, or creep
  clock-drift        a delay between time and arrival that grows or shrinks
  dead-link          links to what the store does not have; foreign-link: to other core segments
  link-time          links to another time than usual
  time-shift         motion that comes earlier or later than that of the entities it links to
  broken-action      actions without their end or begin
What is usual is learned from the store itself. Times of all snapshots are looked at, values of
those that are recorded; latents are not decoded. A QUERY without @ looks at all snapshots of what
it names. --commit records what was found as Reflection/Findings/engram/all and
Reflection/Summary/{entities,skills,chains}/all, so that the store can be asked about it.
Exit code: 0, or 3 where --fail-on was given and there is such a finding.

Examples:
  engram reflect robot.engram
  engram reflect robot.engram 'RobotState'
  engram reflect robot.engram '.*/.*/.*/.* @ last:10min' --findings 0
  engram reflect monday.engram --against sunday.engram
  engram reflect robot.engram --commit && engram query robot.engram 'Reflection @ latest'
  engram reflect robot.engram --json | jq '.findings[] | select(.kind == "dead-link")')";

struct ReflectArguments {
  std::string store;
  std::string query;
  std::string against;
  std::string fail_on;
  size_t max_findings = reports::ReflectionTextOptions{}.max_findings;
  bool is_all = false;
  bool with_images = false;
  bool is_committed = false;
  bool is_json = false;
};

Result<ltm::Reflection> reflect_on(const std::string& store, const ltm::ReflectOptions& options) {
  ProgressLine progress;
  auto reflection =
      ltm::reflect(std::filesystem::path(store), options, progress.sink(), interrupt_token());
  progress.finish();
  return reflection;
}

bool has_failed(const ltm::Reflection& reflection, const std::string& fail_on) {
  if (fail_on.empty()) return false;
  return reflection.count(ltm::Severity::kFault) > 0 ||
         (fail_on == "note" && !reflection.findings.empty());
}

ExitCode run(const ReflectArguments& arguments) {
  auto asked = ltm::reflect_options(arguments.query);
  if (!asked.ok()) return wrong_usage(asked.status());
  ltm::ReflectOptions options = std::move(asked).value();
  options.with_images = arguments.with_images;
  const auto reflection = reflect_on(arguments.store, options);
  if (!reflection.ok()) return fail(reflection.status());
  std::vector<ltm::ReflectionDifference> differences;
  if (!arguments.against.empty()) {
    const auto other = reflect_on(arguments.against, options);
    if (!other.ok()) return fail(other.status());
    differences = ltm::compare_reflections(*reflection, *other);
  }
  if (arguments.is_json) {
    Json json = reports::reflection_json(*reflection);
    if (!arguments.against.empty()) {
      json["against"] = arguments.against;
      json["differences"] = reports::differences_json(differences);
    }
    print_json(json);
  } else {
    reports::print_reflection(*reflection, {arguments.max_findings, arguments.is_all});
    if (!arguments.against.empty())
      reports::print_differences(differences, arguments.store, arguments.against);
  }
  if (arguments.is_committed)
    if (const Status recorded = ltm::record_reflection(arguments.store, *reflection);
        !recorded.ok())
      return fail(recorded);
  return has_failed(*reflection, arguments.fail_on) ? ExitCode::kDoneWithLoss : ExitCode::kDone;
}

}  // namespace

void add_reflect_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ReflectArguments>();
  CLI::App* command =
      app.add_subcommand("reflect", "Find what is odd in a store, and how often skills succeed");
  command->footer(kReflectFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("query", arguments->query, "What is looked at; all without it");
  command->add_option("--against", arguments->against, "Store that it is compared with");
  command->add_flag("--images", arguments->with_images, "Read images, too: do they stand still?");
  command
      ->add_option("--findings", arguments->max_findings,
                   "Max number of findings that are told one by one; 0: all")
      ->capture_default_str();
  command->add_flag("--all", arguments->is_all, "Tell of each entity, however many there are");
  command->add_flag("--commit", arguments->is_committed, "Record what was found into the store");
  command
      ->add_option("--fail-on", arguments->fail_on,
                   "Exit code 3 if there is a fault, or a fault or a note")
      ->check(CLI::IsMember({"fault", "note"}));
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
