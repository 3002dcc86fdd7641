// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/similar.h"

#include "ltm/core/file.h"
#include "ltm/likeness/make_codes.h"
#include "ltm/likeness/store_likeness.h"
#include "ltm/likeness/stored_codes.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/segment_index.h"
#include "tests/ltm/likeness/drawn_moments.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

constexpr int64_t kMoments = 80;
constexpr int64_t kRecordings = 3;

/// The number of a moment in its recording, and its recording.
std::pair<int64_t, int64_t> place_of(Time time) {
  const int64_t number = (to_ns(time) - kExampleStart_ns) / 200'000'000;
  return {number / 10'000, number % 10'000};
}

class SimilarTest : public ::testing::Test {
 protected:
  SimilarTest() : store_(scratch_ / "store") {
    EXPECT_OK(create_store(store_));
    record_drawn(store_, kRecordings, kMoments);
  }

  Result<std::vector<EntityCoding>> code() { return make_codes(store_, {}, {}, {}, {}); }

  Result<SimilarAnswer> find(const SimilarRequest& request) {
    ENGRAM_ASSIGN_OR_RETURN(const auto past, StorePast::open(store_, {}, {}));
    return LikenessSearch(*past).find(request);
  }

  [[nodiscard]] static SimilarRequest like(int64_t recording, int64_t i) {
    return {.entity = example_entity(), .moment = example_time(recording * 10'000 + i)};
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

TEST_F(SimilarTest, FindsTheSameMotionInOtherRooms) {
  ASSERT_OK(code());
  for (const int64_t i : {25, 30, 50, 55}) {
    SimilarRequest request = like(0, i);
    request.is_elsewhere = true;
    request.is_one_per_recording = true;
    const auto answer = find(request);
    ASSERT_OK(answer);
    EXPECT_EQ(answer->computed, 0u);
    EXPECT_TRUE(answer->is_stored_space);
    ASSERT_EQ(answer->moments.size(), 2u);
    for (const SimilarMoment& moment : answer->moments) {
      const auto [recording, found] = place_of(moment.time);
      EXPECT_NE(recording, 0);
      // The square was at the same place, and had gone the same way.
      EXPECT_LE(std::abs(left_at(found) - left_at(i)), 4) << "found " << found << " for " << i;
      EXPECT_EQ(found % 40 < 20, i % 40 < 20) << "found " << found << " for " << i;
      EXPECT_EQ(moment.recording_first, example_time(recording * 10'000));
      EXPECT_EQ(moment.recording_last, example_time(recording * 10'000 + kMoments - 1));
    }
  }
}

TEST_F(SimilarTest, GivesTheSameAnswerWithoutStoredCodes) {
  const auto computed = find(like(1, 30));
  ASSERT_OK(computed);
  EXPECT_EQ(computed->computed, static_cast<uint64_t>(kRecordings * kMoments));
  EXPECT_FALSE(computed->is_stored_space);
  ASSERT_OK(code());
  const auto stored = find(like(1, 30));
  ASSERT_OK(stored);
  EXPECT_EQ(stored->space, computed->space);
  ASSERT_EQ(stored->moments.size(), computed->moments.size());
  for (size_t i = 0; i < stored->moments.size(); ++i) {
    EXPECT_EQ(stored->moments[i].time, computed->moments[i].time);
    EXPECT_EQ(stored->moments[i].distance, computed->moments[i].distance);
  }
}

TEST_F(SimilarTest, OrdersByDistanceAndKeepsMomentsApart) {
  SimilarRequest request = like(0, 40);
  request.count = 12;
  const auto answer = find(request);
  ASSERT_OK(answer);
  ASSERT_EQ(answer->moments.size(), 12u);
  std::vector<Time> taken{*request.moment};
  double before = 0;
  for (const SimilarMoment& moment : answer->moments) {
    EXPECT_GE(moment.distance, before);
    before = moment.distance;
    for (const Time other : taken)
      EXPECT_GE(std::chrono::abs(moment.time - other), std::chrono::seconds(1));
    taken.push_back(moment.time);
  }
  request.apart = Duration::zero();
  request.count = 1000;
  // All but the one that was asked with.
  EXPECT_EQ(find(request)->moments.size(), static_cast<size_t>(kRecordings * kMoments - 1));
}

TEST_F(SimilarTest, SearchesWhatAQuerySelects) {
  SimilarRequest request = like(0, 40);
  request.among = *Query::parse("Vision @ " + to_string(example_time(10'000)) + ".." +
                                to_string(example_time(10'000 + kMoments)));
  const auto answer = find(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->compared, static_cast<uint64_t>(kMoments));
  for (const SimilarMoment& moment : answer->moments) EXPECT_EQ(place_of(moment.time).first, 1);
  request.among = *Query::parse("RobotState @ all");
  EXPECT_FAILS(find(request), StatusCode::kInvalidArgument, "selects nothing of");
}

TEST_F(SimilarTest, FindsAnImage) {
  ASSERT_OK(code());
  SimilarRequest request{.entity = example_entity(), .image = drawn_image(left_at(10), 20, 50, 8)};
  const auto answer = find(request);
  ASSERT_OK(answer);
  const auto [recording, found] = place_of(answer->moments.front().time);
  EXPECT_EQ(recording, 0);
  EXPECT_EQ(left_at(found), left_at(10));
  EXPECT_EQ(answer->moments.front().distance, 0);
}

TEST_F(SimilarTest, ComparesNumbersAndSeveralEntities) {
  SimilarRequest request{.entity = arm_entity(), .moment = example_time(30), .is_elsewhere = true};
  const auto numbers = find(request);
  ASSERT_OK(numbers);
  EXPECT_EQ(numbers->space, "numbers");
  EXPECT_EQ(place_of(numbers->moments.front().time).second % 40, 30);
  EXPECT_NEAR(numbers->moments.front().distance, 0, 1e-5);
  request = like(0, 30);
  request.with = {{arm_entity(), 100}};
  request.is_elsewhere = true;
  const auto both = find(request);
  ASSERT_OK(both);
  EXPECT_EQ(place_of(both->moments.front().time).second % 40, 30);
  EXPECT_THAT(both->space, ::testing::HasSubstr(" + numbers"));
}

/// Sees one recording of each entity, and images of another one redacted.
class OneRoom final : public View {
 public:
  explicit OneRoom(int64_t recording) : recording_(recording) {}

  [[nodiscard]] Sight of(const MemoryId& entity) const override {
    Sight sight;
    if (entity == arm_entity()) sight.times = window(0);
    if (entity == example_entity()) {
      sight.times = window(recording_);
      sight.times.add({example_time(20'000), example_time(30'000)});
      sight.exact = window(recording_);
    }
    return sight;
  }

 private:
  static TimeWindows window(int64_t recording) {
    TimeWindows windows;
    windows.add({example_time(recording * 10'000), example_time(recording * 10'000 + 9'999)});
    return windows;
  }

  const int64_t recording_;
};

TEST_F(SimilarTest, ComparesOnlyWhatMayBeSeen) {
  const auto past = StorePast::open(store_, {}, {});
  ASSERT_OK(past);
  LikenessSearch search(**past);
  const auto ask = [&search](const SimilarRequest& request, int64_t recording) {
    const OneRoom view(recording);
    return search.find(request, {}, {}, &view);
  };
  SimilarRequest request = like(1, 40);
  request.count = 1000;
  request.apart = Duration::zero();
  const auto seen = ask(request, 1);
  ASSERT_OK(seen);
  EXPECT_EQ(seen->compared, static_cast<uint64_t>(kMoments));
  for (const SimilarMoment& moment : seen->moments) EXPECT_EQ(place_of(moment.time).first, 1);
  // No message names what is there and may not be seen.
  const auto hidden = ask(like(0, 30), 1);
  EXPECT_FAILS(hidden, StatusCode::kNotFound,
               "the moment before it is none, after it " + to_string(example_time(10'000)));
  request.among = *Query::parse("Vision @ latest:10");
  EXPECT_EQ(ask(request, 1)->compared, 0u);  // They may be seen redacted only.
  request.among = *Query::parse("Vision @ 0..9");
  EXPECT_EQ(ask(request, 1)->compared, 10u);
  const auto nobody = ask({.entity = example_entity("nobody"), .moment = example_time(0)}, 1);
  EXPECT_FAILS(nobody, StatusCode::kNotFound, "there is no such entity");
  EXPECT_EQ(nobody.status().message().find("joints"), std::string::npos);
  EXPECT_FAILS(ask(like(2, 30), 7), StatusCode::kFailedPrecondition, "redacted only");
  EXPECT_EQ(ask({.entity = arm_entity(), .moment = example_time(30)}, 1)->compared,
            static_cast<uint64_t>(kMoments));
}

TEST_F(SimilarTest, KeepsWhatWasComputedWhenItIsCancelled) {
  const auto past = StorePast::open(store_, {}, {});
  ASSERT_OK(past);
  LikenessSearch search(**past);
  std::stop_source stop;
  const auto stops = [&stop](const Progress& progress) {
    if (progress.what.starts_with("code") && progress.done == 50) stop.request_stop();
  };
  EXPECT_FAILS(search.find(like(0, 30), stops, stop.get_token()), StatusCode::kCancelled, "");
  const auto rest = search.find(like(0, 30));
  ASSERT_OK(rest);
  EXPECT_LT(rest->computed, static_cast<uint64_t>(kRecordings * kMoments - 50));
  const auto whole = find(like(0, 30));
  EXPECT_EQ(rest->space, whole->space);
  ASSERT_EQ(rest->moments.size(), whole->moments.size());
  for (size_t i = 0; i < rest->moments.size(); ++i) {
    EXPECT_EQ(rest->moments[i].time, whole->moments[i].time);
    EXPECT_EQ(rest->moments[i].distance, whole->moments[i].distance);
  }
}

TEST_F(SimilarTest, FollowsAStoreThatIsWrittenTo) {
  ASSERT_OK(code());
  StoreLikeness likeness(store_, {});
  SimilarRequest request{.entity = example_entity(), .image = drawn_image(44, 20, 50, 8)};
  request.apart = Duration::zero();
  EXPECT_EQ(likeness.similar(request)->compared, static_cast<uint64_t>(kRecordings * kMoments));
  const auto writer = *StoreWriter::open(store_, {});
  const auto append = [&writer](Time time, int left) {
    Snapshot snapshot{example_entity(), time, {}};
    snapshot.instances.push_back({idf::Dict{{"image", drawn_image(left, 20, 50, 8)}}, {}});
    ASSERT_OK(writer->append({pack_snapshot(snapshot)}, nullptr));
  };
  // Between, behind and instead of what is there.
  append(example_time(10) + Duration(1), 44);
  append(example_time(90'000), 44);
  append(example_time(20), 44);
  for (const bool is_sealed : {false, true}) {
    if (is_sealed) ASSERT_OK(writer->seal());
    const auto answer = likeness.similar(request);
    ASSERT_OK(answer);
    EXPECT_EQ(answer->computed, 3u);
    EXPECT_EQ(answer->compared, static_cast<uint64_t>(kRecordings * kMoments + 2));
    EXPECT_EQ(answer->moments.at(0).time, example_time(10) + Duration(1));
    EXPECT_EQ(answer->moments.at(1).time, example_time(20));
    EXPECT_EQ(answer->moments.at(2).time, example_time(90'000));
    EXPECT_EQ(answer->moments.at(2).distance, 0);
    EXPECT_GT(answer->moments.at(3).distance, 0);
    EXPECT_EQ(likeness.similar(request)->computed, 0u);
  }
  // What is gone is not compared any more.
  ASSERT_OK(forget_snapshots(store_, {{example_entity(), TimeSet{example_time(90'000)}}}));
  likeness.forget_codes();
  EXPECT_EQ(likeness.similar(request)->compared, static_cast<uint64_t>(kRecordings * kMoments + 1));
}

TEST_F(SimilarTest, SaysWhatIsWrong) {
  SimilarRequest request = like(0, 30);
  request.moment = *request.moment + Duration(1);
  EXPECT_FAILS(find(request), StatusCode::kNotFound, "the moment before it is");
  request = like(0, 30);
  request.image = drawn_image(0, 0, 50);
  EXPECT_FAILS(find(request), StatusCode::kInvalidArgument, "not both");
  request.moment.reset();
  request.image = idf::NdArray::take({16, 16, 3}, std::vector<uint8_t>(768));
  EXPECT_FAILS(find(request), StatusCode::kInvalidArgument,
               "have 64 x 48 x 3 pixels and channels, found an image of 16 x 16 x 3");
  request.takes_any_size = true;
  EXPECT_OK(find(request));
  request.entity = arm_entity();
  EXPECT_FAILS(find(request), StatusCode::kInvalidArgument, "numbers and no images");
  request = like(0, 30);
  request.entity = example_entity("nobody");
  EXPECT_FAILS(find(request), StatusCode::kNotFound, "nobody");
  request = like(0, 30);
  request.with = {{arm_entity(), -1}};
  EXPECT_FAILS(find(request), StatusCode::kInvalidArgument, "must be above 0");
  // As a float it would be infinite, and all distances no numbers.
  request.with.back().weight = 1e39;
  EXPECT_FAILS(find(request), StatusCode::kInvalidArgument, "at most 1000000");
  request.with.clear();
  request.context = Duration::max();
  EXPECT_FAILS(find(request), StatusCode::kInvalidArgument, "context must be at most 1d");
}

TEST_F(SimilarTest, CodesOnlyWhatHasNoCodeYet) {
  const auto first = code();
  ASSERT_OK(first);
  ASSERT_EQ(first->size(), 1u);  // The joints have no images.
  EXPECT_EQ(first->front().coded, static_cast<uint64_t>(kRecordings * kMoments));
  EXPECT_TRUE(first->front().is_learned);
  const auto second = code();
  ASSERT_OK(second);
  EXPECT_EQ(second->front().coded, 0u);
  EXPECT_EQ(second->front().kept, static_cast<uint64_t>(kRecordings * kMoments));
  EXPECT_FALSE(second->front().is_learned);
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = 0; i < 20; ++i) ASSERT_OK(writer->append(drawn_moment(3, i), nullptr));
    ASSERT_OK(writer->seal());
  }
  const auto third = code();
  ASSERT_OK(third);
  EXPECT_EQ(third->front().coded, 20u);
  EXPECT_FALSE(third->front().is_learned);
}

TEST_F(SimilarTest, LearnsAnewOnceThereIsTwiceAsMuch) {
  const auto first = code();
  ASSERT_OK(first);
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = 0; i < kRecordings * kMoments; ++i)
      ASSERT_OK(writer->append(drawn_moment(3, i), nullptr));
    ASSERT_OK(writer->seal());
  }
  const auto second = code();
  ASSERT_OK(second);
  EXPECT_TRUE(second->front().is_learned);
  EXPECT_NE(second->front().space, first->front().space);
  EXPECT_EQ(second->front().coded, static_cast<uint64_t>(2 * kRecordings * kMoments));
  EXPECT_EQ(find(like(0, 30))->computed, 0u);
}

TEST_F(SimilarTest, EndsWhenTheTimeIsOverAndGoesOn) {
  CodesOptions options;
  int asked = 0;
  options.is_over = [&asked] { return ++asked > 50; };
  const auto part = make_codes(store_, {}, options, {}, {});
  ASSERT_OK(part);
  EXPECT_EQ(part->front().coded + part->front().left,
            static_cast<uint64_t>(kRecordings * kMoments));
  EXPECT_GT(part->front().left, 100u);
  const auto rest = code();
  ASSERT_OK(rest);
  EXPECT_EQ(rest->front().kept, part->front().coded);
  EXPECT_EQ(rest->front().coded, part->front().left);
}

TEST_F(SimilarTest, StopsLearningWhenTheTimeIsOver) {
  CodesOptions options;
  int asked = 0;
  options.is_over = [&asked] { return ++asked > 5; };
  const auto none = make_codes(store_, {}, options, {}, {});
  ASSERT_OK(none);
  EXPECT_LT(asked, 10);
  EXPECT_EQ(none->front().left, static_cast<uint64_t>(kRecordings * kMoments));
  EXPECT_FALSE(std::filesystem::exists(store_ / entity_index_name(example_entity(), kSpaceIndex)));
  EXPECT_EQ(code()->front().coded, static_cast<uint64_t>(kRecordings * kMoments));
}

TEST_F(SimilarTest, TellsSmallStepsOfLargeNumbersApart) {
  const MemoryId place = *MemoryId::parse("RobotState/Localization/robot/place");
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = 0; i < 40; ++i) {
      Snapshot snapshot{place, example_time(i), {}};
      snapshot.instances.push_back(
          {idf::Dict{{"east", 5e9 + 0.01 * static_cast<double>(i % 20)}}, {}});
      ASSERT_OK(writer->append({pack_snapshot(snapshot)}, nullptr));
    }
  }
  const auto answer = find({.entity = place, .moment = example_time(27)});
  ASSERT_OK(answer);
  EXPECT_EQ(answer->moments.front().time, example_time(7));
}

TEST_F(SimilarTest, LeavesOutWhatIsDamaged) {
  const SegmentInfo damaged = read_manifest(store_)->segments.at(1);
  const Buffer whole = *read_file(store_ / damaged.file);
  std::vector<std::byte> bytes(whole.bytes().begin(), whole.bytes().end());
  const PackedSnapshot moment = drawn_moment(1, 30).front();
  const auto image = moment.instances.front().value.media.front().bytes.bytes();
  const auto at = std::ranges::search(bytes, image);
  ASSERT_FALSE(at.empty());
  at[at.size() / 2] ^= std::byte{1};
  overwrite_file(store_ / damaged.file, bytes);
  const auto coded = code();
  ASSERT_OK(coded);
  ASSERT_EQ(coded->size(), 1u);
  EXPECT_GE(coded->front().skipped, 1u);
  EXPECT_GE(coded->front().coded, static_cast<uint64_t>((kRecordings - 1) * kMoments));
  EXPECT_OK(find(like(0, 30)));
}

TEST_F(SimilarTest, ForgetsCodesWithTheirSnapshots) {
  ASSERT_OK(code());
  ForgetSet gone;
  for (int64_t i = 0; i < kMoments; ++i) gone[example_entity()].insert(example_time(i));
  ASSERT_OK(forget_snapshots(store_, gone));
  const Manifest manifest = *read_manifest(store_);
  EXPECT_EQ(manifest.segments.size(), 3u);
  size_t codes = 0;
  for (const SegmentInfo& segment : manifest.segments) {
    const auto bytes = read_segment_index(store_, segment, kCodesIndex);
    if (!bytes.ok()) continue;
    const auto unpacked = unpack_codes(bytes->bytes());
    ASSERT_OK(unpacked);
    for (const EntityCodes& entity : *unpacked) codes += entity.times.size();
  }
  EXPECT_EQ(codes, static_cast<size_t>((kRecordings - 1) * kMoments));
  SimilarRequest request = like(1, 30);
  request.apart = Duration::zero();
  request.count = 1000;
  for (const SimilarMoment& moment : find(request)->moments)
    EXPECT_NE(place_of(moment.time).first, 0);
}

TEST_F(SimilarTest, DoesNotUseTheCodeOfAnImageThatWasRecordedAgain) {
  ASSERT_OK(code());
  {
    const auto writer = *StoreWriter::open(store_, {});
    std::vector<PackedSnapshot> again = drawn_moment(0, 30);
    Snapshot other{example_entity(), example_time(30), {}};
    other.instances.push_back({idf::Dict{{"image", drawn_image(45, 2, 200, 3)}}, {}});
    ASSERT_OK(writer->append({pack_snapshot(other)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  SimilarRequest request{.entity = example_entity(), .image = drawn_image(45, 2, 200, 3)};
  const auto answer = find(request);
  ASSERT_OK(answer);
  EXPECT_EQ(answer->computed, 1u);
  EXPECT_EQ(answer->moments.front().time, example_time(30));
  EXPECT_EQ(answer->moments.front().distance, 0);
}

}  // namespace
}  // namespace engram::ltm
