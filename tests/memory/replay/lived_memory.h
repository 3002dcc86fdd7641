// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <random>

#include "ltm/idf/binary.h"
#include "ltm/memory/query.h"
#include "memory/live/memory_service.h"
#include "memory/memory.h"
#include "memory/replay/replay_state.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::testing {

inline constexpr int64_t kLivedFrom_ns = 1'700'000'000'000'000'000;

inline Time lived_at(double seconds) {
  return time_from_ns(kLivedFrom_ns + static_cast<int64_t>(seconds * 1e9));
}

inline ltm::MemoryId lived_entity(int number) {
  return *ltm::MemoryId::from_names({"Robot", "State", "arm", "joint" + std::to_string(number)});
}

/// The bytes of an answer, or its error, without what a replay says of itself.
inline std::string told(Result<ltm::QueryResult> answer) {
  if (!answer.ok()) return std::string(answer.status().message());
  ltm::QueryResult recorded(answer->is_ids_only());
  for (const ltm::EntityResult* entity : answer->entities()) {
    if (entity->id.names()[0] == "SystemState") continue;
    ltm::EntityResult& one = recorded.add_entity(entity->id);
    one.snapshots = entity->snapshots;
  }
  const auto bytes = *idf::encode(recorded.to_data());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A memory that a robot lived: a live service on a clock that the test sets, with a store below
/// it.
class LivedMemory {
 public:
  LivedMemory() : path(folder / "lived.engram") {
    memory::MemoryService::Options options;
    options.name = "robot";
    options.store.emplace();
    options.store->store = path;
    options.store->recording.store.min_free_bytes = 0;
    options.store->recording.store.durability = ltm::Durability::kNone;
    options.store_interval = std::chrono::milliseconds(5);
    options.memory.all.snapshots = 40;  // The rest is in the store, as on a robot.
    auto opened =
        memory::MemoryService::open(options, nullptr, [this] { return time_from_ns(now); });
    EXPECT_OK(opened);
    service = *std::move(opened);
  }

  /// Commits a snapshot of `entity`, measured at `time`, and taken by the memory now.
  ltm::MemoryId commit(int entity, Time time, double x) {
    ltm::Commit one{{{lived_entity(entity), time, {{idf::Dict{{"x", x}}, {.created = time}}}}}};
    const auto admission = service->commit(std::move(one));
    EXPECT_OK(admission);
    came.push_back(lived_entity(entity).at(time));
    return came.back();
  }

  /// So many seconds of four entities at 10 to 40 Hz, measured up to 60 ms before they came, so
  /// that those of the last one come out of order. `between` is called between commits, with the
  /// clock of the memory at that moment.
  template <typename Between>
  void live(double seconds, const Between& between) {
    std::mt19937 random(5);
    // No two commits come in the same nanosecond.
    std::vector<double> next{0, 0.0031, 0.0072, 0.0113};
    const std::vector<double> every{0.1, 0.05, 0.033, 0.025};
    for (;;) {
      const auto first = std::ranges::min_element(next);
      if (*first >= seconds) return;
      const auto entity = static_cast<int>(first - next.begin());
      now = to_ns(lived_at(*first));
      // Those of the last entity come out of order; each has a time of its own.
      const double late = entity < 3 ? 0.01 * entity
                                     : 0.001 * static_cast<double>(random() % 60) +
                                           1e-6 * static_cast<double>(came.size());
      commit(entity, lived_at(*first - late), std::sin(3 * *first + entity));
      *first += every[static_cast<size_t>(entity)];
      const double gap = *std::ranges::min_element(next);
      now = std::max(now.load(), to_ns(lived_at(gap)) - 500'000);
      between(time_from_ns(now));
    }
  }
  void live(double seconds) {
    live(seconds, [](Time) {});
  }

  /// What it answers now, as bytes.
  std::string ask(const std::string& query) {
    auto answer = service->query(*ltm::Query::parse(query));
    if (!answer.ok()) return std::string(answer.status().message());
    return told(std::move(*answer).to_result());
  }

  void end() {
    EXPECT_OK(service->close());
    service.reset();
  }

  ScratchDirectory folder;
  const std::filesystem::path path;
  std::atomic<int64_t> now{kLivedFrom_ns};
  std::vector<ltm::MemoryId> came;  ///< In their order.
  std::unique_ptr<memory::MemoryService> service;
};

}  // namespace engram::testing
