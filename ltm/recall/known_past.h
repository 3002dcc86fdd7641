// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/context/entity_context.h"
#include "ltm/idf/type.h"
#include "ltm/memory/query.h"
#include "ltm/memory/select.h"
#include "ltm/prediction/engine_choice.h"
#include "ltm/recall/answer.h"

namespace engram::ltm {

using SharedContext = std::shared_ptr<const EntityContext>;

/// Which form is read if a snapshot has both.
enum class Prefer { kRecorded, kLatent };

/// The past of one entity: its moments, and its snapshot at each of them.
///
/// Errors: kUnavailable if the store has changed so that this generation can no longer be read;
/// call KnownPast::renew() and ask again.
/// Threading: one thread.
class EntityPast : public Moments {
 public:
  /// Number of moments. Complexity: that of Timeline::count.
  virtual Result<uint64_t> count() = 0;

  /// Reads the snapshot at `moment`, which must be one of the entity's moments.
  /// Errors: kDataLoss if it is damaged; kFailedPrecondition if a latent needs a model that cannot
  /// be loaded.
  virtual Result<RecalledSnapshot> read(Time moment, Prefer prefer) = 0;

  /// Returns the same snapshot without data, from the form that read() would use. Decodes nothing.
  virtual Result<RecalledSnapshot> name(Time moment, Prefer prefer) = 0;

  /// Where its snapshots were, what they link to and when what they tell of went on. `type` is that
  /// of its values. A snapshot that cannot be read has no places and links.
  /// Errors: those of Moments.
  /// Complexity: O(n); unless overridden, all snapshots are read.
  virtual Result<SharedContext> context(const std::optional<idf::Type>& type);
};

/// The past, wherever it is kept. All answers and predictions are made from it.
///
/// It has two implementations: StorePast reads a store alone, JoinedPast reads a store and the
/// working memory above it.
/// Threading: one thread.
class KnownPast {
 public:
  virtual ~KnownPast() = default;

  /// Its name in messages, such as "store 'kitchen.engram'".
  [[nodiscard]] virtual std::string name() const = 0;

  /// The entities that match a query and have a past, sorted by their IDs.
  /// Complexity: O(log n) for each entity that the query names; O(n) if it names none.
  [[nodiscard]] virtual std::vector<MemoryId> matching(const Query& query) = 0;

  /// The past of an entity as it is now; null if it has none. It can be used for as long as this
  /// object lives, but shows nothing that comes after this call.
  virtual Result<std::unique_ptr<EntityPast>> of(const MemoryId& entity) = 0;

  /// The type that was declared for the entity's segment.
  [[nodiscard]] virtual std::optional<idf::Type> type_of(const MemoryId& entity) const = 0;

  /// The predictors of the entity's newest model: its own, if it has one, and a copy-last predictor
  /// with measured errors, if it has one. Empty if there is no model or no loader. They live as
  /// long as this object, or until start_anew().
  /// Errors: those of the loader.
  virtual Result<std::vector<Engine>> models(const MemoryId& entity) = 0;

  /// Whether what is decoded from now on is kept for who asks next. A large answer would push out
  /// everything else.
  virtual void keep_decoded(bool keeps) = 0;

  /// Opens the newest state of the store.
  virtual Status renew() = 0;

  /// Drops everything that was read of the store: decoded snapshots, and models with what belongs
  /// to them. Then calls renew().
  virtual Status start_anew() = 0;

  /// Calls renew() if the store changed in a way that this object follows but is not told of. Call
  /// it before each question; it takes microseconds if nothing changed.
  virtual Status follow() = 0;

  /// Changes if something that was known is not known any more, although nobody forgot it: the past
  /// of a replay that jumped back. Whatever was learned before must be dropped then.
  [[nodiscard]] virtual uint64_t era() const { return 0; }
};

}  // namespace engram::ltm
