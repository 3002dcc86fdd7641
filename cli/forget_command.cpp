// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include "cli/command.h"
#include "cli/confirm.h"
#include "cli/interrupt.h"
#include "cli/learning_module.h"
#include "cli/progress_line.h"
#include "cli/remote_forget.h"
#include "ltm/core/log.h"
#include "ltm/forgetting/forget_config.h"
#include "ltm/store/store_writer.h"
#include "memory/model_loader.h"
#include "reports/plain/forget_job.h"
#include "reports/plain/forget_text.h"

namespace engram::cli {

namespace {

constexpr const char* kForgetFooter =
    R"(What is to go is named by IDs of any level or by queries with a selector, or follows from the
policies in the section 'forget' of a configuration (docs/forgetting.md). With both, the
configuration only says which entities and links are protected. Steps of its list 'fade' leave old
images with less quality, as in 'fade: [{after: 7d, psnr: 32}, {after: 90d, form: gist}]'.

Examples:
  engram forget robot.engram --config robot.yaml --dry-run
  engram forget robot.engram --config robot.yaml --yes
  engram forget robot.engram 'Vision/RGB/head/cam/2022-02-18 13:06:56.492182'
  engram forget robot.engram 'Grasp/.*/.*/blue-cup @ until:2022-01-01T00:00:00Z' --dry-run
  engram forget robot.engram 'Vision @ 2022-02-18T13:06:00Z..2022-02-18T13:07:00Z' --erase
  engram forget robot.engram --erase --yes   # what earlier forgetting left
  engram forget --server unix:/run/robot.sock 'Vision/RGB/head/cam @ last:10min' --erase

Without --erase no answer has what was forgotten, but parts of files may still hold it: the plan says
what, and for how long. With it every byte goes: blocks of latents are coded anew from what stays,
models that learned from it are removed, and a report without the content stays in erasures/.

With --server a running server forgets, in its working memory and its store, also what was not stored
yet; a token needs the right 'erase' for it (docs/access.md). A store that a server records into is
forgotten from through this server: beside it, the server would go on to answer and store what it
holds.)";

struct ForgetArguments {
  RemoteArguments remote;
  std::string store;
  std::vector<std::string> targets;
  std::string config;
  bool is_dry_run = false;
  bool is_json = false;
  bool is_confirmed = false;
  bool erases = false;
};

/// Loads what codes images only if something fades.
Result<ltm::FadeReport> fade(const std::filesystem::path& store, const ltm::FadeSet& what,
                             const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const LearningModule* module, learning_module());
  return module->fade(store, what, progress, stop);
}

std::string question_text(const ltm::ForgetPlan& plan, bool erases) {
  if (erases)
    return fmt::format("Erase {} snapshots, so that no file holds anything of them?",
                       plan.snapshots());
  if (plan.fading() == 0)
    return fmt::format("Forget {} snapshots? They cannot be brought back.", plan.snapshots());
  if (plan.snapshots() == 0)
    return fmt::format("Let {} snapshots fade? What they lose cannot be brought back.",
                       plan.fading());
  return fmt::format("Forget {} snapshots and let {} fade? Neither can be undone.",
                     plan.snapshots(), plan.fading());
}

Status check_server(const ForgetArguments& arguments) {
  if (!arguments.remote.names.empty())
    return invalid_argument("forget: found --names, needs the server itself: --server");
  if (arguments.remote.server.empty())
    return arguments.store.empty() ? invalid_argument("forget: needs a store, or --server")
                                   : Status();
  if (!arguments.config.empty())
    return invalid_argument("forget: found --config beside --server, needs IDs or queries");
  if (arguments.store.empty())
    return invalid_argument("forget: found nothing to forget, needs IDs or queries");
  return {};
}

Status check(const ForgetArguments& arguments) {
  ENGRAM_RETURN_IF_ERROR(check_server(arguments));
  if (arguments.remote.server.empty() && arguments.targets.empty() && arguments.config.empty() &&
      !arguments.erases)
    return invalid_argument("forget: found nothing to forget, needs IDs, queries or --config");
  if (arguments.is_dry_run || arguments.is_confirmed) return {};
  if (arguments.is_json) return invalid_argument("forget: --json needs --yes or --dry-run");
  if (::isatty(STDIN_FILENO) == 0)
    return invalid_argument("forget: nobody to ask, as the input is no terminal; needs --yes");
  return {};
}

