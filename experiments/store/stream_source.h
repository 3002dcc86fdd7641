// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/ndarray.h"

namespace engram::experiments {

inline constexpr size_t kJoints = 43;
using JointRow = std::array<double, kJoints>;

/// The data that a stream is made from, decoded into memory once.
struct StreamSource {
  /// At least two frames. Shape: uint8 [480, 640, 3], RGB.
  std::vector<idf::NdArray> frames;
  std::vector<JointRow> joints;  ///< One row per frame. Unit: rad.
  std::string description;
};

/// Reads every second frame of the videos (*.mp4) below `recordings`, in the order of their names,
/// because robot recordings often repeat every other frame. Videos of another size are scaled.
/// Joints are the first 43 columns of the table NAME.csv with a row per frame. If some videos have
/// a table, only those are used; if none has, joints are made up. Errors: kNotFound if there is no
/// video; those of VideoReader and Table.
Result<StreamSource> read_recordings(const std::filesystem::path& recordings, size_t max_frames);

/// Renders a scene and makes up joints.
Result<StreamSource> render_scene(size_t frames);

/// Reads the recordings below the folder that ENGRAM_RECORDINGS names; if it is not set, renders a
/// scene.
Result<StreamSource> load_stream_source(size_t max_frames);

}  // namespace engram::experiments
