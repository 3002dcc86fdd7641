// SPDX-License-Identifier: Apache-2.0
// What the recorder costs beyond codec and journal, on the paper's stream: 43 joint positions and
// velocities at 100 Hz, two 640 x 480 images at 20 Hz. One item is one second of it.
#include <benchmark/benchmark.h>

#include <cmath>

#include "ltm/recording/recording_config.h"
#include "ltm/store/manifest.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

constexpr int kJoints = 43;
constexpr int kJointRate = 100;
constexpr int kImageRate = 20;

idf::Data joints(int step) {
  idf::Dict positions, velocities;
  for (int j = 0; j < kJoints; ++j) {
    const double phase = 0.01 * step + j;
    positions.append_unique("joint_" + std::to_string(j), std::sin(phase));
    velocities.append_unique("joint_" + std::to_string(j), std::cos(phase));
  }
  return idf::Dict{{"positions", std::move(positions)}, {"velocities", std::move(velocities)}};
}

/// Smooth shapes with some sensor noise, as a camera sees them.
idf::Data image(int step) {
  std::vector<uint8_t> pixels(size_t{640} * 480 * 3);
  uint32_t noise = static_cast<uint32_t>(step) + 1;
  for (size_t i = 0; i < pixels.size(); ++i) {
    noise = noise * 1664525 + 1013904223;
    pixels[i] = static_cast<uint8_t>(i / 2000 + i / 3 % 640 / 8 + static_cast<size_t>(step) +
                                     (noise >> 30));
  }
  return idf::Dict{{"image", idf::NdArray::take<uint8_t>({480, 640, 3}, std::move(pixels))}};
}

/// The commits of one second, times from 0.
std::vector<Commit> make_second() {
  const MemoryId robot = *MemoryId::parse("RobotState/Proprioception/robot/joints");
  const MemoryId left = *MemoryId::parse("Vision/RGB/head/left");
  const MemoryId right = *MemoryId::parse("Vision/RGB/head/right");
  std::vector<Commit> commits;
  for (int i = 0; i < kJointRate; ++i) {
    const Time time{std::chrono::milliseconds(10 * i)};
    Commit commit{{{robot, time, {{joints(i), {}}}}}};
    if (i % (kJointRate / kImageRate) == 0)
      for (const MemoryId& camera : {left, right})
        commit.updates.push_back({camera, time, {{image(i), {}}}});
    commits.push_back(std::move(commit));
  }
  return commits;
}

void shift(std::vector<Commit>& commits, Duration by) {
  for (Commit& commit : commits)
    for (Snapshot& update : commit.updates) update.time += by;
}

/// The whole recorder.
void record(benchmark::State& state, const char* config) {
  const ScratchDirectory directory;
  auto options = parse_recording_config(config, "benchmark").value();
  options.store.durability = Durability::kNone;
  auto recorder = Recorder::open(directory / "store", options).value();
  std::vector<Commit> second = make_second();
  size_t bytes = 0;
  for (const Commit& commit : second)
    for (const Snapshot& update : commit.updates) bytes += update.raw_bytes();
  for (auto _ : state) {
    for (const Commit& commit : second)
      if (!recorder.commit(commit).ok()) return state.SkipWithError("commit failed");
    shift(second, std::chrono::seconds(1));
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(bytes));
  state.SetItemsProcessed(state.iterations());
}

/// Codec and journal alone: what the recorder without filters has to be compared with.
void pack_and_append(benchmark::State& state, const char* config) {
  const ScratchDirectory directory;
  auto options = parse_recording_config(config, "benchmark").value();
  options.store.durability = Durability::kNone;
  if (!create_store(directory / "store").ok()) return state.SkipWithError("no store");
  auto writer = StoreWriter::open(directory / "store", options.store).value();
  std::vector<Commit> second = make_second();
  for (auto _ : state) {
    for (const Commit& commit : second) {
      std::vector<PackedSnapshot> packed;
      for (const Snapshot& update : commit.updates) {
        PackedSnapshot made{update.entity, update.time, {}, update.raw_bytes(), 0, 0};
        made.instances.push_back(
            {pack(update.instances[0].data, options.rules[0].pack).value(), {}});
        packed.push_back(std::move(made));
      }
      if (!writer->append(packed, nullptr).ok()) return state.SkipWithError("append failed");
    }
    shift(second, std::chrono::seconds(1));
  }
  state.SetItemsProcessed(state.iterations());
}

/// What comes out of working memory: 100 snapshots of 86 typed numbers, of which a filter keeps
/// none, so that what is left is what the recorder does with their values. One item is a snapshot.
void take_over(benchmark::State& state, bool is_checked) {
  const ScratchDirectory directory;
  auto options = parse_recording_config(
                     "entities: [{match: .*, filters: [{frequency: {rate: 1mHz}}]}]", "benchmark")
                     .value();
  options.store.durability = Durability::kNone;
  auto recorder = Recorder::open(directory / "store", options).value();
  const MemoryId segment = *MemoryId::parse("RobotState/Proprioception");
  const auto numbers = idf::Type::dict(idf::Type::float64());
  const auto type = idf::Type::object("Joints", {{"positions", numbers}, {"velocities", numbers}});
  if (!recorder.declare(segment, type).ok()) return state.SkipWithError("not declared");
  std::vector<std::shared_ptr<const CheckedSnapshot>> held;
  std::vector<const CheckedSnapshot*> updates;
  for (int i = 0; i < kJointRate; ++i) {
    Snapshot snapshot{*MemoryId::parse("RobotState/Proprioception/robot/joints"),
                      Time{std::chrono::milliseconds(10 * i)},
                      {{joints(i), {}}}};
    held.push_back(CheckedSnapshot::check(std::move(snapshot), recorder.types()).value().snapshot);
    updates.push_back(held.back().get());
  }
  for (auto _ : state) {
    Commit copy;
    if (!is_checked)
      for (const CheckedSnapshot* update : updates) copy.updates.push_back(*update);
    const Status status = is_checked ? recorder.commit_checked(updates) : recorder.commit(copy);
    if (!status.ok()) return state.SkipWithError("commit failed");
  }
  state.SetItemsProcessed(state.iterations() * kJointRate);
}

// zstd is the cheapest codec: what is left is the recorder's own work.
constexpr const char* kPlain =
    "entities: [{match: .*, codecs: [{kind: image, codec: zstd}]}]\nrecording: {threads: 1}\n";
constexpr const char* kPlainThreads =
    "entities: [{match: .*, codecs: [{kind: image, codec: zstd}]}]\nrecording: {threads: 2}\n";
// Filters that look at everything and keep nothing but the first: no codec, no journal.
constexpr const char* kEquality =
    "entities: [{match: .*, filters: [{frequency: {rate: 1mHz}}, equality]}]\n";
constexpr const char* kSimilarity =
    "entities: [{match: .*, filters: [{similarity: {numbers: {measure: max_abs, bound: 1e9},"
    " images: {measure: ssim, bound: -1}, max_gap: never}}]}]\n";
constexpr const char* kImages =
    "entities: [{match: .*, filters: [{similarity: {numbers: {measure: ignore},"
    " images: {measure: mse, bound: 1e9}, max_gap: never}}]}]\n";

BENCHMARK_CAPTURE(pack_and_append, zstd, kPlain)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record, zstd_one_thread, kPlain)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record, zstd_two_threads, kPlainThreads)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(record, filter_frequency, kEquality)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record, filter_similarity_ssim, kSimilarity)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record, filter_similarity_mse, kImages)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(record, preset_balanced, "preset: balanced\n")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(take_over, checks_again, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(take_over, by_proof, true)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace engram::ltm
