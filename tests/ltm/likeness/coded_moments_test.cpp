// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/coded_moments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "ltm/likeness/nearest_moments.h"

namespace engram::ltm {
namespace {

/// Codes at 5 Hz, in recordings of a minute an hour apart.
CodedMoments random_moments(size_t count) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> number(-128, 127);
  CodedMoments coded;
  coded.numbers = kCodeSize;
  for (size_t i = 0; i < count; ++i) {
    const auto hours = static_cast<int64_t>(i / 300);
    coded.times.push_back(
        time_from_ns(hours * 3'600'000'000'000 + static_cast<int64_t>(i) * 200'000'000));
    for (size_t j = 0; j < kCodeSize; ++j)
      coded.bytes.push_back(static_cast<int8_t>(number(random)));
  }
  coded.finish();
  return coded;
}

TEST(CodedMoments, ComparesWhatCameBeforeEachMoment) {
  const CodedMoments coded = random_moments(1000);
  ASSERT_EQ(coded.recordings.size(), 4u);
  constexpr size_t kAsked = 310;  // Two seconds into its recording.
  const auto squares = coded.square_distances(kAsked, std::chrono::seconds(2));
  const double unit = coded.spread * coded.spread * kCodeSize * 5;
  for (const size_t i : {0u, 3u, 299u, 300u, 310u, 999u}) {
    const Sequence& recording = coded.recordings[coded.recording_of(i)];
    double sum = 0;
    for (const size_t steps : {0u, 1u, 3u, 5u, 10u}) {
      const size_t before = std::max(recording.first, i - std::min<size_t>(i, steps));
      EXPECT_EQ(coded.before(i, Duration(200'000'000) * static_cast<int64_t>(steps)), before);
      for (size_t j = 0; j < kCodeSize; ++j)
        sum += std::pow(
            coded.bytes[(kAsked - steps) * kCodeSize + j] - coded.bytes[before * kCodeSize + j], 2);
    }
    EXPECT_NEAR(squares[i], sum / unit, 1e-6) << i;
  }
}

TEST(CodedMoments, HasTheDistanceOneAtRandom) {
  const CodedMoments coded = random_moments(3000);
  const auto squares = coded.square_distances(17, Duration::zero());
  double sum = 0;
  for (const float square : squares) sum += square;
  EXPECT_NEAR(sum / 3000, 1, 0.1);
}

TEST(CodedMoments, IsCutAsAWholeWhenMoreCame) {
  const CodedMoments whole = random_moments(203'000);
  for (const size_t sealed : {0u, 2'000u, 100'000u, 201'000u, 202'999u}) {
    CodedMoments grown = whole;
    grown.truncate(sealed);
    grown.finish();
    grown.times = whole.times;
    grown.bytes = whole.bytes;
    grown.finish_from(sealed);
    EXPECT_EQ(grown.recordings, whole.recordings) << sealed;
    EXPECT_NEAR(grown.spread, whole.spread, 0.1 * whole.spread);
    // And back again.
    grown.truncate(sealed);
    grown.finish_from(sealed);
    EXPECT_EQ(grown.recordings.empty() ? 0 : grown.recordings.back().end, sealed);
    EXPECT_EQ(grown.recordings.size(), (sealed + 299) / 300);
  }
}

TEST(NearestMoments, AreThoseOfASortOfAll) {
  const CodedMoments coded = random_moments(20'000);
  const auto squares = coded.square_distances(5'000, Duration::zero());
  std::vector<size_t> order(coded.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&squares](size_t i) { return squares[i]; });
  SimilarRequest request{.moment = coded.times[5'000], .count = 15'000, .apart = Duration::zero()};
  const auto all = nearest_moments(coded, squares, request, 5'000);
  ASSERT_EQ(all.size(), 15'000u);
  // The first one is the moment that was asked with.
  for (size_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i].time, coded.times[order[i + 1]]) << i;
  request.count = 100;
  request.is_one_per_recording = true;
  request.is_elsewhere = true;
  const auto some = nearest_moments(coded, squares, request, 5'000);
  EXPECT_EQ(some.size(), coded.recordings.size() - 1);
  // Nothing is left: no endless search.
  const std::vector<float> none(coded.size(), kNeverNear);
  EXPECT_TRUE(nearest_moments(coded, none, request, std::nullopt).empty());
}

}  // namespace
}  // namespace engram::ltm
