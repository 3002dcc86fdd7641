// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::ltm {

/// What makes a snapshot worth keeping.
enum class SaliencyPart : uint8_t {
  kChange,    ///< What the more salient snapshots before it do not tell.
  kSurprise,  ///< The error of a prediction of it, over the bound that was told before.
  kNovelty,   ///< How far it is from all that its entity had before.
  kOutcome,   ///< It tells that an action failed, was stopped, succeeded or began.
  kSpeech,    ///< Somebody said something.
  kLinks,     ///< It leads elsewhere than the snapshot before.
  kReads,     ///< It was asked for.
};

inline constexpr size_t kSaliencyParts = 7;

/// "change", "surprise", ...
[[nodiscard]] std::string_view name_of(SaliencyPart part);

/// A number for each part.
class SaliencyParts {
 public:
  [[nodiscard]] double operator[](SaliencyPart part) const {
    return values_[static_cast<size_t>(part)];
  }
  [[nodiscard]] double& operator[](SaliencyPart part) { return values_[static_cast<size_t>(part)]; }
  [[nodiscard]] const std::array<double, kSaliencyParts>& values() const { return values_; }

  friend bool operator==(const SaliencyParts&, const SaliencyParts&) = default;

 private:
  std::array<double, kSaliencyParts> values_{};
};

/// How much each part counts.
///
/// Shape: each is 0 or more, and all together are 1.
struct SaliencyWeights {
  SaliencyParts parts;
  /// Snapshots whose reads they were learned from; 0: nobody asked enough yet.
  uint64_t learned_from = 0;

  /// What counts as long as nothing was learned.
  [[nodiscard]] static SaliencyWeights standard();

  /// Errors: kInvalidArgument.
  [[nodiscard]] Status validate() const;
};

/// The saliency of a snapshot: the weighted sum of its parts, 0 to 1.
[[nodiscard]] double saliency_of(const SaliencyParts& parts, const SaliencyWeights& weights);

/// The part that stands for what an entity usually changes in so many seconds: 0 at a hundredth of
/// a second, 1 at a hundred seconds or more, and in between by its logarithm.
[[nodiscard]] double change_part(double seconds);
/// The change that change_part() turns into `part`. Unit: seconds.
[[nodiscard]] double change_seconds(double part);

/// The part that stands for an error of `ratio` times its bound: 0 up to the bound, 1 at a hundred
/// times the bound or more.
[[nodiscard]] double surprise_part(double ratio);

/// The part that stands for so many reads.
[[nodiscard]] double reads_part(uint64_t reads);

}  // namespace engram::ltm
