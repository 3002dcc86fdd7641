// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ltm/core/status.h"

namespace engram::encoders {

/// A picture that a model keeps, so that AV1 videos of the same place begin from it instead of with
/// a key frame of their own. It is named by the hash of its key frame.
///
/// Source: docs/learning_methods.md, section "References".
struct VideoReference {
  /// The picture as a packed video, from which an encoder makes the key frame again.
  std::vector<std::byte> picture;
  /// The first packet of each video that begins from the picture, delimiter included.
  std::vector<std::byte> key_frame;
  int64_t time = 0;     ///< When the picture was recorded. Unit: ns since the Unix epoch.
  int32_t key = 0;      ///< Quality of the key frame, as a crf.
  bool is_deep = true;  ///< Whether its videos are coded with 10 bits, else with 8.
  /// Videos begin from it if their first image differs by at most so much (reference_distance).
  float reach = 0;

  /// Its name: XXH3 of the key frame.
  [[nodiscard]] uint64_t hash() const;

  friend bool operator==(const VideoReference&, const VideoReference&) = default;
};

/// Maximum number of references of one image member.
inline constexpr size_t kMaxReferences = 64;

/// References as a model file keeps them.
///
/// Format: a varint of their number; of each its time and reach as they are in memory, little
/// endian, varints of its key, its depth (8 or 10) and the sizes of picture and key frame, and
/// both.
[[nodiscard]] std::vector<std::byte> to_bytes(std::span<const VideoReference> references);

/// It is safe on hostile bytes.
/// Errors: kDataLoss.
Result<std::vector<VideoReference>> references_from(std::span<const std::byte> bytes);

}  // namespace engram::encoders
