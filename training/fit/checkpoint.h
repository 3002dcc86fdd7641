// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "encoders/training_curve.h"
#include "ltm/idf/data.h"
#include "training/fit/fit_step.h"
#include "training/fit/train_options.h"
#include "training/fit/training_source.h"

// Internal to the learning rooms.

namespace engram::training {

enum class FitPhase : int32_t { kAutoencoder, kDynamics, kMotion };

/// "autoencoder", "dynamics", "motion".
[[nodiscard]] std::string_view name_of(FitPhase phase);

/// What a checkpoint belongs to: options (but for the time they allow and the threads that use it),
/// code, the times of the data and the model that training goes on from. Another key, another
/// training.
[[nodiscard]] uint64_t checkpoint_key(const TrainingSource& source, const TrainOptions& options);

/// Training between two steps: all that the rest of it depends on, but for the data.
struct Checkpoint {
  FitPhase phase = FitPhase::kAutoencoder;
  double share = 0;    ///< Of this phase.
  double seconds = 0;  ///< Of work so far, in all processes.
  FitStep coded;       ///< The end of the autoencoder's phase; in later ones only.
  FitStep predicted;   ///< The end of the dynamics' phase; in later ones only.
  idf::Data state;     ///< Of the fit, see kept_state().
  std::vector<encoders::CurvePoint> curve;  ///< Up to here, of all processes.
};

/// Writes the file whole: a reader sees the old one or this one.
/// Errors: kUnavailable, kResourceExhausted.
Status write_checkpoint(const std::filesystem::path& file, uint64_t key,
                        const Checkpoint& checkpoint);

/// Safe on hostile bytes.
/// Errors: kNotFound; kFailedPrecondition where it has another key; kDataLoss where it is damaged.
Result<Checkpoint> read_checkpoint(const std::filesystem::path& file, uint64_t key);

/// The checkpoint of one training, written every now and then. What goes wrong with it is told as a
/// warning: training goes on.
///
/// Threading: one thread.
class Checkpoints {
 public:
  /// `file` empty: keeps nothing. `interval`: of work, between two of them.
  Checkpoints(std::filesystem::path file, uint64_t key, Duration interval);

  /// What an earlier process left; null where there is none.
  [[nodiscard]] const Checkpoint* found() const { return found_ ? &*found_ : nullptr; }
  /// For one that turns out not to fit: from now on none was found.
  void refuse_found(const Status& why);
  [[nodiscard]] bool has_refused() const { return has_refused_; }

  [[nodiscard]] bool is_on() const { return !file_.empty(); }
  [[nodiscard]] bool is_due() const;
  void save(Checkpoint checkpoint);

  /// Of work, what earlier processes did included.
  [[nodiscard]] double seconds() const;
  void did_not_work(double seconds) { idle_seconds_ += seconds; }

  FitStep coded, predicted;       ///< Go into what is saved from now on.
  encoders::TrainingCurve curve;  ///< Likewise.

 private:
  std::filesystem::path file_;
  uint64_t key_;
  Duration interval_;
  std::optional<Checkpoint> found_;
  bool has_refused_ = false;
  bool has_warned_ = false;
  double idle_seconds_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_ = start_;
};

}  // namespace engram::training
