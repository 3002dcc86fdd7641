// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "ltm/store/store_writer.h"

namespace engram::ltm::faults {

/// What a session says about itself while it runs. Fixed size: it goes through pipes and files.
struct Told {
  enum Kind : int32_t {
    kStored,    ///< Snapshot `index` of entity `number`, in this `version`, was acknowledged.
    kDropping,  ///< From now on recorded forms of entity `number` may be gone.
    kForgetting,  ///< From now on snapshot `index` of entity `number` may be gone.
    kForgotten,   ///< It is gone: acknowledged.
    kDeclared,  ///< The type of core segment `number` was acknowledged.
    kFailed,    ///< An error was reported; `number` is its code.
    kStep,      ///< Step `number` begins; see step_name.
    kFinished,
  };
  Kind kind = kStep;
  int32_t number = 0;
  int64_t index = 0;
  int64_t version = 0;
};

using Tell = std::function<void(const Told&)>;

/// Entities of a session: the first has numbers and texts and is dropped from time to time, the
/// second has a number and an image. Sealed, the first one's numbers are columns, the second one's
/// images groups.
inline constexpr int kEntities = 2;
[[nodiscard]] MemoryId session_entity(int number);

/// Core segments whose types a session declares.
inline constexpr int kDeclaredSegments = 3;
[[nodiscard]] MemoryId declared_segment(int number);

/// What a session stores: known by these three numbers alone.
[[nodiscard]] Snapshot session_snapshot(int entity, int64_t index, int64_t version);

/// "record", "seal", ...
[[nodiscard]] const char* step_name(int step);
inline constexpr int kSteps = 8;

struct SessionOptions {
  StoreWriter::Options store;
  /// Waits after each append, so that a session is spread over time. Unit: microseconds.
  int pause_us = 0;
  /// Index of the first snapshot: earlier sessions have stored those before it.
  int64_t first = 0;
  /// Rounds of record, seal, update, declare, publish, drop, compact and forget.
  int rounds = 2;
  /// Only every so many rounds publish, drop and compact, which takes long where much is stored.
  int consolidate_every = 1;
};

/// Records into `store`, made where it is missing, and does everything else that a robot's day
/// has. After an error it goes on as a careful caller would: opens the store again, tries again.
void run_session(const std::filesystem::path& store, const SessionOptions& options,
                 const Tell& tell);

}  // namespace engram::ltm::faults
