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

/// The key of the training that a checkpoint belongs to. It covers the options (without the budget,
/// and without the threads unless steps are fixed), the format of checkpoints, the times of the
/// data and the model that training starts from. A checkpoint with another key is not used.
[[nodiscard]] uint64_t checkpoint_key(const TrainingSource& source, const TrainOptions& options);

/// The state of training between two steps: everything that the remaining steps depend on, except
/// the data.
struct Checkpoint {
  FitPhase phase = FitPhase::kAutoencoder;
  double share = 0;    ///< Done share of this phase.
  double seconds = 0;  ///< Time of work so far, in all processes.
  FitStep coded;       ///< Last step of the autoencoder's phase; set in later phases only.
  FitStep predicted;   ///< Last step of the dynamics' phase; set in later phases only.
  idf::Data state;     ///< State of the fit, see kept_state().
  std::vector<encoders::CurvePoint> curve;  ///< Curve up to here, of all processes.
};

/// Replaces the file atomically: a reader sees the old file or the new one.
/// Errors: kUnavailable, kResourceExhausted.
Status write_checkpoint(const std::filesystem::path& file, uint64_t key,
                        const Checkpoint& checkpoint);

/// Reads a checkpoint. It is safe on hostile bytes.
/// Errors: kNotFound; kFailedPrecondition if the key is another one; kDataLoss if it is damaged.
Result<Checkpoint> read_checkpoint(const std::filesystem::path& file, uint64_t key);

/// The checkpoint of one training, written at intervals. Errors of writing are logged as warnings,
/// and training continues.
///
/// Threading: one thread.
class Checkpoints {
 public:
  /// Keeps nothing if `file` is empty. `interval` is the time between two checkpoints.
  Checkpoints(std::filesystem::path file, uint64_t key, Duration interval);

  /// The checkpoint of an earlier process, or null.
  [[nodiscard]] const Checkpoint* found() const { return found_ ? &*found_ : nullptr; }
  /// Discards the found checkpoint because it does not fit: found() then returns null.
  void refuse_found(const Status& why);
  [[nodiscard]] bool has_refused() const { return has_refused_; }

  [[nodiscard]] bool is_on() const { return !file_.empty(); }
  [[nodiscard]] bool is_due() const;
  void save(Checkpoint checkpoint);

  /// Time of work, including that of earlier processes.
  [[nodiscard]] double seconds() const;
  void did_not_work(double seconds) { idle_seconds_ += seconds; }

  FitStep coded, predicted;       ///< Written into every later checkpoint.
  encoders::TrainingCurve curve;  ///< Written into every later checkpoint.

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
