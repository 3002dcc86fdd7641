// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/recall/recall.h"
#include "python/bindings/inspected_model.h"

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

  /// Times of the first and of the last snapshot of an entity. Unit: ns.
  std::pair<int64_t, int64_t> span(const std::string& entity);

  /// Times of the first snapshots behind `after` (ns, None: from the beginning), `count` at most.
  std::vector<int64_t> times(const std::string& entity, std::optional<int64_t> after, size_t count);

  /// What a selector (docs/query.md) takes of one entity: a list of snapshots, as dicts.
  pybind11::list select(const std::string& entity, const std::string& selector,
                        bool prefers_latents);

  /// The whole text form: a list of (entity, snapshots). `engine`: of predictions; empty: the best.
  pybind11::list query(const std::string& text, bool prefers_latents, const std::string& engine);

  /// What is expected so long (ns) after the last snapshot up to `from` (None: the newest), by the
  /// engine of that name; empty: by the best. Snapshots, as dicts.
  pybind11::list predict(const std::string& entity, const std::vector<int64_t>& horizons,
                         std::optional<int64_t> from, const std::string& engine,
                         bool prefers_latents);

  /// {"name", "model", "predictions", "error", "bound"} of each way to predict, the best one first.
  pybind11::list engines(const std::string& entity, int64_t ahead, std::optional<int64_t> from,
                         bool prefers_latents);

  /// {"entity", "version", "file", "bytes"} of each model, older ones first.
  pybind11::list models();

  /// Of each snapshot that is kept as latents, columns by name: "time" int64, "model" int64, "form"
  /// list of str, "bytes", "psnr_db" and "rmse" float64, NaN where there is none.
  pybind11::dict stored_snapshots(const std::string& entity);

  /// What InspectedModel::encode gives, of what is stored of that model from `first` to `last`
  /// (ns), with "times". One instance a snapshot: the first.
  pybind11::dict latents(const std::string& entity, int version, int64_t first, int64_t last,
                         InspectedModel& model);

  /// Sees what came since it was opened.
  void refresh();

  /// Nothing may follow but this.
  void close();

 private:
  template <typename F>
  auto with_recall(F work);

  std::filesystem::path path_;
  int process_ = 0;  ///< That opened it: locks and threads of a store do not survive a fork.
  Mutex mutex_;
  std::unique_ptr<ltm::Recall> recall_ ENGRAM_GUARDED_BY(mutex_);  ///< Null once it is closed.
};

}  // namespace engram::python
