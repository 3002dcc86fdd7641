// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/store/store_reader.h"
#include "training/forms/entity_videos.h"

// Private to this room.

namespace engram::training {

/// What nights found out about an entity, so that the next one need not find it out again. It is
/// advice, and no part of the memory: a night without it does the same, but takes longer.
/// Source: docs/night.md, section "What one night tells the next".
struct NightHistory {
  /// Snapshots that the entity ever had when networks were last trained and lost against video
  /// alone; 0 if they never lost, or won since.
  uint64_t networks_lost_at = 0;
  /// The length of chains that reaches any moment within `access`, as measured here. A measurement
  /// varies, and chains of another length need a new model.
  struct Chain {
    Duration access{};
    int rows = 0;

    friend bool operator==(const Chain&, const Chain&) = default;
  };
  std::optional<Chain> chain;
  /// How quality followed from crf, by the codec and its settings, as in "av1:effort=7". One for
  /// each image member.
  std::map<std::string, std::vector<VideoHistory::Line>, std::less<>> lines;

  /// The searches begin where those of an earlier night ended: with the same settings, else with
  /// others of the same codec.
  void teach(EntityVideos& videos) const;
  /// Notes where the searches ended.
  void learn(EntityVideos& videos);

  friend bool operator==(const NightHistory&, const NightHistory&) = default;
};

/// Snapshots that an entity ever had: those that are there and those that were forgotten. Under a
/// quota the former stop growing.
/// Errors: the errors of the store.
Result<uint64_t> snapshots_ever(ltm::StoreReader& reader, const ltm::MemoryId& entity);

/// Reads the history of an entity. It is empty if there is none, or if it is damaged or larger than
/// 1 MiB.
[[nodiscard]] NightHistory read_history(const std::filesystem::path& store,
                                        const ltm::MemoryId& entity);

/// Replaces the history of an entity. What fails is logged, because the night has done its work.
void write_history(const std::filesystem::path& store, const ltm::MemoryId& entity,
                   const NightHistory& history);

}  // namespace engram::training
