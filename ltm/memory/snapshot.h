// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// What is known about one datum beside its value.
struct InstanceMetadata {
  Time created{};   ///< When the producer measured it.
  Time sent{};      ///< When the producer handed it over.
  Time arrived{};   ///< When the memory took it.
  std::string provider;
  float confidence = 1.0f;  ///< 0..1.

  friend bool operator==(const InstanceMetadata&, const InstanceMetadata&) = default;
};

/// One datum of an entity's state.
struct Instance {
  idf::Data data;
  InstanceMetadata metadata;

  friend bool operator==(const Instance&, const Instance&) = default;
};

/// The state of one entity at one time.
struct Snapshot {
  MemoryId entity;
  Time time{};
  std::vector<Instance> instances;

  [[nodiscard]] MemoryId id() const { return entity.at(time); }

  /// Bytes of the plain values, in IDF's binary form: what "raw bytes" counts everywhere.
  [[nodiscard]] size_t raw_bytes() const;

  friend bool operator==(const Snapshot&, const Snapshot&) = default;
};

/// A bundle of new snapshots, one per updated entity.
struct Commit {
  std::vector<Snapshot> updates;
};

}  // namespace engram::ltm
