// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/training/recorded_scene.h"

namespace engram::testing {

inline constexpr const char* kRoomCamera = "Vision/RGB/head/cam";
/// Images of a recording. With fewer the gaps between recordings would not be unusual.
inline constexpr int kRoomRows = 16;

/// A textured room with a mark that moves.
inline idf::Data view_of_room(int moment) {
  constexpr int kSide = 64;
  std::vector<uint8_t> pixels;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) {
        const bool is_mark = x / 8 == moment % 8 && y / 8 == moment / 8 % 8;
        const int shade = 50 + (x * x + 3 * y * x + 7 * y) % 61 + 5 * c;
        pixels.push_back(static_cast<uint8_t>(is_mark ? 240 : shade));
      }
  idf::Dict dict;
  dict.set("image", idf::NdArray::take<uint8_t>({kSide, kSide, 3}, std::move(pixels)));
  return dict;
}

inline Time time_of_room(int moment) {
  return Time(std::chrono::hours(1000 + moment / kRoomRows) +
              std::chrono::seconds(moment % kRoomRows));
}

/// Short recordings, an hour apart.
inline void record_rooms(const std::filesystem::path& store, int first, int recordings) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  for (int i = first * kRoomRows; i < (first + recordings) * kRoomRows; ++i)
    ASSERT_TRUE(
        recorder->commit({{{id(kRoomCamera), time_of_room(i), {{view_of_room(i), {}}}}}}).ok());
  ASSERT_TRUE(recorder->close().ok());
}

/// All images as video, so good that they keep `bound_db`.
inline training::ConsolidateOptions as_video(double bound_db) {
  auto options = quick_consolidation();
  options.representation.kind = training::Representation::kVideo;
  options.representation.bound_db = bound_db;
  return options;
}

}  // namespace engram::testing
