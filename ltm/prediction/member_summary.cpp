// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/member_summary.h"

#include <cmath>

#include "ltm/core/not_a_number.h"

namespace engram::ltm {

namespace {

double elements_of(const idf::TensorMember& member) {
  double count = 1;
  for (const int64_t size : member.shape) count *= static_cast<double>(size);
  return count;
}

double known_or(double known, double other) {
  return std::isnan(known) ? other : known;
}

/// A weighted mean over one kind of members. It is NaN if one of them is NaN.
struct WeightedSum {
  double sum = 0, weight = 0;

  void add(double value, double elements) {
    sum += value * elements;
    weight += elements;
  }
  [[nodiscard]] double mean() const { return weight > 0 ? sum / weight : kNaN; }
};

/// Combines a model's own estimate with its measured errors.
void take_estimate(const Prediction& predicted, MemberPrediction& member) {
  const ErrorEstimate& own = predicted.error;
  member.copied = member.is_image ? predicted.copied_images : predicted.copied_numbers;
  if (member.copied >= 1) member.engine = kCopyLast;
  if (member.is_image) {
    member.expected_mse = known_or(own.expected.image_mse, member.expected_mse);
    member.bound_mse = known_or(own.bound.image_mse, member.bound_mse);
  } else {
    member.expected_mse = known_or(member.expected_mse, own.expected.number_mse);
    member.bound_mse = known_or(member.bound_mse, own.bound.number_mse);
  }
}

}  // namespace

MemberPrediction whole_prediction(const Engine& model, const Prediction& predicted) {
  MemberPrediction whole;
  whole.engine = model.predictor->name();
  whole.expected_mse = predicted.error.expected.number_mse;
  whole.bound_mse = predicted.error.bound.number_mse;
  return whole;
}

void summarize(const ValueRow& rows, const std::vector<MemberCandidate>& candidates,
               const std::vector<MemberChoice>& choices, const std::vector<bool>& is_moving,
               const std::map<const Engine*, Prediction>& models,
               std::vector<MemberPrediction>& members, ErrorEstimate& error) {
  const std::vector<idf::TensorMember>& layout = rows.layout().members();
  std::vector<bool> is_counted(layout.size(), true);
  for (const RowMember& member : rows.row_members()) is_counted[member.member] = !member.is_copied;
  WeightedSum images, numbers, image_bounds, number_bounds;
  for (size_t i = 0; i < layout.size(); ++i) {
    const MemberCandidate& used = candidates[choices[i].candidate];
    MemberPrediction& member = members.emplace_back();
    member.path = layout[i].path;
    member.engine = used.engine;
    member.is_image = layout[i].kind == idf::MemberKind::kImage;
    member.is_moving = is_moving[i];
    member.copied = used.engine == kCopyLast ? 1 : 0;
    member.is_counted = is_counted[i];
    if (!member.is_counted) {
      member.engine = kCopyLast;
      member.copied = 1;
      continue;
    }
    member.expected_mse = choices[i].record.mean;
    member.bound_mse = choices[i].record.bound;
    if (used.model != nullptr) take_estimate(models.at(used.model), member);
    (member.is_image ? images : numbers).add(member.expected_mse, elements_of(layout[i]));
    (member.is_image ? image_bounds : number_bounds).add(member.bound_mse, elements_of(layout[i]));
  }
  error.expected = {images.mean(), numbers.mean()};
  error.bound = {image_bounds.mean(), number_bounds.mean()};
}

}  // namespace engram::ltm
