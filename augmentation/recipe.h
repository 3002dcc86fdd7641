// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/idf/data.h"

namespace engram::augmentation {

/// One change of a recipe: its name, and parameters as data.
///
/// Those of changes of images are whole numbers (image_change.h); changes that others make, such as
/// rendering a scene anew, may have any.
struct Change {
  std::string name;
  idf::Dict parameters;

  /// Errors: kInvalidArgument where there is no such whole number.
  Result<int64_t> integer(std::string_view parameter) const;

  friend bool operator==(const Change&, const Change&) = default;
};

/// What is done to a snapshot, one change after the other. It alone makes the same bytes again.
///
/// Source: docs/augmentation.md, section "Recipes".
struct Recipe {
  std::vector<Change> changes;

  /// {"version": 1, "changes": [{"change": "brightness", "levels": 12}, ...]}.
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values. Changes need not be known.
  /// Errors: kInvalidArgument naming the change, what was found and what was needed.
  static Result<Recipe> from_data(const idf::Data& data);

  /// The JSON form: what the metadata of augmented instances carry.
  /// Errors: kInvalidArgument where a parameter has no JSON form.
  Result<std::string> to_text() const;

  /// Errors: as from_data.
  static Result<Recipe> parse(std::string_view text);

  friend bool operator==(const Recipe&, const Recipe&) = default;
};

}  // namespace engram::augmentation
