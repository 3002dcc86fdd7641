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

/// A whole number that a change needs, and the bounds that it must lie within.
struct Parameter {
  std::string_view name;
  int64_t min = 0;
  int64_t max = 0;
  std::string_view what;  ///< What the number means, with its unit.
};

/// The numbers of one change. They are complete and within their bounds.
using Parameters = std::map<std::string_view, int64_t>;

/// One way to change the images of an instance. All images are changed alike: colour images in both
/// light and place, depth and labels only in place.
///
/// Implementations use only integers and those functions of OpenCV that are bit-exact, so they give
/// the same bytes on every machine and with any number of threads.
/// Threading: immutable, const-parallel.
/// Source: docs/augmentation.md.
class ImageChange {
 public:
  virtual ~ImageChange() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;
  /// One line of text for the user.
  [[nodiscard]] virtual std::string_view about() const = 0;
  [[nodiscard]] virtual std::span<const Parameter> parameters() const = 0;
  /// Returns true if the change affects an object and therefore needs labels that locate it.
  [[nodiscard]] virtual bool needs_mask() const { return false; }

  /// Draws parameters. `strength_percent`, 1 to 100, bounds how far they may go.
  [[nodiscard]] virtual Parameters draw(Random& random, int strength_percent) const = 0;

  virtual void apply(const Parameters& parameters, SceneImages& images) const = 0;
};

/// Returns all changes in the order in which recipes apply them: objects, view, light, sensor.
[[nodiscard]] const std::vector<std::unique_ptr<const ImageChange>>& all_image_changes();

/// Finds a change by its name.
/// Errors: kInvalidArgument naming the closest change and all that exist.
Result<const ImageChange*> find_image_change(std::string_view name);

/// Reads the numbers of a change.
/// Errors: kInvalidArgument if a number is missing, is not whole, is out of its bounds, or is not
/// known to the change.
Result<Parameters> check_parameters(const ImageChange& kind, const Change& change);

}  // namespace engram::augmentation
