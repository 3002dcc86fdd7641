// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/snapshot.h"

#include "ltm/idf/binary.h"

namespace engram::ltm {

size_t Snapshot::raw_bytes() const {
  size_t total = 0;
  for (const Instance& instance : instances) total += idf::encoded_size(instance.data);
  return total;
}

}  // namespace engram::ltm
