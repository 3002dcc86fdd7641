// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/prediction_scores.h"

#include <cmath>

#include "ltm/core/log.h"
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

void PredictionScores::add(const ltm::Answer& answer) {
  for (const ltm::RecalledEntity& entity : answer.entities)
    for (const ltm::RecalledSnapshot& snapshot : entity.snapshots) {
      if (snapshot.answer.source != ltm::Source::kPredicted) continue;
      const MutexLock lock(mutex_);
      waiting_.push_back({entity.id, snapshot.answer});
      if (waiting_.size() <= kMaxWaiting) continue;
      unscored_ += waiting_.front().predicted.instances.size();
      waiting_.pop_front();
    }
}

void PredictionScores::rewind(Time now) {
  const MutexLock lock(mutex_);
  std::erase_if(waiting_, [now](const Waiting& one) {
    return one.predicted.time - one.predicted.horizon > now;
  });
}

std::vector<PredictionScore> PredictionScores::compare(Time now, ltm::KnownPast& past) {
  std::deque<Waiting> due;
  {
    const MutexLock lock(mutex_);
    std::erase_if(waiting_, [&](Waiting& one) {
      if (one.predicted.time > now) return false;
      due.push_back(std::move(one));
      return true;
    });
  }
  std::vector<PredictionScore> scores;
  if (due.empty()) return scores;
  uint64_t given_up = 0;
  std::erase_if(due, [&](const Waiting& one) {
    const Outcome outcome = compare_one(one, now, past, scores);
    if (outcome == Outcome::kGivenUp) given_up += one.predicted.instances.size();
    return outcome != Outcome::kWaits;
  });
  const MutexLock lock(mutex_);
  unscored_ += given_up;
  waiting_.insert(waiting_.begin(), std::make_move_iterator(due.begin()),
                  std::make_move_iterator(due.end()));
  return scores;
}

PredictionScores::Outcome PredictionScores::compare_one(const Waiting& one, Time now,
                                                        ltm::KnownPast& past,
                                                        std::vector<PredictionScore>& scores) {
  const Time moment = one.predicted.time;
  const auto nothing = now - moment > kMaxWait ? Outcome::kGivenUp : Outcome::kWaits;
  const auto known = past.of(one.entity);
  if (!known.ok() || !*known) return nothing;
  const auto after = (*known)->at_or_after(moment);
  if (!after.ok() || !*after) return nothing;
  Time came = **after;
  if (const auto before = (*known)->at_or_before(moment);
      before.ok() && *before && moment - **before < came - moment)
    came = **before;
  // What it started from is no truth of what came.
  const Duration away = came < moment ? moment - came : came - moment;
  if (away * 2 > one.predicted.horizon) return Outcome::kGivenUp;
  const auto truth = (*known)->read(came, ltm::Prefer::kRecorded);
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
