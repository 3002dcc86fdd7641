// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

#include "ltm/core/mutex.h"
#include "ltm/recording/recorder.h"

namespace engram::python {

/// A store that Python records into. Encoding and writing run without the GIL.
///
/// Errors: exceptions of engram.errors.
/// Threading: any thread; calls run one after the other.
class StoreRecorder {
 public:
  /// `config` is a file, `preset` a name. Both may be empty; at most one may be given.
  StoreRecorder(const std::string& store, const std::string& config, const std::string& preset);

  /// Records updates as one commit, see commit_of().
  void commit(const pybind11::list& updates);

  /// Per entity: the number of snapshots received, and what became of them.
  pybind11::dict counts();

  /// Seals everything. Only close() and counts() may be called afterwards.
  void close();

 private:
  template <typename Work>
  auto with_recorder(Work work);

  Mutex mutex_;
  std::optional<ltm::Recorder> recorder_ ENGRAM_GUARDED_BY(mutex_);  ///< Empty once it is closed.
  std::map<ltm::MemoryId, ltm::RecordingCounters> counters_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::python
