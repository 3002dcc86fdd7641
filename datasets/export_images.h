// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <string>
#include <vector>

#include "datasets/export_sink.h"

namespace engram::datasets {

/// An image member of a value.
struct ImageMember {
  std::string path;
  idf::NdArray image;
};

/// The images that lie at fixed places of a value: uint8 [H, W, 3] or [H, W, 1], uint16 [H, W, 1].
[[nodiscard]] std::vector<ImageMember> image_members(const idf::Data& data);

/// Counts what a format of pictures leaves out: all members but the images.
void count_other_members(const idf::Data& data, ExportReport& report);

}  // namespace engram::datasets
