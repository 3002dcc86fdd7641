// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace engram {

/// The progress of a long task.
struct Progress {
  std::string what;    ///< "import Vision/RGB/head/cam", "train Vision/RGB/head/cam", ...
  uint64_t done = 0;
  uint64_t total = 0;  ///< In the unit of `done`; zero where it is unknown.
  std::string detail;  ///< "epoch 3, loss 0.0123"; may be empty.
  double seconds_left = -1;  ///< Negative where it is unknown.
};

/// Receives progress, in the thread that does the work. May be empty.
using ProgressSink = std::function<void(const Progress&)>;

}  // namespace engram
