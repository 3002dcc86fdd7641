// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "ltm/context/entity_context.h"
#include "ltm/idf/type.h"
#include "ltm/memory/links.h"
#include "ltm/memory/result.h"

namespace engram::ltm {

/// Finds places, links and spans in the values of an entity, snapshot by snapshot.
///
/// A place is a dict of a `position` and an `orientation`: arrays of 3 and 4 (w, x, y, z) numbers,
/// or dicts of `x`, `y`, `z` and `w`. Its frame is FRAME of the name of a member `pose_FRAME_THING`
/// that holds it, or else the text of the nearest member `frame_id` or `frame` around it, also of a
/// dict `header`. A camera is a value with a pose, and with a link in a member whose name has
/// `calibration`, `intrinsics` or `camera_info`, or with `fx`, `fy`, `cx`, `cy`, `width` and
/// `height` itself. A span has a time in `started`, and in `ended` where it ended. Something says
/// by a bool `is_visible` or `visible` whether it was seen.
///
/// Threading: one thread.
/// Source: docs/query.md, "Places".
class ContextReader {
 public:
  /// `type` is that of the values; without one all texts that read as IDs of snapshots are links.
  explicit ContextReader(std::optional<idf::Type> type) : type_(std::move(type)) {}

  /// Adds a snapshot, later than those before.
  void add(Time time, std::span<const InstanceResult> instances);

  [[nodiscard]] EntityContext take() &&;

 private:
  void add_value(const idf::Data& value, int32_t instance);
  [[nodiscard]] std::vector<Link> links_of(const idf::Data& value) const;

  std::optional<idf::Type> type_;
  EntityContext context_;
  KnownIndices<std::string> frames_;
  KnownIndices<MemoryId> targets_;
};

/// Whether values of a type can have anything of a context: most of what is recorded are numbers
/// that cannot, and need not be read.
[[nodiscard]] bool tells_context(const idf::Type& type);

/// The intrinsics in a value; nothing if it has none.
[[nodiscard]] std::optional<Intrinsics> intrinsics_in(const idf::Data& value);

/// FRAME of `pose_FRAME_THING`; empty if the name is another one.
[[nodiscard]] std::string_view frame_in_name(std::string_view member);

}  // namespace engram::ltm
