// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <stop_token>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/likeness/moment_coder.h"
#include "ltm/likeness/moment_map.h"
#include "ltm/likeness/similar_moments.h"
#include "ltm/memory/sight.h"

namespace engram::ltm {

/// Finds the moments of an entity that are like one of its moments, or like an image. All of them
/// are compared, so none is missed. The codes of the entities that were searched last are kept for
/// the next questions.
///
/// Threading: one thread; the working memory may be used at the same time.
/// Source: docs/recall.md, section "When was it like this before?".
class LikenessSearch {
 public:
  /// Both must outlive it. The past is shown as it is now, or, if it follows changes, as it is at
  /// each question. What `memory` holds is compared, too; null: there is none.
  explicit LikenessSearch(StorePast& past, const WorkingMemory* memory = nullptr)
      : past_(past), memory_(memory) {}

  /// `view` is what may be seen by who asks; null: everything. The answer is as if there were
  /// nothing else: no other moment is compared, and the distance of two moments at random is that
  /// of those that are seen. Images that may be seen redacted only are not compared, because their
  /// codes tell of what is hidden.
  /// Errors: kInvalidArgument if the request does not validate, if the image is none or of another
  /// size; kNotFound if there is no such entity or moment; kFailedPrecondition if the entity has
  /// neither images nor numbers, or if its images may be seen redacted only; kCancelled on `stop`;
  /// those of reading.
  /// Complexity: linear in the number of moments.
  Result<SimilarAnswer> find(const SimilarRequest& request, const ProgressSink& progress = {},
                             const std::stop_token& stop = {}, const View* view = nullptr);

  /// At most `max_moments` moments of an entity in two dimensions.
  /// Errors: kInvalidArgument if `max_moments` is 0; those of find() about entities.
  /// Complexity: linear in the number of moments.
  Result<MomentMap> map(const MemoryId& entity, size_t max_moments,
                        const std::stop_token& stop = {});

  /// Drops what is kept for the next questions.
  void forget_codes() { coders_.clear(); }

 private:
  class Question;

  MomentCoder& coder_of(const MemoryId& entity);

  StorePast& past_;
  const WorkingMemory* const memory_;
  std::map<MemoryId, MomentCoder> coders_;
};

}  // namespace engram::ltm
