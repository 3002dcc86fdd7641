// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/redaction/box.h"

namespace engram::ltm {

/// An image as detectors get it.
///
/// Shape: pixels [height, width, channels], row by row; sizes are at least 0, so that it may be
/// empty. `channels` is 3, in RGB order, or 1. Images of other numbers, such as depth in metres,
/// are stretched to 0..255.
struct DetectorImage {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::span<const uint8_t> pixels;
  std::string entity;  ///< Where it is of, for detectors that treat cameras differently.
  std::string member;  ///< The path in the value.
  Time time{};
};

/// Finds in images what must not be kept.
///
/// All members pass tests/ltm/redaction/detector_conformance_test.cpp.
/// Threading: thread-safe.
/// Source: docs/recording.md, section "Redaction".
class Detector {
 public:
  virtual ~Detector() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;

  /// The boxes of what it finds, which may reach beyond the image; none in an image that is empty
  /// or too small.
  /// Errors: kUnavailable if it gave no answer, in time or at all. The image may then hold
  /// anything.
  virtual Result<std::vector<Box>> find(const DetectorImage& image) = 0;

  /// Waits until find() may answer, for those who have time to wait. Servers do not: find() tells
  /// them at once.
  /// Errors: kUnavailable if it is not so within the time that a new start may take; kCancelled on
  /// a stop.
  virtual Status wait_ready(const std::stop_token& stop) {
    return stop.stop_requested() ? cancelled("redacting was stopped") : Status();
  }
};

}  // namespace engram::ltm
