// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <stop_token>
#include <utility>
#include <vector>

#include "ltm/core/mutex.h"
#include "ltm/core/progress.h"
#include "ltm/likeness/coded_moments.h"
#include "ltm/likeness/similar_moments.h"
#include "ltm/recall/store_past.h"

namespace engram::ltm {

/// Finds the moments of an entity that are like one of its moments, or like an image. All of them
/// are compared, so none is missed. The codes of the entities that were searched last are kept, so
/// that the next question about them reads nothing.
///
/// Threading: one thread.
/// Source: docs/recall.md, section "When was it like this before?".
class LikenessSearch {
 public:
  /// Shows the past as it is now; `past` must outlive it.
  explicit LikenessSearch(StorePast& past) : past_(past) {}

  /// Errors: kInvalidArgument if the request does not validate, if the image is none or of another
  /// size; kNotFound if there is no such entity or moment; kFailedPrecondition if the entity has
  /// neither images nor numbers; kCancelled on `stop`; those of reading.
  /// Complexity: linear in the number of moments.
  Result<SimilarAnswer> find(const SimilarRequest& request, const ProgressSink& progress = {},
                             const std::stop_token& stop = {});

 private:
  Result<std::shared_ptr<const CodedMoments>> coded(const MemoryId& entity,
                                                    const ProgressSink& progress,
                                                    const std::stop_token& stop);
  Result<std::vector<double>> distances(const SimilarRequest& request, const CodedMoments& coded,
                                        SimilarAnswer& answer, const ProgressSink& progress,
                                        const std::stop_token& stop);

  StorePast& past_;
  std::map<MemoryId, std::shared_ptr<const CodedMoments>> kept_;
};

/// Answers what is like what in a store, as the store is at each question.
///
/// Threading: thread-safe; questions take turns.
class StoreLikeness {
 public:
  StoreLikeness(std::filesystem::path store, ModelLoader loader)
      : store_(std::move(store)), loader_(std::move(loader)) {}

  /// Errors: those of LikenessSearch::find and StoreReader::open.
  Result<SimilarAnswer> similar(const SimilarRequest& request);

 private:
  const std::filesystem::path store_;
  const ModelLoader loader_;
  Mutex mutex_;
  StoreMark mark_ ENGRAM_GUARDED_BY(mutex_);  ///< Of the store as `past_` shows it.
  std::unique_ptr<StorePast> past_ ENGRAM_GUARDED_BY(mutex_);
  std::unique_ptr<LikenessSearch> search_ ENGRAM_GUARDED_BY(mutex_);
};

}  // namespace engram::ltm
