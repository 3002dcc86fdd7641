// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ltm/filter/filter.h"
#include "ltm/filter/measure.h"
#include "ltm/memory/name_pattern.h"

namespace engram::ltm {

/// Drops snapshots that are similar to the last one kept in every member of every instance.
///
/// Members are those of the layout, by the segment's type if one is declared. Numbers of one rule
/// are measured together as one vector, each image and each orientation by itself. Snapshots with
/// another layout or another number of instances are kept.
/// Owns: the last snapshot that it kept; its arrays are shared with the caller.
/// Source: docs/recording.md, section "Filters".
class SimilarityFilter final : public Filter {
 public:
  /// How to compare members whose whole path matches. Image measures (is_image_measure) compare
  /// reduced images (see ReducedImage); kMse and kMae compare all elements of a member that is not
  /// an image. kSsim acts as kEqual on such a member, and kAngle on one that is not a rotation.
  struct MemberRule {
    NamePattern path;
    Similarity similarity;
  };

  struct Options {
    /// The first rule that matches a member is used.
    std::vector<MemberRule> members;
    // If no rule matches, the kind of member decides:
    Similarity images{Measure::kSsim, 0.95};         ///< Images and depth images.
    Similarity numbers{Measure::kMaxAbs, 0.01};      ///< Numbers, arrays, positions, clouds.
    Similarity orientations{Measure::kAngle, 0.01};  ///< Only a type can declare them.
    /// If true, what is not a tensor (texts, lists) must be equal to be similar. If false, it is
    /// ignored.
    bool compares_remainder = true;
    /// Max time between kept snapshots: then one is kept without a change. Empty: no limit.
    std::optional<Duration> max_gap = std::chrono::seconds(10);

    [[nodiscard]] Status validate() const;
  };

  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<SimilarityFilter> create(const Options& options);

  SimilarityFilter(SimilarityFilter&&) noexcept;
  ~SimilarityFilter() override;

  [[nodiscard]] std::string_view name() const override { return "similarity"; }
  void offer(Candidate candidate, FilterDecisions& decisions) override;

 private:
  struct State;
  explicit SimilarityFilter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace engram::ltm
