// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "memory/memory.h"

namespace engram::speech {

/// Whether a hand is more open where the numbers of its fingers are larger.
enum class OpenHand : uint8_t {
  /// Grippers, and fingers that no description of a robot names and whose numbers never leave 0..1
  /// are open where they are large; else they are angles, which are large where they bend.
  kAuto,
  kHigh,
  kLow,
};

struct NoticeOptions {
  /// The entity of the joints; nothing: each below RobotState whose values have joints of hands.
  std::optional<ltm::MemoryId> joints;
  OpenHand open = OpenHand::kAuto;
};

/// What a robot did that nobody told: it held something in a hand.
struct NoticedDeed {
  std::string hand;
  std::string task;       ///< Of its episode; empty: none is told.
  std::string thing;      ///< What the task names: "yellow bottle"; empty: nothing.
  std::string place;      ///< "table"; empty: none.
  ltm::MemoryId episode;  ///< The snapshot of Recording/Episodes; empty where there is none.
  Time episode_begins{};
  /// The hand closed from its first to its second snapshot.
  ltm::MemoryId close_began, close_ended;
  /// It opened again; both or none.
  std::optional<ltm::MemoryId> open_began, open_ended;
  std::vector<ltm::MemoryId> images;  ///< The last one of each camera when it had closed.
  double open_before = 0;  ///< How far it was open before it closed, in the unit of its joints,
  double open_after = 0;   ///< and after.
};

struct Noticed {
  std::vector<NoticedDeed> deeds;  ///< In the order in which hands closed.
  size_t episodes = 0;
  size_t snapshots = 0;               ///< Of joints that were read.
  std::vector<ltm::MemoryId> joints;  ///< Entities that have hands.
};

/// Looks for what the robot took and let go in the joints of its hands, episode by episode; where a
/// memory has no Recording/Episodes, from one pause of five seconds in its joints to the next. What
/// it was called is read from the episode's task. Nothing is written.
///
/// Errors: kNotFound where nothing has joints of hands; kCancelled; those of Memory::query.
/// Threading: one thread. Memory: 16 bytes a hand for each 50 ms.
/// Source: docs/verbalisation.md, section "Deeds that nobody told".
Result<Noticed> notice_deeds(Memory& memory, const NoticeOptions& options,
                             const ProgressSink& progress = {}, const std::stop_token& stop = {});

/// Commits deeds as executions of the provider "noticed", with their tasks as plans and the things
/// and places that they name, so that the memory can be asked about them. What was noticed before
/// is left out, and so are deeds of episodes within which somebody else told of executions: those
/// are known better. Returns of how many something was committed.
/// Errors: kFailedPrecondition where others told of all of them; those of Memory::commit.
Result<size_t> remember_deeds(Memory& memory, const std::vector<NoticedDeed>& deeds);

}  // namespace engram::speech
