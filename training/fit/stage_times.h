// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>

namespace engram::training {

/// A kind of work of the nightly job.
enum class Stage {
  kPlan,          ///< Finding out what there is to do, and the noise of images.
  kSamples,       ///< Encoding samples for the plan. Their number does not grow with the images.
  kReading,       ///< Reading the snapshots that are encoded, and stored videos of them.
  kTraining,      ///< Reading the training data, training, measuring predictions.
  kLatents,       ///< Networks and entropy coding: latents of images, and numbers.
  kResiduals,     ///< What latents lack of the bound.
  kVideo,         ///< Searching for the video of each chain, without loss too.
  kVerification,  ///< Decoding what will be stored and comparing it with what was recorded.
  kPublishing,    ///< Writing the model, reading it back, writing latents into the store.
  kOther,
};
inline constexpr size_t kStages = static_cast<size_t>(Stage::kOther) + 1;

/// Such as "plan".
[[nodiscard]] std::string_view to_string(Stage stage);

/// Unit: s.
struct StageTime {
  double processor_seconds = 0;  ///< Sum over all threads.
  double seconds = 0;            ///< Includes waiting.
};

/// The clocks of this process. Processor time is that of the whole process, because encoders and
/// networks work in threads of their own, whose time belongs to the stage that waits for them. So
/// work of other threads that run beside the job counts for the job's stage of that moment.
[[nodiscard]] StageTime process_clocks();

/// Measures where the time of a job goes. A moment counts for one stage only: a stage that begins
/// within another one interrupts it.
///
/// Threading: one thread.
class StageTimes {
 public:
  using Clocks = std::function<StageTime()>;

  StageTimes() : StageTimes(process_clocks) {}
  explicit StageTimes(Clocks clocks);

  [[nodiscard]] const StageTime& of(Stage stage) const {
    return spent_[static_cast<size_t>(stage)];
  }
  [[nodiscard]] StageTime total() const;

  /// Counts the time until its end for a stage.
  class [[nodiscard]] Scope {
   public:
    /// `times` may be null: then nothing is measured. It must outlive this object.
    Scope(StageTimes* times, Stage stage);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTimes* times_;
    std::optional<Stage> interrupted_;
  };

 private:
  /// Returns the stage before it.
  std::optional<Stage> change_to(std::optional<Stage> stage);

  Clocks clocks_;
  std::array<StageTime, kStages> spent_{};
  std::optional<Stage> stage_;  ///< The stage that time counts for now; none outside all scopes.
  StageTime changed_at_;
};

}  // namespace engram::training
