// SPDX-License-Identifier: Apache-2.0
#include "store/recorder_run.h"

#include <algorithm>
#include <thread>

#include "ltm/likeness/make_codes.h"
#include "ltm/likeness/sealed_indexer.h"
#include "ltm/recording/recording_config.h"
#include "ltm/store/segment_index.h"
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
  ENGRAM_ASSIGN_OR_RETURN(auto options, ltm::parse_recording_config(run.config, run.name));
  std::optional<ltm::SealedIndexer> coder;
  if (run.codes_images) {
    coder.emplace(store);
    options.store.after_seal = [&coder](const std::string& segment) { coder->add(segment); };
  }
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

/// Makes an empty store that knows how to code the images of the stream: what a night learned from
/// the same stream before.
Status make_learned(const RecorderRun& run, const Stream& stream,
                    const std::filesystem::path& store) {
  const std::filesystem::path kept = store.string() + ".indexes";
  RecorderFigures unused;
  ENGRAM_RETURN_IF_ERROR(
      record({run.name, run.config, run.keeps_all, 0, false}, stream, store, unused));
  ENGRAM_RETURN_IF_ERROR(ltm::make_codes(store, {}, {}, {}, {}).status());
  std::filesystem::remove_all(kept);
  std::filesystem::create_directories(kept);
  std::error_code missing;  // Too few images to learn from.
  for (const auto& file : std::filesystem::directory_iterator(store / ltm::kIndexFolder, missing))
    if (file.path().extension() == ".space")
      std::filesystem::copy(file.path(), kept / file.path().filename());
  ENGRAM_RETURN_IF_ERROR(make_empty(store));
  ENGRAM_RETURN_IF_ERROR(ltm::create_store(store));
  std::filesystem::create_directories(store / ltm::kIndexFolder);
  std::filesystem::copy(kept, store / ltm::kIndexFolder,
                        std::filesystem::copy_options::overwrite_existing);
  std::filesystem::remove_all(kept);
  return {};
}

}  // namespace

Result<RecorderFigures> record_stream(const RecorderRun& run, const Stream& stream,
                                      const std::filesystem::path& store) {
  ENGRAM_RETURN_IF_ERROR(make_empty(store));
  if (run.codes_images) ENGRAM_RETURN_IF_ERROR(make_learned(run, stream, store));
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
