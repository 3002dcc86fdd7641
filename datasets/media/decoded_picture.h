// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "datasets/media/libav_input.h"

namespace engram::datasets {

/// The output of a decoder, in its own pixel format.
///
/// Threading: immutable, const-parallel.
class DecodedPicture {
 public:
  /// Takes over the pixels; `frame` is empty afterwards.
  explicit DecodedPicture(AVFrame& frame) : frame_(av_frame_alloc()) {
    if (frame_) av_frame_move_ref(frame_.get(), &frame);
  }

  /// Returns false if there was no memory for the frame.
  [[nodiscard]] bool is_valid() const { return frame_ != nullptr; }
  [[nodiscard]] const AVFrame& frame() const { return *frame_; }
  [[nodiscard]] size_t bytes() const;

  /// Returns true if format, size and every pixel are equal.
  friend bool operator==(const DecodedPicture& a, const DecodedPicture& b);

 private:
  libav::Frame frame_;
};

}  // namespace engram::datasets
