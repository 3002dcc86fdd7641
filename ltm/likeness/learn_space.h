// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "ltm/core/sequences.h"
#include "ltm/core/time.h"

namespace engram::ltm {

/// What a space is learned from: N moments of one entity, in the order of time.
struct LikenessSamples {
  std::vector<Time> times;
  std::vector<std::vector<float>> descriptors;  ///< [N, kDescriptorSize]
  /// Numbers that say what else was alike, such as the joints now and a second ago. Each moment has
  /// as many, or all have none. [N, V]
  std::vector<std::vector<double>> views;
  std::vector<Sequence> recordings;  ///< Cover all N.
};

/// The part of a LikenessSpace that is learned.
struct LearnedProjection {
  std::vector<float> mean;        ///< [kDescriptorSize]
  std::vector<float> projection;  ///< [kCodeSize, kDescriptorSize]
};

/// Learns which differences of images matter, in closed form.
///
/// With views: moments of different recordings whose views are alike should have alike codes. What
/// differs between their images is the room and the light. So the directions are kept in which all
/// images differ much and these pairs differ little: the generalised eigenvectors of both
/// covariances, among the first 64 principal components. Without views the principal components
/// are the code.
/// The same samples give the same projection.
/// Needs two samples or more (checked).
/// Source: linear discriminant analysis with the views instead of classes;
/// docs/recall.md, section "How likeness is measured".
[[nodiscard]] LearnedProjection learn_projection(const LikenessSamples& samples);

/// Pairs of moments of different recordings with the nearest views: indices of samples. The half of
/// all that is nearer is kept. Empty without views, or where there is one recording alone.
[[nodiscard]] std::vector<std::pair<size_t, size_t>> alike_pairs(const LikenessSamples& samples);

}  // namespace engram::ltm
