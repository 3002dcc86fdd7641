// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/why_salient.h"

#include <algorithm>

#include "ltm/recall/access_log.h"
#include "ltm/saliency/entity_scoring.h"
#include "ltm/saliency/make_saliency.h"
#include "ltm/saliency/pending_saliency.h"
#include "ltm/saliency/saliency_table.h"
#include "ltm/saliency/surprise_meter.h"

namespace engram::ltm {

namespace {

/// "positions[3]", or the path alone where there is one number.
std::string name_of_number(const std::vector<ContentMember>& members, size_t number) {
  for (const ContentMember& member : members) {
    if (number < member.first || number >= member.first + member.width) continue;
    const std::string path = member.path.empty() ? "the value" : member.path;
    return member.width == 1 ? path : fmt::format("{}[{}]", path, number - member.first);
  }
  return "?";
}

/// Explains one snapshot of an entity.
class Explaining {
 public:
  Explaining(StorePast& past, const AccessTable& accesses,
             const std::vector<SnapshotEntry>& entries, const EntitySaliency& saliency)
      : past_(past), accesses_(accesses), entries_(entries), saliency_(saliency) {}

  Result<SalientMoment> run(size_t entry, size_t row, const MemberUnits& units,
                            const SaliencyWeights& weights) {
    const MemoryId& entity = saliency_.entity;
    ENGRAM_ASSIGN_OR_RETURN(const auto contents, EntityContents::open(past_, entity));
    told_.entity = entity;
    told_.time = entries_[entry].time;
    told_.learned_from = weights.learned_from;
    told_.count = saliency_.times.size();
    const SaliencyParts parts = parts_at(row);
    told_.saliency = saliency_of(parts, weights);
    told_.rank = 1;
    for (size_t i = 0; i < saliency_.times.size(); ++i)
      told_.rank += saliency_of(parts_at(i), weights) > told_.saliency ? 1 : 0;
    for (size_t i = 0; i < kSaliencyParts; ++i) {
      const auto part = static_cast<SaliencyPart>(i);
      told_.parts.push_back(
          {part, parts[part], weights.parts[part], parts[part] * weights.parts[part], "", ""});
    }
    ENGRAM_RETURN_IF_ERROR(explain_surprise(entry, *contents, units));
    ENGRAM_RETURN_IF_ERROR(explain_change(entry, row, *contents, units));
    explain_events(parts);
    std::ranges::stable_sort(told_.parts, std::greater(), &SalientPart::contribution);
    return std::move(told_);
  }

 private:
  [[nodiscard]] SaliencyParts parts_at(size_t row) const {
    return parts_of(saliency_.rows[row].parts,
                    accesses_.find(saliency_.entity, saliency_.times[row]).count);
  }

  SalientPart& part(SaliencyPart which) { return told_.parts[static_cast<size_t>(which)]; }

  Result<bool> add(size_t entry, EntityContents& contents, SeriesBuilder& series) {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_read, contents.read(entries_[entry]));
    if (!is_read) return false;
    content_ = contents.content();
    if (series.add(entries_[entry].time, contents.members(), content_, true)) return true;
    series.clear();  // What came before has other members, and tells nothing of it.
    return series.add(entries_[entry].time, contents.members(), content_, true);
  }

  /// A number of the last row in the unit of its member.
  static double value_of(const SeriesBuilder& series, size_t number, double in_units) {
    return series.reference()[number] + in_units * series.units()[number];
  }

  Status explain_surprise(size_t entry, EntityContents& contents, const MemberUnits& units) {
    SeriesBuilder series(units);
    for (size_t i = entry - std::min(entry, SurpriseMeter::kReach); i <= entry; ++i)
      ENGRAM_RETURN_IF_ERROR(add(i, contents, series).status());
    const ContentSeries& read = series.series();
    if (read.size() == 0 || read.times.back() != entries_[entry].time)
      return failed_precondition("'{}': is damaged", told_.entity.at(told_.time).printable());
    SurpriseMeter meter;
    Surprise told;
    for (size_t i = 0; i < read.size(); ++i) told = meter.next(read, i);
    SalientPart& part = this->part(SaliencyPart::kSurprise);
    if (!told.is_known) {
      part.expected = "nothing: fewer than 8 steps of these members came before";
      return {};
    }
    if (told.has_changed && 1 - told.changed_facts >= surprise_part(told.ratio())) {
      part.found = "texts or links changed";
      part.expected = fmt::format(
          "those of the snapshot before; they changed in {:.0f} % of up to 32 steps before",
          100 * told.changed_facts);
    } else if (read.width() > 0) {
      part.found =
          fmt::format("{} is {:.4g}", name_of_number(read.members, told.member),
                      value_of(series, told.member, read.row(read.size() - 1)[told.member]));
      part.expected = fmt::format(
          "{:.4g} ({}); all numbers together are {:.3g} times as wrong as 90 % of the steps before",
          value_of(series, told.member, told.predicted),
          told.is_line ? "its last step continued" : "its last value held", told.ratio());
    }
    return {};
  }

