// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// Numbers of a descriptor: 8 x 8 cells with 9 directions of edges each.
inline constexpr size_t kDescriptorSize = 8 * 8 * 9;

/// The size of the images of one camera.
struct ImageSize {
  int64_t width = 0;
  int64_t height = 0;
  int64_t channels = 0;

  /// "640 x 480 x 3".
  [[nodiscard]] std::string to_string() const;

  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

/// The size of an image [H, W] or [H, W, C] of uint8, uint16 or float32 with C up to 4 and sides of
/// 8 pixels or more; nothing for other arrays.
[[nodiscard]] std::optional<ImageSize> image_size_of(const idf::NdArray& array);

/// Describes where the edges of an image are and how they lie, and not its colours or how bright it
/// is: those change with the light, and a place is the same at night.
///
/// The image is area-averaged to 128 x 128 pixels. A pixel's gradient counts for the two nearest of
/// nine directions, with its strength, in the cell of 16 x 16 pixels in which it lies. The roots of
/// these sums are divided by the length of all.
/// Shape: [kDescriptorSize], by rows of cells; its length is 1, or 0 for an image of one colour.
/// Errors: kInvalidArgument if the array is no image (image_size_of).
/// Source: histograms of oriented gradients, Dalal and Triggs 2005, without their normalisation by
/// blocks; docs/recall.md, section "How likeness is measured".
Result<std::vector<float>> describe_image(const idf::NdArray& image);

}  // namespace engram::ltm
