// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ltm/core/mutex.h"
#include "memory/memory.h"
#include "python/bindings/bound_similar.h"
#include "python/bindings/watch.h"
#include "speech/language/asker.h"

namespace engram::python {

/// A memory that Python commits to and queries: one that this program opened, or that of a server.
/// It answers the same queries as OpenStore, through engram::Memory.
///
/// Errors: exceptions of engram.errors, with the message of the status.
/// Threading: any thread, also several at once; every wait releases the GIL.
class FrontDoor {
 public:
  /// Opens the store in a directory for reading and writing, and creates it if it does not exist.
  static std::unique_ptr<FrontDoor> open(const std::string& store, const OpenOptions& options);

  /// Connects to a server without waiting for it; an empty endpoint means that of this user.
  static std::unique_ptr<FrontDoor> connect(const std::string& endpoint,
                                            const ConnectOptions& options);

  /// Opens a store as the memory that it was at a moment.
  static std::unique_ptr<FrontDoor> replay(const std::string& store, const ReplayOptions& options);

  FrontDoor(const FrontDoor&) = delete;
  FrontDoor& operator=(const FrontDoor&) = delete;
  ~FrontDoor();

  /// Names of all entities, sorted, such as "Vision/RGB/head/cam".
  std::vector<std::string> entities();

  /// The number of "snapshots" of an entity, and the times "first" and "last" in ns.
  /// Complexity: O(snapshots).
  pybind11::dict summary(const std::string& entity);

  /// Times of the first and the last snapshot of an entity. Unit: ns.
  std::pair<int64_t, int64_t> span(const std::string& entity);

  /// Times (ns) of all snapshots after `after` (ns; None: from the beginning). `count` is ignored.
  std::vector<int64_t> times(const std::string& entity, std::optional<int64_t> after, size_t count);

  /// The times that selectors with conditions (docs/query.md) take of one entity. Unit: ns.
  std::vector<int64_t> selected_times(const std::string& entity, const std::string& selectors);

  /// The snapshots of one entity that selectors with conditions take, as a list of dicts.
  pybind11::list select(const std::string& entity, const std::string& selector);

  /// Answers a query in its text form: a list of (entity, snapshots).
  pybind11::list query(const std::string& text, const std::string& engine);

  /// See OpenStore::predict.
  pybind11::list predict(const std::string& entity, const std::vector<int64_t>& horizons,
                         std::optional<int64_t> from, const std::string& engine,
                         const std::string& plan);

  /// See OpenStore::engines.
  pybind11::list engines(const std::string& entity, int64_t ahead, std::optional<int64_t> at);

  /// The moments of an entity that are like another one.
  pybind11::dict similar(const SimilarArguments& asked);

  /// At most `max_moments` moments of an entity in two dimensions; see map_of.
  pybind11::dict map(const std::string& entity, size_t max_moments);

  /// Declares the type of a segment. `type` is the result of engram.idf.type_to_data.
  void declare(const std::string& segment, const pybind11::object& type);

  /// Opens a store for reading alone.
  static std::unique_ptr<FrontDoor> read(const std::string& store);

  /// Answers a question in English, or a program (docs/verbalisation.md), as JSON. `now` (ns) is
  /// when it is asked; None: the last moment of a store that is read, else that of the clock.
  std::string ask(const std::string& question, std::optional<int64_t> now, bool is_program);

  /// Tells a time in at most `sentences`: a JSON list of {"level", "text", "links"}.
  std::string tell(const std::string& since, const std::string& until, std::optional<int64_t> now,
                   size_t sentences);

  /// Commits updates, see commit_of(). `durability` is "default", "memory" or "journal".
  void commit(const pybind11::list& updates, const std::string& durability);

  /// Subscribes. Returns once every snapshot from now on is delivered.
  std::unique_ptr<Watch> watch(const SubscriptionOptions& options);

  /// Closes the memory and ends its watches. Only close() may be called afterwards.
  void close();

 private:
  /// `store`: empty for a server.
  FrontDoor(std::unique_ptr<Memory> memory, std::string store, bool is_past = false);

  template <typename F>
  auto with_memory(F work);

  /// Calls `work` with what the memory tells now, and when it is asked.
  template <typename F>
  Result<std::string> with_asker(Memory& memory, std::optional<int64_t> now, F work);

  /// Times of an entity's snapshots, without reading their data.
  Result<std::vector<int64_t>> times_of(Memory& memory, const std::string& entity,
                                        const std::vector<ltm::Selector>& selectors);

  /// Whether "now" is its last moment, because nothing is added to it.
  const std::string store_;
  const bool is_past_;
  Mutex speech_mutex_;
  /// Null until something is asked, and once it is closed. Refers to the memory.
  std::unique_ptr<speech::Asker> asker_ ENGRAM_GUARDED_BY(speech_mutex_);
  /// The process that opened it: threads and connections do not survive a fork.
  const int process_;
  Mutex mutex_;
  /// Null once it is closed. Shared with calls that are still running.
  std::shared_ptr<Memory> memory_ ENGRAM_GUARDED_BY(mutex_);
  std::vector<std::weak_ptr<Inbox>> watches_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::python
