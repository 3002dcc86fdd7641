// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "ltm/recall/recall.h"

namespace engram::python {

/// A store that Python reads. Everything that reads or decodes runs without the GIL.
///
/// Errors: exceptions of engram.errors, with the message of the status.
/// Threading: any thread; one call after the other.
class OpenStore {
 public:
  explicit OpenStore(const std::filesystem::path& path);

  /// Names, in their order: "Vision/RGB/head/cam".
  std::vector<std::string> entities();

  /// What the store says of an entity: counts, bytes, times in ns, models.
  pybind11::dict summary(const std::string& entity);

  /// Times of the first snapshots behind `after` (ns, None: from the beginning), `count` at most.
  std::vector<int64_t> times(const std::string& entity, std::optional<int64_t> after, size_t count);

  /// What a selector (docs/query.md) takes of one entity: a list of snapshots, as dicts.
  pybind11::list select(const std::string& entity, const std::string& selector,
                        bool prefers_latents);

  /// The whole text form: a list of (entity, snapshots).
  pybind11::list query(const std::string& text, bool prefers_latents);

  /// Nothing may follow but this.
  void close();

 private:
  template <typename F>
  auto with_recall(F work);

  std::mutex mutex_;
  std::unique_ptr<ltm::Recall> recall_;  ///< Null once it is closed.
};

}  // namespace engram::python
