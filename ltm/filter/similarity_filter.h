// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "ltm/filter/filter.h"
#include "ltm/filter/measure.h"
#include "ltm/memory/name_pattern.h"

namespace engram::ltm {

/// Drops snapshots that are similar to the last one kept, in every member of every instance.
///
/// Members are those of the layout, by the segment's type where there is one. Numbers of one rule
/// are measured together, as one vector; each image and each orientation by itself. Snapshots of
/// another layout, or of another number of instances, are kept.
/// Owns: the last snapshot that it kept, arrays shared with whoever made them.
/// Source: docs/recording.md, section "Filters".
class SimilarityFilter final : public Filter {
 public:
  /// How members are compared whose whole path matches; kImage measures compare reduced images
  /// (see ReducedImage) and fall back to all elements where a member is none. kSsim and kAngle
  /// become kEqual where a member has no such thing.
  struct MemberRule {
    NamePattern path;
    Similarity similarity;
  };

  struct Options {
    /// The first rule that matches a member counts.
    std::vector<MemberRule> members;
    // Where none does, by kind of member:
    Similarity images{Measure::kSsim, 0.95};         ///< Images and depth images.
    Similarity numbers{Measure::kMaxAbs, 0.01};      ///< Numbers, arrays, positions, clouds.
    Similarity orientations{Measure::kAngle, 0.01};  ///< Only where a type tells of them.
    /// What is no tensor (texts, lists) must be equal to be similar; else it is not looked at.
    bool compares_remainder = true;
    /// Keep one at least this often, even without change. Nothing: never for that reason.
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
