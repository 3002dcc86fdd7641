// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/member_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "ltm/core/check.h"

namespace engram::ltm {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double known_or_infinite(const MemberRecord& record) {
  return record.predictions > 0 && !std::isnan(record.mean) ? record.mean : kInfinity;
}

/// The kind of moments whose records decide about one member.
enum class Moments { kAtRest, kMoving, kEverMoving, kNone };

const MemberRecord& record_of(const MotionRecords& records, Moments moments) {
  static const MemberRecord kNothing;
  switch (moments) {
    case Moments::kAtRest:
      return records.at_rest;
    case Moments::kMoving:
      return records.moving;
    case Moments::kEverMoving:
      return records.ever_moving;
    case Moments::kNone:
      break;
  }
  return kNothing;
}

/// Selects what decides about one member: the records of one kind of moments, or none.
class MemberCase {
 public:
  MemberCase(const std::vector<MemberCandidate>& candidates, size_t member, bool is_moving)
      : candidates_(candidates), member_(member) {
    const Moments here = is_moving ? Moments::kMoving : Moments::kAtRest;
    const Moments elsewhere = is_moving ? Moments::kAtRest : Moments::kMoving;
    if (count(here) >= kMinMoments || count(elsewhere) == 0)
      moments_ = here;
    else if (count(Moments::kEverMoving) >= kMinMoments)
      moments_ = Moments::kEverMoving;
    else if (!is_moving)
      // Its movements say more than a few moments of rest, and their bound is the wider one.
      moments_ = count(Moments::kMoving) > count(here) ? Moments::kMoving : here;
    else
      is_unknown_movement_ = true;
  }

  [[nodiscard]] const MemberRecord& record(size_t candidate) const {
    return record_of(candidates_[candidate].members[member_], moments_);
  }
  [[nodiscard]] Moments moments() const { return moments_; }
  /// True if the member moves now but moved too rarely in the past for any record.
  [[nodiscard]] bool is_unknown_movement() const { return is_unknown_movement_; }
  [[nodiscard]] bool is_known() const { return count(moments_) > 0; }

  /// The candidate with the smallest error; the first of equal ones.
  [[nodiscard]] size_t best() const {
    size_t best = 0;
    for (size_t i = 1; i < candidates_.size(); ++i)
      if (known_or_infinite(record(i)) < known_or_infinite(record(best))) best = i;
    return best;
  }

 private:
  [[nodiscard]] size_t count(Moments moments) const {
    size_t max = 0;
    for (const MemberCandidate& candidate : candidates_)
      max = std::max(max, record_of(candidate.members[member_], moments).predictions);
    return max;
  }

  const std::vector<MemberCandidate>& candidates_;
  size_t member_;
  Moments moments_ = Moments::kNone;
  bool is_unknown_movement_ = false;
};

/// The candidate with the smallest error over all members that one kind of moments decides about.
/// Each error counts relative to that of a copy, because members have different units.
std::optional<size_t> best_for_all(size_t candidates, const std::vector<MemberCase>& cases,
                                   Moments moments) {
  std::optional<size_t> best;
  double best_score = kInfinity;
  for (size_t i = 0; i < candidates; ++i) {
    double score = 0;
    size_t counted = 0;
    for (const MemberCase& one : cases) {
      const double copy = known_or_infinite(one.record(0));
      if (one.moments() != moments || !(copy > 0) || std::isinf(copy)) continue;
      score += known_or_infinite(one.record(i)) / copy;
      ++counted;
    }
    if (counted == 0 || !(score < best_score)) continue;
    best = i;
    best_score = score;
  }
  return best;
}

size_t place_of(const std::vector<MemberCandidate>& candidates, std::string_view engine) {
  const auto found = std::ranges::find(candidates, engine, &MemberCandidate::engine);
  return found == candidates.end() ? 0 : static_cast<size_t>(found - candidates.begin());
}

MemberChoice chosen(const std::vector<MemberCandidate>& candidates, const MemberCase& one,
                    std::optional<size_t> common) {
  if (one.is_unknown_movement()) return {place_of(candidates, "constant-velocity"), {}};
  if (!one.is_known()) return {};
  size_t choice = common.value_or(0);
  if (!(known_or_infinite(one.record(choice)) < known_or_infinite(one.record(0)))) choice = 0;
  const size_t best = one.best();
  if (known_or_infinite(one.record(best)) <= kClearGain * known_or_infinite(one.record(choice)))
    choice = best;
  return {choice, one.record(choice)};
}

}  // namespace

bool MemberCandidate::is_measured() const {
  return std::ranges::any_of(members, [](const MotionRecords& records) {
    return records.at_rest.predictions + records.moving.predictions > 0;
  });
}

std::vector<MemberChoice> choose_members(const std::vector<MemberCandidate>& candidates,
                                         const ValueRow& rows, const std::vector<bool>& is_moving) {
  ENGRAM_CHECK(!candidates.empty() && candidates.front().engine == kCopyLast,
               "found {} candidates, needs a copy first", candidates.size());
  std::vector<MemberChoice> choices(rows.layout().members().size());
  if (std::ranges::none_of(candidates, &MemberCandidate::is_measured)) {
    // Before anything can be measured, a model answers: it was trained on earlier data.
    const auto model = std::ranges::find_if(
        candidates, [](const MemberCandidate& one) { return one.model != nullptr; });
    if (model != candidates.end())
      for (MemberChoice& choice : choices)
        choice.candidate = static_cast<size_t>(model - candidates.begin());
    return choices;
  }
  std::vector<MemberCase> cases;
  for (const RowMember& member : rows.row_members())
    if (!member.is_copied) cases.emplace_back(candidates, member.member, is_moving[member.member]);
  std::map<Moments, std::optional<size_t>> common;
  for (const Moments moments : {Moments::kAtRest, Moments::kMoving, Moments::kEverMoving})
    common[moments] = best_for_all(candidates.size(), cases, moments);
  size_t next = 0;
  for (const RowMember& member : rows.row_members()) {
    if (member.is_copied) continue;
    const MemberCase& one = cases[next++];
    choices[member.member] = chosen(candidates, one, common[one.moments()]);
  }
  for (const size_t member : rows.other_members()) {
    const MemberCase one(candidates, member, false);
    const size_t best = one.best();
    choices[member] = {best, one.record(best)};
  }
  return choices;
}

std::vector<MemberChoice> named_members(const std::vector<MemberCandidate>& candidates,
                                        const ValueRow& rows, const std::vector<bool>& is_moving) {
  std::vector<MemberChoice> choices(rows.layout().members().size());
  const size_t named = candidates.size() - 1;
  for (const RowMember& member : rows.row_members()) {
    if (member.is_copied) continue;
    const MemberCase one(candidates, member.member, is_moving[member.member]);
    choices[member.member] = {named,
                              one.is_unknown_movement() ? MemberRecord{} : one.record(named)};
  }
  for (const size_t member : rows.other_members()) {
    const size_t used = candidates[named].model != nullptr ? named : 0;
    choices[member] = {used, MemberCase(candidates, member, false).record(used)};
  }
  return choices;
}

}  // namespace engram::ltm
