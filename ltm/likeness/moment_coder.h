// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/likeness/coded_moments.h"
#include "ltm/likeness/compared_past.h"
#include "ltm/likeness/stored_codes.h"

namespace engram::ltm {

/// The codes of an entity, and what it took to have them.
struct CodedAnswer {
  std::shared_ptr<const CodedMoments> moments;  ///< May change with the next question.
  uint64_t computed = 0;  ///< Images that were decoded for it, because no code of them was there.
};

/// The codes of all moments of one entity, for one question after the other.
///
/// Codes of images come from the indexes of segments, and are computed where they are not stored:
/// for journals, for working memory and for what no night has coded. What was computed is kept for
/// the next question; so is a space that had to be learned, until the entity has twice as many
/// snapshots. Numbers are read: that takes no longer than reading codes of them would. Of more than
/// 100,000 sealed moments with numbers an even part is taken.
///
/// What is in segments is gathered once for each generation of the store. A question later on costs
/// what came since then, and a copy of the codes if some of that lies between older moments.
/// Threading: one thread.
class MomentCoder {
 public:
  explicit MomentCoder(MemoryId entity) : entity_(std::move(entity)) {}

  /// Errors: kNotFound if there is no such entity; kFailedPrecondition if it has neither images nor
  /// numbers, or too few; kCancelled on `stop`, and what was computed until then is kept; those of
  /// reading.
  Result<CodedAnswer> code(ComparedPast& past, const ProgressSink& progress,
                           const std::stop_token& stop);

 private:
  /// A code; empty if the moment has none.
  using Row = std::vector<float>;

  struct HeldRow {
    std::weak_ptr<const HeldSnapshot> of;
    Row row;
  };

  class Run;

  const MemoryId entity_;
  std::optional<LikenessSpace> space_;
  bool is_stored_space_ = false;
  CodedBy coded_by_ = CodedBy::kImages;
  size_t numbers_ = 0;         ///< K of a row.
  std::vector<double> first_;  ///< Taken off numbers, so that floats tell small steps apart. [K]

  /// What is in segments; of numbers before their changes and as they are. Of images newer moments
  /// may stand behind them, for the question at hand.
  std::shared_ptr<CodedMoments> sealed_;
  std::vector<uint64_t> sealed_from_;   ///< Where each sealed moment is stored.
  std::optional<uint64_t> generation_;  ///< Of the store that `sealed_` is whole for.
  std::map<std::pair<uint64_t, uint64_t>, Row> unsealed_;  ///< By journal and offset.
  std::map<Time, HeldRow> held_;
};

}  // namespace engram::ltm
