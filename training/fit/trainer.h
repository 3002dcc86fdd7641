// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "encoders/training_variant.h"
#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/idf/layout.h"

namespace engram::training {

/// A model of the same entity that training may go on from.
struct PreviousModel {
  std::filesystem::path file;
  int version = 0;
  uint64_t checksum = 0;
};

/// Values that were made of those that are trained on, by changing them on purpose: they are
/// trained on too, and never encoded, measured or counted as real ones.
struct AugmentedValues {
  /// Per run of consecutive values that were changed alike: which of the source's times each was
  /// made of, one after the other.
  std::vector<std::vector<size_t>> origins;
  /// Value `index` of run `run`.
  std::function<Result<idf::Data>(size_t run, size_t index)> read;
  size_t left_out = 0;    ///< Values that were made of others.
  uint64_t identity = 0;  ///< The same for the same values alone.
};

/// What one model is trained on: values of one layout, in the order of time.
struct TrainingSource {
  std::string entity;
  std::vector<Time> times;
  /// The value of times[index].
  std::function<Result<idf::Data>(size_t index)> read;
  /// That the values have; not given: what the first one shows.
  std::optional<idf::Layout> layout;

  /// Another entity whose numbers predictions may start from; empty: none.
  std::string condition_entity;
  /// Its value at or before times[index]; nothing where there is none.
  std::function<Result<std::optional<idf::Data>>(size_t index)> read_condition;

  /// Training starts from its weights where its networks have the same sizes, else anew.
  std::optional<PreviousModel> previous;
  /// Beside `times`: which of them that model has latents of. Where training starts from it, they
  /// are told again beside the others, see RowSampler. Empty: none.
  std::vector<bool> is_known;

  /// Trained on beside the others, at TrainOptions::augmented_share.
  std::optional<AugmentedValues> augmented;
};

/// How one model is trained. Written into the model file.
struct TrainOptions {
  /// Time for one model. More is better, by about 1 dB per doubling at first.
  Duration budget = std::chrono::minutes(2);
  /// A fixed number of optimiser steps instead of the budget: same seed, same model.
  std::optional<int> steps;
  uint64_t seed = 1;
  int batch_size = 8;
  /// What the latents of images are trained for. Others than kRateAware are there to compare with.
  encoders::TrainingVariant variant = encoders::TrainingVariant::kRateAware;
  /// Quality of images to aim at: mean of their PSNR, at the fewest bytes. Figures are in
  /// docs/learning.md, section "Measured".
  double psnr_db = 36;
  /// Largest error of a number, in its unit, and of an orientation in rad; 0 keeps every bit. Not
  /// given: 0.005 standard deviations of each, and 0.001 rad.
  std::optional<double> number_bound;
  /// Without, images get no latents and no prediction but copies.
  bool has_networks = true;
  /// Features of the networks where places are few, a multiple of 16; zero chooses by the number of
  /// snapshots, because the model is stored too. consolidate() chooses by what networks may save.
  int width = 0;
  /// Channels of an image's latents at 16 x 16 and at 8 x 8 pixels.
  int coarse_channels = 24;
  int fine_channels = 8;
  /// Snapshots of a chain, each coded from those before: more take fewer bytes, one is reached
  /// later.
  int chain_rows = 16;
  /// Share of training on images as another view would show them (view_change.h), where there is
  /// more than one scene: more carries over better to new places, less knows old ones better.
  double varied_share = 0.1;
  /// Share of training on augmented values, where there are any.
  double augmented_share = 0.5;
  /// Threads of the networks. Whether two processes of one thread are quicker: parallel_speed.h.
  int threads = 2;
  /// Most bytes of decoded values to hold; beyond it evenly spaced snapshots are used.
  uint64_t memory_bytes = uint64_t{2} << 30;
  /// So many of the last recordings take no part in training.
  int hold_out_recordings = 0;

  [[nodiscard]] Status validate() const;
};

class JobPace;

/// How training runs beside other work, and outlives its process: nothing of it changes what so
/// many steps learn.
struct TrainControl {
  /// Training ends at this moment instead of after the budget.
  std::optional<Time> end;
  /// Kept here now and then, and gone on from where it fits; a training that is done leaves it.
  /// Empty: nowhere. See checkpoint_key.
  std::filesystem::path checkpoint;
  Duration checkpoint_interval = std::chrono::minutes(1);
  /// Where training waits while the robot is busy; null: it never does.
  JobPace* pace = nullptr;
};

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

/// Networks may take this part of what they save.
inline constexpr double kMostModelShare = 0.2;

/// About the bytes of networks of options.width, which is not 0; 0 where the layout has no images
/// or cannot be a tensor.
[[nodiscard]] uint64_t network_bytes(const idf::Layout& layout, const TrainOptions& options);

/// Features of the networks that are made for so many snapshots.
[[nodiscard]] int network_width(const TrainOptions& options, size_t snapshots);

/// The most features of 32, 48, 64, 96 and 128 whose networks take no more than a fifth of the
/// bytes that they may save; 0 where none do, or the layout has no images.
/// Source: docs/learning.md, section "What is stored: latents or video".
[[nodiscard]] int width_that_pays(const idf::Layout& layout, const TrainOptions& options,
                                  double saved_bytes);

/// What a checkpoint belongs to: options (but for the time they allow and the threads that use it),
/// code, the times of the data and the model that training goes on from. Another key, another
/// training.
[[nodiscard]] uint64_t checkpoint_key(const TrainingSource& source, const TrainOptions& options);

/// Trains a model on `source` and writes it to `file`, which must not exist.
///
/// Errors: kInvalidArgument where the values cannot be tensors; kCancelled on `stop`;
/// kResourceExhausted where memory ends, or the time of control.pace while the robot is busy;
/// those of source.read.
/// Threading: one at a time per process; uses LibTorch's global random generator and threads.
Result<TrainReport> train_model(const TrainingSource& source, const TrainOptions& options,
                                const std::filesystem::path& file, const ProgressSink& progress,
                                const std::stop_token& stop, const TrainControl& control = {});

}  // namespace engram::training
