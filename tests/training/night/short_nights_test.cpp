// SPDX-License-Identifier: Apache-2.0
// Nights that are too short for a day, or that end early: training/night/time_shares.h,
// encoding_limits.h, video_alone.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "encoders/load_model.h"
#include "ltm/store/store_check.h"
#include "ltm/store/store_reader.h"
#include "tests/training/recorded_scene.h"
#include "training/night/encoding_limits.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::kSquare;
using engram::testing::night;
using engram::testing::ScratchPath;
using std::chrono::seconds;

/// Images alone: there is nothing to train.
void record_images(const std::filesystem::path& store, int first, int count) {
  engram::testing::record(store, "Test/Scene/sim/square", first, count, false);
}

/// Video alone in short chains, of which each is published at once.
ConsolidateOptions video() {
  ConsolidateOptions options;
  options.representation.kind = Representation::kVideo;
  options.representation.bound_db = 30;
  options.access = Duration::zero();
  options.train.chain_rows = 8;
  options.train.threads = 1;
  options.job.publish_interval = Duration::zero();
  return options;
}

size_t with_latents(const std::filesystem::path& store) {
  auto reader = ltm::StoreReader::open(store);
  EXPECT_TRUE(reader.ok());
  const auto index = (*reader)->index(id(kSquare));
  EXPECT_TRUE(index.ok());
  return static_cast<size_t>(std::ranges::count_if(
      **index, [](const ltm::SnapshotEntry& entry) { return entry.latent.has_value(); }));
}

void expect_clean(const std::filesystem::path& store) {
  const auto checked = ltm::check_store(
      store, {.is_deep = true, .test_model = [](const std::filesystem::path& file) -> Status {
                return encoders::load_model(file).status();
              }});
  ASSERT_TRUE(checked.ok()) << checked.status().to_string();
  EXPECT_TRUE(checked->is_clean()) << checked->findings.front().what;
}

/// A clock that stands still until it is moved.
struct Hand {
  Time now = time_from_ns(0);
  ProgressSink progress;
  std::stop_token stop;
  JobPace pace{nullptr, progress, stop, {}, [this] { return now; }};
};

TEST(EncodingRate, LetsWholeChainsFitIntoWhatIsLeft) {
  Hand hand;
  const EncodingLimits limits{hand.now + seconds(100), 0.5, {}, {}};
  EncodingRate rate(limits, hand.pace);
  EXPECT_EQ(rate.fitting(16), 160u) << "80 s of 0.5 s each";
  rate.count(100, 80);
  hand.now += seconds(80);
  EXPECT_EQ(rate.fitting(16), 16u) << "16 s of 0.8 s each";
  EXPECT_DOUBLE_EQ(rate.seconds_for(10), 8);
  hand.now += seconds(10);
  EXPECT_EQ(rate.fitting(16), 8u) << "a shorter chain";
  hand.now += seconds(5);
  EXPECT_EQ(rate.fitting(16), 0u) << "any would end too late";
}

TEST(EncodingRate, ExpectsNoLessThanWasMeasuredBefore) {
  Hand hand;
  const EncodingLimits limits{hand.now + seconds(100), 1, {}, {}};
  EncodingRate rate(limits, hand.pace);
  rate.count(1000, 1);  // Videos that the store holds.
  EXPECT_EQ(rate.fitting(8), 80u);
}

TEST(EncodingRate, LetsAShortNightDoSomething) {
  Hand hand;
  const EncodingLimits limits{hand.now + seconds(3), 10, {}, {}};
  EncodingRate rate(limits, hand.pace);
  EXPECT_EQ(rate.fitting(16), 8u);
  EXPECT_EQ(rate.fitting(4), 4u);
  hand.now += seconds(10);
  EXPECT_FALSE(rate.is_over()) << "what was begun may end";
  hand.now += seconds(10);
  EXPECT_TRUE(rate.is_over());
  EXPECT_EQ(rate.fitting(16), 0u);
}

