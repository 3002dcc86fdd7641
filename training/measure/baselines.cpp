// SPDX-License-Identifier: Apache-2.0
#include "training/measure/baselines.h"

#include <algorithm>
#include <array>
#include <limits>

#include "encoders/flow_extrapolation.h"

namespace engram::training {

namespace {

template <typename T>
idf::NdArray on_a_line(const idf::NdArray& before, const idf::NdArray& last, int step) {
  const auto from = before.values<T>();
  const auto to = last.values<T>();
  std::vector<T> values(to.size());
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<T>(std::clamp<int>(int{to[i]} + step * (int{to[i]} - int{from[i]}), 0,
                                               std::numeric_limits<T>::max()));
  return idf::NdArray::take<T>(last.shape(), std::move(values));
}

Result<std::vector<idf::NdArray>> next_images(Baseline baseline, const idf::NdArray& before,
                                              const idf::NdArray& last, int steps) {
  if (baseline == Baseline::kFlow) return encoders::flow_extrapolated(before, last, steps);
  std::vector<idf::NdArray> images;
  for (int step = 1; step <= steps; ++step)
    images.push_back(last.type() == idf::ElementType::kUInt8
                         ? on_a_line<uint8_t>(before, last, step)
                         : on_a_line<uint16_t>(before, last, step));
  return images;
}

}  // namespace

std::string_view to_string(Baseline baseline) {
  constexpr std::array<std::string_view, kBaselines> kNames{"copy-last", "linear", "flow"};
  return kNames[static_cast<size_t>(baseline)];
}

Result<std::vector<idf::Data>> predict_by(Baseline baseline, const encoders::TensorPlan& plan,
                                          const idf::Data& before, const idf::Data& last,
                                          int steps) {
  if (baseline == Baseline::kCopyLast)
    return std::vector<idf::Data>(static_cast<size_t>(steps), last);
  ENGRAM_ASSIGN_OR_RETURN(const idf::SplitValue from, plan.layout().split(before));
  ENGRAM_ASSIGN_OR_RETURN(const idf::SplitValue to, plan.layout().split(last));
  std::vector<idf::SplitValue> next(static_cast<size_t>(steps), to);
  for (const encoders::ImageMember& image : plan.images()) {
    ENGRAM_ASSIGN_OR_RETURN(auto images, next_images(baseline, from.tensors[image.member],
                                                     to.tensors[image.member], steps));
    for (size_t i = 0; i < next.size(); ++i) next[i].tensors[image.member] = std::move(images[i]);
  }
  const std::vector<double> numbers_before = plan.read_numbers(from);
  std::vector<double> numbers = plan.read_numbers(to);
  std::vector<idf::Data> values;
  for (idf::SplitValue& value : next) {
    if (!numbers.empty()) {
      std::vector<double> line = numbers;
      const auto step = static_cast<double>(values.size() + 1);
      for (size_t i = 0; i < line.size(); ++i) line[i] += step * (numbers[i] - numbers_before[i]);
      plan.write_numbers(line, value.tensors);
    }
    ENGRAM_ASSIGN_OR_RETURN(values.emplace_back(), plan.layout().join(value));
  }
  return values;
}

}  // namespace engram::training
