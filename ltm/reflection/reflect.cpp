// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/reflect.h"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "ltm/recall/timeline_moments.h"
#include "ltm/reflection/action_log.h"
#include "ltm/reflection/looks.h"
#include "ltm/reflection/series_reader.h"

namespace engram::ltm {

namespace {

/// Max number of numbers in a block. Each takes 8 bytes.
constexpr size_t kMaxBlockNumbers = size_t{1} << 24;
/// Instances of a snapshot that are looked at; more are a list, and no parts of a state.
constexpr int32_t kMaxLookedInstances = 16;
/// Snapshots between two looks at the stop token.
constexpr uint64_t kStopInterval = 512;

struct TimeSpan {
  Time first = Time::min();
  Time last = Time::max();
};

class Reflector {
 public:
  Reflector(StoreReader& store, const ReflectOptions& options, const ProgressSink& progress,
            const std::stop_token& stop)
      : store_(store), options_(options), progress_(progress), stop_(stop), targets_(store) {}

  Result<Reflection> run() {
    reflection_.store = store_.path().string();
    ENGRAM_RETURN_IF_ERROR(find_entities());
    for (Looked& looked : entities_) ENGRAM_RETURN_IF_ERROR(look_at(looked));
    finish();
    return std::move(reflection_);
  }

 private:
  struct Looked {
    EntityReflection entity;
    std::vector<TimeSpan> spans;
    std::vector<int64_t> times;
    std::optional<idf::Type> type;  ///< Of its values.
  };

  Status find_entities() {
    for (const MemoryId& id : store_.entities()) {
      const bool is_asked =
          options_.query ? options_.query->matches(id) : id.names().front() != kReflectionMemory;
      if (!is_asked) continue;
      Looked looked;
      looked.entity.id = id;
      if (const idf::Type* type = store_.manifest().types.of_entity(id)) looked.type = *type;
      ENGRAM_RETURN_IF_ERROR(read_times(looked));
      total_ += looked.times.size();
      entities_.push_back(std::move(looked));
    }
    if (entities_.empty() && options_.query)
      return not_found("store '{}': no entity matches '{}'", reflection_.store,
                       options_.query->to_string());
    // Descriptions and classes come first: they say what belongs to others.
    std::ranges::stable_sort(entities_, {},
                             [](const Looked& looked) { return looked.times.size(); });
    reflection_.snapshots = total_;
    return {};
  }

  Status read_times(Looked& looked) {
    ENGRAM_ASSIGN_OR_RETURN(looked.spans, spans_of(looked.entity.id));
    ENGRAM_ASSIGN_OR_RETURN(const auto* times, targets_.times(looked.entity.id));
    if (looked.spans.size() == 1 && looked.spans.front().first == Time::min()) {
      looked.times = *times;
      return {};
    }
    for (const TimeSpan& span : looked.spans) {
      const auto first = std::ranges::lower_bound(*times, to_ns(span.first));
      const auto last = std::ranges::upper_bound(*times, to_ns(span.last));
      looked.times.insert(looked.times.end(), first, last);
    }
    return {};
  }

  /// The spans of time that the query selects, without overlaps.
  Result<std::vector<TimeSpan>> spans_of(const MemoryId& entity) {
    if (!options_.query || options_.are_names_only) return std::vector<TimeSpan>{TimeSpan{}};
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store_.timeline(entity));
    TimelineMoments moments(*timeline);
    std::vector<TimeSpan> spans;
    const std::vector<SnapshotQuery> queries = options_.query->snapshots_of(entity);
    ENGRAM_RETURN_IF_ERROR(refuse_conditions(queries, "reflect"));
    for (const SnapshotQuery& query : queries) {
      ENGRAM_ASSIGN_OR_RETURN(const Selection selected, select_times(query.selector, moments));
      if (selected.snapshots)
        spans.push_back({selected.snapshots->first, selected.snapshots->last});
    }
    std::ranges::sort(spans, {}, &TimeSpan::first);
    std::vector<TimeSpan> united;
    for (const TimeSpan& span : spans) {
      if (!united.empty() && span.first <= united.back().last)
        united.back().last = std::max(united.back().last, span.last);
      else
        united.push_back(span);
    }
    return united;
  }

