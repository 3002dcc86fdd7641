// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/data.h"

namespace engram::augmentation {

/// One change of a recipe: its name, and its parameters as data.
///
/// Changes of images have only whole numbers (image_change.h). Other changes, such as rendering a
/// scene again, may have parameters of any kind.
struct Change {
  std::string name;
  idf::Dict parameters;

  /// Errors: kInvalidArgument if there is no such parameter or it is not a whole number.
  Result<int64_t> integer(std::string_view parameter) const;

  friend bool operator==(const Change&, const Change&) = default;
};

/// The changes that are applied to a snapshot, one after the other. A recipe is enough to make the
/// same bytes again.
///
/// Source: docs/augmentation.md, section "Recipes".
struct Recipe {
  std::vector<Change> changes;

  /// {"version": 1, "changes": [{"change": "brightness", "levels": 12}, ...]}.
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values. Changes with unknown names are accepted.
  /// Errors: kInvalidArgument naming the change, what was found and what was needed.
  static Result<Recipe> from_data(const idf::Data& data);

  /// The JSON form, which the metadata of augmented instances contain.
  /// Errors: kInvalidArgument if a parameter has no JSON form.
  Result<std::string> to_text() const;

  /// Errors: as from_data.
  static Result<Recipe> parse(std::string_view text);

  friend bool operator==(const Recipe&, const Recipe&) = default;
};

}  // namespace engram::augmentation
