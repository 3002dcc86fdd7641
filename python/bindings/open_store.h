// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/likeness/similar.h"
#include "ltm/recall/recall.h"
#include "python/bindings/bound_similar.h"
#include "python/bindings/inspected_model.h"

namespace engram::python {

/// A store that Python reads. Reading and decoding run without the GIL.
///
/// Errors: exceptions of engram.errors, with the message of the status.
/// Threading: any thread; calls run one after the other.
class OpenStore {
 public:
  explicit OpenStore(const std::filesystem::path& path);

  /// Names of all entities, sorted, such as "Vision/RGB/head/cam".
  std::vector<std::string> entities();

  /// The store's figures of an entity: counts, bytes, times in ns, models.
  pybind11::dict summary(const std::string& entity);

  /// Times of the first and the last snapshot of an entity. Unit: ns.
  std::pair<int64_t, int64_t> span(const std::string& entity);

  /// Times (ns) of the first `count` snapshots after `after` (ns; None: from the beginning).
  std::vector<int64_t> times(const std::string& entity, std::optional<int64_t> after, size_t count);

  /// The times that selectors with conditions (docs/query.md) take of one entity. Unit: ns.
  std::vector<int64_t> selected_times(const std::string& entity, const std::string& selectors);

  /// The snapshots of one entity that selectors with conditions take, as a list of dicts.
  pybind11::list select(const std::string& entity, const std::string& selector,
                        bool prefers_latents);

  /// Answers a query in its text form: a list of (entity, snapshots). `engine` names the engine of
  /// predictions; empty: the best one.
  pybind11::list query(const std::string& text, bool prefers_latents, const std::string& engine);

  /// Predictions at these horizons (ns) after the last snapshot up to `from` (None: the newest), by
  /// the named engine; empty: the best one. `plan` is an entity of planned values; empty: none. A
  /// list of snapshots, as dicts.
  pybind11::list predict(const std::string& entity, const std::vector<int64_t>& horizons,
                         std::optional<int64_t> from, const std::string& engine,
                         const std::string& plan, bool prefers_latents);

  /// The engines of an entity at the horizon `ahead` (ns), best first: dicts with "name", "model",
  /// "predictions", "error", "bound".
  pybind11::list engines(const std::string& entity, int64_t ahead, std::optional<int64_t> from,
                         bool prefers_latents);

  /// The moments of an entity that are like another one.
  pybind11::dict similar(const SimilarArguments& asked);

  /// At most `max_moments` moments of an entity in two dimensions; see map_of.
  pybind11::dict map(const std::string& entity, size_t max_moments);

  /// Why the snapshot of an entity at `moment` (ns; None: its last one) is salient: a dict with
  /// "time", "saliency", "rank", "count", "is_stored", "learned_from" and "parts", dicts with
  /// "part", "value", "weight", "contribution", "found" and "expected".
  pybind11::dict why_salient(const std::string& entity, std::optional<int64_t> moment);

  /// The models, older ones first: dicts with "entity", "version", "file", "bytes".
  pybind11::list models();

  /// The snapshots that are stored as latents, as columns: "time" and "model" int64, "form" a list
  /// of str, "bytes", "psnr_db" and "rmse" float64, NaN if unknown.
  pybind11::dict stored_snapshots(const std::string& entity);

  /// The stored latents of a model version from `first` to `last` (ns), in the form of
  /// InspectedModel::encode, with "times". Only the first instance of each snapshot is included.
  pybind11::dict latents(const std::string& entity, int version, int64_t first, int64_t last,
                         InspectedModel& model);

  /// Makes snapshots visible that were recorded after the store was opened.
  void refresh();

  /// Closes the store. Only close() may be called afterwards.
  void close();

 private:
  template <typename F>
  auto with_recall(F work);
  Status open_likeness() ENGRAM_REQUIRES(mutex_);

  std::filesystem::path path_;
  /// The process that opened it: locks and threads of a store do not survive a fork.
  int process_ = 0;
  Mutex mutex_;
  std::unique_ptr<ltm::Recall> recall_ ENGRAM_GUARDED_BY(mutex_);  ///< Null once it is closed.
  /// Opened with the first question about likeness, and kept for the next ones.
  std::unique_ptr<ltm::StorePast> past_ ENGRAM_GUARDED_BY(mutex_);
  std::unique_ptr<ltm::LikenessSearch> likeness_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::python
