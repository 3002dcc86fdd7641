// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/forgetting/erasure.h"
#include "ltm/memory/sight.h"
#include "ltm/recall/recall.h"
#include "ltm/working/working_memory.h"
#include "memory/live/long_term.h"

namespace engram::memory {

/// What a running memory is to forget.
struct ForgetRequest {
  std::vector<std::string> targets;  ///< See ltm::ForgetTarget.
  /// Whether no file of the store may hold anything of it, see ltm::ForgetTools.
  bool erases = false;
  bool is_dry_run = false;  ///< Only counts, and changes nothing.
  /// What may be forgotten by who asks; null: everything. Selectors select as if there were nothing
  /// else.
  ltm::SharedView view{};
  ProgressSink progress{};
  std::stop_token stop{};
  /// Called with all that goes once working memory has nothing of it, so that those who hold copies
  /// let go of them. May be called several times.
  std::function<void(const ltm::ForgetSet& gone)> on_forgotten{};
};

/// What was forgotten, or would be. Unit: snapshots. It tells of nothing that the view leaves out.
struct ForgetOutcome {
  struct OfEntity {
    ltm::MemoryId entity;
    uint64_t snapshots = 0;
    Time first{}, last{};
  };
  std::vector<OfEntity> entities;  ///< In the order of their IDs.
  uint64_t snapshots = 0;          ///< Of all entities.
  uint64_t from_memory = 0;        ///< Of them those that working memory had.
  uint64_t never_stored = 0;       ///< Of these those that waited to be stored.
  uint64_t from_store = 0;         ///< Those that were in the store.
  std::vector<std::string> notes;  ///< As of a plan: what a reader may have understood otherwise.
  std::optional<ltm::ErasureReport> erased;
};

/// What erasing needs of the rooms that learn.
struct EraseTools {
  /// Empty: what was coded together or learned cannot be coded anew.
  ltm::CodeAnew code_anew;
  /// Says beforehand whether `code_anew` can work on a store; empty: it can.
  std::function<Status(const std::filesystem::path& store)> ready;
};

/// The parts of a running memory that hold snapshots.
struct ForgettingParts {
  std::string name;  ///< In messages, such as "server 'robot'".
  ltm::WorkingMemory& memory;
  LongTerm* store = nullptr;  ///< Null without a store.
  std::filesystem::path path;
  EraseTools tools;
  /// Calls with what answers questions, while nobody else asks.
  std::function<Status(const std::function<Status(ltm::Recall&)>&)> ask;
  /// Has what precedes working memory pass into it, as far as a query selects it and the view sees
  /// it: what is held there is found and forgotten as if it had been committed.
  std::function<void(const ltm::Query&, const ltm::View*)> pass;
  /// Told what waited to be stored and never will be.
  std::function<void(std::span<const ltm::SharedSnapshot>)> unstored;
};

/// Forgets while others go on to commit and ask. Afterwards nothing of it is answered, predicted or
/// stored. What is committed to the same times while it works may go, too.
///
/// In this order: the targets are looked up; working memory and the filters of the online phase let
/// go; journals are sealed; segments are written without it; what was read and learned from it is
/// dropped. A failure before working memory let go has no effect; after a later one, the message
/// says so, and the same request carries on.
/// Errors: those of ltm::ForgetTarget; kNotFound if a target names nothing that may be forgotten;
/// kFailedPrecondition if it is to erase and the tools are missing for a store with models, or
/// another process learns from the store or erases from it; kCancelled; those of ltm::carry_out.
/// Threading: one call at a time.
/// Source: docs/forgetting.md, "A running server".
Result<ForgetOutcome> forget_live(const ForgettingParts& parts, const ForgetRequest& request);

}  // namespace engram::memory
