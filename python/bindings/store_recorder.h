// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "ltm/core/mutex.h"
#include "ltm/recording/recorder.h"

namespace engram::python {

/// A store that Python records into. What is encoded and written runs without the GIL.
///
/// Errors: exceptions of engram.errors.
/// Threading: any thread; one call after the other.
class StoreRecorder {
 public:
  /// `config`: a file; `preset`: a name; both may be empty, and one at most is given.
  StoreRecorder(const std::string& store, const std::string& config, const std::string& preset);

  /// What commit_of() takes; all of them in one commit.
  void commit(const pybind11::list& updates);

  /// Per entity: what came in and what became of it.
  pybind11::dict counts();

  /// Seals all. Nothing may follow but this and counts().
  void close();

 private:
  template <typename Work>
  auto with_recorder(Work work);

  Mutex mutex_;
  std::optional<ltm::Recorder> recorder_ ENGRAM_GUARDED_BY(mutex_);  ///< Empty once it is closed.
  std::map<ltm::MemoryId, ltm::RecordingCounters> counters_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::python
