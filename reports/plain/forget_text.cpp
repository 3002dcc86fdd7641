// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/forget_text.h"

#include <cmath>

#include "ltm/core/printable.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

std::string size_text(uint64_t bytes) {
  return bytes_text(static_cast<double>(bytes));
}

std::string target_text(std::optional<double> psnr_db) {
  return psnr_db ? fmt::format("{} dB", *psnr_db) : "a gist";
}

void print_fading(const ltm::EntityForgetPlan& plan) {
  for (const ltm::FadingSnapshots& part : plan.fading)
    print(fmt::format("  fades  {} snapshots to {}, {} to {}", count_text(part.times.size()),
                      target_text(part.psnr_db), to_string(part.times.front()),
                      to_string(part.times.back())));
  for (const auto& [reason, count] : plan.fading_reasons)
    print(fmt::format("         {} {}", count_text(count), reason));
  if (plan.faded_bytes > 0)
    print(fmt::format("         frees about {}", size_text(plan.faded_bytes)));
}

Json counts_json(const std::map<std::string, uint64_t>& counts) {
  Json json = Json::object();
  for (const auto& [reason, count] : counts) json[reason] = count;
  return json;
}

/// An infinite PSNR, of what did not fade, is null.
Json db_json(double psnr_db) {
  return std::isfinite(psnr_db) ? Json(psnr_db) : Json();
}

Json faded_json(const ltm::FadeReport& report) {
  Json entities = Json::array();
  for (const auto& [id, entity] : report.entities)
    entities.push_back({{"id", id.to_string()},
                        {"faded", entity.faded},
                        {"kept", entity.kept},
                        {"waiting", entity.waiting},
                        {"latent_bytes_before", entity.bytes_before},
                        {"latent_bytes_after", entity.bytes_after},
                        {"expected_psnr", db_json(entity.expected_db)},
                        {"certain_psnr", db_json(entity.certain_db)}});
  return entities;
}

void print_faded(const ltm::FadeReport& report) {
  for (const auto& [id, entity] : report.entities) {
    print(id.printable());
    if (entity.faded > 0)
      print(
          fmt::format("  faded  {} snapshots, latents {} before, {} after; the worst {:.1f} dB, "
                      "certainly {:.1f} dB",
                      count_text(entity.faded), size_text(entity.bytes_before),
                      size_text(entity.bytes_after), entity.expected_db, entity.certain_db));
    if (entity.kept > 0)
      print(fmt::format("  stays  {} snapshots, which would hardly become smaller",
                        count_text(entity.kept)));
    if (entity.waiting > 0)
      print(fmt::format("  waits  {} snapshots, coded together with some that do not fade",
                        count_text(entity.waiting)));
  }
}

void print_erased(const ltm::ErasureReport& report) {
  for (const auto& [id, entity] : report.entities) {
    print(id.printable());
    print(fmt::format("  erased {} snapshots", count_text(entity.erased)));
    if (entity.recoded > 0)
      print(fmt::format("  anew   {} snapshots whose recorded form is gone{}",
                        count_text(entity.recoded),
                        std::isfinite(entity.certain_db)
                            ? fmt::format("; the worst {:.1f} dB, certainly {:.1f} dB",
                                          entity.expected_db, entity.certain_db)
                            : ""));
    if (entity.uncoded > 0)
      print(fmt::format("  waits  {} snapshots, which the next night codes anew",
                        count_text(entity.uncoded)));
    for (const std::string& model : entity.models) print("  model  " + model + " is replaced");
    if (entity.is_waiting && entity.uncoded == 0) print("  waits  the next night learns again");
  }
  if (!report.files.empty())
    print(fmt::format("{} side files removed", count_text(report.files.size())));
  print("The report is in " + report.report);
}

Json erased_json(const ltm::ErasureReport& report) {
  Json json = report.to_json();
  json["report"] = report.report;
  return json;
}

std::string stays_text(const ltm::EntityForgetPlan& plan) {
  std::string text = count_text(plan.stays);
  if (plan.shielded > 0) text += ", " + count_text(plan.shielded) + " of them protected";
  if (plan.unsealed > 0) text += ", " + count_text(plan.unsealed) + " not sealed yet";
  return text;
}

void print_entity(const ltm::MemoryId& id, const ltm::EntityForgetPlan& plan) {
  print(id.printable());
  if (!plan.gone.empty())
    print(fmt::format("  goes   {} snapshots, {} to {}, about {}", count_text(plan.gone.size()),
                      to_string(plan.gone.front()), to_string(plan.gone.back()),
                      size_text(plan.freed_bytes)));
  for (const auto& [reason, count] : plan.reasons)
    print(fmt::format("         {} {}", count_text(count), reason));
  print_fading(plan);
  print("  stays  " + stays_text(plan));
}

