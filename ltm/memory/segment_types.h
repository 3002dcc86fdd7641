// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "ltm/idf/cast.h"
#include "ltm/idf/type.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// A value after the cast to its segment's type.
struct ReinterpretedValue {
  idf::Data value;
  /// Members that were dropped because the type does not know them, and numbers that were rounded.
  std::vector<idf::CastNote> notes;
  bool is_cast = false;  ///< The cast changed the value.
};

/// The types of the values of core and provider segments. A core segment has a core type, which its
/// provider segments may extend. Segments without a type take any value.
///
/// Threading: const-parallel.
/// Source: docs/idf.md, section "Types of segments".
class SegmentTypes {
 public:
  /// Sets the type of the values of a segment from now on.
  /// Errors: kInvalidArgument where `segment` is neither a core nor a provider segment, where a
  /// provider's type does not extend that of its core segment, or where the types of its provider
  /// segments do not extend a new core type: naming the path, what was found and what was needed.
  Status declare(const MemoryId& segment, const idf::Type& type);

  /// The type that was declared for exactly this segment; null where there is none.
  [[nodiscard]] const idf::Type* find(const MemoryId& segment) const;

  /// The type of an entity's values: that of its provider segment, otherwise that of its core
  /// segment; null where neither has one.
  [[nodiscard]] const idf::Type* of_entity(const MemoryId& entity) const;

  /// Returns the value unchanged where it fits its entity's type or there is no type. Otherwise it
  /// casts the value, which needs all members that the type requires.
  /// Errors: kInvalidArgument with all paths that do not fit.
  Result<ReinterpretedValue> reinterpret(const MemoryId& entity, const idf::Data& value) const;

  /// Like reinterpret, but without a copy: nothing where the value stays as it is.
  Result<std::optional<idf::CastResult>> cast_misfit(const MemoryId& entity,
                                                     const idf::Data& value) const;

  /// Only the types that are needed to read these entities.
  [[nodiscard]] SegmentTypes of_entities(const std::vector<MemoryId>& entities) const;

  /// Ordered by the names of the segments.
  [[nodiscard]] const std::map<MemoryId, idf::Type>& all() const { return types_; }

  /// Returns {"Vision/RGB": type as a value, ...}. Source: docs/idf.md, section "Types as values".
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kDataLoss naming the segment.
  static Result<SegmentTypes> from_data(const idf::Data& data);

  friend bool operator==(const SegmentTypes&, const SegmentTypes&) = default;

 private:
  std::map<MemoryId, idf::Type> types_;
};

}  // namespace engram::ltm