  Status look_at(Looked& looked) {
    look_at_rates(looked.times, looked.entity, findings_, gaps_);
    ENGRAM_ASSIGN_OR_RETURN(Timeline * timeline, store_.timeline(looked.entity.id));
    std::vector<SeriesReader> readers;
    for (const TimeSpan& span : looked.spans)
      ENGRAM_RETURN_IF_ERROR(
          timeline->for_each(span.first, span.last, [&](const SnapshotEntry& entry) -> Status {
            ENGRAM_RETURN_IF_ERROR(count_one(looked));
            return read(looked, entry, readers);
          }));
    for (SeriesReader& reader : readers) look_at(looked, reader.take());
    return {};
  }

  Status count_one(const Looked& looked) {
    if (done_ % kStopInterval == 0) {
      if (stop_.stop_requested())
        return cancelled("reflection on '{}': stopped", reflection_.store);
      if (progress_) progress_({"reflect", done_, total_, looked.entity.id.to_string(), -1});
    }
    ++done_;
    return {};
  }

  Status read(Looked& looked, const SnapshotEntry& entry, std::vector<SeriesReader>& readers) {
    if (!entry.recorded) return {};
    const MemoryId& id = looked.entity.id;
    const auto packed =
        options_.with_images ? store_.read_packed(id, entry) : store_.read_values(id, entry);
    if (!packed.ok()) {
      if (packed.status().code() != StatusCode::kDataLoss) return packed.status();
      findings_.add({ReflectionKind::kUnreadable, Severity::kFault, id, "", entry.time, entry.time,
                     1, packed.status().message(), "a snapshot that decodes"});
      return {};
    }
    int32_t index = 0;
    size_t held = 0;
    for (const PackedInstance& instance : packed->instances) {
      if (index >= kMaxLookedInstances) break;
      if (instance.metadata.is_augmented()) continue;
      const auto at = static_cast<size_t>(index++);
      if (at >= readers.size()) add_reader(looked, readers);
      SeriesReader& reader = readers[at];
      ENGRAM_RETURN_IF_ERROR(
          reader.add(entry.time, instance.metadata.arrived, instance.value.rest));
      actions_.add(id, entry.time, instance.value.rest, looked.type);
      if (options_.with_images) add_images(instance, reader);
      held += reader.held();
    }
    if (held >= kMaxBlockNumbers)
      for (SeriesReader& reader : readers) look_at(looked, reader.take());
    return {};
  }

  void add_reader(const Looked& looked, std::vector<SeriesReader>& readers) {
    readers.emplace_back(SeriesBlock{looked.entity.id, static_cast<int32_t>(readers.size()),
                                     looked.entity.is_periodic, looked.entity.median_step_s},
                         looked.type, targets_);
  }

