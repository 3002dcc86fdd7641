// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace engram::training {

/// What training did.
struct TrainReport {
  size_t snapshots = 0;       ///< That were offered.
  size_t used_snapshots = 0;  ///< That the autoencoder was trained on.
  size_t sequences = 0;       ///< Recordings, left-out ones included.
  size_t augmented = 0;       ///< Augmented values that the autoencoder was trained on, too.
  int started_from = 0;       ///< Version of the model that training went on from; 0: of none.
  int64_t autoencoder_steps = 0;
  int64_t dynamics_steps = 0;
  double seconds = 0;  ///< Of work, that of interrupted processes included.
  /// Steps of the autoencoder times images of a batch, per second of processor time (all threads),
  /// in this process; 0 where it made none.
  double images_per_second = 0;
  double final_loss = 0;
  double training_psnr_db = 0;     ///< Mean over images, smoothed, at the end; 0 without images.
  std::vector<std::string> notes;  ///< What a reader should know, in sentences.
};

}  // namespace engram::training
