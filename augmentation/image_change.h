// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "augmentation/random.h"
#include "augmentation/recipe.h"

namespace engram::augmentation {

struct SceneImages;

/// A whole number that a change needs, within bounds.
struct Parameter {
  std::string_view name;
  int64_t min = 0;
  int64_t max = 0;
  std::string_view what;  ///< With its unit.
};

/// Numbers of one change that are complete and within their bounds.
using Parameters = std::map<std::string_view, int64_t>;

/// One way to change the images of an instance. All of them are changed alike: colour images in
/// light and place, depth and labels in place alone.
///
/// Integers and OpenCV's bit-exact functions alone: the same bytes on every machine, whatever the
/// number of threads.
/// Threading: immutable, const-parallel.
/// Source: docs/augmentation.md.
class ImageChange {
 public:
  virtual ~ImageChange() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;
  /// One line for people.
  [[nodiscard]] virtual std::string_view about() const = 0;
  [[nodiscard]] virtual std::span<const Parameter> parameters() const = 0;
  /// Whether it changes an object, and so needs to be told where that is.
  [[nodiscard]] virtual bool needs_mask() const { return false; }

  /// Draws its parameters. `strength_percent` 1 to 100: how far they may go.
  [[nodiscard]] virtual Parameters draw(Random& random, int strength_percent) const = 0;

  virtual void apply(const Parameters& parameters, SceneImages& images) const = 0;
};

/// In the order in which recipes apply them: objects, then view, then light, then sensor.
[[nodiscard]] const std::vector<std::unique_ptr<const ImageChange>>& all_image_changes();

/// Errors: kInvalidArgument naming the closest one and all there are.
Result<const ImageChange*> find_image_change(std::string_view name);

/// The numbers of a change.
/// Errors: kInvalidArgument where one is missing, is no whole number, is out of its bounds, or
/// where there is one that the change does not know.
Result<Parameters> check_parameters(const ImageChange& kind, const Change& change);

}  // namespace engram::augmentation
