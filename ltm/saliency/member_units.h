// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what a change is measured in.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "ltm/saliency/moment_content.h"

namespace engram::ltm {

/// The unit of each member of a kind of entities: a change of one unit is a large one.
///
/// A unit is the standard deviation of a member over all moments of all entities of a provider
/// segment, and four times its median step from one snapshot to the next. So an object that never
/// moved is measured by those that did, and noise does not look like a change.
/// Threading: const-parallel.
class MemberUnits {
 public:
  /// Gathers from pairs of consecutive snapshots, which may be of several entities.
  void add(const std::vector<ContentMember>& members, const std::vector<double>& before,
           const std::vector<double>& after);

  /// The unit of a member, the root of the mean square over its elements. A member that never
  /// changed has a unit so small that any change is a large one.
  [[nodiscard]] double of(const std::string& path) const;

  /// Calculates units from what was gathered. Call it once, after add().
  void finish();

 private:
  struct Sums {
    double count = 0;
    std::vector<double> mean, square;  ///< Of each element.
    std::vector<double> steps;         ///< Root mean square over the elements, of each pair.
    double unit = 0;
  };
  std::map<std::string, Sums> members_;
};

}  // namespace engram::ltm
