// SPDX-License-Identifier: Apache-2.0
#include "tests/speech/dialogues/recorded_kitchens.h"

#include "datasets/kitchen/kitchen.h"
#include "ltm/recording/recorder.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::speech {

namespace {

void record(const std::filesystem::path& store, const datasets::KitchenOptions& options) {
  auto recorder = ltm::Recorder::open(store, {.max_ahead = ltm::AheadLimits::kNone});
  ENGRAM_CHECK(recorder.ok(), "{}", recorder.status().message());
  for (const auto& [segment, type] : datasets::kitchen_types(false, options.has_colours)) {
    const Status declared = recorder->declare(segment, type);
    ENGRAM_CHECK(declared.ok(), "{}", declared.message());
  }
  const auto summary = datasets::simulate_kitchen(
      options, [&](const ltm::Commit& commit) { return recorder->commit(commit); }, {});
  ENGRAM_CHECK(summary.ok(), "{}", summary.status().message());
  const Status closed = recorder->close();
  ENGRAM_CHECK(closed.ok(), "{}", closed.message());
}

datasets::KitchenOptions without_images(uint64_t seed, double seconds) {
  datasets::KitchenOptions options = datasets::KitchenOptions::fast();
  options.has_images = false;
  options.seed = seed;
  options.seconds = seconds;
  return options;
}

/// A store that lives as long as the process.
struct RecordedStore {
  ScratchDirectory scratch;
  std::unique_ptr<Memory> memory;

  [[nodiscard]] std::filesystem::path path() const { return scratch.path() / "kitchen.engram"; }
  void open() {
    auto opened = Memory::open(path(), {.is_read_only = true, .notes_reads = false});
    ENGRAM_CHECK(opened.ok(), "{}", opened.status().message());
    memory = *std::move(opened);
  }
};

}  // namespace

Memory& kitchen_of_seed_1() {
  static RecordedStore store;
  if (store.memory == nullptr) {
    record(store.path(), without_images(1, 60));
    store.open();
  }
  return *store.memory;
}

Memory& coloured_kitchen() {
  static RecordedStore store;
  if (store.memory == nullptr) {
    datasets::KitchenOptions options = without_images(1, 5);
    options.has_colours = true;
    record(store.path(), options);
    store.open();
  }
  return *store.memory;
}

Memory& three_days() {
  static RecordedStore store;
  if (store.memory == nullptr) {
    for (const uint64_t seed : {2, 3, 4}) {
      datasets::KitchenOptions options = without_images(seed, 25);
      options.start += std::chrono::hours(1) + std::chrono::days(seed - 2);
      record(store.path(), options);
    }
    store.open();
  }
  return *store.memory;
}

}  // namespace engram::speech