Json times_json(const TimeSet& times) {
  Json list = Json::array();
  for (const Time time : times) list.push_back(to_ns(time));
  return list;
}

Json entity_json(const ltm::MemoryId& id, const ltm::EntityForgetPlan& plan) {
  Json json = planned_entity_json(id, plan);
  for (size_t i = 0; i < plan.fading.size(); ++i)
    json["fading"][i]["times_ns"] = times_json(plan.fading[i].times);
  json["times_ns"] = times_json(plan.gone);
  return json;
}

}  // namespace

void print_plan(const ltm::ForgetPlan& plan) {
  for (const auto& [id, entity] : plan.entities)
    if (!entity.gone.empty() || !entity.fading.empty() || entity.shielded > 0)
      print_entity(id, entity);
  print(fmt::format("In all {} snapshots, about {} of {}", count_text(plan.snapshots()),
                    size_text(plan.freed_bytes), size_text(plan.store_bytes)));
  if (plan.fading() > 0)
    print(fmt::format("{} snapshots fade, which frees about {}{}", count_text(plan.fading()),
                      size_text(plan.faded_bytes),
                      plan.fades_for_quota ? "; then the quota is looked at again" : ""));
  if (plan.unsealed() > 0)
    print(fmt::format("{} snapshots are not sealed yet and stay", count_text(plan.unsealed())));
  for (const std::string& note : plan.notes) print("Note: " + printable(note));
}

Json plan_sums_json(const ltm::ForgetPlan& plan) {
  return {{"snapshots", plan.snapshots()},
          {"freed_bytes", plan.freed_bytes},
          {"fading", plan.fading()},
          {"faded_bytes", plan.faded_bytes},
          {"fades_for_quota", plan.fades_for_quota},
          {"store_bytes", plan.store_bytes},
          {"free_disk_bytes", plan.free_disk_bytes},
          {"quota_missing_bytes", plan.missing_bytes},
          {"not_sealed_yet", plan.unsealed()},
          {"notes", plan.notes}};
}

Json planned_entity_json(const ltm::MemoryId& id, const ltm::EntityForgetPlan& plan) {
  Json fading = Json::array();
  for (const ltm::FadingSnapshots& part : plan.fading) {
    Json one{{"form", part.psnr_db ? "psnr" : "gist"}, {"snapshots", part.times.size()}};
    if (part.psnr_db) one["psnr"] = *part.psnr_db;
    fading.push_back(std::move(one));
  }
  return {{"id", id.to_string()},
          {"forgotten", plan.gone.size()},
          {"reasons", counts_json(plan.reasons)},
          {"freed_bytes", plan.freed_bytes},
          {"fading", std::move(fading)},
          {"fading_reasons", counts_json(plan.fading_reasons)},
          {"faded_bytes", plan.faded_bytes},
          {"stays", plan.stays},
          {"protected", plan.shielded},
          {"not_sealed_yet", plan.unsealed}};
}

Json plan_json(const ltm::ForgetPlan& plan) {
  Json json = plan_sums_json(plan);
  json["entities"] = Json::array();
  for (const auto& [id, entity] : plan.entities)
    json["entities"].push_back(entity_json(id, entity));
  return json;
}

void print_report(const ltm::ForgetReport& report) {
  print_faded(report.faded);
  if (report.erased) print_erased(*report.erased);
  print(fmt::format(
      "{} snapshots forgotten, {} freed: {} before, {} after{}",
      count_text(report.rewritten.snapshots),
      size_text(report.bytes_before - std::min(report.bytes_before, report.bytes_after)),
      size_text(report.bytes_before), size_text(report.bytes_after),
      report.rounds > 1 ? fmt::format(" ({} rounds for the quota)", report.rounds) : ""));
}

Json report_json(const ltm::ForgetReport& report) {
  return {{"snapshots", report.rewritten.snapshots},
          {"erased", report.erased ? erased_json(*report.erased) : Json()},
          {"faded", faded_json(report.faded)},
          {"rounds", report.rounds},
          {"segments_before", report.rewritten.segments_before},
          {"segments_after", report.rewritten.segments_after},
          {"segment_bytes_freed", report.rewritten.freed_bytes()},
          {"store_bytes_before", report.bytes_before},
          {"store_bytes_after", report.bytes_after},
          {"quota_missing_bytes", report.missing_bytes},
          {"is_cancelled", report.rewritten.is_cancelled || report.faded.is_cancelled}};
}

}  // namespace engram::reports
