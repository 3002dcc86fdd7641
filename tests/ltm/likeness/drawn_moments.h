// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "ltm/idf/ndarray.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

/// A bright square on stripes. Shape: uint8 [48, 64, 3].
inline idf::NdArray drawn_image(int left, int top, int light, int stripe = 16) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const bool is_square = x >= left && x < left + 14 && y >= top && y < top + 14;
      const int grey = is_square ? 2 * light : light / 2 + (y / stripe % 2) * light / 4;
      for (int c = 0; c < 3; ++c)
        pixels.push_back(static_cast<uint8_t>(std::min(grey + 3 * c, 255)));
    }
  return idf::NdArray::take({48, 64, 3}, std::move(pixels));
}

/// Where the square is at step `i`: it goes to the right and comes back, in forty steps.
inline int left_at(int64_t i) {
  const auto step = static_cast<int>(i % 40);
  return 2 + 2 * (step < 20 ? step : 40 - step);
}

inline MemoryId arm_entity() {
  return *MemoryId::from_names({"RobotState", "Proprioception", "arm", "joints"});
}

/// Moment `i` of a recording in a room: the image, with a link to the joint that moves the square.
inline std::vector<PackedSnapshot> drawn_moment(int64_t recording, int64_t i) {
  const Time time = example_time(recording * 10'000 + i);
  const auto room = static_cast<int>(recording);
  Snapshot image{example_entity(), time, {}};
  image.instances.push_back(
      {idf::Dict{{"image", drawn_image(left_at(i), 20, 50 + 30 * room, 8 + 5 * room)},
                 {"joints", arm_entity().at(time).instance(0).to_string()}},
       {}});
  Snapshot joints{arm_entity(), time, {}};
  joints.instances.push_back({idf::Dict{{"position", 0.05 * left_at(i)}}, {}});
  return {pack_snapshot(image), pack_snapshot(joints)};
}

/// Records so many moments of each of `recordings` rooms, five a second, and seals each.
inline void record_drawn(const std::filesystem::path& store, int64_t recordings, int64_t moments) {
  const auto writer = StoreWriter::open(store, {});
  ASSERT_OK(writer);
  for (int64_t recording = 0; recording < recordings; ++recording) {
    for (int64_t i = 0; i < moments; ++i)
      ASSERT_OK((*writer)->append(drawn_moment(recording, i), nullptr));
    ASSERT_OK((*writer)->seal());
  }
}

}  // namespace engram::ltm
