// SPDX-License-Identifier: Apache-2.0
#include "viewer/sampled_series.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "reports/plain/shown_value.h"

namespace engram::viewer {

namespace {

constexpr size_t kFirstPass = 64;

/// Snapshots whose recorded form is gone are decoded, so many at once.
constexpr size_t kDecodedAtOnce = 32;

/// A server is asked for so many moments in one query.
constexpr size_t kAskedMoments = 500;

/// The bins of a request as places in a column: bin i begins at [i].
std::vector<size_t> bin_begins(const std::vector<Time>& times, const ltm::TimeBins& bins,
                               size_t stride) {
  std::vector<size_t> begins;
  begins.reserve(bins.count() + 1);
  auto from = times.begin();
  for (size_t i = 0; i <= bins.count(); ++i) {
    from = std::lower_bound(from, times.end(), bins.begin(i));
    begins.push_back((static_cast<size_t>(from - times.begin()) + stride - 1) / stride);
  }
  return begins;
}

DrawnSeries empty_series(size_t bins) {
  const std::vector<float> empty(bins, std::numeric_limits<float>::quiet_NaN());
  return {empty, empty, empty};
}

/// Draws what is known of a column, and adds how many numbers that is to `read`.
DrawnSeries draw_column(const NumberColumn& column, const std::vector<size_t>& begins,
                        uint64_t& read) {
  DrawnSeries drawn = empty_series(begins.size() - 1);
  for (size_t bin = 0; bin + 1 < begins.size(); ++bin) {
    float min = std::numeric_limits<float>::infinity();
    float max = -min;
    bool has_any = false;
    for (size_t i = begins[bin]; i < begins[bin + 1]; ++i) {
      if (!column.was_read(i)) continue;
      ++read;
      const float number = column.at(i);
      drawn.last[bin] = number;
      // A NaN is neither.
      if (number <= min) min = number;
      if (number >= max) max = number;
      has_any |= !std::isnan(number);
    }
    if (!has_any) continue;
    drawn.min[bin] = min;
    drawn.max[bin] = max;
  }
  return drawn;
}

/// Reads what the columns of a request lack, coarse first.
class SeriesReading {
 public:
  SeriesReading(const SeriesRequest& request, KeptNumbers& kept, SteadyTime deadline)
      : request_(request), kept_(kept), deadline_(deadline) {
    columns_ = kept.columns(request.instance, request.paths);
    stride_ = columns_.front()->stride();
    begins_ = bin_begins(kept.times().all, request.bins, stride_);
  }

  /// Reads what needs no decoding.
  Status read_recorded(const StoreView& view) {
    ENGRAM_ASSIGN_OR_RETURN(ltm::Timeline * timeline, view.reader.timeline(request_.entity));
    const size_t first = begins_.front();
    Status status;
    visit_missing([&](size_t i) {
      const auto read = [&]() -> Status {
        const Time time = kept_.times().all[(first + i) * stride_];
        ENGRAM_ASSIGN_OR_RETURN(const auto entry, timeline->at_or_after(time));
        if (!entry || entry->time != time || !entry->recorded) {
          encoded_.push_back(first + i);
          return {};
        }
        ENGRAM_ASSIGN_OR_RETURN(const auto packed,
                                view.reader.read_values(request_.entity, *entry));
        put(first + i, request_.instance < packed.instances.size()
                           ? &packed.instances[request_.instance].value.rest
                           : nullptr);
        return {};
      };
      status = read();
      return status.ok() && steady_now() < deadline_;
    });
    return status;
  }

