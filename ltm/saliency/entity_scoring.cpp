// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/entity_scoring.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "ltm/likeness/likeness_space.h"
#include "ltm/saliency/novelty_meter.h"
#include "ltm/saliency/pending_saliency.h"
#include "ltm/saliency/surprise_meter.h"

namespace engram::ltm {

namespace {

/// Numbers of a series that is scored together. Three times as many floats are held.
constexpr size_t kMaxSeriesNumbers = size_t{1} << 22;
constexpr size_t kMaxSeriesRows = size_t{1} << 16;
constexpr size_t kMinSeriesRows = 1024;
constexpr size_t kUnitPairs = 4096;
constexpr size_t kMaxUnitEntities = 512;
constexpr size_t kMaxLookedInstances = 16;
/// Numbers of codes deviate by 12, and two moments at random are to be a unit apart.
constexpr double kCodeUnit = 12 * std::numbers::sqrt2;

double outcome_part(ActionOutcome outcome) {
  switch (outcome) {
    case ActionOutcome::kFailure:
    case ActionOutcome::kStop:
      return 1;
    case ActionOutcome::kSuccess:
      return 0.5;
    case ActionOutcome::kRunning:
      return 0.25;
    case ActionOutcome::kUnknown:
      break;
  }
  return 0;
}

/// Turns quaternions so that those of one orientation have one sign.
void align_quaternions(const std::vector<ContentMember>& members, const std::vector<double>& last,
                       std::vector<double>& numbers) {
  for (const ContentMember& member : members) {
    if (member.width != 4) continue;
    double length = 0, cosine = 0;
    for (size_t i = member.first; i < member.first + 4; ++i) {
      length += numbers[i] * numbers[i];
      cosine += numbers[i] * last[i];
    }
    if (std::abs(length - 1) > 1e-3 || cosine >= 0) continue;
    for (size_t i = member.first; i < member.first + 4; ++i) numbers[i] = -numbers[i];
  }
}

/// Snapshots of one layout that are scored together, and all that came before of this layout.
struct Layout {
  Layout(const MemberUnits& units, const std::vector<ContentMember>& members)
      : builder(units), novelty(members) {}

  SeriesBuilder builder;
  NoveltyMeter novelty;
};

/// Scores one entity, series by series.
class Scoring {
 public:
  Scoring(const MemberUnits& units, const TakeRow& take) : units_(units), take_(take) {}

  /// `is_new`: its parts are wanted; otherwise it is looked at alone. `follows`: it is the one
  /// behind the last that was added.
  Status add(const SnapshotEntry& entry, EntityContents& contents, bool is_new, bool follows) {
    if (layout_ == nullptr || layout_->builder.series().members != contents.members()) {
      ENGRAM_RETURN_IF_ERROR(finish());
      keep_last(0);
      layout_ = &layout_of(contents.members());
    } else if (is_full()) {
      ENGRAM_RETURN_IF_ERROR(finish());
      keep_last(std::min(rows_.size(), SurpriseMeter::kReach));
    }
    ENGRAM_CHECK(layout_->builder.add(entry.time, contents.members(), contents.content(), follows),
                 "its members are those of the layout");
    rows_.push_back({entry, contents.content(), is_new});
    rows_.back().content.numbers.clear();
    return {};
  }

  /// A snapshot that cannot be read. Its row says so, and is taken in the order of time.
  void add_damaged(const SnapshotEntry& entry) { damaged_.push_back(entry); }

  Status finish() {
    if (rows_.empty()) return take_damaged(Time::max());
    const ContentSeries& series = layout_->builder.series();
    const std::vector<double> change = measure_change(series);
    SurpriseMeter surprise;
    for (size_t i = 0; i < rows_.size(); ++i) {
      const Row& row = rows_[i];
      SaliencyParts parts;
      parts[SaliencyPart::kSurprise] = surprise.next(series, i).part();
      if (row.is_learned) continue;
      parts[SaliencyPart::kNovelty] = layout_->novelty.next(series, i);
      if (!row.is_new) continue;
      parts[SaliencyPart::kChange] = change_part(change[i]);
      add_events(i, parts);
      ENGRAM_RETURN_IF_ERROR(take_damaged(row.entry.time));
      ENGRAM_RETURN_IF_ERROR(take_(row.entry, {stored_parts(parts)}));
    }
    return take_damaged(Time::max());
  }

 private:
  struct Row {
    SnapshotEntry entry;
    MomentContent content;  ///< Without numbers.
    bool is_new = false;
    bool is_learned = false;  ///< It was in the series before, too.
  };

  /// The layout with these members. An entity whose layout changes back and forth has not
  /// forgotten what it had before; of many layouts those that were used last stay.
  Layout& layout_of(const std::vector<ContentMember>& members) {
    const auto is_same = [&](const auto& known) { return known.first == members; };
    auto found = std::ranges::find_if(layouts_, is_same);
    if (found == layouts_.end()) {
      if (layouts_.size() >= kMaxLayouts) layouts_.erase(layouts_.begin());
      layouts_.emplace_back(members, std::make_unique<Layout>(units_, members));
    } else {
      std::rotate(found, found + 1, layouts_.end());
    }
    return *layouts_.back().second;
  }

