// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/vault_text.h"

#include "ltm/core/printable.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

using namespace datasets::vault;

/// A vault may be damaged as a whole; whoever wants all of it asks for JSON.
constexpr size_t kMaxFindingsPrinted = 100;

Json finding_json(const VaultFinding& finding) {
  Json json;
  const bool has_day = finding.entity.depth() > 0;
  json["entity"] = has_day ? Json(finding.entity.to_string()) : Json(nullptr);
  json["day"] = has_day ? Json(day_text(finding.day)) : Json(nullptr);
  json["file"] = finding.file.empty() ? Json(nullptr) : Json(finding.file);
  json["what"] = finding.what;
  return json;
}

Json findings_json(const std::vector<VaultFinding>& findings) {
  Json all = Json::array();
  for (const VaultFinding& finding : findings) all.push_back(finding_json(finding));
  return all;
}

void print_vault_findings(const std::vector<VaultFinding>& findings) {
  for (size_t i = 0; i < findings.size() && i < kMaxFindingsPrinted; ++i) {
    const VaultFinding& finding = findings[i];
    if (finding.entity.depth() > 0)
      print(fmt::format("  {} {}: {}", day_text(finding.day), finding.entity.printable(),
                        printable(finding.what)));
    else
      print("  " + printable(finding.what));
  }
  if (findings.size() > kMaxFindingsPrinted)
    print(fmt::format("  ... and {} more", count_text(findings.size() - kMaxFindingsPrinted)));
}

std::string size_of(uint64_t bytes) {
  return bytes_text(static_cast<double>(bytes));
}

Json day_json(const ltm::MemoryId& entity, Day day, const VaultDay& kept) {
  return {{"entity", entity.to_string()},  {"day", day_text(day)},
          {"is_destroyed", false},         {"snapshots", kept.snapshots},
          {"instances", kept.instances},   {"reconstructed", kept.reconstructed},
          {"first_ns", to_ns(kept.first)}, {"last_ns", to_ns(kept.last)},
          {"raw_bytes", kept.raw_bytes},   {"bytes", kept.file_bytes},
          {"file", to_text(kept.file)}};
}

std::vector<std::string> day_row(const ltm::MemoryId& entity, Day day, const VaultDay& kept) {
  return {entity.printable(),
          day_text(day),
          count_text(kept.snapshots),
          count_text(kept.reconstructed),
          to_string(kept.first).substr(11, 8),
          to_string(kept.last).substr(11, 8),
          size_of(kept.file_bytes)};
}

TextTable days_table() {
  return TextTable({"Entity", "Day", "Snapshots", "From latents", "First", "Last", "Bytes"});
}

}  // namespace

Json vault_export_json(const VaultExportReport& report) {
  return {{"added", report.added},
          {"replaced", report.replaced},
          {"unchanged", report.unchanged},
          {"kept_recorded", report.kept_recorded},
          {"destroyed", report.destroyed},
          {"vault_alone", report.vault_alone},
          {"snapshots", report.snapshots},
          {"instances", report.instances},
          {"reconstructed", report.reconstructed},
          {"bytes", report.bytes},
          {"unread", findings_json(report.unread)}};
}

void print_vault_export(const VaultExportReport& report, const std::filesystem::path& vault,
                        bool is_dry) {
  print(fmt::format("Vault {}: {} entity-days {} new, {} replaced, {} as before",
                    printable(vault.string()), count_text(report.added),
                    is_dry ? "would be" : "are", count_text(report.replaced),
                    count_text(report.unchanged)));
  if (is_dry)
    print(fmt::format("{} snapshots would be written", count_text(report.snapshots)));
  else
    print(fmt::format("{} snapshots with {} instances, {}", count_text(report.snapshots),
                      count_text(report.instances), size_of(report.bytes)));
  if (report.reconstructed > 0)
    print(fmt::format("{} of them were decoded from latents, as nothing recorded is left",
                      count_text(report.reconstructed)));
  if (report.kept_recorded > 0)
    print(fmt::format("{} of those as before stay as they were recorded; the store has latents",
                      count_text(report.kept_recorded)));
  if (report.destroyed > 0)
    print(fmt::format("{} entity-days are left out, as their keys were destroyed",
                      count_text(report.destroyed)));
  if (report.vault_alone > 0)
    print(fmt::format("{} entity-days are in the vault alone; 'engram vault forget' takes them out",
                      count_text(report.vault_alone)));
  if (!report.unread.empty()) print("Left out, as the store cannot read it:");
  print_vault_findings(report.unread);
}

