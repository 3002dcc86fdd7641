// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "datasets/media/libav_input.h"

namespace engram::datasets {

/// What a decoder gave, in its own pixel format.
///
/// Threading: immutable, const-parallel.
class DecodedPicture {
 public:
  /// Takes the pixels over; `frame` is empty then.
  explicit DecodedPicture(AVFrame& frame) : frame_(av_frame_alloc()) {
    if (frame_) av_frame_move_ref(frame_.get(), &frame);
  }

  /// False where there was no memory.
  [[nodiscard]] bool is_valid() const { return frame_ != nullptr; }
  [[nodiscard]] const AVFrame& frame() const { return *frame_; }
  [[nodiscard]] size_t bytes() const;

  /// Whether format, size and every pixel are the same.
  friend bool operator==(const DecodedPicture& a, const DecodedPicture& b);

 private:
  libav::Frame frame_;
};

}  // namespace engram::datasets
