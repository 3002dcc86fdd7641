// SPDX-License-Identifier: Apache-2.0
#include "viewer/sampled_series.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "viewer/shown_value.h"

namespace engram::viewer {

namespace {

constexpr size_t kFirstPass = 64;

/// Snapshots whose recorded form is gone are decoded, so many at once.
constexpr size_t kDecodedAtOnce = 32;

/// A server is asked for so many moments in one query.
constexpr size_t kAskedMoments = 500;

/// Draws values as they come, in any order.
class SeriesDrawing {
 public:
  explicit SeriesDrawing(const SeriesRequest& request)
      : request_(request), last_times_(request.bins.count(), Time::min()) {
    const std::vector<float> empty(request.bins.count(), std::numeric_limits<float>::quiet_NaN());
    answer.series.assign(request.paths.size(), {empty, empty, empty});
    for (size_t i = 0; i <= request.bins.count(); ++i) begins_.push_back(request.bins.begin(i));
  }

  void add(Time time, const idf::Data& value) {
    ++answer.read;
    const auto after = std::ranges::upper_bound(begins_, time);
    if (after == begins_.begin() || after == begins_.end()) return;
    const auto bin = static_cast<size_t>(after - begins_.begin()) - 1;
    const bool is_last = time >= last_times_[bin];
    if (is_last) last_times_[bin] = time;
    for (size_t i = 0; i < request_.paths.size(); ++i) {
      const auto number = static_cast<float>(number_at(value, request_.paths[i]));
      DrawnSeries& drawn = answer.series[i];
      // A NaN that was read replaces nothing, and what was not read is a NaN.
      drawn.min[bin] = std::fmin(drawn.min[bin], number);
      drawn.max[bin] = std::fmax(drawn.max[bin], number);
      if (is_last) drawn.last[bin] = number;
    }
  }

  SeriesAnswer answer;

 private:
  const SeriesRequest& request_;
  std::vector<Time> begins_;
  std::vector<Time> last_times_;
};

/// Adds the instance that is asked for of each snapshot of an answer.
void add_answer(const ltm::QueryResult& found, const SeriesRequest& request,
                SeriesDrawing& drawing) {
  for (const ltm::EntityResult* entity : found.entities())
    for (const ltm::SnapshotResult& snapshot : entity->snapshots)
      if (const auto* instance = snapshot.find(static_cast<int32_t>(request.instance)))
        drawing.add(snapshot.time, instance->data);
}

Status draw_decoded(ViewedMemory& viewed, const SeriesRequest& request,
                    const std::vector<Time>& times, SteadyTime deadline, SeriesDrawing& drawing) {
  for (size_t i = 0; i < times.size() && steady_now() < deadline; i += kDecodedAtOnce) {
    std::vector<ltm::Selector> selectors;
    for (size_t k = i; k < std::min(times.size(), i + kDecodedAtOnce); ++k)
      selectors.push_back(ltm::select::Before{times[k], true});
    ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::of_entity(request.entity, selectors));
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, viewed.memory().query(query));
    add_answer(found, request, drawing);
  }
  return {};
}

/// Draws what can be read without decoding anything; `encoded` gets the times of all else.
Status draw_recorded(ViewedMemory& viewed, const StoreView& view, const SeriesRequest& request,
                     SteadyTime deadline, SeriesDrawing& drawing, std::vector<Time>& encoded) {
  ENGRAM_ASSIGN_OR_RETURN(const auto times, viewed.times(view, request.entity));
  ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, view.reader.timeline(request.entity));
  const auto begin = std::ranges::lower_bound(times->all, request.bins.begin(0));
  const auto end = std::ranges::lower_bound(times->all, request.bins.begin(request.bins.count()));
  const auto count = static_cast<size_t>(end - begin);
  drawing.answer.total = count;
  Status status;
  visit_coarse_first(count, kFirstPass, [&](size_t i) {
    const Time time = begin[static_cast<ptrdiff_t>(i)];
    const auto read = [&]() -> Status {
      ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(time));
      if (!entry || !entry->recorded) {
        encoded.push_back(time);
        return {};
      }
      ENGRAM_ASSIGN_OR_RETURN(const auto packed, view.reader.read_values(request.entity, *entry));
      if (request.instance < packed.instances.size())
        drawing.add(time, packed.instances[request.instance].value.rest);
      return {};
    };
    status = read();
    return status.ok() && steady_now() < deadline;
  });
  return status;
}

}  // namespace

Result<SeriesAnswer> sample_series(ViewedMemory& viewed, const SeriesRequest& request) {
  const SteadyTime deadline = steady_now() + request.budget;
  if (viewed.is_store()) {
    std::optional<SeriesDrawing> drawing;
    std::vector<Time> encoded;
    ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) {
      drawing.emplace(request);
      encoded.clear();
      return draw_recorded(viewed, view, request, deadline, *drawing, encoded);
    }));
    ENGRAM_RETURN_IF_ERROR(draw_decoded(viewed, request, encoded, deadline, *drawing));
    return std::move(drawing->answer);
  }
  SeriesDrawing drawing(request);
  // One query, of the last moments of evenly spread parts: how many there are nobody tells.
  std::vector<ltm::Selector> selectors;
  const size_t count = std::min(request.bins.count(), kAskedMoments);
  for (size_t i = 1; i <= count; ++i)
    selectors.push_back(
        ltm::select::Before{request.bins.begin(i * request.bins.count() / count), false});
  ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::of_entity(request.entity, selectors));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, viewed.memory().query(query));
  add_answer(found, request, drawing);
  drawing.answer.total = drawing.answer.read;
  return std::move(drawing.answer);
}

}  // namespace engram::viewer
