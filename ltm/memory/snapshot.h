// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// What is known about one instance besides its value.
struct InstanceMetadata {
  Time created{};  ///< When the producer measured it.
  Time sent{};     ///< When the producer handed it over.
  Time arrived{};  ///< When the memory took it.
  std::string provider;
  float confidence = 1.0f;  ///< 0..1.
  /// The instance that this one was deliberately changed from; empty: not changed.
  MemoryId origin{};
  /// How it was changed: a recipe as JSON (docs/augmentation.md); empty: not changed.
  std::string recipe{};

  /// Whether it must not be mistaken for a perception.
  [[nodiscard]] bool is_augmented() const { return !recipe.empty() || origin.depth() > 0; }

  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<InstanceMetadata> from_data(const idf::Data& data);

  friend bool operator==(const InstanceMetadata&, const InstanceMetadata&) = default;
};

/// One value of an entity's state, with its metadata.
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

  /// Whether any of its instances is augmented.
  [[nodiscard]] bool is_augmented() const;

  /// The size of the plain values in IDF's binary form; this is the meaning of "raw bytes"
  /// everywhere. Unit: bytes.
  [[nodiscard]] size_t raw_bytes() const;

  /// Returns {"entity", "time" in ns, "instances": [{"data", "metadata"}]}.
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<Snapshot> from_data(const idf::Data& data);

  friend bool operator==(const Snapshot&, const Snapshot&) = default;
};

}  // namespace engram::ltm
