// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/forget_text.h"

#include "reports/plain/text.h"

namespace engram::reports {

namespace {

std::string size_text(uint64_t bytes) {
  return bytes_text(static_cast<double>(bytes));
}

std::string stays_text(const ltm::EntityForgetPlan& plan) {
  std::string text = count_text(plan.stays);
  if (plan.shielded > 0) text += ", " + count_text(plan.shielded) + " of them protected";
  if (plan.unsealed > 0) text += ", " + count_text(plan.unsealed) + " not sealed yet";
  return text;
}

void print_entity(const ltm::MemoryId& id, const ltm::EntityForgetPlan& plan) {
  print(id.to_string());
  if (!plan.gone.empty())
    print(fmt::format("  goes   {} snapshots, {} to {}, about {}", count_text(plan.gone.size()),
                      to_string(plan.gone.front()), to_string(plan.gone.back()),
                      size_text(plan.freed_bytes)));
  for (const auto& [reason, count] : plan.reasons)
    print(fmt::format("         {} {}", count_text(count), reason));
  print("  stays  " + stays_text(plan));
}

Json entity_json(const ltm::MemoryId& id, const ltm::EntityForgetPlan& plan) {
  Json times = Json::array();
  for (const Time time : plan.gone) times.push_back(to_ns(time));
  Json reasons = Json::object();
  for (const auto& [reason, count] : plan.reasons) reasons[reason] = count;
  return {{"id", id.to_string()},
          {"forgotten", plan.gone.size()},
          {"reasons", std::move(reasons)},
          {"freed_bytes", plan.freed_bytes},
          {"stays", plan.stays},
          {"protected", plan.shielded},
          {"not_sealed_yet", plan.unsealed},
          {"times_ns", std::move(times)}};
}

}  // namespace

void print_plan(const ltm::ForgetPlan& plan) {
  for (const auto& [id, entity] : plan.entities)
    if (!entity.gone.empty() || entity.shielded > 0) print_entity(id, entity);
  print(fmt::format("In all {} snapshots, about {} of {}", count_text(plan.snapshots()),
                    size_text(plan.freed_bytes), size_text(plan.store_bytes)));
  if (plan.unsealed() > 0)
    print(fmt::format("{} snapshots are not sealed yet and stay", count_text(plan.unsealed())));
}

Json plan_json(const ltm::ForgetPlan& plan) {
  Json entities = Json::array();
  for (const auto& [id, entity] : plan.entities) entities.push_back(entity_json(id, entity));
  return {{"snapshots", plan.snapshots()},
          {"freed_bytes", plan.freed_bytes},
          {"store_bytes", plan.store_bytes},
          {"free_disk_bytes", plan.free_disk_bytes},
          {"quota_missing_bytes", plan.missing_bytes},
          {"not_sealed_yet", plan.unsealed()},
          {"entities", std::move(entities)}};
}

void print_report(const ltm::ForgetReport& report) {
  print(fmt::format(
      "{} snapshots forgotten, {} freed: {} before, {} after{}",
      count_text(report.rewritten.snapshots),
      size_text(report.bytes_before - std::min(report.bytes_before, report.bytes_after)),
      size_text(report.bytes_before), size_text(report.bytes_after),
      report.rounds > 1 ? fmt::format(" ({} rounds for the quota)", report.rounds) : ""));
}

Json report_json(const ltm::ForgetReport& report) {
  return {{"snapshots", report.rewritten.snapshots},
          {"rounds", report.rounds},
          {"segments_before", report.rewritten.segments_before},
          {"segments_after", report.rewritten.segments_after},
          {"segment_bytes_freed", report.rewritten.freed_bytes()},
          {"store_bytes_before", report.bytes_before},
          {"store_bytes_after", report.bytes_after},
          {"quota_missing_bytes", report.missing_bytes},
          {"is_cancelled", report.rewritten.is_cancelled}};
}

}  // namespace engram::reports
