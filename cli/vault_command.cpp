// SPDX-License-Identifier: Apache-2.0
#include "cli/vault_command.h"

#include <unistd.h>

#include "cli/confirm.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "datasets/vault/vault_check.h"
#include "datasets/vault/vault_forget.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "reports/plain/text.h"
#include "reports/plain/vault_text.h"

namespace engram::cli {

namespace {

using namespace datasets::vault;

constexpr const char* kVaultFooter =
    R"(A vault is an encrypted copy of a store, with a key for each entity and day. Whoever destroys a key
erases that day in every copy of the vault. The key file is the only thing that reads it: keep it
elsewhere, and forget in its copies too (docs/vault.md).

Examples:
  engram export robot.engram --to vault -o /mnt/nas/robot.vault --keys ~/robot.keys
  engram vault list /mnt/nas/robot.vault --keys ~/robot.keys
  engram vault verify /mnt/nas/robot.vault --keys ~/robot.keys
  engram vault forget /mnt/nas/robot.vault --keys ~/robot.keys 'Vision @ 2022-02-18'
  engram vault forget /mnt/nas/robot.vault --keys ~/robot.keys Vision/RGB/head/cam --dry-run
  engram import --from /mnt/nas/robot.vault --keys ~/robot.keys back.engram)";

struct VaultArguments {
  VaultPlaces places;
  std::vector<std::string> targets;
  bool is_dry_run = false;
  bool is_confirmed = false;
  bool is_json = false;
};

ExitCode list_vault(const VaultArguments& arguments) {
  const auto keys = read_keys(arguments.places.keys);
  if (!keys.ok()) return fail(keys.status());
  if (arguments.is_json)
    print_json(reports::vault_list_json(*keys));
  else
    reports::print_vault_list(*keys);
  return ExitCode::kDone;
}

ExitCode verify_vault(const VaultArguments& arguments) {
  ProgressLine progress;
  const auto report = check_vault(arguments.places, progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(reports::vault_check_json(*report));
  else
    reports::print_vault_check(*report);
  return report->is_whole() ? ExitCode::kDone : ExitCode::kDoneWithLoss;
}

Status check_forget(const VaultArguments& arguments) {
  if (arguments.is_dry_run || arguments.is_confirmed) return {};
  if (arguments.is_json) return invalid_argument("vault forget: --json needs --yes or --dry-run");
  if (::isatty(STDIN_FILENO) == 0)
    return invalid_argument(
        "vault forget: nobody to ask, as the input is no terminal; needs --yes");
  return {};
}

ExitCode destroy(const VaultArguments& arguments, VaultFolder& folder,
                 const std::vector<EntityDay>& days) {
  if (const Status done = folder.destroy(days, system_now()); !done.ok()) return fail(done);
  const std::string count = reports::count_text(days.size());
  const bool is_near = folder.is_within_reach();
  if (!arguments.is_json)
    print(is_near ? fmt::format("{} keys are destroyed, and their files removed", count)
                  : fmt::format("{} keys are destroyed; their files stay where the vault is, and "
                                "nobody can read them",
                                count));
  return ExitCode::kDone;
}

ExitCode forget_in_vault(const VaultArguments& arguments) {
  if (const Status status = check_forget(arguments); !status.ok()) return wrong_usage(status);
  if (arguments.is_dry_run) {
    const auto keys = read_keys(arguments.places.keys);
    if (!keys.ok()) return fail(keys.status());
    const auto days = find_vault_days(*keys, arguments.targets);
    if (!days.ok()) return fail(days.status());
    if (arguments.is_json)
      print_json({{"days", reports::vault_days_json(*keys, *days)}, {"is_done", false}});
    else
      reports::print_vault_days(*keys, *days);
    return ExitCode::kDone;
  }
  auto folder = VaultFolder::open_keys(arguments.places);
  if (!folder.ok()) return fail(folder.status());
  const auto days = find_vault_days(folder->keys(), arguments.targets);
  if (!days.ok()) return fail(days.status());
  Json json{{"days", reports::vault_days_json(folder->keys(), *days)}};
  if (!arguments.is_json) reports::print_vault_days(folder->keys(), *days);
  if (!arguments.is_confirmed &&
      !is_confirmed(fmt::format(
          "Destroy the keys of {} entity-days? Nobody can read them afterwards.", days->size())))
    return fail(cancelled("vault forget: nothing was changed"));
  const ExitCode done = destroy(arguments, *folder, *days);
  if (done != ExitCode::kDone || !arguments.is_json) return done;
  json["is_done"] = true;
  json["vault_was_there"] = folder->is_within_reach();
  print_json(json);
  return ExitCode::kDone;
}

CLI::App* add_vault_part(CLI::App& vault, const char* name, const char* help,
                         const std::shared_ptr<VaultArguments>& arguments, ExitCode& exit_code,
                         ExitCode (*run)(const VaultArguments&)) {
  CLI::App* part = vault.add_subcommand(name, help);
  part->add_option("vault", arguments->places.vault, "Vault: a directory")->required();
  part->add_flag("--json", arguments->is_json, "As JSON");
  part->callback([arguments, &exit_code, run] { exit_code = run(*arguments); });
  return part;
}

CLI::Option* add_keys(CLI::App& part, VaultArguments& arguments) {
  return part.add_option("--keys", arguments.places.keys, "Key file of the vault");
}

}  // namespace

void add_vault_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<VaultArguments>();
  CLI::App* command =
      app.add_subcommand("vault", "Look into encrypted copies, verify them, forget days of them");
  command->footer(kVaultFooter);
  command->require_subcommand(1);
  add_keys(*add_vault_part(*command, "list", "List the days and entities, by the key file alone",
                           arguments, exit_code, list_vault),
           *arguments)
      ->required();
  add_keys(*add_vault_part(*command, "verify",
                           "Decrypt and check everything; without --keys only the structure",
                           arguments, exit_code, verify_vault),
           *arguments);
  CLI::App* forget = add_vault_part(
      *command, "forget", "Destroy the keys of days, also where the vault is out of reach",
      arguments, exit_code, forget_in_vault);
  add_keys(*forget, *arguments)->required();
  forget->add_option("what", arguments->targets, "IDs, or NAMES @ DAY, DAY..DAY, a range or all")
      ->required();
  forget->add_flag("--dry-run", arguments->is_dry_run, "Only say which days would go");
  forget->add_flag("-y,--yes", arguments->is_confirmed, "Do not ask");
}

}  // namespace engram::cli
