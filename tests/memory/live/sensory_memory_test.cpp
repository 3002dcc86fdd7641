// SPDX-License-Identifier: Apache-2.0
#include "memory/live/sensory_memory.h"

#include <gmock/gmock.h>

#include <thread>

#include "memory/live/memory_service.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/memory/live/served_memory.h"

namespace engram::memory {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::ServedMemory;

constexpr const char* kCamera = "Vision/RGB/head/left";
constexpr const char* kOther = "Vision/RGB/head/right";
constexpr const char* kHand = "Hand/Pose/arm/left";

class SensoryMemoryTest : public ::testing::Test {
 protected:
  void open(Duration hold = 10s, size_t ring_bytes = size_t{1} << 20) {
    service_.options.sensory.segments = {{*ltm::MemoryId::parse("Vision/RGB"), hold}};
    service_.options.sensory.ring_bytes = ring_bytes;
    service_.options.sensory.query_attention = 30ms;
    service_.open();
    service_->tell_of_passed([this](std::span<const ltm::SharedSnapshot> passed) { note(passed); });
  }

  void note(std::span<const ltm::SharedSnapshot> told) {
    const MutexLock lock(mutex_);
    for (const auto& one : told) told_.push_back(to_ns(one->time));
  }

  std::vector<int64_t> told() {
    const MutexLock lock(mutex_);
    return told_;
  }

  /// What a server does with a commit that need not be durable.
  Status commit(const std::string& entity, int64_t at, idf::Data data = int64_t{7}) {
    return commit(ServedMemory::commit(entity, at, std::move(data)));
  }

  Status commit(ltm::Commit commit) {
    std::vector<std::vector<Buffer>> encoded;
    ENGRAM_RETURN_IF_ERROR(service_->hold(commit, encoded));
    if (commit.updates.empty()) return {};
    ENGRAM_ASSIGN_OR_RETURN(const auto admission, service_->commit(std::move(commit)));
    note(admission.snapshots);
    return {};
  }

  SensoryCounts counts() { return *service_->counters().sensory; }
  uint64_t committed_to_memory() { return service_->counters().memory.committed; }

