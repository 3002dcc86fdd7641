// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/server_commands.h"
#include "reports/plain/text.h"
#include "server/access/audit_check.h"
#include "server/access/audit_log.h"

namespace engram::cli {

namespace {

constexpr const char* kAuditFooter =
    R"(A server that is given an audit log notes in it who asked what, and who was refused. No record can be
changed, left out or put in afterwards without a trace, not even by who takes over the machine.

Examples:
  engram audit create /var/log/engram/audit.log      # move audit.log.key to another machine
  engram serve robot.engram --tokens tokens.yaml --audit /var/log/engram/audit.log
  engram audit verify /var/log/engram/audit.log --key audit.log.key
  jq -c 'select(.did == "query") | [.time, .who, .on]' /var/log/engram/audit.log)";

struct AuditArguments {
  std::filesystem::path log;
  std::filesystem::path key;
  bool is_json = false;
};

ExitCode create(const AuditArguments& arguments) {
  if (const Status status = server::AuditLog::create(arguments.log); !status.ok())
    return fail(status);
  const std::string log = arguments.log.string(),
                    state = server::AuditLog::state_path(log).string(),
                    key = server::AuditLog::key_path(log).string();
  if (arguments.is_json) {
    print_json({{"log", log}, {"state", state}, {"key", key}});
    return ExitCode::kDone;
  }
  print(fmt::format("Made {}, with {} for servers.", log, state));
  print(
      fmt::format("{} verifies it, and lets who has it write the log anew: move it to another "
                  "machine.",
                  key));
  return ExitCode::kDone;
}

Json report_json(const server::AuditReport& report, const std::filesystem::path& log) {
  Json flaws = Json::array();
  for (const server::AuditFlaw& flaw : report.flaws)
    flaws.push_back({{"line", flaw.line}, {"what", flaw.what}});
  return {{"log", log.string()},
          {"lines", report.lines},
          {"whole_records", report.whole},
          {"is_whole", report.is_whole()},
          {"flaw_count", report.flaw_count},
          {"flaws", std::move(flaws)},
          {"last_seal", report.seal}};
}

void print_report(const server::AuditReport& report, const std::filesystem::path& log) {
  for (const server::AuditFlaw& flaw : report.flaws)
    print(fmt::format("line {}: {}", flaw.line, flaw.what));
  if (report.flaw_count > report.flaws.size())
    print(fmt::format("... and {} more", report.flaw_count - report.flaws.size()));
  if (report.is_whole() && report.lines == 0)
    print(fmt::format("{}: has no records yet", log.string()));
  else if (report.is_whole())
    print(fmt::format("{}: all {} records are as servers wrote them", log.string(),
                      reports::count_text(report.whole)));
  else
    print(fmt::format("{}: {} of {} lines are records as servers wrote them", log.string(),
                      reports::count_text(report.whole), reports::count_text(report.lines)));
  print(fmt::format("last seal {}", report.seal));
}

ExitCode verify(const AuditArguments& arguments) {
  const auto key =
      arguments.key.empty() ? server::AuditLog::key_path(arguments.log) : arguments.key;
  ProgressLine progress;
  const auto report =
      server::check_audit_log(arguments.log, key, progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(report_json(*report, arguments.log));
  else
    print_report(*report, arguments.log);
  return report->is_whole() ? ExitCode::kDone : ExitCode::kDoneWithLoss;
}

CLI::App* add_part(CLI::App& audit, const char* name, const char* help,
                   const std::shared_ptr<AuditArguments>& arguments, ExitCode& exit_code,
                   ExitCode (*run)(const AuditArguments&)) {
  CLI::App* part = audit.add_subcommand(name, help);
  part->add_option("log", arguments->log, "Audit log")->required();
  part->add_flag("--json", arguments->is_json, "As JSON");
  part->callback([arguments, &exit_code, run] { exit_code = run(*arguments); });
  return part;
}

}  // namespace

void add_audit_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<AuditArguments>();
  CLI::App* command =
      app.add_subcommand("audit", "Keep a log of who asked what of servers, and verify it");
  command->footer(kAuditFooter);
  command->require_subcommand(1);
  add_part(*command, "create", "Make an empty log, and the key that verifies it", arguments,
           exit_code, create);
  add_part(*command, "verify", "Tell whether anything was changed, left out or put in", arguments,
           exit_code, verify)
      ->add_option("--key", arguments->key, "File with the key; by default LOG.key");
}

}  // namespace engram::cli
