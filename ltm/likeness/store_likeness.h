// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <stop_token>
#include <utility>

#include "ltm/core/mutex.h"
#include "ltm/likeness/similar.h"

namespace engram::ltm {

/// Answers what is like what in a store and in the working memory above it, as they are at each
/// question. It opens the store with the first question.
///
/// Threading: thread-safe; questions take turns.
class StoreLikeness {
 public:
  /// What `memory` holds is compared, too; null: there is none. It must outlive this.
  StoreLikeness(std::filesystem::path store, ModelLoader loader,
                const WorkingMemory* memory = nullptr)
      : path_(std::move(store)), loader_(std::move(loader)), memory_(memory) {}

  /// `view` is what may be seen by who asks; null: everything.
  /// Errors: those of LikenessSearch::find and StoreReader::open.
  Result<SimilarAnswer> similar(const SimilarRequest& request, const View* view = nullptr,
                                const std::stop_token& stop = {});

  /// At most `max_moments` moments of an entity in two dimensions.
  /// Errors: those of LikenessSearch::map and StoreReader::open.
  Result<MomentMap> map(const MemoryId& entity, size_t max_moments,
                        const std::stop_token& stop = {});

  /// Drops all that is kept for the next questions: some of it was forgotten. The question that is
  /// being answered begins anew.
  void forget_codes() ENGRAM_EXCLUDES(mutex_, stopping_);

 private:
  /// Asks the search with a token that is stopped by the caller, and where some was forgotten
  /// meanwhile; then it asks anew. `about` is what errors name.
  template <typename Ask>
  auto ask(const MemoryId& about, const std::stop_token& stop, const Ask& question)
      -> decltype(question(std::declval<LikenessSearch&>(), stop));
  template <typename Ask>
  auto ask_once(const MemoryId& about, const std::stop_token& stop, const Ask& question)
      -> decltype(question(std::declval<LikenessSearch&>(), stop));

  const std::filesystem::path path_;
  const ModelLoader loader_;
  const WorkingMemory* const memory_;
  Mutex stopping_;
  std::stop_source forgotten_
      ENGRAM_GUARDED_BY(stopping_);  ///< Renewed whenever some is forgotten.
  Mutex mutex_;
  std::unique_ptr<StorePast> past_ ENGRAM_GUARDED_BY(mutex_);
  std::unique_ptr<LikenessSearch> search_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::ltm
