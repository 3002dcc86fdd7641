// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/nearest_moments.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace engram::ltm {

namespace {

/// Max moments that are sorted at first; eight times as many each time that they are not enough.
constexpr size_t kFirstSorted = 4096;
constexpr size_t kMoreSorted = 8;

/// Chooses moments one after the other.
class Choice {
 public:
  Choice(const CodedMoments& coded, const SimilarRequest& request)
      : coded_(coded), request_(request), is_used_(coded.recordings.size(), false) {}

  /// Leaves out what lies around the moment that was asked with.
  void leave_out(size_t moment) {
    taken_.insert(coded_.times[moment]);
    if (request_.is_elsewhere) is_used_[coded_.recording_of(moment)] = true;
  }

  /// Takes a moment, unless it is too near to one that was taken.
  void take(size_t at, float square) {
    const size_t number = coded_.recording_of(at);
    if (is_used_[number] || !is_free(coded_.times[at])) return;
    const Sequence& recording = coded_.recordings[number];
    taken_.insert(coded_.times[at]);
    is_used_[number] = request_.is_one_per_recording;
    moments.push_back({coded_.times[at], std::sqrt(static_cast<double>(square)),
                       coded_.times[recording.first], coded_.times[recording.end - 1]});
  }

  [[nodiscard]] bool is_full() const { return moments.size() >= request_.count; }

  std::vector<SimilarMoment> moments;

 private:
  /// Whether the nearest in time of those that were taken is far enough away.
  [[nodiscard]] bool is_free(Time time) const {
    const auto next = taken_.lower_bound(time);
    if (next != taken_.end() && (*next == time || *next - time < request_.apart)) return false;
    return next == taken_.begin() || time - *std::prev(next) >= request_.apart;
  }

  const CodedMoments& coded_;
  const SimilarRequest& request_;
  std::set<Time> taken_;
  std::vector<bool> is_used_;  ///< Recordings that may not be answered any more.
};

/// A square that about `count` others are below, by an even sample of all.
float square_of_rank(std::span<const float> squares, size_t count) {
  constexpr size_t kSample = 1 << 14;
  if (count >= squares.size()) return kNeverNear;
  const size_t step = std::max<size_t>(squares.size() / kSample, 1);
  std::vector<float> sample;
  for (size_t i = 0; i < squares.size(); i += step) sample.push_back(squares[i]);
  const size_t rank = std::min(count / step + 1, sample.size() - 1);
  std::ranges::nth_element(sample, sample.begin() + static_cast<std::ptrdiff_t>(rank));
  return sample[rank];
}

}  // namespace

std::vector<SimilarMoment> nearest_moments(const CodedMoments& coded,
                                           std::span<const float> squares,
                                           const SimilarRequest& request,
                                           std::optional<size_t> asked) {
  Choice choice(coded, request);
  if (asked) choice.leave_out(*asked);
  // Sorting all of ten million takes seconds, and the nearest few thousand nearly always do.
  size_t count = std::max(kFirstSorted, kMoreSorted * std::min(request.count, squares.size()));
  for (float above = -1; !choice.is_full(); count *= kMoreSorted) {
    const float below = square_of_rank(squares, count);
    std::vector<size_t> some;
    for (size_t i = 0; i < squares.size(); ++i)
      if (squares[i] > above && squares[i] <= below && squares[i] != kNeverNear) some.push_back(i);
    std::ranges::sort(some, [&squares](size_t a, size_t b) {
      return squares[a] != squares[b] ? squares[a] < squares[b] : a < b;
    });
    for (const size_t at : some) {
      if (choice.is_full()) break;
      choice.take(at, squares[at]);
    }
    if (below == kNeverNear) break;
    above = std::max(above, below);
  }
  return std::move(choice.moments);
}

}  // namespace engram::ltm
