// SPDX-License-Identifier: Apache-2.0
#include "store/recorder_run.h"

#include <algorithm>
#include <thread>

#include "ltm/recording/recording_config.h"
#include "store/verify_store.h"

namespace engram::experiments {

namespace {

/// Waits for the time of a tick and returns its delay.
double wait_for(const Stopwatch& clock, size_t tick, double pace) {
  if (pace <= 0) return 0;
  const double due = static_cast<double>(tick) / (pace * Stream::kTicksPerSecond);
  const double early = due - clock.seconds();
  if (early > 0) std::this_thread::sleep_for(std::chrono::duration<double>(early));
  return std::max(0.0, clock.seconds() - due);
}

Status commit_all(const RecorderRun& run, const Stream& stream, ltm::Recorder& recorder,
                  RecorderFigures& figures) {
  std::vector<double> latencies;
  latencies.reserve(stream.ticks());
  const Stopwatch clock;
  for (size_t i = 0; i < stream.ticks(); ++i) {
    const ltm::Commit commit = commit_of(stream.tick(i));
    figures.late_s = std::max(figures.late_s, wait_for(clock, i, run.pace));
    const Stopwatch one;
    ENGRAM_RETURN_IF_ERROR(recorder.commit(commit));
    latencies.push_back(one.seconds());
  }
  if (!latencies.empty()) figures.commit = summarize(latencies);
  return {};
}

uint64_t kept(const ltm::Recorder& recorder) {
  uint64_t sum = 0;
  for (const auto& [entity, counters] : recorder.counters()) sum += counters.kept;
  return sum;
}

Status record(const RecorderRun& run, const Stream& stream, const std::filesystem::path& store,
              RecorderFigures& figures) {
  ENGRAM_ASSIGN_OR_RETURN(const auto options, ltm::parse_recording_config(run.config, run.name));
  const Stopwatch clock;
  const double cpu = cpu_seconds();
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder, ltm::Recorder::open(store, options));
  ENGRAM_RETURN_IF_ERROR(commit_all(run, stream, recorder, figures));
  const double committed = clock.seconds();
  ENGRAM_RETURN_IF_ERROR(recorder.close());
  figures.seconds = clock.seconds();
  figures.cpu_seconds = cpu_seconds() - cpu;
  figures.times_real = stream.seconds() / (run.pace > 0 ? committed : figures.seconds);
  figures.snapshots = kept(recorder);
  return {};
}

}  // namespace

Result<RecorderFigures> record_stream(const RecorderRun& run, const Stream& stream,
                                      const std::filesystem::path& store) {
  ENGRAM_RETURN_IF_ERROR(make_empty(store));
  ENGRAM_RETURN_IF_ERROR(reset_peak_memory());
  ENGRAM_ASSIGN_OR_RETURN(const Memory before, memory());
  RecorderFigures figures;
  ENGRAM_RETURN_IF_ERROR(record(run, stream, store, figures));
  ENGRAM_ASSIGN_OR_RETURN(const Memory after, memory());
  figures.memory_bytes = after.peak_bytes - std::min(after.peak_bytes, before.now_bytes);
  figures.raw_bytes = stream.raw_bytes();
  ENGRAM_ASSIGN_OR_RETURN(figures.disk_bytes, tree_bytes(store));
  const uint64_t expected = run.keeps_all ? count_snapshots(stream) : figures.snapshots;
  ENGRAM_RETURN_IF_ERROR(verify_store(store, stream, expected));
  return figures;
}

}  // namespace engram::experiments