  ServedMemory service_;
  Mutex mutex_;
  std::vector<int64_t> told_ ENGRAM_GUARDED_BY(mutex_);
};

TEST_F(SensoryMemoryTest, LosesWhatNobodyAttendsTo) {
  open(20ms);
  for (int64_t at = 1; at <= 5; ++at) ASSERT_OK(commit(kCamera, at));
  EXPECT_EQ(counts().held, 5u);
  EXPECT_EQ(committed_to_memory(), 0u);
  std::this_thread::sleep_for(60ms);
  EXPECT_EQ(counts().lost(), 5u) << "it is let go of although nothing more comes";
  EXPECT_EQ(counts().held_bytes, 0u);
  const auto attention = service_->attend(kCamera);
  ASSERT_OK(attention);
  EXPECT_THAT(told(), IsEmpty()) << "it is too old";
}

TEST_F(SensoryMemoryTest, PassesWhatIsHeldOnceAndInOrder) {
  open();
  for (int64_t at = 1; at <= 3; ++at) ASSERT_OK(commit(kCamera, at));
  ASSERT_OK(commit(kOther, 4));
  auto attention = service_->attend("Vision/.*/head/left");
  ASSERT_OK(attention);
  EXPECT_THAT(told(), ElementsAre(1, 2, 3));
  ASSERT_OK(commit(kCamera, 5));
  ASSERT_OK(commit(kOther, 6));
  EXPECT_THAT(told(), ElementsAre(1, 2, 3, 5));
  {
    const auto again = service_->attend(kCamera);
    ASSERT_OK(again);
  }
  ASSERT_OK(commit(kCamera, 7));
  attention->end();
  ASSERT_OK(commit(kCamera, 8));
  EXPECT_THAT(told(), ElementsAre(1, 2, 3, 5, 7));
  const auto all = service_->attend("Vision");
  ASSERT_OK(all);
  EXPECT_THAT(told(), ElementsAre(1, 2, 3, 5, 7, 4, 6, 8));
  EXPECT_EQ(counts().committed, 8u);
  EXPECT_EQ(counts().passed, 8u);
  EXPECT_EQ(counts().lost(), 0u);
}

TEST_F(SensoryMemoryTest, AQueryAttendsForAWhile) {
  open();
  for (int64_t at = 1; at <= 3; ++at) ASSERT_OK(commit(kCamera, at));
  EXPECT_THAT(*service_.ask("Vision @ latest:2"), ElementsAre(2, 3));
  ASSERT_OK(commit(kCamera, 4));
  EXPECT_EQ(counts().passed, 4u);
  std::this_thread::sleep_for(100ms);
  ASSERT_OK(commit(kCamera, 5));
  EXPECT_EQ(counts().passed, 4u);
  EXPECT_EQ(counts().held, 1u);
  // Another question finds it all the same.
  EXPECT_THAT(*service_.ask("Vision @ all"), ElementsAre(1, 2, 3, 4, 5));
}

TEST_F(SensoryMemoryTest, AQueryAboutEarlierTimesDoesNotAttend) {
  open();
  const int64_t now = to_ns(system_now());
  ASSERT_OK(commit(kCamera, now));
  const int64_t minutes = std::chrono::nanoseconds(5min).count();
  // Not by way of hold(), as a commit that must not be lost.
  ASSERT_OK(service_->commit(ServedMemory::commit(kOther, now - 2 * minutes)));
  const auto ask = [&](const std::string& selector) {
    EXPECT_OK(service_.ask("Vision @ " + selector));
    return counts().passed;
  };
  EXPECT_EQ(ask(fmt::format("time:{}..{}", now - 2 * minutes, now - minutes)), 0u);
  EXPECT_EQ(ask(fmt::format("before:{}", now - minutes)), 0u);
  EXPECT_EQ(ask(fmt::format("nearest:{}~1s", now - minutes)), 0u);
  // Neither where it ended just before what is held.
  const int64_t second = std::chrono::nanoseconds(1s).count();
  EXPECT_EQ(ask(fmt::format("time:{}..{}", now - 2 * minutes, now - second)), 0u);
  EXPECT_EQ(ask(fmt::format("before:{}", now - second)), 0u);
  // The time between may be more than a duration can tell.
  const auto of_the_first =
      ltm::Query::of_entity(*ltm::MemoryId::parse(kCamera),
                            ltm::select::Nearest{.time = time_from_ns(INT64_MIN), .tolerance = 1s});
  EXPECT_FALSE(service_->query_memory(of_the_first).has_value());
  EXPECT_EQ(counts().passed, 0u);
  EXPECT_EQ(ask(fmt::format("time:{}..{}", now - 2 * minutes, now)), 1u);
}

TEST_F(SensoryMemoryTest, AQueryAboutEarlierTimesFindsWhatCameLate) {
  open();
  const int64_t now = to_ns(system_now());
  const int64_t second = std::chrono::nanoseconds(1s).count();
  ASSERT_OK(commit(kCamera, now - 20 * second));
  EXPECT_THAT(
      *service_.ask(fmt::format("Vision @ time:{}..{}", now - 30 * second, now - 10 * second)),
      ElementsAre(now - 20 * second));
}

TEST_F(SensoryMemoryTest, OneCommitMayHoldBoth) {
  open();
  ltm::Commit both = ServedMemory::commit(kHand, 1);
  both.updates.push_back(ServedMemory::commit(kCamera, 2).updates.front());
  ASSERT_OK(commit(both));
  EXPECT_THAT(told(), ElementsAre(1));
  EXPECT_EQ(counts().held, 1u);
  EXPECT_EQ(committed_to_memory(), 1u);
}

TEST_F(SensoryMemoryTest, HoldsNothingOfACommitThatIsRefused) {
  open(10s, SensoryMemory::kMinRingBytes);
  ltm::Commit twice = ServedMemory::commit(kCamera, 1);
  twice.updates.push_back(twice.updates.front());
  EXPECT_EQ(commit(twice).code(), StatusCode::kInvalidArgument);
  ltm::Commit large = ServedMemory::commit(kOther, 2);
  large.updates.push_back(
      ServedMemory::commit(kCamera, 3, idf::NdArray::take({100'000}, std::vector<uint8_t>(100'000)))
          .updates.front());
  EXPECT_FAILS(commit(large), StatusCode::kResourceExhausted, "'Vision/RGB/head/left'");
  EXPECT_EQ(counts().committed, 0u);
}

TEST_F(SensoryMemoryTest, CountsWhatIsCrowdedOut) {
  open(10s, SensoryMemory::kMinRingBytes);
  const auto image = [] { return idf::NdArray::take({20'000}, std::vector<uint8_t>(20'000)); };
  for (int64_t at = 1; at <= 8; ++at) ASSERT_OK(commit(kCamera, at, image()));
  EXPECT_EQ(counts().crowded_out, 5u);
  EXPECT_LE(counts().held_bytes, SensoryMemory::kMinRingBytes);
  EXPECT_THAT(*service_.ask("Vision @ all"), ElementsAre(6, 7, 8));
  EXPECT_EQ(counts().lost(), 5u);
}

TEST_F(SensoryMemoryTest, RefusesMoreEntitiesThanItMayKnow) {
  service_.options.max_entities = 1;
  open();
  ASSERT_OK(commit(kCamera, 1));
  EXPECT_FAILS(commit(kOther, 1), StatusCode::kResourceExhausted, "'Vision/RGB/head/right'");
}

TEST_F(SensoryMemoryTest, ForgetsEntitiesOfWhichNothingIsLeft) {
  service_.options.max_entities = 1;
  open(20ms);
  ASSERT_OK(commit(kCamera, 1));
  std::this_thread::sleep_for(60ms);
  EXPECT_OK(commit(kOther, 1));
  EXPECT_EQ(counts().held, 1u);
}

/// Sees one entity.
class OneEntity final : public ltm::View {
 public:
  [[nodiscard]] ltm::Sight of(const ltm::MemoryId& entity) const override {
    if (entity.to_string() != kCamera) return {};
    return {ltm::TimeWindows::all(), ltm::TimeWindows::all(), true};
  }
};

TEST_F(SensoryMemoryTest, WhoMayNotSeeDoesNotAttend) {
  open();
  ASSERT_OK(commit(kCamera, 1));
  ASSERT_OK(commit(kOther, 2));
  const OneEntity view;
  const auto answer =
      service_->query_memory(*ltm::Query::parse("Vision @ latest"), SIZE_MAX, &view);
  ASSERT_TRUE(answer.has_value());
  EXPECT_THAT(told(), ElementsAre(1));
}

TEST_F(SensoryMemoryTest, RedactsWhatPasses) {
  ltm::EntityRule rule{"cameras", *ltm::EntityPattern::parse("Vision"), {}, {}, {}, {}};
  rule.pack.rules = {ltm::PackRule{.codec = "none"}};
  rule.redact = ltm::testing::marker_redaction(service_.folder.path(), "finds");
  service_.options.store->recording.rules = {rule};
  open();
  ASSERT_OK(commit(kCamera, 1, ltm::testing::image_with_secret(64, 48, 20, 5)));
  const auto answer = service_->query(*ltm::Query::parse("Vision @ latest"));
  ASSERT_OK(answer);
  ASSERT_EQ(answer->entities.size(), 1u);
  const auto& data = answer->entities[0].snapshots[0].held->instances[0].data;
  EXPECT_FALSE(ltm::testing::has_secret(*data.get_if<idf::NdArray>()));
  EXPECT_EQ(service_->counters().redaction.redacted, 1u);
}

TEST_F(SensoryMemoryTest, ForgetsWhatIsHeld) {
  open();
  ASSERT_OK(commit(kCamera, 1));
  ASSERT_OK(commit(kOther, 2));
  ForgetRequest request;
  request.targets = {kCamera};
  const auto outcome = service_->forget(std::move(request));
  ASSERT_OK(outcome);
  EXPECT_EQ(outcome->snapshots, 1u);
  EXPECT_THAT(*service_.ask("Vision @ all"), ElementsAre(2));
}

TEST_F(SensoryMemoryTest, ForgettingTakesNoMoreThanATargetNames) {
  open();
  for (int64_t at = 1; at <= 5; ++at) ASSERT_OK(commit(kCamera, at));
  ForgetRequest request;
  request.targets = {std::string(kCamera) + " @ time:2..3"};
  const auto outcome = service_->forget(std::move(request));
  ASSERT_OK(outcome);
  EXPECT_EQ(outcome->snapshots, 2u);
  EXPECT_THAT(told(), ElementsAre(2, 3));
  EXPECT_EQ(counts().held, 3u);
  EXPECT_THAT(*service_.ask("Vision @ all"), ElementsAre(1, 4, 5));
}

TEST_F(SensoryMemoryTest, NamesWhatIsWrongWithOptions) {
  SensoryMemory::Options options;
  const auto fails = [&options](const std::string& text) {
    EXPECT_FAILS(options.validate(), StatusCode::kInvalidArgument, text);
  };
  const ltm::MemoryId vision = *ltm::MemoryId::parse("Vision");
  options.segments = {{vision, 11s}};
  fails("found 11s for 'Vision', needs 1ms to 10s");
  options.segments = {{vision, 1s}, {vision, 2s}};
  fails("found 'Vision' twice");
  options.segments = {{ltm::MemoryId(), 1s}};
  fails("needs a memory, a segment or an entity");
  options.segments = {{vision, 1s}};
  options.ring_bytes = 10;
  fails("found a ring of 10 bytes");
  options.ring_bytes = SensoryMemory::kMinRingBytes;
  options.query_attention = 0s;
  fails("queries that attend for 0s");
  service_.options.sensory = options;
  EXPECT_FALSE(MemoryService::open(service_.options, nullptr).ok());
}

TEST_F(SensoryMemoryTest, AttentionMayOutliveTheMemory) {
  open();
  ASSERT_OK(commit(kCamera, 1));
  auto attention = service_->attend(kCamera);
  ASSERT_OK(attention);
  service_.close();
  attention->end();
  EXPECT_THAT(told(), ElementsAre(1));
}

/// Each opening passes all that is held: with a long time to hold, everything passes in the end,
/// once and in the order in which it came, however often attention opens and closes meanwhile.
TEST_F(SensoryMemoryTest, OpensExactlyWhileAProviderWrites) {
  open(10s, size_t{64} << 20);
  constexpr int kOpenings = 3000;
  std::atomic<int64_t> last{0};
  std::atomic<bool> is_over{false};
  std::jthread provider([&] {
    while (!is_over && last < 50'000) {
      ASSERT_OK(commit(kCamera, last + 1));
      ++last;
    }
    is_over = true;
  });
  int openings = 0;
  for (; openings < kOpenings || !is_over; ++openings) {
    const int64_t before = last;
    auto attention = service_->attend(kCamera);
    ASSERT_OK(attention);
    ASSERT_GE(static_cast<int64_t>(told().size()), before);
    const int64_t during = last;
    ASSERT_GE(static_cast<int64_t>(told().size()), during);
    if (openings % 16 == 0) std::this_thread::sleep_for(100us);
    attention->end();
    if (openings >= kOpenings) is_over = true;
  }
  provider.join();
  const auto attention = service_->attend(kCamera);
  ASSERT_OK(attention);
  const std::vector<int64_t> all = told();
  ASSERT_EQ(static_cast<int64_t>(all.size()), last);
  for (size_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], static_cast<int64_t>(i) + 1);
  EXPECT_EQ(counts().lost(), 0u);
}

}  // namespace
}  // namespace engram::memory
