// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <random>
#include <string>
#include <vector>

#include "ltm/idf/data.h"
#include "speech/sights/true_sights.h"

// Private to this room.

namespace engram::speech {

/// A colour as hue, saturation and value. Unit: degrees; 0 to 1.
struct Hsv {
  double hue = 0;
  double saturation = 0;
  double value = 0;
};

/// How things look that are called red, and so on: measured on images, so that no colour has to be
/// known before a memory tells of it.
class ColourLooks {
 public:
  /// Notes the pixels of the things in an image, uint8 [H, W, 3].
  void see(const idf::NdArray& image, const ImageTruth& truth);

  /// The usual look of a colour; with no saturation where it was not seen, or has no hue.
  [[nodiscard]] Hsv look(int64_t colour) const;
  [[nodiscard]] size_t colours() const { return seen_.size(); }

 private:
  static constexpr size_t kHues = 36;
  struct Seen {
    std::array<double, kHues> weight{}, hue{}, saturation{}, value{};
  };
  std::vector<Seen> seen_;
};

/// An image as it would be with things of other colours, in other light, and perhaps in a mirror.
struct ChangedImage {
  idf::NdArray image;
  ImageTruth truth;
};

/// Changes an image, uint8 [H, W, 3], by chance. Things whose colour has a hue get another one, but
/// where their printing is grey it stays so. Where it is mirrored, things in one of two hands are
/// in the other: `mirrored_where` has for each place in SightWords::where the one in the mirror.
[[nodiscard]] ChangedImage change_image(const idf::NdArray& image, const ImageTruth& truth,
                                        const CellGrid& grid, const ColourLooks& looks,
                                        const std::vector<int64_t>& mirrored_where,
                                        std::mt19937_64& random);

/// The first member of a value that is an image in colours, uint8 [H, W, 3]; null: there is none.
[[nodiscard]] const idf::NdArray* image_in(const idf::Data& value);
/// The value with another image in its place.
[[nodiscard]] idf::Data with_image(const idf::Data& value, idf::NdArray image);

}  // namespace engram::speech
