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
#include "python/bindings/watch.h"

namespace engram::python {

/// A memory that Python commits to and asks: one that this program opened, or one of a server. It
/// has the questions of OpenStore, answered through engram::Memory.
///
/// Errors: exceptions of engram.errors, with the message of the status.
/// Threading: any thread, and several at once; everything that waits does so without the GIL.
class FrontDoor {
 public:
  /// Opens the store in a directory for reading and writing, and makes it where there is none.
  static std::unique_ptr<FrontDoor> open(const std::string& store, const OpenOptions& options);

  /// Reaches a server; empty: that of this user. Does not wait for it.
  static std::unique_ptr<FrontDoor> connect(const std::string& endpoint,
                                            const ConnectOptions& options);

  FrontDoor(const FrontDoor&) = delete;
  FrontDoor& operator=(const FrontDoor&) = delete;
  ~FrontDoor();

  /// Names, in their order: "Vision/RGB/head/cam".
  std::vector<std::string> entities();

  /// "snapshots", and "first" and "last" in ns, of an entity. Complexity: O(snapshots).
  pybind11::dict summary(const std::string& entity);

  /// Times of the first and of the last snapshot of an entity. Unit: ns.
  std::pair<int64_t, int64_t> span(const std::string& entity);

  /// Times of all snapshots behind `after` (ns, None: from the beginning), however many `count` is.
  std::vector<int64_t> times(const std::string& entity, std::optional<int64_t> after, size_t count);

  /// What a selector (docs/query.md) takes of one entity: a list of snapshots, as dicts.
  pybind11::list select(const std::string& entity, const std::string& selector);

  /// The whole text form: a list of (entity, snapshots).
  pybind11::list query(const std::string& text, const std::string& engine);

  /// What is expected so long (ns) after the last snapshot. Snapshots, as dicts.
  pybind11::list predict(const std::string& entity, const std::vector<int64_t>& horizons,
                         const std::string& engine);

  /// What OpenStore::engines gives.
  pybind11::list engines(const std::string& entity, int64_t ahead);

  /// `type`: what engram.idf.type_to_data gives.
  void declare(const std::string& segment, const pybind11::object& type);

  /// What commit_of() takes. `durability`: "default", "memory" or "journal".
  void commit(const pybind11::list& updates, const std::string& durability);

  /// Returns when everything from now on is told.
  std::unique_ptr<Watch> watch(const SubscriptionOptions& options);

  /// Ends watches, too. Nothing may follow but this.
  void close();

 private:
  explicit FrontDoor(std::unique_ptr<Memory> memory);

  template <typename F>
  auto with_memory(F work);

  /// Of an entity, without data.
  Result<std::vector<int64_t>> times_of(Memory& memory, const std::string& entity,
                                        const std::vector<ltm::Selector>& selectors);

  const int process_;  ///< That opened it: its threads and connections do not survive a fork.
  Mutex mutex_;
  /// Null once it is closed; shared with calls that go on.
  std::shared_ptr<Memory> memory_ ENGRAM_GUARDED_BY(mutex_);
  std::vector<std::weak_ptr<Inbox>> watches_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::python
