// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/import_report.h"

#include "reports/plain/text.h"

namespace engram::reports {

namespace {

Json filter_json(const ltm::FilterCounters& counters) {
  return {{"filter", counters.filter},
          {"offered", counters.offered},
          {"offered_bytes", counters.offered_bytes},
          {"kept", counters.kept},
          {"dropped_by", counters.dropped_by},
          {"dropped_bytes", counters.dropped_bytes},
          {"held", counters.held.snapshots},
          {"held_bytes", counters.held.bytes}};
}

Json entity_json(const ltm::MemoryId& id, const ltm::RecordingCounters& counters) {
  Json filters = Json::array();
  for (const ltm::FilterCounters& filter : counters.filters) filters.push_back(filter_json(filter));
  return {{"entity", id.to_string()},
          {"rule", counters.rule},
          {"offered", counters.offered},
          {"kept", counters.kept},
          {"dropped_by", counters.dropped_by},
          {"held", counters.held.snapshots},
          {"held_bytes", counters.held.bytes},
          {"late", counters.late},
          {"failed", counters.failed},
          {"filters", std::move(filters)},
          {"reinterpreted", counters.reinterpreted},
          {"offered_bytes", counters.offered_bytes},
          {"kept_bytes", counters.kept_bytes},
          {"stored_bytes", counters.stored_bytes}};
}

Json entities_json(const ltm::Recorder& recorder) {
  Json entities = Json::array();
  for (const auto& [id, counters] : recorder.counters())
    entities.push_back(entity_json(id, counters));
  return entities;
}

/// "frequency 120 (rate 120), similarity 12 (similar 12)"; "0" where nothing was dropped.
std::string dropped_text(const ltm::RecordingCounters& counters) {
  std::string text;
  for (const ltm::FilterCounters& filter : counters.filters) {
    if (filter.dropped() == 0) continue;
    std::string reasons;
    for (const auto& [reason, count] : filter.dropped_by)
      reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", reason, count_text(count));
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", filter.filter, reasons);
  }
  return text.empty() ? "0" : text;
}

void print_filters(const ltm::MemoryId& id, const ltm::RecordingCounters& counters) {
  if (!counters.rule.empty())
    print(fmt::format("{}: rule '{}', dropped by {}", id.to_string(), counters.rule,
                      dropped_text(counters)));
  if (counters.held.snapshots > 0)
    print(fmt::format("{}: {} snapshots ({}) were still held by filters", id.to_string(),
                      count_text(counters.held.snapshots),
                      bytes_text(static_cast<double>(counters.held.bytes))));
  if (counters.late > 0)
    print(fmt::format("{}: {} snapshots came late, past the filters", id.to_string(),
                      count_text(counters.late)));
  if (counters.failed > 0)
    print(fmt::format("{}: {} snapshots could not be stored", id.to_string(),
                      count_text(counters.failed)));
}

void print_recorder(const ltm::Recorder& recorder) {
  TextTable table({"entity", "offered", "kept", "dropped", "raw", "kept raw", "journal"});
  for (const auto& [id, counters] : recorder.counters()) {
    uint64_t total = 0;
    for (const auto& [filter, count] : counters.dropped_by) total += count;
    std::string dropped = count_text(total);
    for (const auto& [filter, count] : counters.dropped_by) dropped += " " + filter;
    table.add({id.to_string(), count_text(counters.offered), count_text(counters.kept), dropped,
               bytes_text(static_cast<double>(counters.offered_bytes)),
               bytes_text(static_cast<double>(counters.kept_bytes)),
               bytes_text(static_cast<double>(counters.stored_bytes))});
  }
  print(table.to_string());
  for (const auto& [id, counters] : recorder.counters()) print_filters(id, counters);
  for (const auto& [id, counters] : recorder.counters())
    if (counters.reinterpreted > 0)
      print(fmt::format("{}: {} values were cast to their segment's type ({})", id.to_string(),
                        count_text(counters.reinterpreted), counters.last_reinterpretation));
}

void print_span(const std::optional<Time>& first, const std::optional<Time>& last) {
  if (first && last) print(fmt::format("{} to {}", to_string(*first), to_string(*last)));
}

}  // namespace

Json import_json(const datasets::ImportReport& report, const ltm::Recorder& recorder) {
  return {{"frames", report.frames},
          {"rows", report.rows},
          {"damaged_frames", report.damaged_frames},
          {"duplicate_frames", report.duplicate_frames},
          {"rows_outside_video", report.rows_outside_video},
          {"cancelled", report.is_cancelled},
          {"damaged_journal_places", recorder.lost_frames()},
          {"entities", entities_json(recorder)}};
}

Json import_json(const datasets::RecordingImportReport& report, const ltm::Recorder& recorder) {
  Json not_carried = Json::object();
  for (const auto& [what, count] : report.reading.not_carried) not_carried[what] = count;
  return {{"episodes", report.episodes},
          {"values", report.values},
          {"not_carried", std::move(not_carried)},
          {"damaged", report.reading.damaged},
          {"duplicate_images", report.reading.duplicate_images},
          {"truncated_at", report.reading.truncated_at},
          {"cancelled", report.is_cancelled},
          {"damaged_journal_places", recorder.lost_frames()},
          {"entities", entities_json(recorder)}};
}

void print_import(const datasets::ImportReport& report, const ltm::Recorder& recorder) {
  print_recorder(recorder);
  print_span(report.first, report.last);
  if (report.duplicate_frames > 0)
    print(fmt::format("{} frames repeat the one before exactly",
                      count_text(report.duplicate_frames)));
  if (report.rows_outside_video > 0)
    print(fmt::format("{} rows lie outside of the video", count_text(report.rows_outside_video)));
}

void print_import(const datasets::RecordingImportReport& report, const ltm::Recorder& recorder) {
  print_recorder(recorder);
  print_span(report.first, report.last);
  print(fmt::format("{} values of {} episodes", count_text(report.values),
                    count_text(report.episodes)));
  if (report.reading.duplicate_images > 0)
    print(fmt::format("{} images repeat the one before exactly",
                      count_text(report.reading.duplicate_images)));
  if (!report.reading.not_carried.empty()) print("Not as it was:");
  for (const auto& [what, count] : report.reading.not_carried)
    print(fmt::format("  {:>10}  {}", count_text(count), what));
}

}  // namespace engram::reports
