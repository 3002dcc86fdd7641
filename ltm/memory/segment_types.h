// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "ltm/idf/cast.h"
#include "ltm/idf/type.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// A value as its segment's type wants it.
struct ReinterpretedValue {
  idf::Data value;
  /// Members that the type does not know and `value` has no more, and numbers that were rounded.
  std::vector<idf::CastNote> notes;
  bool is_cast = false;  ///< It is not as it came.
};

/// What the values of core and provider segments are: a core segment has a core type, its provider
/// segments may extend it. Segments without a type take any value.
///
/// Threading: const-parallel.
/// Source: docs/idf.md, section "Types of segments".
class SegmentTypes {
 public:
  /// Says what the values of a segment are from now on.
  /// Errors: kInvalidArgument where `segment` is no core and no provider segment, where a
  /// provider's type does not extend that of its core segment, or where a new core type is not
  /// what the types of its provider segments extend: naming the path, what was found and needed.
  Status declare(const MemoryId& segment, const idf::Type& type);

  /// The type that was declared for exactly this segment; null where none was.
  [[nodiscard]] const idf::Type* find(const MemoryId& segment) const;

  /// The type of an entity's values: that of its provider segment, else that of its core segment;
  /// null where neither has one.
  [[nodiscard]] const idf::Type* of_entity(const MemoryId& entity) const;

  /// The value as the entity's type has it: as it is where it fits or where there is no type, else
  /// cast, where all that the type needs is there.
  /// Errors: kInvalidArgument with all paths that do not fit.
  Result<ReinterpretedValue> reinterpret(const MemoryId& entity, const idf::Data& value) const;

  /// The same without a copy: nothing where the value stays as it is.
  Result<std::optional<idf::CastResult>> cast_misfit(const MemoryId& entity,
                                                     const idf::Data& value) const;

  /// Only the types that are asked for when these entities are read.
  [[nodiscard]] SegmentTypes of_entities(const std::vector<MemoryId>& entities) const;

  /// In the order of the segments' names.
  [[nodiscard]] const std::map<MemoryId, idf::Type>& all() const { return types_; }

  /// {"Vision/RGB": type as a value, ...}. Source: docs/idf.md, section "Types as values".
  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kDataLoss naming the segment.
  static Result<SegmentTypes> from_data(const idf::Data& data);

  friend bool operator==(const SegmentTypes&, const SegmentTypes&) = default;

 private:
  std::map<MemoryId, idf::Type> types_;
};

}  // namespace engram::ltm
