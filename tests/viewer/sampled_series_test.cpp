// SPDX-License-Identifier: Apache-2.0
#include "viewer/sampled_series.h"

#include <cmath>
#include <set>

#include "memory/memory.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::viewer {
namespace {

using ::testing::ElementsAre;

std::vector<size_t> order_of(size_t count, size_t first_pass) {
  std::vector<size_t> order;
  visit_coarse_first(count, first_pass, [&order](size_t i) {
    order.push_back(i);
    return true;
  });
  return order;
}

TEST(CoarseFirst, VisitsEachOnceAndTheWholeSpanEarly) {
  EXPECT_THAT(order_of(8, 2), ElementsAre(0, 4, 2, 6, 1, 3, 5, 7));
  EXPECT_THAT(order_of(3, 64), ElementsAre(0, 1, 2));
  EXPECT_THAT(order_of(0, 64), ::testing::IsEmpty());
  for (const size_t count : {1, 63, 64, 65, 1000, 4097}) {
    const auto order = order_of(count, 64);
    EXPECT_EQ(order.size(), count);
    EXPECT_EQ(std::set<size_t>(order.begin(), order.end()).size(), count);
  }
}

TEST(CoarseFirst, EndsWhenItIsToldTo) {
  size_t visits = 0;
  visit_coarse_first(100, 10, [&visits](size_t) { return ++visits < 3; });
  EXPECT_EQ(visits, 3u);
}

class SampledSeriesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto memory = *Memory::open(store_);
    for (int64_t i = 0; i < 100; ++i)
      EXPECT_OK(memory->commit({{{arm_,
                                  time_from_ns(i),
                                  {{idf::Dict{{"x", static_cast<double>(i)},
                                              {"nan", i == 5 ? 1.0 : std::nan("")}}}}}}}));
    EXPECT_OK(memory->close());
    viewed_ =
        *ViewedMemory::open({.name = "arm", .store = store_, .open = [this](bool prefers_latents) {
                               return Memory::open(store_, {.is_read_only = true,
                                                            .prefers_latents = prefers_latents,
                                                            .notes_reads = false});
                             }});
  }

  SeriesRequest request_of(std::vector<std::string> paths, int64_t to, size_t pixels) const {
    return {.entity = arm_,
            .paths = std::move(paths),
            .bins = *ltm::TimeBins::create(time_from_ns(0), time_from_ns(to), pixels)};
  }

  const ScratchDirectory scratch_;
  const std::filesystem::path store_ = scratch_ / "arm.engram";
  const ltm::MemoryId arm_ = *ltm::MemoryId::parse("Robot/Joints/arm/left");
  std::unique_ptr<ViewedMemory> viewed_;
};

TEST_F(SampledSeriesTest, HasTheExtremesAndTheLastOfEachPixel) {
  const auto answer = sample_series(*viewed_, request_of({"x"}, 200, 4));
  ASSERT_OK(answer);
  EXPECT_EQ(answer->read, 100u);
  EXPECT_EQ(answer->total, 100u);
  const auto nan = ::testing::IsNan();
  EXPECT_THAT(answer->series[0].min, ElementsAre(0, 50, nan, nan));
  EXPECT_THAT(answer->series[0].max, ElementsAre(49, 99, nan, nan));
  EXPECT_THAT(answer->series[0].last, ElementsAre(49, 99, nan, nan));
}

TEST_F(SampledSeriesTest, LeavesOutWhatIsNoNumber) {
  const auto answer = sample_series(*viewed_, request_of({"nan", "none"}, 100, 1));
  ASSERT_OK(answer);
  EXPECT_THAT(answer->series[0].min, ElementsAre(1));
  EXPECT_TRUE(std::isnan(answer->series[0].last[0]));
  EXPECT_TRUE(std::isnan(answer->series[1].max[0]));
}

TEST_F(SampledSeriesTest, SeesWhatCameMeanwhile) {
  ASSERT_OK(sample_series(*viewed_, request_of({"x"}, 200, 1)));
  const auto memory = *Memory::open(store_);
  EXPECT_OK(memory->commit({{{arm_, time_from_ns(150), {{idf::Dict{{"x", -7.0}}}}}}}));
  EXPECT_OK(memory->close());
  std::this_thread::sleep_for(viewed_->options().max_age);
  const auto answer = sample_series(*viewed_, request_of({"x"}, 200, 1));
  ASSERT_OK(answer);
  EXPECT_EQ(answer->total, 101u);
  EXPECT_THAT(answer->series[0].min, ElementsAre(-7));
}

