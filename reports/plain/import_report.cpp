// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/import_report.h"

#include "ltm/core/printable.h"
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
          {"redacted", counters.redacted_images},
          {"redacted_boxes", counters.redacted_boxes},
          {"redact_unanswered", counters.redact_unanswered},
          {"redact_unreadable", counters.redact_unreadable},
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

/// Such as "frequency 120 (rate 120), similarity 12 (similar 12)"; "0" if nothing was dropped.
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
    print(fmt::format("{}: rule '{}', dropped by {}", id.printable(), counters.rule,
                      dropped_text(counters)));
  if (counters.held.snapshots > 0)
    print(fmt::format("{}: {} snapshots ({}) were still held by filters", id.printable(),
                      count_text(counters.held.snapshots),
                      bytes_text(static_cast<double>(counters.held.bytes))));
  if (counters.late > 0)
    print(fmt::format("{}: {} snapshots came late, past the filters", id.printable(),
                      count_text(counters.late)));
  if (counters.redacted_images + counters.redact_dropped > 0)
    print(fmt::format(
        "{}: {} images redacted in {} boxes; {} snapshots dropped, {} of them without an answer "
        "and "
        "{} with images in which no detector looks",
        id.printable(), count_text(counters.redacted_images), count_text(counters.redacted_boxes),
        count_text(counters.redact_dropped), count_text(counters.redact_unanswered),
        count_text(counters.redact_unreadable)));
  if (counters.failed > 0)
    print(fmt::format("{}: {} snapshots could not be stored", id.printable(),
                      count_text(counters.failed)));
}

void print_recorder(const ltm::Recorder& recorder) {
  TextTable table({"entity", "offered", "kept", "dropped", "raw", "kept raw", "journal"});
  for (const auto& [id, counters] : recorder.counters()) {
    uint64_t total = 0;
    for (const auto& [filter, count] : counters.dropped_by) total += count;
    std::string dropped = count_text(total);
    for (const auto& [filter, count] : counters.dropped_by) dropped += " " + filter;
    table.add({id.printable(), count_text(counters.offered), count_text(counters.kept), dropped,
               bytes_text(static_cast<double>(counters.offered_bytes)),
               bytes_text(static_cast<double>(counters.kept_bytes)),
               bytes_text(static_cast<double>(counters.stored_bytes))});
  }
  print(table.to_string());
  for (const auto& [id, counters] : recorder.counters()) print_filters(id, counters);
  for (const auto& [id, counters] : recorder.counters())
    if (counters.reinterpreted > 0)
      print(fmt::format("{}: {} values were cast to their segment's type ({})", id.printable(),
                        count_text(counters.reinterpreted), counters.last_reinterpretation));
}

void print_span(const std::optional<Time>& first, const std::optional<Time>& last) {
  if (first && last) print(fmt::format("{} to {}", to_string(*first), to_string(*last)));
}

}  // namespace

void show_streams(std::string_view format, const std::vector<datasets::RecordingStream>& streams,
                  bool is_json) {
  if (is_json) {
    Json list = Json::array();
    for (const datasets::RecordingStream& stream : streams)
      list.push_back({{"name", stream.name},
                      {"entity", stream.entity.to_string()},
                      {"values", stream.values}});
    print_json({{"format", format}, {"streams", std::move(list)}});
    return;
  }
  TextTable table({fmt::format("in the {}", format), "becomes", "values"});
  for (const datasets::RecordingStream& stream : streams)
    table.add({printable(stream.name), stream.entity.printable(),
               stream.values > 0 ? count_text(stream.values) : "-"});
  print(table.to_string());
}

Json import_json(const datasets::RecordingImportReport& report, const ltm::Recorder& recorder) {
  const datasets::ReadingReport& reading = report.reading;
  Json not_carried = Json::object();
  for (const auto& [what, count] : reading.not_carried) not_carried[what] = count;
  Json json{{"episodes", report.episodes}, {"values", report.values}};
  for (const auto& [what, count] : report.counts) json[what] = count;
  json.update({{"not_carried", std::move(not_carried)},
               {"damaged", reading.damaged},
               {"duplicate_images", reading.duplicate_images},
               {"truncated_at", reading.truncated_at}});
  // Videos reported these names before they were imported like all other recordings, and keep them
  // for scripts that read them.
  if (report.counts.contains("frames"))
    json.update({{"rows", report.counts.contains("rows") ? report.counts.at("rows") : 0},
                 {"damaged_frames", reading.damaged},
                 {"duplicate_frames", reading.duplicate_images},
                 {"rows_outside_video", reading.rows_outside}});
  json.update({{"cancelled", report.is_cancelled},
               {"damaged_journal_places", recorder.lost_frames()},
               {"entities", entities_json(recorder)}});
  return json;
}

void print_import(const datasets::RecordingImportReport& report, const ltm::Recorder& recorder) {
  const datasets::ReadingReport& reading = report.reading;
  print_recorder(recorder);
  print_span(report.first, report.last);
  if (report.counts.empty())
    print(fmt::format("{} values of {} episodes", count_text(report.values),
                      count_text(report.episodes)));
  if (reading.duplicate_images > 0)
    print(fmt::format("{} images repeat the one before exactly",
                      count_text(reading.duplicate_images)));
  if (reading.rows_outside > 0)
    print(fmt::format("{} rows lie outside of the video", count_text(reading.rows_outside)));
  if (!reading.not_carried.empty()) print("Not as it was:");
  for (const auto& [what, count] : reading.not_carried)
    print(fmt::format("  {:>10}  {}", count_text(count), what));
}

}  // namespace engram::reports
