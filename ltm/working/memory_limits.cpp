// SPDX-License-Identifier: Apache-2.0
#include "ltm/working/memory_limits.h"

namespace engram::ltm {

Status MemoryLimits::validate() const {
  if (snapshots && *snapshots == 0)
    return invalid_argument("limits: found 0 snapshots, needs more");
  if (bytes && *bytes == 0) return invalid_argument("limits: found 0 bytes, needs more");
  if (age && *age <= Duration(0))
    return invalid_argument("limits: found an age of {}, needs more", to_string(*age));
  return {};
}

}  // namespace engram::ltm