  /// Compares with the last one before it that changes more.
  Status explain_change(size_t entry, size_t row, EntityContents& contents,
                        const MemberUnits& units) {
    const uint16_t own = saliency_.rows[row].parts.front();
    SalientPart& part = this->part(SaliencyPart::kChange);
    size_t from = row;
    while (from > 0 && saliency_.rows[from - 1].parts.front() <= own) --from;
    if (from == 0) {
      part.found = "no snapshot before it changes more";
      part.expected = "nothing is told before it";
      return {};
    }
    const auto before =
        std::ranges::lower_bound(entries_, saliency_.times[from - 1], {}, &SnapshotEntry::time);
    if (before == entries_.end()) return {};
    SeriesBuilder series(units);
    ENGRAM_RETURN_IF_ERROR(
        add(static_cast<size_t>(before - entries_.begin()), contents, series).status());
    ENGRAM_RETURN_IF_ERROR(add(entry, contents, series).status());
    const ContentSeries& both = series.series();
    part.expected = fmt::format(
        "as at {}, the last one that changes more; without this one, its time would be told as "
        "wrong as by what usually changes in {:.3g} s",
        to_string(saliency_.times[from - 1]), change_seconds(part.value));
    if (both.size() < 2) {
      part.found = "other members";
    } else if (both.facts[0] != both.facts[1]) {
      part.found = "other texts or links";
    } else if (both.width() > 0) {
      size_t max = 0;
      const auto off = [&](size_t i) { return std::abs(both.row(1)[i] - both.row(0)[i]); };
      for (size_t i = 0; i < both.width(); ++i) max = off(i) > off(max) ? i : max;
      part.found = fmt::format("{} is {:.4g} and was {:.4g}", name_of_number(both.members, max),
                               value_of(series, max, both.row(1)[max]),
                               value_of(series, max, both.row(0)[max]));
    }
    return {};
  }

  void explain_events(const SaliencyParts& parts) {
    SalientPart& novelty = part(SaliencyPart::kNovelty);
    novelty.found = fmt::format("{:.2f} from the nearest before it", novelty.value);
    novelty.expected = "0: as before; 1: as far as two at random, or texts that never came";
    SalientPart& outcome = part(SaliencyPart::kOutcome);
    if (content_.outcome != ActionOutcome::kUnknown)
      outcome.found = parts[SaliencyPart::kOutcome] > 0
                          ? std::string(name_of(content_.outcome))
                          : fmt::format("{}, as the one before it", name_of(content_.outcome));
    if (content_.is_speech) part(SaliencyPart::kSpeech).found = "somebody said something";
    if (parts[SaliencyPart::kLinks] > 0)
      part(SaliencyPart::kLinks).found = "it leads elsewhere than the one before it";
    const auto reads = accesses_.find(told_.entity, told_.time).count;
    part(SaliencyPart::kReads).found = reads == 0 ? "" : fmt::format("read {} times", reads);
  }

  StorePast& past_;
  const AccessTable& accesses_;
  const std::vector<SnapshotEntry>& entries_;
  const EntitySaliency& saliency_;
  SalientMoment told_;
  MomentContent content_;  ///< Of the snapshot that was read last.
};

/// The parts of all snapshots of an entity, calculated now.
Result<EntitySaliency> calculate(StorePast& past, const MemoryId& entity,
                                 const std::vector<SnapshotEntry>& entries,
                                 const MemberUnits& units, const std::stop_token& stop) {
  EntitySaliency saliency{entity, {}, {}};
  ENGRAM_RETURN_IF_ERROR(score_entity(
      past, entity, units, entries, 0, [&stop] { return stop.stop_requested(); },
      [&](const SnapshotEntry& entry, const SaliencyRow& row) {
        saliency.append(entry.time, row);
        return Status();
      }));
  if (stop.stop_requested()) return cancelled("'{}': calculating saliency", entity.to_string());
  return saliency;
}

}  // namespace

Result<SalientMoment> why_salient(StorePast& past, const AccessTable& accesses,
                                  const MemoryId& entity, std::optional<Time> time,
                                  const std::stop_token& stop) {
  if (!entity.is_entity())
    return invalid_argument("'{}': needs an entity or a snapshot of one", entity.printable());
  ENGRAM_ASSIGN_OR_RETURN(const auto entries, entries_of(past.store(), entity));
  if (entries.empty()) return not_found("'{}': has no snapshots", entity.printable());
  const Time asked = time.value_or(entries.back().time);
  const auto entry = std::ranges::lower_bound(entries, asked, {}, &SnapshotEntry::time);
  if (entry == entries.end() || entry->time != asked)
    return not_found("'{}': has no snapshot at {}; 'engram query' finds the nearest one",
                     entity.printable(), to_string(asked));
  ENGRAM_ASSIGN_OR_RETURN(const MemberUnits units,
                          measure_units(past, entities_beside(past.store(), entity),
                                        [&stop] { return stop.stop_requested(); }));
  if (stop.stop_requested()) return cancelled("'{}': explaining it", entity.printable());
  EntitySaliency saliency = stored_saliency_of(past.store(), entity).known_rows();
  const bool is_stored = saliency.find(asked).has_value();
  if (!is_stored) {
    ENGRAM_ASSIGN_OR_RETURN(saliency, calculate(past, entity, entries, units, stop));
    saliency = saliency.known_rows();
  }
  const auto row = saliency.find(asked);
  if (!row) return failed_precondition("'{}': is damaged", entity.at(asked).printable());
  Explaining explaining(past, accesses, entries, saliency);
  ENGRAM_ASSIGN_OR_RETURN(SalientMoment told,
                          explaining.run(static_cast<size_t>(entry - entries.begin()), *row, units,
                                         stored_weights(past.store().path())));
  told.is_stored = is_stored;
  return told;
}

Result<SalientMoment> why_salient(const std::filesystem::path& store, const ModelLoader& loader,
                                  const MemoryId& entity, std::optional<Time> time,
                                  const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const auto past, StorePast::open(store, loader, {}));
  return why_salient(*past, read_accesses(store), entity, time, stop);
}

}  // namespace engram::ltm