TEST_F(SampledSeriesTest, ReadsEachNumberOnce) {
  const auto column = [this](const char* path) {
    std::shared_ptr<NumberColumn> found;
    EXPECT_OK(viewed_->with_store([&](const StoreView& view) -> Status {
      ENGRAM_ASSIGN_OR_RETURN(const auto kept, viewed_->numbers(view, arm_));
      found = kept->columns(0, {path}).front();
      return {};
    }));
    return found;
  };
  const auto first = sample_series(*viewed_, request_of({"x"}, 40, 7));
  ASSERT_OK(first);
  EXPECT_TRUE(column("x")->was_read(39));
  EXPECT_FALSE(column("x")->was_read(40));
  EXPECT_FALSE(column("nan")->was_read(5));
  ASSERT_OK(sample_series(*viewed_, request_of({"nan", "x"}, 200, 7)));
  EXPECT_TRUE(column("x")->is_whole());
  EXPECT_TRUE(column("nan")->is_whole());
  // Nothing is left to read, so even no time suffices.
  SeriesRequest request = request_of({"x"}, 40, 7);
  request.budget = Duration::zero();
  const auto again = sample_series(*viewed_, request);
  ASSERT_OK(again);
  EXPECT_EQ(again->read, 40u);
  EXPECT_EQ(again->series[0].min, first->series[0].min);
  EXPECT_EQ(again->series[0].max, first->series[0].max);
  EXPECT_EQ(again->series[0].last, first->series[0].last);
}

TEST(KeptNumbers, KeepNoMoreThanTheyMay) {
  const auto times = std::make_shared<ltm::EntityTimes>();
  for (int64_t i = 0; i < 1000; ++i) times->all.push_back(time_from_ns(i));
  KeptNumbers kept(times, 10'000);
  const auto two = kept.columns(0, {"a", "b"});
  EXPECT_EQ(two[0]->stride(), 1u);
  EXPECT_EQ(kept.held_bytes(), 8'000u);
  EXPECT_EQ(kept.columns(0, {"b"}).front(), two[1]);
  // Others go where they do not fit beside these.
  EXPECT_EQ(kept.columns(1, {"a"}).front()->stride(), 1u);
  EXPECT_EQ(kept.held_bytes(), 4'000u);
  std::vector<std::string> paths;
  for (int i = 0; i < 64; ++i) paths.push_back("p" + std::to_string(i));
  const auto many = kept.columns(0, paths);
  EXPECT_EQ(many[63]->stride(), 32u);
  EXPECT_EQ(many[63]->size(), 32u);
  EXPECT_LE(kept.held_bytes(), 10'000u);
}

TEST_F(SampledSeriesTest, DrawsAnEvenPartOfWhatDoesNotFit) {
  ViewedMemory::Options options = viewed_->options();
  options.max_numbers_bytes = 120;  // 25 of 100 numbers.
  const auto small = ViewedMemory::open(std::move(options));
  ASSERT_OK(small);
  for (int round = 0; round < 2; ++round) {
    const auto answer = sample_series(**small, request_of({"x"}, 100, 2));
    ASSERT_OK(answer);
    EXPECT_EQ(answer->total, 100u);
    EXPECT_EQ(answer->read, 25u);
    EXPECT_THAT(answer->series[0].min, ElementsAre(0, 52));
    EXPECT_THAT(answer->series[0].last, ElementsAre(48, 96));
  }
}

TEST(NumberColumn, TellsWhatWasReadFromWhatIsNoNumber) {
  NumberColumn column(3, 1);
  EXPECT_TRUE(std::isnan(column.at(0)));
  EXPECT_FALSE(column.was_read(0));
  for (int round = 0; round < 2; ++round) {
    column.put(0, std::nanf("1"));
    column.put(1, std::bit_cast<float>(0x7FC0'0001U));
    EXPECT_TRUE(column.was_read(0));
    EXPECT_TRUE(column.was_read(1));
    EXPECT_FALSE(column.is_whole());
  }
  column.put(2, 4);
  EXPECT_EQ(column.at(2), 4);
  EXPECT_TRUE(column.is_whole());
}

TEST_F(SampledSeriesTest, OfNoEntityIsAnError) {
  SeriesRequest request = request_of({"x"}, 10, 1);
  request.entity = *ltm::MemoryId::parse("Robot/Joints/arm/right");
  EXPECT_FAILS(sample_series(*viewed_, request), StatusCode::kNotFound, "has no entity");
}

}  // namespace
}  // namespace engram::viewer
