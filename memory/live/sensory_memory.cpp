// SPDX-License-Identifier: Apache-2.0
#include "memory/live/sensory_memory.h"

#include <algorithm>

#include "ltm/core/check.h"

namespace engram::memory {

using ltm::MemoryId;

namespace {

/// Whether a selector may select a snapshot of the time `recent` or a later one. Those that count
/// from the end, or are open to it, do.
class Reach {
 public:
  explicit Reach(Time recent) : recent_(recent) {}

  static bool any(std::span<const ltm::SnapshotQuery> asked, Time recent) {
    return std::ranges::any_of(asked, [recent](const ltm::SnapshotQuery& one) {
      return std::visit(Reach(recent), one.selector);
    });
  }

  bool operator()(const ltm::select::TimeRange& range) const { return range.last >= recent_; }
  bool operator()(const ltm::select::At& at) const { return at.time >= recent_; }
  bool operator()(const ltm::select::Before& before) const { return before.time >= recent_; }
  bool operator()(const ltm::select::Nearest& nearest) const {
    if (nearest.time >= recent_) return true;
    // Times may lie further apart than a Duration can tell.
    const uint64_t apart =
        static_cast<uint64_t>(to_ns(recent_)) - static_cast<uint64_t>(to_ns(nearest.time));
    return nearest.tolerance.count() >= 0 &&
           static_cast<uint64_t>(nearest.tolerance.count()) >= apart;
  }
  template <typename Other>
  bool operator()(const Other& /*other*/) const {
    return true;
  }