  /// Equal images have equal bytes, if each is stored for itself. Those of a video share their
  /// bytes, and each has its own place there, so nothing is said of them.
  static void add_images(const PackedInstance& instance, SeriesReader& reader) {
    for (const PackedMedium& medium : instance.value.media) {
      if (medium.group) continue;
      const auto bytes = medium.bytes.bytes();
      reader.add_image(medium.path,
                       std::hash<std::string_view>{}(
                           {reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
    }
  }

  void look_at(Looked& looked, const SeriesBlock& block) {
    if (block.rows() == 0) return;
    EntityReflection& entity = looked.entity;
    look_at_bounds(block, entity, findings_);
    std::ranges::move(find_limits(block), std::back_inserter(limits_));
    look_at_limits(block, limits_, entity, findings_);
    look_at_frozen(block, entity, findings_);
    const std::vector<ChangePair> pairs = find_change_pairs(block);
    look_at_motion(block, pairs, entity, pool_, jumps_, motions_[entity.id]);
    look_at_drift(block, pairs, entity, findings_);
    look_at_links(block, entity, findings_);
    if (!block.is_periodic) return;
    for (const LinkColumn& column : block.links)
      for (size_t i = 0; i < column.targets.size(); i += 16)
        if (const LinkTarget& target = column.targets[i]; target.has_time && target.entity >= 0)
          links_.emplace(entity.id, targets_.entity(target.entity));
  }

  /// A gap of one entity in which nobody has snapshots is the end of a recording and the begin of
  /// the next one.
  void judge_gaps() {
    for (const PossibleGap& gap : gaps_) {
      // The last snapshots of a recording come one after the other, so both ends are left out.
      const int64_t end =
          std::min((gap.last_ns - gap.first_ns) / 5,
                   std::max<int64_t>(1'000'000'000, std::llround(3e9 * gap.usual_s)));
      const bool are_others_there = std::ranges::any_of(entities_, [&](const Looked& other) {
        if (other.entity.id == gap.entity) return false;
        const auto next = std::ranges::upper_bound(other.times, gap.first_ns + end);
        return next != other.times.end() && *next < gap.last_ns - end;
      });
      const bool is_alone = entities_.size() == 1;
      if (!are_others_there && !is_alone) continue;
      const double seconds = 1e-9 * static_cast<double>(gap.last_ns - gap.first_ns);
      Looked* looked = find(gap.entity);
      looked->entity.missing += gap.missing;
      looked->entity.gap_s += seconds;
      const bool is_fault = looked->entity.is_periodic && gap.missing > 0;
      findings_.add({ReflectionKind::kGap, is_fault ? Severity::kFault : Severity::kNote,
                     gap.entity, "", time_from_ns(gap.first_ns), time_from_ns(gap.last_ns), 1,
                     gap.missing > 0 ? fmt::format("nothing for {:.3g} s, {} snapshots missing",
                                                   seconds, gap.missing)
                                     : fmt::format("nothing for {:.3g} s", seconds),
                     fmt::format("one each {:.3g} s", gap.usual_s)},
                    Duration(0));
    }
  }

  /// What moves a thousandth of a millimetre rests, if others of its provider segment move.
  void judge_rest(EntityReflection& entity) const {
    const bool moves = std::ranges::any_of(entity.members, [&](const MemberReflection& member) {
      const auto pooled = pool_.find({entity.id.parent(), member.path});
      return member.is_motion && member.speed > 0 &&
             (pooled == pool_.end() || member.speed >= kMovingShare * pooled->second);
    });
    if (!entity.has_motion || moves) return;
    entity.idle_share = 1;
    entity.longest_idle_s = to_seconds(entity.last - entity.first);
  }

  /// Needs entities in the order of their names.
  Looked* find(const MemoryId& id) {
    const auto id_of = [](const Looked& looked) { return looked.entity.id; };
    return &*std::ranges::lower_bound(entities_, id, {}, id_of);
  }

  void finish() {
    std::ranges::sort(entities_, {}, [](const Looked& looked) { return looked.entity.id; });
    std::map<MemoryId, EntityReflection*> by_id;
    Time end = Time::min();
    for (Looked& looked : entities_) {
      by_id[looked.entity.id] = &looked.entity;
      if (!looked.times.empty()) end = std::max(end, time_from_ns(looked.times.back()));
    }
    judge_gaps();
    for (Looked& looked : entities_) judge_rest(looked.entity);
    judge_jumps(pool_, jumps_, findings_);
    look_at_shifts(motions_, links_, by_id, reflection_.shifts, findings_);
    actions_.reflect(end, reflection_, by_id, findings_);
    reflection_.findings = findings_.take(reflection_.untold);
    for (Looked& looked : entities_) {
      reflection_.looks += looked.entity.looked_at.size();
      reflection_.entities.push_back(std::move(looked.entity));
    }
  }

  StoreReader& store_;
  const ReflectOptions& options_;
  const ProgressSink& progress_;
  std::stop_token stop_;
  LinkTargets targets_;
  Reflection reflection_;
  std::vector<Looked> entities_;
  FindingList findings_;
  std::vector<PossibleGap> gaps_;
  std::vector<DescribedLimits> limits_;
  SpeedPool pool_;
  std::vector<PossibleJump> jumps_;
  std::map<MemoryId, EntityMotion> motions_;
  std::set<std::pair<MemoryId, MemoryId>> links_;
  ActionLog actions_;
  uint64_t done_ = 0;
  uint64_t total_ = 0;
};

}  // namespace

Result<Reflection> reflect(StoreReader& store, const ReflectOptions& options,
                           const ProgressSink& progress, const std::stop_token& stop) {
  return Reflector(store, options, progress, stop).run();
}

Result<Reflection> reflect(const std::filesystem::path& store, const ReflectOptions& options,
                           const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, StoreReader::open(store));
  return reflect(*reader, options, progress, stop);
}

Result<ReflectOptions> reflect_options(const std::string& query) {
  ReflectOptions options;
  if (query.empty()) return options;
  ENGRAM_ASSIGN_OR_RETURN(options.query, Query::parse(query));
  options.are_names_only = query.find('@') == std::string::npos;
  return options;
}

}  // namespace engram::ltm
