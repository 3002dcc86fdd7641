// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/prediction_scores.h"

#include <cmath>
#include <map>

#include "ltm/idf/binary.h"
#include "ltm/memory/score_id.h"
#include "memory/replay/prediction_error.h"

namespace engram::memory {

namespace {

idf::Data number_or_none(double number) {
  return std::isnan(number) ? idf::Data() : idf::Data(number);
}

idf::Data error_data(const ltm::MeasuredError& error) {
  return idf::Dict{{"image_mse", number_or_none(error.image_mse)},
                   {"number_mse", number_or_none(error.number_mse)}};
}

/// True unless both are known and the error is larger.
bool keeps(double error, double bound) {
  return std::isnan(error) || std::isnan(bound) || error <= bound;
}

/// What a prediction takes while it waits. Unit: bytes.
size_t bytes_of(const ltm::SnapshotResult& predicted) {
  size_t bytes = sizeof(predicted);
  for (const ltm::InstanceResult& instance : predicted.instances)
    bytes += sizeof(instance) + idf::encoded_size(instance.data);
  return bytes;
}

}  // namespace

bool PredictionScore::has_bound() const {
  const auto is_known = [](double told, double was) { return !std::isnan(told + was); };
  return is_known(bound.image_mse, error.image_mse) || is_known(bound.number_mse, error.number_mse);
}

bool PredictionScore::is_within_bound() const {
  return keeps(error.image_mse, bound.image_mse) && keeps(error.number_mse, bound.number_mse);
}

idf::Data PredictionScore::to_data() const {
  return idf::Dict{{"instance", instance},
                   {"time", to_ns(time)},
                   {"came", to_ns(came)},
                   {"horizon", horizon.count()},
                   {"engine", engine},
                   {"model", model},
                   {"error", error_data(error)},
                   {"expected", error_data(expected)},
                   {"bound", error_data(bound)},
                   {"is_within_bound", has_bound() ? idf::Data(is_within_bound()) : idf::Data()}};
}

ltm::Commit commit_of(const std::vector<PredictionScore>& scores, Time now) {
  std::map<ltm::MemoryId, ltm::Snapshot> updates;
  for (const PredictionScore& score : scores) {
    const ltm::MemoryId entity = ltm::score_id(score.entity);
    const auto update = updates.try_emplace(entity, ltm::Snapshot{entity, now, {}}).first;
    update->second.instances.push_back(
        {score.to_data(), {.created = now, .sent = now, .provider = "engram"}});
  }
  ltm::Commit commit;
  for (auto& [entity, update] : updates) commit.updates.push_back(std::move(update));
  return commit;
}

void PredictionScores::add(const ltm::Answer& answer) {
  for (const ltm::RecalledEntity& entity : answer.entities)
    for (const ltm::RecalledSnapshot& snapshot : entity.snapshots) {
      if (snapshot.answer.source != ltm::Source::kPredicted) continue;
      const size_t bytes = bytes_of(snapshot.answer);
      const MutexLock lock(mutex_);
      waiting_.push_back({entity.id, snapshot.answer, bytes});
      waiting_bytes_ += bytes;
      keep_bounds();
    }
}

void PredictionScores::keep_bounds() {
  while (waiting_.size() > kMaxWaiting || waiting_bytes_ > kMaxWaitingBytes) {
    unscored_ += waiting_.front().predicted.instances.size();
    waiting_bytes_ -= waiting_.front().bytes;
    waiting_.pop_front();
  }
}

std::deque<PredictionScores::Waiting> PredictionScores::take_if(
    const std::function<bool(const ltm::SnapshotResult&)>& is_taken) {
  std::deque<Waiting> taken;
  std::erase_if(waiting_, [&](Waiting& one) ENGRAM_REQUIRES(mutex_) {
    if (!is_taken(one.predicted)) return false;
    waiting_bytes_ -= one.bytes;
    taken.push_back(std::move(one));
    return true;
  });
  return taken;
}

void PredictionScores::rewind(Time now) {
  const MutexLock lock(mutex_);
  take_if([now](const auto& predicted) { return predicted.time - predicted.horizon > now; });
}

std::vector<PredictionScore> PredictionScores::compare(Time now, ltm::KnownPast& past) {
  std::deque<Waiting> due;
  {
    const MutexLock lock(mutex_);
    due = take_if([now](const auto& predicted) { return predicted.time <= now; });
  }
  std::vector<PredictionScore> scores;
  if (due.empty()) return scores;
  uint64_t given_up = 0;
  bool is_renewed = false;
  std::erase_if(due, [&](const Waiting& one) {
    Outcome outcome = compare_one(one, past, scores);
    if (outcome == Outcome::kOutdated && !is_renewed) {
      is_renewed = true;
      if (past.renew().ok()) outcome = compare_one(one, past, scores);
    }
    if (outcome == Outcome::kCompared) return true;
    const bool waits = outcome != Outcome::kGivenUp && now - one.predicted.time <= kMaxWait;
    if (!waits) given_up += one.predicted.instances.size();
    return !waits;
  });
  const MutexLock lock(mutex_);
  unscored_ += given_up;
  for (const Waiting& one : due) waiting_bytes_ += one.bytes;
  waiting_.insert(waiting_.begin(), std::make_move_iterator(due.begin()),
                  std::make_move_iterator(due.end()));
  keep_bounds();
  return scores;
}

PredictionScores::Outcome PredictionScores::compare_one(const Waiting& one, ltm::KnownPast& past,
                                                        std::vector<PredictionScore>& scores) {
  const Time moment = one.predicted.time;
  const auto is_outdated = [](const auto& result) {
    return result.status().code() == StatusCode::kUnavailable;
  };
  const auto known = past.of(one.entity);
  if (is_outdated(known)) return Outcome::kOutdated;
  if (!known.ok() || !*known) return Outcome::kWaits;
  const auto after = (*known)->at_or_after(moment);
  if (is_outdated(after)) return Outcome::kOutdated;
  if (!after.ok() || !*after) return Outcome::kWaits;
  Time came = **after;
  if (const auto before = (*known)->at_or_before(moment);
      before.ok() && *before && moment - **before < came - moment)
    came = **before;
  // What it started from is no truth of what came.
  const Duration away = came < moment ? moment - came : came - moment;
  if (away * 2 > one.predicted.horizon) return Outcome::kGivenUp;
  const auto truth = (*known)->read(came, ltm::Prefer::kRecorded);
  if (is_outdated(truth)) return Outcome::kOutdated;
  if (!truth.ok()) return Outcome::kGivenUp;
  size_t compared = 0;
  for (const ltm::InstanceResult& told : one.predicted.instances) {
    const ltm::InstanceResult* is = truth->answer.find(told.index);
    if (is == nullptr) continue;
    const auto error = prediction_error(told.data, is->data, past.type_of(one.entity));
    if (!error.ok()) continue;
    ++compared;
    scores.push_back({one.entity, told.index, moment, came, one.predicted.horizon,
                      one.predicted.predictor, one.predicted.model, *error,
                      told.error.value_or(ltm::MeasuredError()),
                      told.bound.value_or(ltm::MeasuredError())});
  }
  return compared > 0 ? Outcome::kCompared : Outcome::kGivenUp;
}

bool PredictionScores::has_waiting() const {
  const MutexLock lock(mutex_);
  return !waiting_.empty();
}

uint64_t PredictionScores::unscored() const {
  const MutexLock lock(mutex_);
  return unscored_;
}

}  // namespace engram::memory
