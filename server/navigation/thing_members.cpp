// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/thing_members.h"

#include <cmath>

namespace engram::navigation {

std::optional<std::vector<double>> finite_numbers(const idf::Data* data, int64_t count) {
  const auto* array = data == nullptr ? nullptr : data->get_if<idf::NdArray>();
  if (array == nullptr || array->shape() != idf::Shape{count}) return {};
  std::vector<double> numbers;
  if (array->type() == idf::ElementType::kFloat64)
    for (const double number : array->values<double>()) numbers.push_back(number);
  if (array->type() == idf::ElementType::kFloat32)
    for (const float number : array->values<float>()) numbers.push_back(number);
  for (const double number : numbers)
    if (!std::isfinite(number)) return {};
  if (numbers.empty()) return {};
  return numbers;
}

Result<typed::Pose<double>> pose_in(const idf::Data& data, const std::string& member) {
  const idf::Data* value = data.at(member);
  if (value == nullptr) return invalid_argument("it has no member {}", member);
  const auto position = finite_numbers(value->at(idf::kPositionKey), 3);
  const auto turned = finite_numbers(value->at(idf::kOrientationKey), 4);
  if (!position || !turned) return invalid_argument("its {} is no pose of finite numbers", member);
  typed::Pose<double> pose;
  pose.position = {(*position)[0], (*position)[1], (*position)[2]};
  const Eigen::Quaterniond given((*turned)[0], (*turned)[1], (*turned)[2], (*turned)[3]);
  if (std::abs(given.norm() - 1) > 0.01)
    return invalid_argument("the orientation of its {} has a norm of {}, needs 1", member,
                            given.norm());
  pose.orientation = given.normalized();
  return pose;
}

}  // namespace engram::navigation
