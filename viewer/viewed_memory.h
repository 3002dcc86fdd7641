// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/idf/type.h"
#include "ltm/recall/model.h"
#include "ltm/store/store_mark.h"
#include "ltm/store/store_reader.h"
#include "memory/memory.h"
#include "speech/language/asker.h"
#include "viewer/kept_numbers.h"
#include "viewer/long_questions.h"

namespace engram::viewer {

/// A state of a store as one request sees it.
struct StoreView {
  ltm::StoreReader& reader;
  uint64_t state = 0;  ///< Views of one state have the same number.
};

/// The memory that the viewer shows: a store that is read, or a server.
///
/// Questions go to a Memory, as those of any program do. What only a store can tell quickly, such
/// as times, sizes and forms, is read beside it: a reader is lent to one request at a time, and
/// opened anew when the store has changed. Threading: thread-safe. Source: docs/viewer.md.
class ViewedMemory {
 public:
  struct Options {
    std::string name;             ///< What people call it.
    std::filesystem::path store;  ///< Empty: a server is shown.
    /// Opens the memory; with `prefers_latents` it answers from latents where it can.
    std::function<Result<std::unique_ptr<Memory>>(bool prefers_latents)> open;
    /// Opens the models of the store, where a plan of forgetting has to see what latents show.
    ltm::ModelLoader loader = {};
    /// Opens what reads questions beside the grammar; empty, or a null reader: nothing does.
    std::function<Result<std::shared_ptr<speech::QuestionReader>>()> open_reader = {};
    /// How long a reader may show an earlier state of a store that grows. Opening one costs
    /// milliseconds, and a journal that is written changes with each commit.
    Duration max_age = std::chrono::milliseconds(200);
    /// Max bytes of times that are kept for the next requests.
    size_t max_times_bytes = size_t{256} << 20;
    /// Max bytes of the numbers of one entity that are kept, likewise; those of others go first.
    size_t max_numbers_bytes = size_t{128} << 20;
  };

  /// Errors: those of `options.open` and StoreReader::open.
  static Result<std::unique_ptr<ViewedMemory>> open(Options options);

  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] bool is_store() const { return !options_.store.empty(); }

  [[nodiscard]] Memory& memory() { return *memory_; }

  /// The same memory for predictions, which may take seconds, because they learn first. A memory of
  /// a store answers one question after the other, and looking at a moment must not wait for those.
  /// Opened when it is asked for.
  /// Errors: those of `options.open`.
  Result<Memory*> for_long_questions();

  /// The same memory, answering from latents where a snapshot has both forms.
  /// Errors: kFailedPrecondition for a server, which has its preference configured.
  Result<Memory*> latents();

  /// Calls `use` with what answers questions in words, and knows all that the memory knows now. One
  /// request uses it at a time.
  /// Errors: those of speech::Asker and of `use`.
  Status with_asker(const std::function<Status(speech::Asker&)>& use);

  [[nodiscard]] LongQuestions& long_questions() { return long_questions_; }

  /// Calls `read` with the store's present state; again with a new one if the store was changed
  /// under it, three times in all. So `read` begins from nothing each time.
  /// Errors: kFailedPrecondition for a server; those of StoreReader::open and of `read`.
  using Read = std::function<Status(const StoreView&)>;
  Status with_store(const Read& read);

  /// The times of an entity's snapshots in `view`. They are kept until the store changes.
  /// Errors: those of StoreReader::times.
  using SharedTimes = std::shared_ptr<const ltm::EntityTimes>;
  Result<SharedTimes> times(const StoreView& view, const ltm::MemoryId& entity);

  /// What is kept of the numbers of an entity in `view`, until the store changes.
  /// Errors: those of StoreReader::times.
  Result<std::shared_ptr<KeptNumbers>> numbers(const StoreView& view, const ltm::MemoryId& entity);

  /// The type of an entity's values; nothing if none is known.
  std::optional<idf::Type> type_of(const ltm::MemoryId& entity);

  /// All entities, sorted.
  /// Errors: those of StoreReader::open, or of the server.
  Result<std::vector<ltm::MemoryId>> entities();

 private:
  struct Lent {
    std::unique_ptr<ltm::StoreReader> reader;
    uint64_t state = 0;
    SteadyTime opened{};
  };

  explicit ViewedMemory(Options options) : options_(std::move(options)) {}

  /// A memory that is opened when it is asked for first.
  Result<Memory*> opened(std::unique_ptr<Memory>& memory, bool prefers_latents)
      ENGRAM_REQUIRES(mutex_);
  Result<Lent> lend(bool is_new);
  Result<Lent> open_reader();

  const Options options_;
  std::unique_ptr<Memory> memory_;
  LongQuestions long_questions_;
  Mutex asking_;
  std::unique_ptr<speech::Asker> asker_ ENGRAM_GUARDED_BY(asking_);
  Mutex mutex_;
  std::unique_ptr<Memory> latents_ ENGRAM_GUARDED_BY(mutex_);
  std::unique_ptr<Memory> for_long_questions_ ENGRAM_GUARDED_BY(mutex_);
  std::vector<Lent> idle_ ENGRAM_GUARDED_BY(mutex_);
  ltm::StoreMark mark_ ENGRAM_GUARDED_BY(mutex_);                         ///< Of the newest state.
  uint64_t state_ ENGRAM_GUARDED_BY(mutex_) = 0;                          ///< Its number.
  std::map<ltm::MemoryId, SharedTimes> times_ ENGRAM_GUARDED_BY(mutex_);  ///< Of the newest state.
  size_t times_bytes_ ENGRAM_GUARDED_BY(mutex_) = 0;
  std::map<ltm::MemoryId, std::shared_ptr<KeptNumbers>> numbers_
      ENGRAM_GUARDED_BY(mutex_);  ///< Of the newest state.
};

}  // namespace engram::viewer
