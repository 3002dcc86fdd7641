// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace engram::training {

/// The result of a training in numbers.
struct TrainReport {
  size_t snapshots = 0;       ///< Snapshots of the source.
  size_t used_snapshots = 0;  ///< Snapshots that the autoencoder was trained on.
  size_t sequences = 0;       ///< Recordings, including left-out ones.
  size_t augmented = 0;       ///< Augmented values that the autoencoder was trained on.
  int started_from = 0;       ///< Version of the model that training started from; 0 for none.
  int64_t autoencoder_steps = 0;
  int64_t dynamics_steps = 0;
  double seconds = 0;  ///< Time of work, including that of interrupted processes.
  /// Steps of the autoencoder times images of a batch, per second of processor time of all threads,
  /// in this process; 0 if it made no steps.
  double images_per_second = 0;
  double final_loss = 0;
  double training_psnr_db = 0;     ///< Mean over images, smoothed, at the end; 0 without images.
  std::vector<std::string> notes;  ///< Notes for the reader, in sentences.
};

}  // namespace engram::training
