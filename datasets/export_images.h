// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <functional>
#include <string>
#include <vector>

#include "datasets/export_sink.h"

namespace engram::datasets {

/// An image member of a value.
struct ImageMember {
  std::string path;
  idf::NdArray image;
};

/// Returns the images at fixed places of a value: uint8 [H, W, 3] or [H, W, 1], uint16 [H, W, 1].
[[nodiscard]] std::vector<ImageMember> image_members(const idf::Data& data);

/// Calls `write` with every image of a snapshot and the index of its instance. Counts snapshot,
/// instances and images in `report`, and all other members as not carried by an image format.
/// Errors: those of `write`; the first one ends the iteration.
Status for_each_image(const ltm::SnapshotResult& snapshot, ExportReport& report,
                      const std::function<Status(int32_t index, const ImageMember&)>& write);

}  // namespace engram::datasets
