// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"
#include "ltm/memory/commit.h"
#include "store/stream_source.h"

namespace engram::experiments {

/// Two cameras, in the order of a tick's images.
inline constexpr std::array<const char*, 2> kCameras{"left", "right"};

/// The data of a robot in one hundredth of a second.
struct Tick {
  struct Pose {
    std::string name;  ///< "platform" is the robot; all others are things.
    std::array<float, 16> matrix{};
  };

  Time time{};
  JointRow positions{};   ///< Unit: rad.
  JointRow velocities{};  ///< Unit: rad/s.
  /// Empty or one per camera. Shape: uint8 [480, 640, 3], RGB.
  std::vector<idf::NdArray> images;
  std::vector<Pose> poses;
  std::string text;  ///< Empty if nothing was said.

  /// Bytes of pixels, numbers and texts, without names. This is "raw" for every peer.
  [[nodiscard]] uint64_t raw_bytes() const;
};

/// The stream of the reference paper's robot: two 640 x 480 RGB images at 20 Hz, 43 joint positions
/// and velocities at 100 Hz, the robot's pose at 20 Hz, three poses of things at 10 Hz, and a text
/// at 1 Hz.
///
/// Decoded frames are kept in memory. The cameras show different frames of the same list, which is
/// repeated when it ends.
/// Threading: immutable.
class Stream {
 public:
  static constexpr int kTicksPerSecond = 100;
  static constexpr int kTicksPerImage = 5;

  Stream(StreamSource source, double seconds);

  [[nodiscard]] size_t ticks() const { return ticks_; }
  [[nodiscard]] double seconds() const { return static_cast<double>(ticks_) / kTicksPerSecond; }
  [[nodiscard]] Tick tick(size_t index) const;

  /// Returns the tick of a time of this stream.
  [[nodiscard]] size_t tick_at(Time time) const;

  /// Returns the raw bytes of all ticks.
  [[nodiscard]] uint64_t raw_bytes() const;

  /// A description for reports: "904 frames of 5 recordings".
  [[nodiscard]] const std::string& description() const { return source_.description; }

  /// The decoded frames, and the index of the one that a camera shows at a tick with images.
  [[nodiscard]] const std::vector<idf::NdArray>& frames() const { return source_.frames; }
  [[nodiscard]] size_t frame_index(size_t camera, size_t tick) const;

 private:
  [[nodiscard]] Time time_of(size_t tick) const;
  [[nodiscard]] JointRow positions_at(size_t tick) const;

  StreamSource source_;
  size_t ticks_;
};

/// Returns "Vision/RGB/head/left".
[[nodiscard]] ltm::MemoryId camera_id(size_t camera);

/// Returns the commit that Engram records for a tick: a snapshot per sensor.
[[nodiscard]] ltm::Commit commit_of(const Tick& tick);

}  // namespace engram::experiments
