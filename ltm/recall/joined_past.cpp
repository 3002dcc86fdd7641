// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/joined_past.h"

#include <algorithm>
#include <utility>

#include "ltm/recall/past_context.h"

namespace engram::ltm {

namespace {

std::optional<Time> earlier(std::optional<Time> a, std::optional<Time> b) {
  return a && b ? std::min(*a, *b) : (a ? a : b);
}

std::optional<Time> later(std::optional<Time> a, std::optional<Time> b) {
  return a && b ? std::max(*a, *b) : (a ? a : b);
}

constexpr auto kTime = [](const SharedSnapshot& snapshot) { return snapshot->time; };

/// Asks the store only if it could change the answer. Most questions are about the newest moments,
/// which are held, and the store may have to be opened again before it can answer.
///
/// The newest moment is known from the beginning. The others, which may be hundreds of thousands,
/// are asked for when a question is about one of them, and in any case before the store is opened.
///
/// It ends where it ended when it was made. The store may be opened later and have more by then,
/// and the answer to one question must not be made of several pasts.
class JoinedEntityPast final : public EntityPast {
 public:
  explicit JoinedEntityPast(JoinedParts parts)
      : newest_(std::move(parts.newest)),
        until_(parts.until()),
        end_(later(newest_ ? std::optional(newest_->time) : std::nullopt, until_)),
        parts_(std::move(parts)) {}

  Result<std::optional<Time>> first() override {
    fill();
    const auto here = held_.empty() ? std::nullopt : std::optional(held_.front()->time);
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    if (stored == nullptr) return here;
    ENGRAM_ASSIGN_OR_RETURN(const auto there, stored->first());
    return earlier(here, known(there));
  }

  Result<std::optional<Time>> last() override {
    const auto here = newest_ ? std::optional(newest_->time) : std::nullopt;
    if (is_latest(here)) return here;
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    if (stored == nullptr) return here;
    ENGRAM_ASSIGN_OR_RETURN(const auto there, stored->at_or_before(*end_));
    return later(here, there);
  }

  Result<std::optional<Time>> at_or_after(Time time) override {
    std::optional<Time> here;
    if (newest_ && newest_->time == time) here = time;
    if (newest_ && newest_->time > time) {
      fill();
      here = (*std::ranges::lower_bound(held_, time, {}, kTime))->time;
    }
    if (here == time || !until_ || *until_ < time) return here;
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    if (stored == nullptr) return here;
    ENGRAM_ASSIGN_OR_RETURN(const auto there, stored->at_or_after(time));
    return earlier(here, known(there));
  }

  Result<std::optional<Time>> at_or_before(Time time) override {
    std::optional<Time> here;
    if (newest_ && newest_->time <= time) here = newest_->time;
    if (newest_ && newest_->time > time) {
      fill();
      const auto behind = std::ranges::upper_bound(held_, time, {}, kTime);
      if (behind != held_.begin()) here = (*std::prev(behind))->time;
    }
    if (here == time || is_latest(here)) return here;
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    if (stored == nullptr) return here;
    ENGRAM_ASSIGN_OR_RETURN(const auto there, stored->at_or_before(std::min(time, *end_)));
    return later(here, there);
  }

  /// Complexity: O(held * log stored) if the two overlap.
  Result<std::optional<Time>> nth(uint64_t index) override {
    fill();
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    if (stored == nullptr)
      return index < held_.size() ? std::optional(held_[index]->time) : std::nullopt;
    ENGRAM_RETURN_IF_ERROR(find_unstored(*stored));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t count, stored->count());
    // Binary search for the number of unstored moments that lie before the answer.
    const auto& unstored = *unstored_;
    size_t low = 0;
    size_t high = std::min<uint64_t>(unstored.size(), index);
    while (low < high) {
      const size_t middle = low + (high - low) / 2;
      // unstored[middle] lies before the answer if fewer than index - middle stored moments do.
      const uint64_t rank = index - middle - 1;
      ENGRAM_ASSIGN_OR_RETURN(const auto there, stored->nth(rank));
      if (rank >= count || !there || unstored[middle] < *there)
        low = middle + 1;
      else
        high = middle;
    }
    ENGRAM_ASSIGN_OR_RETURN(const auto there, stored->nth(index - low));
    const auto here = low < unstored.size() ? std::optional(unstored[low]) : std::nullopt;
    return earlier(here, known(there));
  }

