// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace engram {

/// How far a long piece of work is.
struct Progress {
  std::string what;    ///< "import Vision/RGB/head/cam", "train Vision/RGB/head/cam", ...
  uint64_t done = 0;
  uint64_t total = 0;  ///< Same unit as `done`; zero where nobody knows.
  std::string detail;  ///< "epoch 3, loss 0.0123", may be empty.
  double seconds_left = -1;  ///< Negative where nobody knows.
};

/// Receives progress, from the thread that does the work. May be empty.
using ProgressSink = std::function<void(const Progress&)>;

}  // namespace engram
