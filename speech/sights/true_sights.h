// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "memory/memory.h"
#include "speech/sights/latent_images.h"
#include "speech/sights/sight_words.h"

// Private to this room.

namespace engram::speech {

/// One thing, and where it is in an image. Numbers are places in SightWords.
struct TrueSight {
  int64_t kind = 0;
  int64_t where = 0;
  int64_t colour = kUntold;
  bool is_in_sight = false;
  /// The corners of its convex outline, from the left top. Unit: shares of the width and of the
  /// height of the image. Empty: it is behind the camera, or behind another.
  std::vector<cv::Point2f> outline;
  double distance_m = 0;

  static constexpr int64_t kUntold = -1;
};

/// What an image shows.
struct ImageTruth {
  std::vector<TrueSight> things;  ///< From far to near, in sight or not.
  /// The kind of the thing in each cell, or one of those below. Shape: [rows, columns].
  std::vector<int64_t> kinds;

  static constexpr int64_t kNothing = -1;
  static constexpr int64_t kUnclear = -2;  ///< A bit of a thing.
};

/// What the images of a memory truly show, from the poses of its things and of its cameras. Of a
/// camera the value of the image tells the pose, and it links to the calibration of a pinhole.
///
/// Owns: nothing of the memory, which must outlive it.
/// Threading: one thread.
class TrueSights {
 public:
  /// Adds to `words` what the memory tells of that they do not have.
  /// Errors: kNotFound where it has no things with poses whose kinds have sizes; those of
  /// Memory::query.
  static Result<TrueSights> read(Memory& memory, SightWords& words);

  TrueSights(TrueSights&&) noexcept;
  ~TrueSights();

  /// The value of an image. Errors: those of Memory::query.
  Result<idf::Data> value_of(const LatentImage& image);

  /// Nothing where no pose of the camera is known, or of no thing at that time.
  /// Errors: those of Memory::query.
  Result<std::optional<ImageTruth>> of(const LatentImage& image, const idf::Data& value,
                                       const CellGrid& grid);

 private:
  struct State;
  explicit TrueSights(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

/// 255 where the middle of a pixel of an image of this size is within an outline, else 0.
/// Shape: uint8 [H, W].
[[nodiscard]] cv::Mat mask_of(const std::vector<cv::Point2f>& outline, const cv::Size& size);

}  // namespace engram::speech