  /// Reads the others, whose recorded form is gone.
  Status read_decoded(ViewedMemory& viewed) {
    const std::vector<Time>& times = kept_.times().all;
    for (size_t i = 0; i < encoded_.size() && steady_now() < deadline_; i += kDecodedAtOnce) {
      const std::span<const size_t> some =
          std::span(encoded_).subspan(i, std::min(kDecodedAtOnce, encoded_.size() - i));
      std::vector<ltm::Selector> selectors;
      for (const size_t place : some)
        selectors.push_back(ltm::select::Before{times[place * stride_], true});
      ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::of_entity(request_.entity, selectors));
      ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, viewed.memory().query(query));
      for (const ltm::EntityResult* entity : found.entities())
        for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
          const auto at = std::ranges::lower_bound(times, snapshot.time);
          if (at == times.end() || *at != snapshot.time) continue;
          const auto* instance = snapshot.find(static_cast<int32_t>(request_.instance));
          put(static_cast<size_t>(at - times.begin()) / stride_,
              instance == nullptr ? nullptr : &instance->data);
        }
    }
    return {};
  }

  [[nodiscard]] SeriesAnswer draw() const {
    SeriesAnswer answer;
    const std::vector<Time>& times = kept_.times().all;
    const auto begin = std::ranges::lower_bound(times, request_.bins.begin(0));
    const auto end = std::ranges::lower_bound(times, request_.bins.begin(request_.bins.count()));
    answer.total = static_cast<uint64_t>(end - begin);
    answer.read = answer.total;
    for (const auto& column : columns_) {
      uint64_t read = 0;
      answer.series.push_back(draw_column(*column, begins_, read));
      answer.read = std::min(answer.read, read);
    }
    return answer;
  }

 private:
  /// Visits the places of the span that a column lacks; `visit` returns false to end it.
  template <typename Visit>
  void visit_missing(const Visit& visit) {
    if (std::ranges::all_of(columns_, [](const auto& column) { return column->is_whole(); }))
      return;
    const size_t first = begins_.front();
    visit_coarse_first(begins_.back() - first, kFirstPass, [&](size_t i) {
      const bool is_known = std::ranges::all_of(
          columns_, [&](const auto& column) { return column->was_read(first + i); });
      return is_known || visit(i);
    });
  }

  /// `value` is null where there is none.
  void put(size_t place, const idf::Data* value) {
    for (size_t i = 0; i < columns_.size(); ++i)
      columns_[i]->put(place, value == nullptr ? std::numeric_limits<float>::quiet_NaN()
                                               : static_cast<float>(reports::number_at(
                                                     *value, request_.paths[i])));
  }

  const SeriesRequest& request_;
  KeptNumbers& kept_;
  const SteadyTime deadline_;
  std::vector<std::shared_ptr<NumberColumn>> columns_;  ///< One per path, never empty.
  size_t stride_ = 1;
  std::vector<size_t> begins_;   ///< Places in a column.
  std::vector<size_t> encoded_;  ///< Likewise, of those that have to be decoded.
};

/// Draws the values of an answer of a server, in any order.
void draw_answer(const ltm::QueryResult& found, const SeriesRequest& request,
                 SeriesAnswer& answer) {
  std::vector<Time> begins;
  for (size_t i = 0; i <= request.bins.count(); ++i) begins.push_back(request.bins.begin(i));
  std::vector<Time> last_times(request.bins.count(), Time::min());
  answer.series.assign(request.paths.size(), empty_series(request.bins.count()));
  for (const ltm::EntityResult* entity : found.entities())
    for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
      const auto* instance = snapshot.find(static_cast<int32_t>(request.instance));
      if (instance == nullptr) continue;
      ++answer.read;
      const auto after = std::ranges::upper_bound(begins, snapshot.time);
      if (after == begins.begin() || after == begins.end()) continue;
      const auto bin = static_cast<size_t>(after - begins.begin()) - 1;
      const bool is_last = snapshot.time >= last_times[bin];
      if (is_last) last_times[bin] = snapshot.time;
      for (size_t i = 0; i < request.paths.size(); ++i) {
        const auto number =
            static_cast<float>(reports::number_at(instance->data, request.paths[i]));
        DrawnSeries& drawn = answer.series[i];
        // A NaN that was read replaces nothing, and what was not read is a NaN.
        drawn.min[bin] = std::fmin(drawn.min[bin], number);
        drawn.max[bin] = std::fmax(drawn.max[bin], number);
        if (is_last) drawn.last[bin] = number;
      }
    }
  answer.total = answer.read;
}

}  // namespace

Result<SeriesAnswer> sample_series(ViewedMemory& viewed, const SeriesRequest& request) {
  const SteadyTime deadline = steady_now() + request.budget;
  if (viewed.is_store()) {
    std::shared_ptr<KeptNumbers> kept;
    std::optional<SeriesReading> reading;
    ENGRAM_RETURN_IF_ERROR(viewed.with_store([&](const StoreView& view) -> Status {
      reading.reset();
      ENGRAM_ASSIGN_OR_RETURN(kept, viewed.numbers(view, request.entity));
      return reading.emplace(request, *kept, deadline).read_recorded(view);
    }));
    ENGRAM_RETURN_IF_ERROR(reading->read_decoded(viewed));
    return reading->draw();
  }
  // One query, of the last moments of evenly spread parts: how many there are nobody tells.
  std::vector<ltm::Selector> selectors;
  const size_t count = std::min(request.bins.count(), kAskedMoments);
  for (size_t i = 1; i <= count; ++i)
    selectors.push_back(
        ltm::select::Before{request.bins.begin(i * request.bins.count() / count), false});
  ENGRAM_ASSIGN_OR_RETURN(const auto query, ltm::Query::of_entity(request.entity, selectors));
  ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, viewed.memory().query(query));
  SeriesAnswer answer;
  draw_answer(found, request, answer);
  return answer;
}

}  // namespace engram::viewer
