// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/memory/memory_id.h"

namespace engram::ltm {

/// The kinds of conditions: each asks something of the place or the context of a snapshot.
///
/// A snapshot has a place for each pose in its values that says its frame (docs/query.md,
/// "Places").
namespace where {
/// A place of the snapshot is at most `metres` from a place of `entity` in the same frame, as
/// `entity` was then.
struct Within {
  MemoryId entity;
  double metres = 0;
  friend bool operator==(const Within&, const Within&) = default;
};
/// A place of the snapshot is at most `metres` from `point` in `frame`. Unit: m.
struct Near {
  std::array<double, 3> point{};
  double metres = 0;
  std::string frame = "world";
  friend bool operator==(const Near&, const Near&) = default;
};
/// A camera and something with a place, one of which is the entity that is asked and the other
/// `entity`: the place projects into an image of the camera.
struct InView {
  enum class Sighting : uint8_t {
    kAny,     ///< Whether it was seen or not.
    kSeen,    ///< And it was seen.
    kInVain,  ///< And it was not seen although nothing known was before it.
  };
  MemoryId entity;
  Sighting sighting = Sighting::kAny;
  friend bool operator==(const InView&, const InView&) = default;
};
/// What `entity` tells of was going on: an action from its start to its end.
struct While {
  MemoryId entity;
  friend bool operator==(const While&, const While&) = default;
};
/// The snapshot links to `id` or to anything below it.
struct LinkedTo {
  MemoryId id;
  friend bool operator==(const LinkedTo&, const LinkedTo&) = default;
};
/// A snapshot at `id` or below it links to the snapshot.
struct LinksFrom {
  MemoryId id;
  friend bool operator==(const LinksFrom&, const LinksFrom&) = default;
};
}  // namespace where

/// What the snapshots of an entity must meet to be selected among.
struct Condition {
  using Kind = std::variant<where::Within, where::Near, where::InView, where::While,
                            where::LinkedTo, where::LinksFrom>;
  Kind kind;
  bool is_negated = false;  ///< The snapshots that do not meet it.

  friend bool operator==(const Condition&, const Condition&) = default;
};

/// The entity that a condition names beside the one that is asked; nothing if it needs to know of
/// no other one.
[[nodiscard]] std::optional<MemoryId> entity_of(const Condition& condition);

/// Checks the values of a condition.
/// Errors: kInvalidArgument if a distance is negative or not finite, if an ID names no entity, or
/// if an entity has a time.
[[nodiscard]] Status validate(const Condition& condition);

/// Reads conditions one after the other: `within ENTITY 0.3m`, `near 1,2,0.9 50cm`, `near 1,2,0.9
/// 50cm in FRAME`, `in-view ENTITY`, `seen-with ENTITY`, `in-vain ENTITY`, `while ENTITY`,
/// `linked-to ID`, `links-from ID`, each with `not` before it where it must not hold. A backslash
/// makes a space, a comma, a semicolon or a backslash part of a name.
/// Errors: kInvalidArgument naming the text and what was needed.
Result<std::vector<Condition>> parse_conditions(std::string_view text);

/// Where the first condition begins behind a selector; npos if there is none.
[[nodiscard]] size_t find_conditions(std::string_view text);

/// Whether a text that ends in `near` and its point lacks some of the two commas of the point, so
/// that a comma that follows is the point's.
[[nodiscard]] bool ends_in_a_point(std::string_view text);

/// A text that parse_conditions() reads back to the same condition.
[[nodiscard]] std::string to_string(const Condition& condition);

}  // namespace engram::ltm
