// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/store/store_reader.h"
#include "training/fit/job_pace.h"
#include "training/night/consolidate_options.h"

// Private to this room.

namespace engram::training {

/// What every step of the work on one entity is given beside what the steps before it made.
///
/// Owns: only the name; the job owns the rest, which outlives all steps.
struct EntityWork {
  ltm::StoreReader& reader;  ///< One generation of the store.
  ltm::MemoryId entity;
  const ConsolidateOptions& options;
  JobPace& pace;
};

/// The time that an entity gets.
struct Allotment {
  Duration budget{};                ///< For training.
  std::optional<Time> end;          ///< Training ends then instead.
  std::optional<Time> encoded_end;  ///< With it: when encoding should have ended.
};

/// Why an entity stays as it is, while the job goes on with the next one.
struct Skipped {
  std::string reason;
  bool is_late = false;  ///< For want of time: the next job goes on where this one was.
};

/// Whether what went wrong while a model was fitted, or snapshots were encoded, concerns the entity
/// alone: the time is over, or the entity cannot be a tensor or has images that no codec takes.
/// Nothing where it ends the whole job. Needs an error (checked).
[[nodiscard]] std::optional<Skipped> skipped_by(const Status& error, const JobPace& pace);

}  // namespace engram::training
