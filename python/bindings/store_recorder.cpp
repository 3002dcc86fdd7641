// SPDX-License-Identifier: Apache-2.0
#include "python/bindings/store_recorder.h"

#include <pybind11/stl.h>

#include "ltm/recording/recording_config.h"
#include "python/bindings/bound_commit.h"
#include "python/bindings/errors.h"

namespace engram::python {

namespace {

namespace py = pybind11;

Result<ltm::Recorder::Options> options_of(const std::string& config, const std::string& preset) {
  if (!config.empty()) return ltm::read_recording_config(config);
  if (preset.empty()) return ltm::Recorder::Options{};
  ENGRAM_ASSIGN_OR_RETURN(const std::string_view yaml, ltm::recording_preset(preset));
  return ltm::parse_recording_config(yaml, "preset " + preset);
}

py::dict counts_of(const ltm::RecordingCounters& of) {
  py::dict counts;
  counts["rule"] = of.rule;
  counts["offered"] = of.offered;
  counts["offered_bytes"] = of.offered_bytes;
  counts["kept"] = of.kept;
  counts["kept_bytes"] = of.kept_bytes;
  counts["stored_bytes"] = of.stored_bytes;
  py::dict dropped;
  for (const auto& [filter, count] : of.dropped_by) dropped[py::str(filter)] = count;
  counts["dropped_by"] = std::move(dropped);
  counts["redacted"] = of.redacted_images;
  counts["redacted_boxes"] = of.redacted_boxes;
  counts["redact_unanswered"] = of.redact_unanswered;
  counts["redact_unreadable"] = of.redact_unreadable;
  counts["late"] = of.late;
  counts["failed"] = of.failed;
  return counts;
}

}  // namespace

StoreRecorder::StoreRecorder(const std::string& store, const std::string& config,
                             const std::string& preset) {
  const auto options = value_or_raise(options_of(config, preset));
  auto opened = [&] {
    const py::gil_scoped_release released;
    return ltm::Recorder::open(store, options);
  }();
  recorder_.emplace(value_or_raise(std::move(opened)));
}

/// Calls `work`, which returns a Status, without the GIL.
template <typename Work>
auto StoreRecorder::with_recorder(Work work) {
  const Status status = [&]() -> Status {
    const py::gil_scoped_release released;
    const MutexLock lock(mutex_);
    if (!recorder_) return failed_precondition("the recorder is closed");
    return work(*recorder_);
  }();
  if (!status.ok()) raise(status);
}

void StoreRecorder::commit(const py::list& updates) {
  const ltm::Commit commit = commit_of(updates);
  with_recorder([&](ltm::Recorder& recorder) { return recorder.commit(commit); });
}

py::dict StoreRecorder::counts() {
  const auto found = [&] {
    const py::gil_scoped_release released;
    const MutexLock lock(mutex_);
    return recorder_ ? recorder_->counters() : counters_;
  }();
  py::dict counts;
  for (const auto& [entity, of] : found) counts[py::str(entity.to_string())] = counts_of(of);
  return counts;
}

void StoreRecorder::close() {
  const Status status = [&]() -> Status {
    const py::gil_scoped_release released;
    const MutexLock lock(mutex_);
    if (!recorder_) return {};
    const Status closed = recorder_->close();
    counters_ = recorder_->counters();
    recorder_.reset();
    return closed;
  }();
  if (!status.ok()) raise(status);
}

}  // namespace engram::python