 private:
  Time recent_;
};

/// Whether a selector may select a snapshot of this time; those that look at others may.
bool may_select(const ltm::SnapshotQuery& asked, Time time) {
  const auto* range = std::get_if<ltm::select::TimeRange>(&asked.selector);
  return range == nullptr || (range->first <= time && time <= range->last);
}

}  // namespace

Attention& Attention::operator=(Attention&& other) noexcept {
  if (this == &other) return *this;
  end();
  memory_ = std::move(other.memory_);
  number_ = other.number_;
  return *this;
}

void Attention::end() {
  if (const auto memory = memory_.lock()) memory->end(number_);
  memory_.reset();
}

Status SensoryMemory::Options::validate() const {
  for (const SensorySegment& segment : segments) {
    const std::string name = segment.match.to_string();
    if (segment.match.names().empty() || segment.match.time())
      return invalid_argument("sensory: found '{}', needs a memory, a segment or an entity", name);
    if (segment.hold < kMinHold || segment.hold > kMaxHold)
      return invalid_argument("sensory: found {} for '{}', needs {} to {}", to_string(segment.hold),
                              name, to_string(kMinHold), to_string(kMaxHold));
    if (std::ranges::count(segments, segment.match, &SensorySegment::match) > 1)
      return invalid_argument("sensory: found '{}' twice, needs it once", name);
  }
  if (ring_bytes < kMinRingBytes || ring_bytes > kMaxRingBytes)
    return invalid_argument("sensory: found a ring of {} bytes, needs {} to {}", ring_bytes,
                            kMinRingBytes, kMaxRingBytes);
  if (query_attention && (*query_attention < kMinHold || *query_attention > kRecent))
    return invalid_argument("sensory: found queries that attend for {}, needs {} to {}",
                            to_string(*query_attention), to_string(kMinHold), to_string(kRecent));
  return {};
}

std::shared_ptr<SensoryMemory> SensoryMemory::create(const Options& options, size_t max_entities,
                                                     PassCommit pass, Clock clock) {
  return std::shared_ptr<SensoryMemory>(
      new SensoryMemory(options, max_entities, std::move(pass), std::move(clock)));
}

SensoryMemory::SensoryMemory(const Options& options, size_t max_entities, PassCommit pass,
                             Clock clock)
    : options_(options),
      max_entities_(std::min(max_entities, kMaxEntities)),
      clock_(std::move(clock)) {
  for (const SensorySegment& segment : options_.segments) {
    plain_.push_back(std::make_shared<PlainRing>(segment, options_.ring_bytes, pass));
    const MutexLock lock(mutex_);
    sources_.push_back(plain_.back());
  }
}

const SensorySegment* SensoryMemory::segment_of(const MemoryId& entity) const {
  const SensorySegment* best = nullptr;
  for (const SensorySegment& segment : options_.segments)
    if (segment.match.is_prefix_of(entity) &&
        (best == nullptr || segment.match.depth() > best->match.depth()))
      best = &segment;
  return best;
}

PlainRing& SensoryMemory::ring_of(const MemoryId& entity) {
  const SensorySegment* segment = segment_of(entity);
  ENGRAM_CHECK(segment != nullptr, "'{}' is not sensory", entity.to_string());
  return *plain_[static_cast<size_t>(segment - options_.segments.data())];
}

Result<SharedSensoryEntity> SensoryMemory::entity(const MemoryId& id) {
  const SensorySegment* segment = segment_of(id);
  ENGRAM_CHECK(segment != nullptr, "'{}' is not sensory", id.to_string());
  const MutexLock lock(mutex_);
  if (const auto known = entities_.find(id); known != entities_.end()) return known->second;
  // Those of providers that are gone make room.
  if (entities_.size() >= max_entities_)
    std::erase_if(entities_, [](const auto& one) { return one.second.use_count() == 1; });
  if (entities_.size() >= max_entities_)
    return resource_exhausted("sensory memory: entity '{}': knows {} already, needs fewer",
                              id.to_string(), entities_.size());
  auto made = std::make_shared<SensoryEntity>(id, segment->hold);
  for (auto& [number, opened] : opened_) {
    if (!opened.is_wanted(id)) continue;
    ++made->attentions_;
    opened.entities.push_back(made);
  }
  made->is_attended_ = made->attentions_ > 0;
  entities_.emplace(id, made);
  return made;
}

bool SensoryMemory::settle(SensoryEntity& entity, SteadyTime now) {
  const bool is_attended = entity.attentions_ > 0 || now < entity.attended_until_;
  return entity.is_attended_.exchange(is_attended) != is_attended;
}

void SensoryMemory::tell_sources() {
  for (const auto& source : sources_) source->attention_changed();
}

Attention SensoryMemory::attend(Wanted is_wanted) {
  Sources sources;
  uint64_t number = 0;
  {
    const MutexLock lock(mutex_);
    number = ++last_opened_;
    Opened opened{std::move(is_wanted), {}};
    for (const auto& [id, entity] : entities_) {
      if (!opened.is_wanted(id)) continue;
      ++entity->attentions_;
      settle(*entity, steady_now());
      opened.entities.push_back(entity);
    }
    if (!opened.entities.empty()) {
      tell_sources();
      sources = sources_;
    }
    opened_.emplace(number, std::move(opened));
  }
  // Another one may have opened attention to the same and be passing still: sources wait for it.
  for (const auto& source : sources) source->pass();
  return {weak_from_this(), number};
}

void SensoryMemory::end(uint64_t number) {
  const MutexLock lock(mutex_);
  const auto opened = opened_.extract(number);
  if (opened.empty()) return;
  bool is_changed = false;
  for (const auto& entity : opened.mapped().entities) {
    --entity->attentions_;
    is_changed = settle(*entity, steady_now()) || is_changed;
  }
  if (is_changed) tell_sources();
}

EarliestTimes SensoryMemory::earliest_held() const {
  Sources sources;
  {
    const MutexLock lock(mutex_);
    sources = sources_;
  }
  EarliestTimes times;
  for (const auto& source : sources) source->note_earliest(times);
  return times;
}

std::vector<SharedSensoryEntity> SensoryMemory::asked_for(const ltm::Query& query,
                                                          const ltm::View* view) const {
  const Time now = clock_();
  std::vector<SharedSensoryEntity> found;
  std::vector<std::pair<SharedSensoryEntity, std::vector<ltm::SnapshotQuery>>> of_the_past;
  {
    const MutexLock lock(mutex_);
    for (const auto& [id, entity] : entities_) {
      auto asked = query.snapshots_of(id);
      if (!Reach::any(asked, now - kRecent)) continue;
      // Who may not see it must not notice it by the time an answer takes, or cost RAM.
      const ltm::Sight sight = ltm::sight_of(view, id);
      if (sight.times.empty() || sight.times.windows().back().last < now - kRecent) continue;
      if (Reach::any(asked, now))
        found.push_back(entity);
      else
        of_the_past.emplace_back(entity, std::move(asked));
    }
  }
  if (of_the_past.empty()) return found;
  // Without the lock, because a source may be passing.
  const EarliestTimes held = earliest_held();
  for (auto& [entity, asked] : of_the_past)
    if (const auto earliest = held.of(entity->id); earliest && Reach::any(asked, *earliest))
      found.push_back(std::move(entity));
  return found;
}

void SensoryMemory::attend(const ltm::Query& query, const ltm::View* view) {
  const std::vector<SharedSensoryEntity> wanted = asked_for(query, view);
  if (wanted.empty()) return;
  Sources sources;
  {
    const SteadyTime now = steady_now();
    const MutexLock lock(mutex_);
    bool is_changed = false;
    for (const auto& entity : wanted) {
      entity->attended_until_ = now + options_.query_attention.value_or(entity->hold);
      is_changed = settle(*entity, now) || is_changed;
    }
    if (is_changed) tell_sources();
    sources = sources_;
  }
  for (const auto& source : sources) source->pass();
}

void SensoryMemory::pass_chosen(const ltm::Query& query, const ltm::View* view) {
  const auto is_chosen = [&](const MemoryId& entity, Time time) {
    if (!ltm::sight_of(view, entity).times.contains(time)) return false;
    const auto asked = query.snapshots_of(entity);
    return std::ranges::any_of(
        asked, [time](const ltm::SnapshotQuery& one) { return may_select(one, time); });
  };
  Sources sources;
  {
    const MutexLock lock(mutex_);
    if (std::ranges::none_of(entities_, [&](const auto& one) {
          return query.matches(one.first) && !ltm::sight_of(view, one.first).times.empty();
        }))
      return;
    sources = sources_;
  }
  for (const auto& source : sources) source->pass_chosen(is_chosen);
}

bool SensoryMemory::selects(const ltm::Query& query, const ltm::View* view) const {
  const Time recent = clock_() - kRecent;
  const MutexLock lock(mutex_);
  return std::ranges::any_of(entities_, [&](const auto& one) {
    return Reach::any(query.snapshots_of(one.first), recent) &&
           !ltm::sight_of(view, one.first).times.empty();
  });
}

Status SensoryMemory::hold(ltm::Commit& commit, std::vector<std::vector<Buffer>>& encoded) {
  // Nothing is held of a commit that is refused: first everything is checked.
  std::vector<SharedSensoryEntity> entities(commit.updates.size());
  bool has_any = false;
  for (size_t i = 0; i < commit.updates.size(); ++i) {
    const MemoryId& id = commit.updates[i].entity;
    if (segment_of(id) == nullptr) continue;
    if (!has_any) ENGRAM_RETURN_IF_ERROR(commit.check());
    has_any = true;
    const size_t bytes = PlainRing::bytes_of(commit.updates[i],
                                             encoded.empty() ? std::vector<Buffer>() : encoded[i]);
    if (bytes > options_.ring_bytes)
      return resource_exhausted(
          "sensory memory: '{}' takes {} bytes, needs at most the {} that are held of a segment",
          id.to_string(), bytes, options_.ring_bytes);
    ENGRAM_ASSIGN_OR_RETURN(entities[i], entity(id));
  }
  if (!has_any) return {};
  std::vector<ltm::EntityUpdate> passed;
  std::vector<std::vector<Buffer>> passed_bytes;
  for (size_t i = 0; i < commit.updates.size(); ++i) {
    std::vector<Buffer> none;
    std::vector<Buffer>& bytes = encoded.empty() ? none : encoded[i];
    if (entities[i] && ring_of(entities[i]->id).hold(entities[i], commit.updates[i], bytes))
      continue;
    passed.push_back(std::move(commit.updates[i]));
    if (!encoded.empty()) passed_bytes.push_back(std::move(bytes));
  }
  commit.updates = std::move(passed);
  encoded = std::move(passed_bytes);
  return {};
}

void SensoryMemory::add(std::shared_ptr<SensorySource> source) {
  const MutexLock lock(mutex_);
  source->attention_changed();
  sources_.push_back(std::move(source));
}

SensoryCounts SensoryMemory::add_up(const SensoryCounts& first, const SensoryCounts& second) {
  return {first.committed + second.committed, first.passed + second.passed,
          first.refused + second.refused,     first.crowded_out + second.crowded_out,
          first.held + second.held,           first.held_bytes + second.held_bytes};
}

void SensoryMemory::keep_counts(const SensorySource& gone) {
  SensoryCounts counts = gone.counts();
  counts.held = 0;
  counts.held_bytes = 0;
  of_gone_ = add_up(of_gone_, counts);
}

void SensoryMemory::remove(const SensorySource* source) {
  std::shared_ptr<SensorySource> removed;
  const MutexLock lock(mutex_);
  const auto found = std::ranges::find(sources_, source, &std::shared_ptr<SensorySource>::get);
  if (found == sources_.end()) return;
  keep_counts(**found);
  sources_.erase(found);
}

void SensoryMemory::sweep(SteadyTime now) {
  Sources sources;
  {
    const MutexLock lock(mutex_);
    bool is_changed = false;
    for (const auto& [id, entity] : entities_) is_changed = settle(*entity, now) || is_changed;
    if (is_changed) tell_sources();
    sources = sources_;
  }
  // Without the lock, because a source may be passing.
  for (const auto& source : sources)
    if (!source->sweep(now)) remove(source.get());
}

void SensoryMemory::close() {
  Sources sources;
  const MutexLock lock(mutex_);
  for (const auto& source : sources_) keep_counts(*source);
  sources = std::exchange(sources_, {});
}

SensoryCounts SensoryMemory::counts() const {
  Sources sources;
  SensoryCounts counts;
  {
    const MutexLock lock(mutex_);
    counts = of_gone_;
    sources = sources_;
  }
  for (const auto& source : sources) counts = add_up(counts, source->counts());
  return counts;
}

size_t SensoryMemory::source_count() const {
  const MutexLock lock(mutex_);
  return sources_.size();
}

}  // namespace engram::memory
