// SPDX-License-Identifier: Apache-2.0
#include "training/fit/row_rotation.h"

#include <algorithm>
#include <random>

#include "training/fit/load_dataset.h"
#include "training/fit/scenes.h"

namespace engram::training {

namespace {

/// Steps after which a run makes room for another. Eight rows of a step and 32 of a run mean that a
/// row is drawn once on average before it goes.
constexpr int64_t kStepsOfSwap = 4;

}  // namespace

RowRotation::RowRotation(const TrainingSource& source, Dataset& data, uint64_t seed)
    : source_(source), data_(data), in_place_(data.source_rows) {
  if (data.left_out_runs.empty()) return;
  for (size_t i = 0; i < data.sequences.size(); ++i)
    if (data.first_held_out[i] == data.sequences[i].end)
      places_[kind_of(data.source_rows[i])].push_back(i);
  std::vector<Sequence> runs;
  for (const Sequence& run : data.left_out_runs)
    if (places_.contains(kind_of(run))) runs.push_back(run);
  std::mt19937_64 random(seed);
  std::ranges::shuffle(runs, random);
  waiting_.assign(runs.begin(), runs.end());
}

// Known rows weigh less (RowSampler), so that a known run takes the place of a known one. A run
// that is partly known counts as what its first row is, as it does for backgrounds.
RowRotation::Kind RowRotation::kind_of(const Sequence& run) const {
  return {run.size(), !source_.is_known.empty() && source_.is_known[run.first]};
}

RowRotation::Swap RowRotation::next_swap() {
  const Sequence run = waiting_.front();
  waiting_.pop_front();
  std::deque<size_t>& places = places_.at(kind_of(run));
  const size_t place = places.front();
  places.pop_front();
  places.push_back(place);
  waiting_.push_back(std::exchange(in_place_[place], run));
  return {place, run};
}

void RowRotation::read_next() {
  const Swap swap = next_swap();
  ahead_ = Ahead{swap, std::async(std::launch::async, [this, run = swap.run] {
                   return read_rows(source_, data_, run);
                 })};
}

void RowRotation::put(const Swap& swap, const DatasetRows& rows) {
  data_.replace(swap.place, rows);
  const Sequence& place = data_.sequences[swap.place];
  if (!data_.backgrounds.empty())
    data_.scene.slice(0, static_cast<int64_t>(place.first), static_cast<int64_t>(place.end))
        .fill_(nearest_scene(data_, place));
  data_.source_rows[swap.place] = swap.run;
}

Status RowRotation::catch_up(int64_t swaps) {
  for (; done_ < swaps; ++done_) next_swap();
  for (size_t i = 0; i < in_place_.size(); ++i) {
    if (in_place_[i] == data_.source_rows[i]) continue;
    ENGRAM_ASSIGN_OR_RETURN(const DatasetRows rows, read_rows(source_, data_, in_place_[i]));
    put({i, in_place_[i]}, rows);
  }
  return {};
}

Status RowRotation::advance(int64_t step, RowSampler& sampler) {
  if (waiting_.empty()) return {};
  const int64_t due = step / kStepsOfSwap;
  if (!has_begun_) {
    ENGRAM_RETURN_IF_ERROR(catch_up(due));
    has_begun_ = true;
    read_next();
  }
  for (; done_ < due; ++done_) {
    const Swap swap = ahead_->swap;
    const Result<DatasetRows> rows = ahead_->rows.get();
    if (!rows.ok()) {
      waiting_.clear();
      return rows.status();
    }
    put(swap, *rows);
    sampler.forget(data_.sequences[swap.place]);
    read_next();
  }
  return {};
}

}  // namespace engram::training
