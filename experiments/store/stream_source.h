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

/// What a stream is made of, decoded into memory once.
struct StreamSource {
  /// At least two. Shape: uint8 [480, 640, 3], RGB.
  std::vector<idf::NdArray> frames;
  std::vector<JointRow> joints;  ///< One row per frame. Unit: rad.
  std::string description;
};

/// Every second frame of the videos (*.mp4) below `recordings`, in the order of their names: robot
/// recordings often repeat every other frame. Videos of another size are scaled. Joints are the
/// first 43 columns of the table NAME.csv with a row per frame. Where some videos have a table,
/// only those are taken; where none has, joints are made. Errors: kNotFound where there is no
/// video; those of VideoReader and Table.
Result<StreamSource> read_recordings(const std::filesystem::path& recordings, size_t max_frames);

/// A rendered scene, with made joints.
Result<StreamSource> render_scene(size_t frames);

/// The recordings below the folder that ENGRAM_RECORDINGS names; without it, the scene.
Result<StreamSource> load_stream_source(size_t max_frames);

}  // namespace engram::experiments
