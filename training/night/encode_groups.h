// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "training/night/consolidate_report.h"
#include "training/night/encode_entity.h"

// Private to this room.

namespace engram::training {

/// What is encoded, and published from time to time.
struct EncodedGroups {
  std::shared_ptr<encoders::DeepModel> model;
  int version = 0;
  std::span<const ltm::SnapshotEntry> entries;
  const RepresentationOptions& representation;
  EncodingLimits::Publish publish;
};

/// Encodes snapshots and publishes them every few minutes, where there is nothing to compare them
/// with in the end. Returns `report` with what was done, or that the time was over before anything
/// was.
/// Errors: those that end the whole job.
Result<OrSkipped<EntityReport>> encode_in_groups(const EntityWork& work,
                                                 const EncodedGroups& groups, const Allotment& time,
                                                 EntityReport report);

/// Encodes snapshots with the newest model of the store, which must be `model`, in groups.
/// Errors: those that end the whole job.
Result<OrSkipped<EntityReport>> encode_with_newest(
    const EntityWork& work, const std::shared_ptr<encoders::DeepModel>& model,
    std::span<const ltm::SnapshotEntry> entries, const RepresentationOptions& representation,
    const Allotment& time, EntityReport report);

}  // namespace engram::training
