// SPDX-License-Identifier: Apache-2.0
#include "training/fit/train_options.h"

#include "encoders/latent_block.h"
#include "encoders/network_shape.h"

namespace engram::training {

namespace {

/// Min and max bound that both numbers and orientations accept.
constexpr double kMinNumberBound = 1e-9;
constexpr double kMaxNumberBound = 1e9;

}  // namespace

Status TrainOptions::validate() const {
  if (!steps && budget <= Duration::zero())
    return invalid_argument("training budget: found {}, needs more than zero", to_string(budget));
  if (steps && *steps < 1) return invalid_argument("training steps: found {}, needs 1", *steps);
  if (batch_size < 1) return invalid_argument("batch size: found {}, needs 1", batch_size);
  if (!(psnr_db >= 10 && psnr_db <= 60))
    return invalid_argument("quality: found {} dB, needs 10 to 60", psnr_db);
  if (number_bound && !(*number_bound >= 0 && *number_bound <= kMaxNumberBound))
    return invalid_argument("bound of numbers: found {}, needs 0 (every bit) to {}", *number_bound,
                            kMaxNumberBound);
  if (number_bound && *number_bound > 0 && *number_bound < kMinNumberBound)
    return invalid_argument("bound of numbers: found {}, needs 0 (every bit) or {} and more",
                            *number_bound, kMinNumberBound);
  const encoders::NetworkSizes sizes{width == 0 ? 64 : width, coarse_channels, fine_channels, 1};
  if (!sizes.is_valid())
    return invalid_argument(
        "found a width of {} and {} and {} latent channels, needs a multiple of 16 up to {} (or 0) "
        "and 1 to {}",
        width, coarse_channels, fine_channels, encoders::NetworkSizes::kMaxWidth,
        encoders::NetworkSizes::kMaxChannels);
  if (chain_rows < 1 || chain_rows > static_cast<int>(encoders::kMaxBlockRows))
    return invalid_argument("snapshots of a chain: found {}, needs 1 to {}", chain_rows,
                            encoders::kMaxBlockRows);
  if (!(varied_share >= 0 && varied_share <= 1))
    return invalid_argument("share of varied images: found {}, needs 0 to 1", varied_share);
  if (!(augmented_share >= 0 && augmented_share < 1))
    return invalid_argument("share of augmented values: found {}, needs 0 to below 1",
                            augmented_share);
  if (threads < 1) return invalid_argument("threads: found {}, needs at least 1", threads);
  if (hold_out_recordings < 0)
    return invalid_argument("recordings to leave out: found {}, needs 0 or more",
                            hold_out_recordings);
  return {};
}

}  // namespace engram::training
