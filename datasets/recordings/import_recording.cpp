// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/import_recording.h"

#include <set>

#include "ltm/core/read_ahead.h"

namespace engram::datasets {

namespace {

constexpr uint64_t kValuesPerProgress = 16;
constexpr size_t kBytesAhead = 32 << 20;

size_t bytes_of(const RecordingReader::Moment& moment) {
  if (moment.unmade) return moment.unmade->bytes;
  size_t bytes = 0;
  for (const ltm::EntityUpdate& update : moment.commit.updates) bytes += update.raw_bytes();
  return bytes;
}

class Import {
 public:
  Import(RecordingReader& reader, std::string_view format, ltm::Recorder& recorder,
         const ProgressSink& progress)
      : reader_(reader), format_(format), recorder_(recorder), progress_(progress) {
    for (const RecordingStream& stream : reader.streams())
      if (!stream.counted_as.empty()) {
        counted_as_[stream.entity] = stream.counted_as;
        report_.counts[stream.counted_as] = 0;
      }
  }

  Status run(const std::stop_token& stop) {
    ENGRAM_RETURN_IF_ERROR(check_streams());
    ReadAhead<RecordingReader::Moment> ahead([this] { return reader_.next(); }, bytes_of,
                                             kBytesAhead);
    while (true) {
      if (stop.stop_requested()) {
        report_.is_cancelled = true;
        break;
      }
      ENGRAM_ASSIGN_OR_RETURN(auto moment, ahead.next());
      if (!moment) break;
      if (moment->commit.updates.empty() && !moment->begins) continue;
      ENGRAM_RETURN_IF_ERROR(take(*std::move(moment)));
    }
    tell(true);
    return {};
  }

  [[nodiscard]] const RecordingImportReport& report() const { return report_; }

 private:
  Status take(RecordingReader::Moment moment) {
    if (moment.begins) ENGRAM_RETURN_IF_ERROR(begin(*moment.begins, moment.commit));
    for (const ltm::EntityUpdate& update : moment.commit.updates)
      ENGRAM_RETURN_IF_ERROR(check_is_new(update.entity, update.time));
    ENGRAM_ASSIGN_OR_RETURN(const bool is_dropped, is_dropped_unmade(moment));
    if (!is_dropped) ENGRAM_RETURN_IF_ERROR(recorder_.commit(moment.commit));
    for (const ltm::EntityUpdate& update : moment.commit.updates) count(update);
    tell(false);
    return {};
  }

  /// Makes a lazy value, unless the recorder drops it because of its time. Converting and scaling
  /// images is most of the work of reading a video, so an image that is dropped is never made.
  Result<bool> is_dropped_unmade(RecordingReader::Moment& moment) {
    if (!moment.unmade) return false;
    ltm::EntityUpdate& update = moment.commit.updates.front();
    if (recorder_.drop_unmade(update.entity, update.time, update.raw_bytes())) return true;
    ENGRAM_RETURN_IF_ERROR(moment.unmade->make(update));
    return false;
  }

  void count(const ltm::EntityUpdate& update) {
    if (!report_.first) report_.first = update.time;
    report_.last = update.time;
    ++report_.values;
    if (const auto named = counted_as_.find(update.entity); named != counted_as_.end())
      ++report_.counts[named->second];
  }

  /// Commits the description of an episode and, before the first one, those of the streams.
  Status begin(const RecordingEpisode& episode, const ltm::Commit& first) {
    ++report_.episodes;
    const Time time =
        first.updates.empty() ? episode.start : std::min(episode.start, first.updates[0].time);
    ltm::Commit commit;
    const auto add = [&](const ltm::MemoryId& entity, idf::Data value) -> Status {
      ENGRAM_RETURN_IF_ERROR(check_is_new(entity, time));
      commit.updates.push_back(imported(entity, time, std::move(value)));
      return {};
    };
    ENGRAM_RETURN_IF_ERROR(add(episode_entity(format_), episode.to_data()));
    if (report_.episodes == 1)
      for (const RecordingStream& stream : reader_.streams())
        ENGRAM_RETURN_IF_ERROR(add(stream_entity(format_, stream.entity), stream.to_data()));
    return recorder_.commit(std::move(commit));
  }

  /// Checks the streams whose begin the reader knows, before anything is committed.
  Status check_streams() {
    for (const RecordingStream& stream : reader_.streams())
      if (stream.first) ENGRAM_RETURN_IF_ERROR(check_is_new(stream.entity, *stream.first));
    return {};
  }

  /// Fails if the store has a snapshot at or after `time` of an entity that this import has not yet
  /// written to.
  Status check_is_new(const ltm::MemoryId& entity, Time time) {
    if (!checked_.insert(entity).second) return {};
    const std::optional<Time> last = recorder_.last_time(entity);
    if (!last || *last < time) return {};
    // The suggested start moves `time` behind the last snapshot, by the same shift.
    const Time start = reader_.start().value_or(time);
    const auto fits = std::chrono::ceil<std::chrono::seconds>(start + (*last - time) + Duration(1));
    return failed_precondition(
        "entity '{}': has a snapshot at {}, the import would begin at {}; needs a start of {} or "
        "later",
        entity.to_string(), to_string(*last), to_string(time), to_string(Time(fits)));
  }

  void tell(bool is_last) const {
    if (!progress_ || (!is_last && report_.values % kValuesPerProgress != 0)) return;
    const uint64_t total = is_last && !report_.is_cancelled ? report_.values : reader_.total();
    progress_({.what = fmt::format("import {}", format_),
               .done = report_.values,
               // Some readers know the total only approximately.
               .total = total == 0 ? 0 : std::max(total, report_.values),
               .detail = report_.counts.empty() ? last_text() : report_.counted_text()});
  }

  [[nodiscard]] std::string last_text() const {
    return report_.last ? to_string(*report_.last) : "";
  }

  RecordingReader& reader_;
  std::string_view format_;
  ltm::Recorder& recorder_;
  const ProgressSink& progress_;
  std::set<ltm::MemoryId> checked_;
  std::map<ltm::MemoryId, std::string> counted_as_;
  RecordingImportReport report_;
};

}  // namespace

std::string RecordingImportReport::counted_text() const {
  if (counts.empty()) return fmt::format("{} values", values);
  std::string text;
  for (const auto& [what, count] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : " and ", count, what);
  return text;
}

Result<RecordingImportReport> import_recording(RecordingReader& reader, std::string_view format,
                                               ltm::Recorder& recorder,
                                               const ProgressSink& progress,
                                               const std::stop_token& stop) {
  Import import(reader, format, recorder, progress);
  if (const Status status = import.run(stop); !status.ok())
    return status.with_context(
        fmt::format("import stopped after {}, which stay", import.report().counted_text()));
  RecordingImportReport report = import.report();
  report.reading = reader.report();
  return report;
}

}  // namespace engram::datasets
