// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace engram::ltm {

enum class Severity {
  kNote,   ///< Worth knowing; no data is damaged or lost.
  kFault,  ///< Data is damaged or lost, or the program cannot rule out that it was lost.
};

/// One result of checking or recovering a store.
struct Finding {
  Severity severity = Severity::kNote;
  std::string file;    ///< Relative to the store, "segments/000001.h5".
  std::string object;  ///< The entity, snapshot or model in the file. May be empty.
  std::string what;
  std::string advice;  ///< What to do about it.
};

}  // namespace engram::ltm