  Status take_damaged(Time until) {
    size_t taken = 0;
    for (; taken < damaged_.size() && damaged_[taken].time < until; ++taken)
      ENGRAM_RETURN_IF_ERROR(take_(damaged_[taken], {{}, 1, RowState::kDamaged}));
    damaged_.erase(damaged_.begin(), damaged_.begin() + static_cast<ptrdiff_t>(taken));
    return {};
  }

  void add_events(size_t at, SaliencyParts& parts) const {
    const MomentContent& now = rows_[at].content;
    const MomentContent* const last = at > 0    ? &rows_[at - 1].content
                                      : before_ ? &*before_
                                                : nullptr;
    const bool is_event =
        last == nullptr || now.outcome != last->outcome || now.facts != last->facts;
    if (is_event) parts[SaliencyPart::kOutcome] = outcome_part(now.outcome);
    parts[SaliencyPart::kSpeech] = now.is_speech ? 1 : 0;
    if (last != nullptr && now.links != last->links) parts[SaliencyPart::kLinks] = 1;
  }

  [[nodiscard]] bool is_full() const {
    const ContentSeries& series = layout_->builder.series();
    return series.size() >= kMaxSeriesRows ||
           (series.size() >= kMinSeriesRows && series.numbers.size() >= kMaxSeriesNumbers);
  }

  /// Goes on with the last `count` rows, which were scored.
  void keep_last(size_t count) {
    if (rows_.empty()) return;
    const size_t gone = rows_.size() - count;
    if (gone > 0) before_ = rows_[gone - 1].content;
    layout_->builder.keep_last(count);
    rows_.erase(rows_.begin(), rows_.begin() + static_cast<ptrdiff_t>(gone));
    for (Row& row : rows_) {
      row.is_new = false;
      row.is_learned = true;
    }
  }

  static constexpr size_t kMaxLayouts = 8;

  const MemberUnits& units_;
  const TakeRow& take_;
  /// The one that was used last is the last.
  std::vector<std::pair<std::vector<ContentMember>, std::unique_ptr<Layout>>> layouts_;
  Layout* layout_ = nullptr;  ///< Of `rows_`.
  std::vector<Row> rows_;
  std::vector<SnapshotEntry> damaged_;
  std::optional<MomentContent> before_;  ///< Of the snapshot before the first row.
};

/// Moments before `first` that are looked at: all that are close, and of the others some pairs of
/// neighbours, because a step tells how fast the entity changes.
std::vector<size_t> context_of(size_t first) {
  std::vector<size_t> context;
  const size_t close = first - std::min(first, SurpriseMeter::kReach);
  const size_t pairs = std::min(close, NoveltyMeter::kMaxExamples) / 2;
  for (size_t i = 0; i < pairs; ++i) {
    const size_t at = i * close / pairs;
    context.push_back(at);
    context.push_back(at + 1);
  }
  for (size_t i = close; i < first; ++i) context.push_back(i);
  return context;
}

}  // namespace

Result<std::unique_ptr<EntityContents>> EntityContents::open(StorePast& past,
                                                             const MemoryId& entity) {
  auto contents =
      std::unique_ptr<EntityContents>(new EntityContents(past, entity, past.type_of(entity)));
  if (const auto space = read_space(past.store(), entity))
    contents->codes_ = StoredCodes::read(past.store(), entity, space->id());
  return contents;
}

Result<bool> EntityContents::read(const SnapshotEntry& entry) {
  reader_.begin();
  const auto code = codes_ ? codes_->find(entry) : std::span<const int8_t>();
  const Status status = entry.recorded ? read_values(entry) : read_latents(entry, !code.empty());
  if (status.code() == StatusCode::kDataLoss) return false;
  ENGRAM_RETURN_IF_ERROR(status);
  if (!code.empty()) {
    std::vector<double> numbers;
    for (const int8_t number : code) numbers.push_back(number / kCodeUnit);
    reader_.add("image code", numbers);
  }
  return true;
}

Status EntityContents::read_values(const SnapshotEntry& entry) {
  ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, past_.store().read_values(entity_, entry));
  const size_t count = std::min(packed.instances.size(), kMaxLookedInstances);
  for (size_t i = 0; i < count; ++i) reader_.add(packed.instances[i].value.rest);
  return {};
}

Status EntityContents::read_latents(const SnapshotEntry& entry, bool has_code) {
  if (has_code) {
    ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot found, past_.store().read_latent(entity_, entry));
    for (const LatentInstance& instance : found.instances)
      reader_.add(idf::Data(instance.latent.remainder));
    return {};
  }
  if (decoded_ == nullptr) {
    ENGRAM_ASSIGN_OR_RETURN(decoded_, past_.of(entity_));
  }
  ENGRAM_ASSIGN_OR_RETURN(const RecalledSnapshot found,
                          decoded_->read(entry.time, Prefer::kLatent));
  const auto& instances = found.answer.instances;
  for (size_t i = 0; i < std::min(instances.size(), kMaxLookedInstances); ++i)
    reader_.add(instances[i].data);
  return {};
}

