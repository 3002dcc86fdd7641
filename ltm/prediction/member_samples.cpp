// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/member_samples.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/not_a_number.h"
#include "ltm/idf/element_visit.h"

namespace engram::ltm {

namespace {

constexpr float kPeak = 255;
constexpr double kGoldenRatio = 0.6180339887498949;

/// Takes one place in each of `max` equal parts, at a different offset in each. A fixed stride
/// could hit the same column of an image, or the same colour channel, every time.
std::vector<size_t> places_in(size_t count, size_t max) {
  const size_t wanted = std::min(count, max);
  std::vector<size_t> places(wanted);
  const double width =
      static_cast<double>(count) / static_cast<double>(std::max<size_t>(wanted, 1));
  for (size_t i = 0; i < wanted; ++i) {
    const double jitter = wanted == count ? 0 : std::fmod(static_cast<double>(i) * kGoldenRatio, 1);
    places[i] = std::min(count - 1, static_cast<size_t>((static_cast<double>(i) + jitter) * width));
  }
  return places;
}

float scale_of(const idf::NdArray& array, bool is_image) {
  if (!is_image || array.type() != idf::ElementType::kUInt16) return 1;
  const auto values = array.values<uint16_t>();
  return kPeak / static_cast<float>(std::max<uint16_t>(1, std::ranges::max(values)));
}

/// A mean of squares, weighted by the number of elements that each sample stands for.
struct WeightedMean {
  double sum = 0, weight = 0;

  [[nodiscard]] double mean() const { return weight > 0 ? sum / weight : kNaN; }
};

}  // namespace

MemberSamples::MemberSamples(const ValueRow& rows) {
  for (const size_t index : rows.other_members()) {
    const idf::TensorMember& member = rows.layout().members()[index];
    size_t count = 1;
    for (const int64_t size : member.shape) count *= static_cast<size_t>(size);
    const bool is_image = member.kind == idf::MemberKind::kImage;
    parts_.push_back({index, is_image, static_cast<double>(count), places_in(count, kMaxElements)});
    images_ += is_image ? 1 : 0;
    numbers_ += is_image ? 0 : count;
  }
}

MemberSample MemberSamples::sample(const idf::SplitValue& value) const {
  MemberSample sample;
  for (const Part& part : parts_) {
    const idf::NdArray& array = value.tensors[part.member];
    sample.scales.push_back(scale_of(array, part.is_image));
    idf::visit_element_type(array.type(), [&]<typename T>(T) {
      const auto values = array.values<T>();
      std::vector<float>& elements = sample.elements.emplace_back();
      elements.reserve(part.places.size());
      for (const size_t place : part.places) elements.push_back(static_cast<float>(values[place]));
    });
  }
  return sample;
}

std::vector<double> MemberSamples::differences(const MemberSample& recorded,
                                               const MemberSample& other) const {
  std::vector<double> squares;
  for (size_t i = 0; i < parts_.size(); ++i) {
    double sum = 0, count = 0;
    for (size_t k = 0; k < recorded.elements[i].size(); ++k) {
      const double difference = double{recorded.elements[i][k]} - other.elements[i][k];
      if (!std::isfinite(difference)) continue;
      sum += difference * difference;
      count += 1;
    }
    squares.push_back(count == 0 ? kNaN : sum / count * recorded.scales[i] * recorded.scales[i]);
  }
  return squares;
}

MeasuredError MemberSamples::difference(const MemberSample& recorded,
                                        const MemberSample& other) const {
  WeightedMean images, numbers;
  const std::vector<double> squares = differences(recorded, other);
  for (size_t i = 0; i < parts_.size(); ++i) {
    if (std::isnan(squares[i])) continue;
    WeightedMean& mean = parts_[i].is_image ? images : numbers;
    mean.sum += parts_[i].weight * squares[i];
    mean.weight += parts_[i].weight;
  }
  return {images.mean(), numbers.mean()};
}

}  // namespace engram::ltm
