// SPDX-License-Identifier: Apache-2.0
#include "augmentation/image_change.h"

#include <algorithm>

#include "augmentation/image_changes.h"
#include "ltm/core/config.h"

namespace engram::augmentation {

namespace {

std::vector<std::unique_ptr<const ImageChange>> make_all() {
  std::vector<std::unique_ptr<const ImageChange>> all;
  all.push_back(make_recolour());
  all.push_back(make_replace());
  all.push_back(make_shift());
  all.push_back(make_rotate());
  all.push_back(make_occlude());
  all.push_back(make_brightness());
  all.push_back(make_contrast());
  all.push_back(make_temperature());
  all.push_back(make_blur());
  all.push_back(make_noise());
  return all;
}

}  // namespace

const std::vector<std::unique_ptr<const ImageChange>>& all_image_changes() {
  static const auto all = make_all();
  return all;
}

Result<const ImageChange*> find_image_change(std::string_view name) {
  std::vector<std::string> names;
  std::string list;
  for (const auto& change : all_image_changes()) {
    if (change->name() == name) return change.get();
    names.emplace_back(change->name());
    list += (list.empty() ? "" : ", ") + names.back();
  }
  const auto closest = closest_word(name, names);
  return invalid_argument("change of images: found '{}'{}, needs one of {}", name,
                          closest ? ", did you mean '" + *closest + "'?" : "", list);
}

Result<Parameters> check_parameters(const ImageChange& kind, const Change& change) {
  Parameters numbers;
  for (const Parameter& parameter : kind.parameters()) {
    ENGRAM_ASSIGN_OR_RETURN(const int64_t value, change.integer(parameter.name));
    if (value < parameter.min || value > parameter.max)
      return invalid_argument("recipe: change '{}': '{}' is {}, needs {} to {} ({})", change.name,
                              parameter.name, value, parameter.min, parameter.max, parameter.what);
    numbers.emplace(parameter.name, value);
  }
  for (const auto& [key, value] : change.parameters)
    if (!numbers.contains(key))
      return invalid_argument("recipe: change '{}' knows no '{}'", change.name, key);
  return numbers;
}

}  // namespace engram::augmentation