  Result<uint64_t> count() override {
    fill();
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    if (stored == nullptr) return uint64_t{held_.size()};
    ENGRAM_RETURN_IF_ERROR(find_unstored(*stored));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t count, known_of(*stored));
    return count + unstored_->size();
  }

  Result<RecalledSnapshot> read(Time moment, Prefer prefer) override {
    if (SharedSnapshot held = find(moment)) return recalled(std::move(held), {}, false);
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    ENGRAM_CHECK(stored != nullptr, "{} is no moment of this entity", to_string(moment));
    return stored->read(moment, prefer);
  }

  Result<RecalledSnapshot> name(Time moment, Prefer prefer) override {
    if (SharedSnapshot held = find(moment)) return recalled(std::move(held), {}, true);
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    ENGRAM_CHECK(stored != nullptr, "{} is no moment of this entity", to_string(moment));
    return stored->name(moment, prefer);
  }

  Result<SharedContext> context(const std::optional<idf::Type>& type) override {
    fill();
    EntityContext held = context_of_held(held_, type);
    ENGRAM_ASSIGN_OR_RETURN(EntityPast * stored, this->stored());
    if (stored == nullptr) return std::make_shared<const EntityContext>(std::move(held));
    ENGRAM_ASSIGN_OR_RETURN(SharedContext older, stored->context(type));
    return join_contexts(std::move(older), std::move(held));
  }

 private:
  /// True if no stored moment comes after `here`.
  [[nodiscard]] bool is_latest(std::optional<Time> here) const {
    return !until_ || (here && *until_ <= *here);
  }

  /// Nothing where a moment lies after the end.
  [[nodiscard]] std::optional<Time> known(std::optional<Time> there) const {
    return there && *there <= *end_ ? there : std::nullopt;
  }

  /// The number of stored moments up to the end.
  Result<uint64_t> known_of(EntityPast& stored) const {
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t count, stored.count());
    ENGRAM_ASSIGN_OR_RETURN(const auto last, stored.last());
    if (!last || *last <= *end_) return count;
    uint64_t low = 0;
    uint64_t high = count;
    while (low < high) {
      const uint64_t middle = low + (high - low) / 2;
      ENGRAM_ASSIGN_OR_RETURN(const auto there, stored.nth(middle));
      if (there && *there <= *end_)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }

  [[nodiscard]] SharedSnapshot find(Time time) {
    if (!newest_ || newest_->time < time) return nullptr;
    if (newest_->time == time) return newest_;
    fill();
    const auto found = std::ranges::lower_bound(held_, time, {}, kTime);
    return found != held_.end() && (*found)->time == time ? *found : nullptr;
  }

  /// Asks working memory for all moments up to the newest.
  void fill() {
    if (is_filled_) return;
    is_filled_ = true;
    if (!newest_) return;
    held_ = parts_.held();
    // What came since is no part of this past, and the newest may have left.
    std::erase_if(held_, [&](const SharedSnapshot& one) { return one->time >= newest_->time; });
    held_.push_back(newest_);
    // What left between the two questions is in the store.
    until_ = parts_.until();
  }

  Result<EntityPast*> stored() {
    // Memory is asked before the store: a snapshot that leaves it meanwhile is in the store by
    // then. In the other order it could be missed.
    if (until_ && !is_open_) fill();
    if (!until_) return nullptr;
    if (!is_open_) {
      ENGRAM_ASSIGN_OR_RETURN(stored_, parts_.stored());
      is_open_ = true;
    }
    return stored_.get();
  }

  /// Finds the held moments that the store does not have.
  Status find_unstored(EntityPast& stored) {
    if (unstored_) return {};
    std::vector<Time> times;
    ENGRAM_ASSIGN_OR_RETURN(const auto last, stored.last());
    for (const SharedSnapshot& snapshot : held_) {
      if (last && snapshot->time <= *last) {
        ENGRAM_ASSIGN_OR_RETURN(const auto there, stored.at_or_after(snapshot->time));
        if (there == snapshot->time) continue;
      }
      times.push_back(snapshot->time);
    }
    unstored_ = std::move(times);
    return {};
  }

