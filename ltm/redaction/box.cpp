// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/box.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "ltm/idf/strict_json.h"

namespace engram::ltm {

namespace {

using Json = nlohmann::ordered_json;

/// The levels of the answer: the object, the list, a box.
constexpr int kMaxLevels = 4;

Result<Box> read_box(const Json& json, size_t index) {
  if (!json.is_array() || json.size() != 4)
    return invalid_argument("box {}: needs a list of four numbers: x, y, width, height", index);
  double numbers[4] = {};
  for (size_t i = 0; i < 4; ++i) {
    if (!json[i].is_number()) return invalid_argument("box {}: needs four numbers", index);
    numbers[i] = json[i].get<double>();
    if (!std::isfinite(numbers[i]))
      return invalid_argument("box {}: found a number that is not finite", index);
  }
  if (numbers[2] <= 0 || numbers[3] <= 0)
    return invalid_argument("box {}: found the size {} x {}, needs more than zero", index,
                            numbers[2], numbers[3]);
  return Box{numbers[0], numbers[1], numbers[2], numbers[3]};
}

}  // namespace

Result<std::vector<Box>> parse_boxes(std::string_view json, uint64_t image) {
  ENGRAM_ASSIGN_OR_RETURN(const Json answer, idf::parse_json(json, kMaxLevels));
  if (!answer.is_object() || answer.size() != 2 || !answer.contains("image") ||
      !answer.contains("boxes"))
    return invalid_argument("needs an object with the keys 'image' and 'boxes'");
  // An answer that comes late must not be taken for that of the next image.
  if (!answer["image"].is_number_unsigned() || answer["image"].get<uint64_t>() != image)
    return invalid_argument("'image': needs {}, the number of the image", image);
  const Json& list = answer["boxes"];
  if (!list.is_array()) return invalid_argument("'boxes': needs a list");
  if (list.size() > kMaxBoxes)
    return invalid_argument("'boxes': found {}, needs {} at most", list.size(), kMaxBoxes);
  std::vector<Box> boxes;
  boxes.reserve(list.size());
  for (size_t i = 0; i < list.size(); ++i) {
    ENGRAM_ASSIGN_OR_RETURN(boxes.emplace_back(), read_box(list[i], i));
  }
  return boxes;
}

}  // namespace engram::ltm
