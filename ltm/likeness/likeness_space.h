// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/likeness/image_descriptor.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// Numbers of a code. A code of an image takes as many bytes.
inline constexpr size_t kCodeSize = 24;

/// Turns the images of one entity into codes whose distance is small where moments are alike.
/// Codes of one space are comparable with each other and with nothing else.
///
///     image -> descriptor [576] -> minus mean -> projection [24, 576] -> rounded to bytes
///
/// Threading: immutable, const-parallel.
/// Source: docs/recall.md, section "How likeness is measured".
struct LikenessSpace {
  ImageSize size;                 ///< Of the images that it was learned from.
  uint64_t snapshots = 0;         ///< How many the entity had when it was learned.
  uint64_t recordings = 0;        ///< How many they came from.
  std::vector<MemoryId> views;    ///< Whose numbers told which moments are alike; may be empty.
  std::vector<float> mean;        ///< [kDescriptorSize]
  std::vector<float> projection;  ///< [kCodeSize, kDescriptorSize]; its codes deviate by 12.

  /// Tells it from all others: the hash of what it does.
  [[nodiscard]] uint64_t id() const;
  /// "8c21fe03" of its id, for people.
  [[nodiscard]] std::string name() const;

  /// Shape: descriptor [kDescriptorSize], result [kCodeSize].
  [[nodiscard]] std::vector<int8_t> code(std::span<const float> descriptor) const;

  [[nodiscard]] std::vector<std::byte> pack() const;
  /// Reads what pack() wrote; safe on hostile bytes. Errors: kDataLoss.
  static Result<LikenessSpace> unpack(std::span<const std::byte> bytes);
};

}  // namespace engram::ltm