  const SharedSnapshot newest_;  ///< Null: none is held.
  std::optional<Time> until_;
  const std::optional<Time> end_;  ///< The last moment of it. Nothing: there was none.
  const JoinedParts parts_;
  std::vector<SharedSnapshot> held_;  ///< The newest too, once they were asked for.
  bool is_filled_ = false;
  bool is_open_ = false;
  std::unique_ptr<EntityPast> stored_;  ///< Null if the store has no past of the entity.
  std::optional<std::vector<Time>> unstored_;
};

}  // namespace

std::unique_ptr<EntityPast> join_pasts(JoinedParts parts) {
  return std::make_unique<JoinedEntityPast>(std::move(parts));
}

std::unique_ptr<JoinedPast> JoinedPast::create(std::string name, const WorkingMemory& memory,
                                               std::unique_ptr<StorePast> store,
                                               RecordedEntities& recorded) {
  if (store)
    recorded.begin_with(EntityIndex(store->store().manifest().segments),
                        store->store().journal_times());
  return std::unique_ptr<JoinedPast>(
      new JoinedPast(std::move(name), memory, std::move(store), recorded));
}

std::vector<MemoryId> JoinedPast::matching(const Query& query) {
  std::vector<MemoryId> held = memory_.matching(query);
  if (!store_) return held;
  std::vector<MemoryId> recorded = recorded_.matching(query);
  std::vector<MemoryId> all;
  all.reserve(held.size() + recorded.size());
  std::ranges::set_union(std::make_move_iterator(held.begin()), std::make_move_iterator(held.end()),
                         std::make_move_iterator(recorded.begin()),
                         std::make_move_iterator(recorded.end()), std::back_inserter(all));
  return all;
}

Result<std::unique_ptr<EntityPast>> JoinedPast::of(const MemoryId& entity) {
  // Memory is asked before the store, here and later; see JoinedParts.
  std::vector<SharedSnapshot> newest = memory_.all_of(entity, 1);
  if (newest.empty() && !(store_ && recorded_.known_until(entity)))
    return std::unique_ptr<EntityPast>();
  return join_pasts({
      .newest = newest.empty() ? nullptr : std::move(newest.front()),
      .held = [this, entity] { return memory_.all_of(entity); },
      .until = [this, entity] { return store_ ? recorded_.known_until(entity) : std::nullopt; },
      .stored = [this, entity] { return stored(entity); },
  });
}

Result<std::unique_ptr<EntityPast>> JoinedPast::stored(const MemoryId& entity) {
  const RecordedEntities::Changed changed = recorded_.take_changed();
  if (changed.is_all) store_->forget_decoded();
  for (const MemoryId& snapshot : changed.snapshots) store_->forget_decoded(snapshot);
  if (recorded_.recorded_at(entity) > seen_) ENGRAM_RETURN_IF_ERROR(renew());
  return store_->of(entity);
}

std::optional<idf::Type> JoinedPast::type_of(const MemoryId& entity) const {
  return memory_.type_of(entity);
}

Result<std::vector<Engine>> JoinedPast::models(const MemoryId& entity) {
  if (!store_) return std::vector<Engine>{};
  return store_->models(entity);
}

Status JoinedPast::follow() {
  return store_ && store_->is_outdated() ? renew() : Status();
}

template <typename Renew>
Status JoinedPast::renew_by(const Renew& renew) {
  if (!store_) return {};
  // The number is read first: a recording that ends during the renewal may not be in it.
  const uint64_t recorded = recorded_.recordings();
  ENGRAM_RETURN_IF_ERROR(renew(*store_));
  seen_ = recorded;
  return {};
}

Status JoinedPast::renew() {
  return renew_by([](StorePast& store) { return store.renew(); });
}

Status JoinedPast::start_anew() {
  return renew_by([](StorePast& store) { return store.start_anew(); });
}

}  // namespace engram::ltm
