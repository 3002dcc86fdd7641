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

/// The images that lie at fixed places of a value: uint8 [H, W, 3] or [H, W, 1], uint16 [H, W, 1].
[[nodiscard]] std::vector<ImageMember> image_members(const idf::Data& data);

/// Calls `write` with every image of a snapshot and the index of its instance. Counts all of it in
/// `report`, and all members but the images as what a format of pictures leaves out.
/// Errors: those of `write`, which end it.
Status for_each_image(const ltm::SnapshotResult& snapshot, ExportReport& report,
                      const std::function<Status(int32_t index, const ImageMember&)>& write);

}  // namespace engram::datasets
