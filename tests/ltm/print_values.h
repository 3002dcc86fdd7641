// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>

#include "ltm/idf/json.h"
#include "ltm/memory/snapshot.h"

// What GoogleTest prints where values differ.
namespace engram::idf {

inline void PrintTo(const Data& data, std::ostream* out) {
  const auto text = to_json_text(data);
  *out << (text.ok() ? *text : text.status().to_string()).substr(0, 2000);
}

}  // namespace engram::idf

namespace engram::ltm {

inline void PrintTo(const MemoryId& id, std::ostream* out) {
  *out << id.to_string();
}

inline void PrintTo(const Snapshot& snapshot, std::ostream* out) {
  *out << snapshot.id().to_string();
  for (const Instance& instance : snapshot.instances) {
    *out << "\n  of '" << instance.metadata.provider << "': ";
    PrintTo(instance.data, out);
  }
}

}  // namespace engram::ltm
