// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/idf/type.h"
#include "ltm/memory/query.h"
#include "ltm/memory/select.h"
#include "ltm/prediction/engine_choice.h"
#include "ltm/recall/answer.h"

namespace engram::ltm {

/// Which form answers where a snapshot has both.
enum class Prefer { kRecorded, kLatent };

/// The past of one entity: its moments, and what it was at each of them.
///
/// Errors: kUnavailable where the store has changed so much meanwhile that this cannot be read any
/// more: KnownPast::renew(), and ask again.
/// Threading: one thread.
class EntityPast : public Moments {
 public:
  /// Number of moments. Complexity: that of Timeline::count.
  virtual Result<uint64_t> count() = 0;

  /// What it was at a moment, which must be one of these.
  /// Errors: kDataLoss where it is damaged; kFailedPrecondition where a latent needs a model that
  /// cannot be loaded.
  virtual Result<RecalledSnapshot> read(Time moment, Prefer prefer) = 0;

  /// The same without data, from the form that read() would take. Decodes nothing.
  virtual Result<RecalledSnapshot> name(Time moment, Prefer prefer) = 0;
};

/// What is known of the past, wherever it is kept: the one thing that answers and predictions are
/// made from.
///
/// Two implementations: StorePast, a store alone, and JoinedPast, a store and the working memory
/// above it. Threading: one thread.
class KnownPast {
 public:
  virtual ~KnownPast() = default;

  /// "store 'kitchen.engram'": what messages call it.
  [[nodiscard]] virtual std::string name() const = 0;

  /// The entities that a query asks for and that have a past, in the order of their IDs.
  /// Complexity: O(log n) for each entity that the query names; else it looks at all.
  [[nodiscard]] virtual std::vector<MemoryId> matching(const Query& query) = 0;

  /// The past of an entity as it is now; null where it has none. It can be used for as long as this
  /// lives, but shows nothing that comes after this call.
  virtual Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) = 0;

  /// What was declared for the entity's segment.
  [[nodiscard]] virtual std::optional<idf::Type> type_of(const MemoryId& entity) const = 0;

  /// The predictors of the entity's newest model: its own, if it has one, and a copy of the last
  /// value that knows how wrong it was, if it has that. Empty where there is no model, or nothing
  /// that could load it. They live as long as this.
  /// Errors: those of the loader.
  virtual Result<std::vector<Engine>> models(const MemoryId& entity) = 0;

  /// Looks at the store anew.
  virtual Status renew() = 0;

  /// The same where something changed that this is to follow, and would not learn of otherwise. To
  /// be called before a question; costs microseconds where nothing did.
  virtual Status follow() = 0;
};

}  // namespace engram::ltm