TEST(EncodingRate, HasNoEndUnlessOneIsGiven) {
  Hand hand;
  const EncodingLimits limits;
  EncodingRate rate(limits, hand.pace);
  EXPECT_EQ(rate.fitting(16), std::numeric_limits<size_t>::max());
  EXPECT_EQ(rate.seconds_for(5), -1);
  hand.now += std::chrono::hours(100);
  EXPECT_FALSE(rate.is_over());
}

// A machine may be so busy that a night does nothing at all. Each must leave a store that is whole,
// and together they must finish.
TEST(ShortNights, WorkOffABacklogFromTheOldestOn) {
  constexpr size_t kCount = 240;
  const ScratchPath store("short_nights");
  record_images(store.path(), 0, kCount);
  auto chosen = video();
  chosen.representation.video_effort = 7;  // Takes several times what a night has.
  size_t before = 0;
  int nights = 0, partial = 0;
  for (; before < kCount && nights < 60; ++nights) {
    chosen.job.until = system_now() + seconds(nights < 20 ? 5 : 60);
    const auto report = consolidate(store.path(), chosen, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().to_string();
    const EntityReport& one = report->entities[0];
    const size_t now = with_latents(store.path());
    SCOPED_TRACE(one.skipped_reason);
    EXPECT_GE(now, before);
    if (one.skipped_reason.empty()) {
      EXPECT_GT(now, before);
      EXPECT_EQ(one.waiting, kCount - now);
      EXPECT_LT(system_now(), *chosen.job.until + seconds(30));
      partial += one.waiting > 0 ? 1 : 0;
    }
    auto reader = ltm::StoreReader::open(store.path());
    ASSERT_TRUE(reader.ok());
    const auto& index = **(*reader)->index(id(kSquare));
    for (size_t i = 0; i < index.size(); ++i) EXPECT_EQ(index[i].latent.has_value(), i < now);
    before = now;
  }
  EXPECT_EQ(before, kCount);
  EXPECT_GE(nights, 1 + partial);
  expect_clean(store.path());
}

TEST(VideoAlone, KeepsWhatWasPublishedBeforeAStop) {
  const ScratchPath store("video_stopped");
  record_images(store.path(), 0, 200);
  std::stop_source stop;
  const ProgressSink sink = [&](const Progress& progress) {
    if (progress.what.starts_with("encode") && progress.done >= 150) stop.request_stop();
  };
  EXPECT_EQ(consolidate(store.path(), video(), sink, stop.get_token()).status().code(),
            StatusCode::kCancelled);
  const size_t published = with_latents(store.path());
  EXPECT_GT(published, 0u);
  EXPECT_LT(published, 200u);
  expect_clean(store.path());
  const EntityReport rest = night(store.path(), video());
  EXPECT_FALSE(rest.is_model_new);
  EXPECT_EQ(rest.snapshots, 200 - published) << "what was published is not encoded again";
  EXPECT_EQ(with_latents(store.path()), 200u);
  expect_clean(store.path());
}

TEST(VideoAlone, GoesOnWithItsModelUnlessThatKeepsAnotherBound) {
  const ScratchPath store("video_goes_on");
  record_images(store.path(), 0, 40);
  EXPECT_TRUE(night(store.path(), video()).is_model_new);
  record_images(store.path(), 40, 16);
  const EntityReport more = night(store.path(), video());
  EXPECT_FALSE(more.is_model_new);
  EXPECT_EQ(more.model_version, 1);
  EXPECT_EQ(more.snapshots, 16u);
  record_images(store.path(), 56, 8);
  auto better = video();
  better.representation.bound_db = 36;
  const EntityReport again = night(store.path(), better);
  EXPECT_GT(again.snapshots, 8u) << "those below the bound are encoded again";
  EXPECT_GE(again.minimum_psnr_db, 36);
  record_images(store.path(), 64, 8);
  auto smaller = video();
  smaller.representation.bound_db = 25;
  EXPECT_TRUE(night(store.path(), smaller).is_model_new) << "the user asked for fewer bytes";
  auto anew = video();
  anew.starts_anew = true;
  record_images(store.path(), 72, 8);
  EXPECT_TRUE(night(store.path(), anew).is_model_new);
  expect_clean(store.path());
}

}  // namespace
}  // namespace engram::training
