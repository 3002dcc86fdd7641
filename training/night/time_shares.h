// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

// Private to this room.

namespace engram::training {

/// The time that an entity needs. Unit: s.
struct TimeNeed {
  double encoding = 0;  ///< Time for all work after training, with a margin.
  double weight = 0;    ///< Weight of its training; 0 if it does not train.
};

/// The time that an entity gets. Unit: s.
struct TimeShare {
  double training = 0;
  double encoding = 0;
  /// Whether there is too little time to encode all entities. Then nothing is left for training,
  /// and `encoding` may be less than what is needed.
  bool is_short = false;

  [[nodiscard]] double total() const { return training + encoding; }
};

/// Divides `left` seconds among entities, and returns the share of the first one, which is worked
/// on next. The caller asks again before each entity, so that the others share what one saves or
/// loses.
///
/// If there is time to encode all of them, each gets what it needs for that, and a share of the
/// rest by its weight. Otherwise each gets an even part of the time, but none more than it needs.
/// In the order of their needs those that need little are then done whole, and no entity gets
/// nothing. An entity that is not done whole goes on in the next night, in which the others need no
/// time. `rest` must not be empty (checked).
[[nodiscard]] TimeShare first_share(std::span<const TimeNeed> rest, double left);

}  // namespace engram::training