ExitCode conclude(const ForgetArguments& arguments, const ltm::ForgetReport& report) {
  if (report.rewritten.is_cancelled || report.faded.is_cancelled)
    return fail(cancelled("forget was stopped; what was not taken out by then stays"));
  if (report.missing_bytes > 0)
    return fail(resource_exhausted(
        "store '{}': the quota is not met, about {} bytes more would have to go; what is left is "
        "protected, not sealed yet, or no data",
        arguments.store, report.missing_bytes));
  return ExitCode::kDone;
}

ExitCode carry_out(const ForgetArguments& arguments, const reports::ForgetJob& job,
                   ltm::ForgetPlan plan, ProgressLine& progress) {
  Json json{{"plan", reports::plan_json(plan)}};
  const auto report = job.carry_out(std::move(plan));
  progress.finish();
  if (!report.ok()) return fail(report.status());
  json["done"] = reports::report_json(*report);
  if (arguments.is_json)
    print_json(json);
  else
    reports::print_report(*report);
  return conclude(arguments, *report);
}

ExitCode run_remotely(const ForgetArguments& arguments) {
  RemoteForget what{arguments.remote,     {arguments.store}, arguments.erases,
                    arguments.is_dry_run, arguments.is_json, arguments.is_confirmed};
  what.targets.insert(what.targets.end(), arguments.targets.begin(), arguments.targets.end());
  return forget_on_server(what);
}

/// A program that records into the store holds more than the store has.
void warn_of_writer(const std::string& store) {
  if (ltm::StoreWriter::is_open(store))
    log::warning(
        "store '{}': another program records into it, and goes on to answer and store what it "
        "holds "
        "in memory; if it is a server, --server lets it forget that, too",
        store);
}

ExitCode run(const ForgetArguments& arguments) {
  if (const Status status = check(arguments); !status.ok()) return wrong_usage(status);
  if (!arguments.remote.server.empty()) return run_remotely(arguments);
  warn_of_writer(arguments.store);
  ltm::ForgetOptions options;
  if (!arguments.config.empty()) {
    auto config = ltm::read_forget_config(arguments.config);
    if (!config.ok()) return wrong_usage(config.status());
    options = *std::move(config);
  }
  ProgressLine progress;
  const reports::ForgetJob job{arguments.store,   arguments.targets, std::move(options),
                               model_loader(),    progress.sink(),   interrupt_token(),
                               {fade, code_anew}, arguments.erases};
  auto plan = arguments.is_dry_run ? job.plan() : job.final_plan();
  progress.finish();
  if (!plan.ok()) return fail(plan.status());
  if (!arguments.is_json) reports::print_plan(*plan);
  if (arguments.is_dry_run) {
    if (arguments.is_json) print_json({{"plan", reports::plan_json(*plan)}});
    if (plan->missing_bytes > 0 && !plan->fades_for_quota)
      log::warning("store '{}': the quota would not be met, by about {} bytes", arguments.store,
                   plan->missing_bytes);
    return ExitCode::kDone;
  }
  const bool is_work = arguments.erases || plan->snapshots() + plan->fading() > 0;
  const bool needs_answer = is_work && !arguments.is_confirmed;
  if (needs_answer && !is_confirmed(question_text(*plan, arguments.erases)))
    return fail(cancelled("forget: nothing was changed"));
  return carry_out(arguments, job, *std::move(plan), progress);
}

}  // namespace

void add_forget_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ForgetArguments>();
  CLI::App* command = app.add_subcommand("forget", "Take snapshots out of a store for good");
  command->footer(kForgetFooter);
  command->add_option("store", arguments->store, "Store; with --server the first of WHAT");
  command->add_option("what", arguments->targets, "IDs, or queries NAMES @ SELECTOR");
  command->add_option("--config", arguments->config, "YAML file with a section 'forget'");
  command->add_flag("--erase", arguments->erases,
                    "Leave nothing of it in any file, also of what was forgotten before");
  command->add_flag("--dry-run", arguments->is_dry_run, "Only say what would go");
  command->add_flag("--json", arguments->is_json, "The plan and what was done as JSON");
  command->add_flag("-y,--yes", arguments->is_confirmed, "Do not ask");
  add_remote_options(*command, arguments->remote);
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