Json vault_import_json(const VaultImportReport& report) {
  return {{"format", "vault"},
          {"days", report.days},
          {"snapshots", report.snapshots},
          {"instances", report.instances},
          {"reconstructed", report.reconstructed},
          {"already_there", report.already_there},
          {"destroyed", report.destroyed},
          {"first_ns", report.first ? Json(to_ns(*report.first)) : Json(nullptr)},
          {"last_ns", report.last ? Json(to_ns(*report.last)) : Json(nullptr)},
          {"damaged", findings_json(report.damaged)},
          {"is_cancelled", report.is_cancelled}};
}

void print_vault_import(const VaultImportReport& report) {
  print(fmt::format("{} snapshots with {} instances of {} entity-days",
                    count_text(report.snapshots), count_text(report.instances),
                    count_text(report.days)));
  if (report.already_there > 0)
    print(fmt::format("{} snapshots are left out, as the store has some of these times already",
                      count_text(report.already_there)));
  if (report.reconstructed > 0)
    print(
        fmt::format("{} of them were decoded from latents when they were exported; they count as "
                    "recorded from now on",
                    count_text(report.reconstructed)));
  if (report.destroyed > 0)
    print(fmt::format("{} entity-days are gone, as their keys were destroyed",
                      count_text(report.destroyed)));
  if (!report.damaged.empty()) print("Damaged:");
  print_vault_findings(report.damaged);
}

Json vault_check_json(const VaultCheckReport& report) {
  return {{"had_keys", report.had_keys},
          {"files", report.files},
          {"bytes", report.bytes},
          {"snapshots", report.had_keys ? Json(report.snapshots) : Json(nullptr)},
          {"destroyed", report.destroyed},
          {"destroyed_files_left", report.remains},
          {"files_without_key", report.without_key},
          {"is_whole", report.is_whole()},
          {"damaged", findings_json(report.damaged)}};
}

void print_vault_check(const VaultCheckReport& report) {
  if (report.had_keys)
    print(fmt::format("{} files with {}: {} snapshots", count_text(report.files),
                      size_of(report.bytes), count_text(report.snapshots)));
  else
    print(fmt::format("{} files with {}, of which only the structure was checked: needs --keys",
                      count_text(report.files), size_of(report.bytes)));
  if (report.destroyed > 0)
    print(fmt::format("{} entity-days whose keys were destroyed", count_text(report.destroyed)));
  if (report.remains > 0)
    print(fmt::format("{} of their files are still there, and nobody can read them",
                      count_text(report.remains)));
  if (report.without_key > 0)
    print(
        fmt::format("{} files of which this key file has no key", count_text(report.without_key)));
  print(report.is_whole()
            ? "Whole"
            : fmt::format("{} files are damaged or missing:", count_text(report.damaged.size())));
  print_vault_findings(report.damaged);
}

Json vault_list_json(const VaultKeys& keys) {
  Json days = Json::array();
  for (const auto& [entity, of_entity] : keys.days)
    for (const auto& [day, kept] : of_entity) days.push_back(day_json(entity, day, kept));
  for (const auto& [entity, of_entity] : keys.destroyed)
    for (const auto& [day, gone] : of_entity)
      days.push_back({{"entity", entity.to_string()},
                      {"day", day_text(day)},
                      {"is_destroyed", true},
                      {"destroyed_ns", to_ns(gone.when)},
                      {"file", to_text(gone.file)}});
  return {{"vault", to_text(keys.vault)}, {"store", keys.store_id}, {"days", std::move(days)}};
}

void print_vault_list(const VaultKeys& keys) {
  TextTable table = days_table();
  uint64_t snapshots = 0, bytes = 0;
  for (const auto& [entity, of_entity] : keys.days)
    for (const auto& [day, kept] : of_entity) {
      table.add(day_row(entity, day, kept));
      snapshots += kept.snapshots;
      bytes += kept.file_bytes;
    }
  for (const auto& [entity, of_entity] : keys.destroyed)
    for (const auto& [day, gone] : of_entity)
      table.add({entity.printable(), day_text(day), "destroyed", "", "", "", ""});
  print(table.to_string());
  print(fmt::format("{} entity-days with {} snapshots and {}; {} destroyed",
                    count_text(keys.day_count()), count_text(snapshots), size_of(bytes),
                    count_text(keys.destroyed_count())));
}

Json vault_days_json(const VaultKeys& keys, const std::vector<EntityDay>& days) {
  Json all = Json::array();
  for (const auto& [entity, day] : days)
    if (const VaultDay* kept = keys.find(entity, day)) all.push_back(day_json(entity, day, *kept));
  return all;
}

void print_vault_days(const VaultKeys& keys, const std::vector<EntityDay>& days) {
  TextTable table = days_table();
  for (const auto& [entity, day] : days)
    if (const VaultDay* kept = keys.find(entity, day)) table.add(day_row(entity, day, *kept));
  print(table.to_string());
  print("A day has one key, so it goes as a whole.");
}

}  // namespace engram::reports