bool SeriesBuilder::add(Time time, const std::vector<ContentMember>& members,
                        const MomentContent& content, bool follows) {
  if (!has_members_) {
    has_members_ = true;
    series_.members = members;
    reference_ = content.numbers;
    scales_.resize(content.numbers.size());
    for (const ContentMember& member : members) {
      const double unit = member.path == "image code" ? 1 : units_.of(member.path);
      std::fill_n(scales_.begin() + static_cast<ptrdiff_t>(member.first), member.width, unit);
    }
    last_ = content.numbers;
  } else if (members != series_.members) {
    return false;
  }
  std::vector<double> numbers = content.numbers;
  align_quaternions(members, last_, numbers);
  series_.times.push_back(time);
  for (size_t i = 0; i < numbers.size(); ++i)
    series_.numbers.push_back(static_cast<float>((numbers[i] - reference_[i]) / scales_[i]));
  series_.facts.push_back(content.facts ^ (content.links * 3));
  series_.follows.push_back(follows && series_.size() > 1 ? 1 : 0);
  last_ = std::move(numbers);
  return true;
}

void SeriesBuilder::keep_last(size_t count) {
  const size_t gone = series_.size() - count;
  const size_t width = series_.width();
  series_.numbers.erase(series_.numbers.begin(),
                        series_.numbers.begin() + static_cast<ptrdiff_t>(gone * width));
  series_.times.erase(series_.times.begin(), series_.times.begin() + static_cast<ptrdiff_t>(gone));
  series_.facts.erase(series_.facts.begin(), series_.facts.begin() + static_cast<ptrdiff_t>(gone));
  series_.follows.erase(series_.follows.begin(),
                        series_.follows.begin() + static_cast<ptrdiff_t>(gone));
}

void SeriesBuilder::clear() {
  series_ = {};
  has_members_ = false;
}

namespace {

/// Gathers the units of one entity from up to `pairs` pairs of neighbours.
Status add_units(StorePast& past, const MemoryId& entity, size_t pairs, MemberUnits& units) {
  ENGRAM_ASSIGN_OR_RETURN(const auto entries, entries_of(past.store(), entity));
  ENGRAM_ASSIGN_OR_RETURN(const auto contents, EntityContents::open(past, entity));
  const size_t count = std::min(pairs, entries.size());
  for (size_t i = 0; i < count; ++i) {
    const size_t at = i * entries.size() / count;
    ENGRAM_ASSIGN_OR_RETURN(const bool is_read, contents->read(entries[at]));
    if (!is_read) continue;
    std::vector<double> before = contents->content().numbers;
    const size_t next = std::min(at + 1, entries.size() - 1);
    ENGRAM_ASSIGN_OR_RETURN(const bool is_next_read, contents->read(entries[next]));
    if (!is_next_read) continue;
    std::vector<double> after = contents->content().numbers;
    if (before.size() != after.size()) continue;
    align_quaternions(contents->members(), before, after);
    units.add(contents->members(), before, after);
  }
  return {};
}

}  // namespace

Result<MemberUnits> measure_units(StorePast& past, std::span<const MemoryId> entities,
                                  const std::function<bool()>& is_over) {
  MemberUnits units;
  const size_t looked = std::min(entities.size(), kMaxUnitEntities);
  const size_t pairs = kUnitPairs / std::max<size_t>(looked, 1);
  for (size_t e = 0; e < looked && !is_over(); ++e) {
    const Status added = add_units(past, entities[e * entities.size() / looked], pairs, units);
    // Units without some entities are wrong for all, so what will be there in the next try ends
    // this one. An entity that is damaged is told of when it is scored.
    if (added.code() == StatusCode::kResourceExhausted || added.code() == StatusCode::kUnavailable)
      return added;
  }
  units.finish();
  return units;
}

Status score_entity(StorePast& past, const MemoryId& entity, const MemberUnits& units,
                    std::span<const SnapshotEntry> entries, size_t first,
                    const std::function<bool()>& is_over, const TakeRow& take) {
  ENGRAM_ASSIGN_OR_RETURN(const auto contents, EntityContents::open(past, entity));
  Scoring scoring(units, take);
  std::optional<size_t> last;  // Damaged ones in between do not make neighbours.
  const auto add = [&](size_t at, bool is_new) -> Status {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_read, contents->read(entries[at]));
    if (is_read) {
      const bool follows = last && *last + 1 == at;
      last = at;
      return scoring.add(entries[at], *contents, is_new, follows);
    }
    if (!is_new) return Status();
    scoring.add_damaged(entries[at]);
    return {};
  };
  for (const size_t at : context_of(first)) ENGRAM_RETURN_IF_ERROR(add(at, false));
  for (size_t at = first; at < entries.size() && !is_over(); ++at)
    ENGRAM_RETURN_IF_ERROR(add(at, true));
  return scoring.finish();
}

}  // namespace engram::ltm
