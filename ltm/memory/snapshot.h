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
  Time created{};  ///< When the producer measured it.
  Time sent{};     ///< When the producer handed it over.
  Time arrived{};  ///< When the memory took it.
  std::string provider;
  float confidence = 1.0f;  ///< 0..1.
  /// The instance that this was made of by changing it on purpose; empty: nobody changed it.
  MemoryId origin{};
  /// How it was changed: a recipe as JSON (docs/augmentation.md); empty: nobody changed it.
  std::string recipe{};

  /// Whether it must not be taken for what was perceived.
  [[nodiscard]] bool is_augmented() const { return !recipe.empty() || origin.depth() > 0; }

  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<InstanceMetadata> from_data(const idf::Data& data);

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

  /// Whether any of its instances is.
  [[nodiscard]] bool is_augmented() const;

  /// Bytes of the plain values, in IDF's binary form: what "raw bytes" counts everywhere.
  [[nodiscard]] size_t raw_bytes() const;

  /// {"entity", "time" in ns, "instances": [{"data", "metadata"}]}.
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<Snapshot> from_data(const idf::Data& data);

  friend bool operator==(const Snapshot&, const Snapshot&) = default;
};

}  // namespace engram::ltm
