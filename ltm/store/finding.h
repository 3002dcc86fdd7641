// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace engram::ltm {

enum class Severity {
  kNote,   ///< Worth knowing; no data is damaged or lost.
  kFault,  ///< Data is damaged, lost, or cannot be told from lost data.
};

/// One thing that a look through a store found.
struct Finding {
  Severity severity = Severity::kNote;
  std::string file;    ///< Relative to the store, "segments/000001.h5".
  std::string object;  ///< What in it: an entity, a snapshot, a model. May be empty.
  std::string what;
  std::string advice;  ///< What to do about it.
};

}  // namespace engram::ltm
