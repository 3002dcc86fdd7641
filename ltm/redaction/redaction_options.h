// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "ltm/core/time.h"
#include "ltm/filter/entity_pattern.h"
#include "ltm/redaction/detector_registry.h"

namespace engram::ltm {

enum class RedactAction : uint8_t {
  kPixelate,  ///< A box becomes at most 8 x 8 blocks, each of its mean.
  kFill,      ///< A box becomes zeros. Nothing is left of it, in whatever number of images.
  kDrop,      ///< The whole snapshot is dropped.
};

/// How images are redacted before anything is kept of them.
///
/// Source: docs/recording.md, section "Redaction".
struct RedactionOptions {
  DetectorOptions detector;
  RedactAction action = RedactAction::kPixelate;
  /// By how much of its size a box grows to each side. Detectors cut close, so 0 leaves edges.
  double grow = 0.2;
  /// How long a box holds after it was last seen. Detectors miss some images of a row; longer holds
  /// redact what is behind somebody who left.
  Duration hold = std::chrono::seconds(1);

  [[nodiscard]] Status validate() const;
  friend bool operator==(const RedactionOptions&, const RedactionOptions&) = default;
};

/// How the entities that match are redacted; nothing: not at all.
struct RedactionRule {
  EntityPattern match;
  std::optional<RedactionOptions> redact;
};

}  // namespace engram::ltm
