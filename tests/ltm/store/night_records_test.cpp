// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/night_records.h"

#include <fstream>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

MemoryId entity_of(const std::string& text) {
  return *MemoryId::parse(text);
}

Time second(int64_t seconds) {
  return time_from_ns(1'700'000'000'000'000'000 + seconds * 1'000'000'000);
}

class NightRecordsTest : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_OK(create_store(store_)); }

  void publish(uint64_t stored_bytes, std::vector<int> models) {
    ASSERT_OK(edit_manifest(store_, [&](Manifest& manifest) {
      SegmentInfo segment{.file = "segments/000001.h5", .bytes = stored_bytes + 10};
      segment.entities = {{.id = cam_, .snapshots = 4, .stored_bytes = stored_bytes}};
      manifest.segments = {segment};
      manifest.models.clear();
      for (const int version : models)
        manifest.models.push_back({.entity = cam_, .version = version, .file = "m", .bytes = 100});
      return Status();
    }));
  }

  void write(NightWork work, Time began, uint64_t encoded, const Status& failure = {}) {
    auto account = NightAccount::open(store_, work, began);
    ASSERT_OK(account);
    account->of(cam_).encoded = encoded;
    ASSERT_OK(account->write(began + std::chrono::seconds(5), failure));
  }

  [[nodiscard]] size_t files() const {
    size_t count = 0;
    for ([[maybe_unused]] const auto& file :
         std::filesystem::directory_iterator(store_ / kNightsFolder))
      ++count;
    return count;
  }

  const ScratchDirectory scratch_;
  const std::filesystem::path store_ = scratch_ / "store";
  const MemoryId cam_ = entity_of("Vision/RGB/head/cam");
};

TEST_F(NightRecordsTest, HoldWhatANightDidAndWhatItChanged) {
  EXPECT_TRUE(read_nights(store_, 10)->nights.empty());
  publish(1000, {1});
  auto account = NightAccount::open(store_, NightWork::kConsolidate, second(0));
  ASSERT_OK(account);
  account->of(entity_of("A/B/C/D")).skipped = "the time was over";
  NightEntity& cam = account->of(cam_);
  cam.learned = 3;
  cam.encoded = 4;
  cam.psnr_db = 36.128;
  cam.min_psnr_db = std::numeric_limits<double>::infinity();
  publish(300, {2, 3});
  ASSERT_OK(account->write(second(60)));
  const auto found = read_nights(store_, 10);
  ASSERT_OK(found);
  ASSERT_EQ(found->nights.size(), 1u);
  EXPECT_FALSE(found->has_more);
  const NightRecord& night = found->nights[0];
  EXPECT_EQ(night.work, NightWork::kConsolidate);
  EXPECT_EQ(night.began, second(0));
  EXPECT_EQ(night.ended, second(60));
  EXPECT_EQ(night.failure, "");
  EXPECT_EQ(night.bytes_before, 1110u);
  EXPECT_EQ(night.bytes_after, 510u);
  ASSERT_EQ(night.entities.size(), 2u);
  EXPECT_EQ(night.entities[0].skipped, "the time was over");
  const NightEntity& told = night.entities[1];
  EXPECT_EQ(told.entity, cam_);
  EXPECT_EQ(told.learned, 3u);
  EXPECT_EQ(told.encoded, 4u);
  EXPECT_EQ(told.bytes_before, 1100u);
  EXPECT_EQ(told.bytes_after, 500u);
  EXPECT_EQ(told.psnr_db, 36.13);
  EXPECT_EQ(told.min_psnr_db, std::nullopt);
  EXPECT_EQ(told.models_added, (std::vector{2, 3}));
  EXPECT_EQ(told.models_removed, std::vector{1});
}

TEST_F(NightRecordsTest, AreOneNightWhereProcessesShareItsBegin) {
  publish(1000, {});
  write(NightWork::kConsolidate, second(0), 5);
  write(NightWork::kConsolidate, second(0), 7, cancelled("stopped"));
  write(NightWork::kForget, second(0), 1);
  write(NightWork::kConsolidate, second(100), 9);
  const auto found = read_nights(store_, 10);
  ASSERT_OK(found);
  ASSERT_EQ(found->nights.size(), 3u);
  EXPECT_EQ(found->nights[0].began, second(100));
  EXPECT_EQ(found->nights[1].work, NightWork::kForget);
  EXPECT_EQ(found->nights[2].failure, "stopped");
  ASSERT_EQ(found->nights[2].entities.size(), 1u);
  EXPECT_EQ(found->nights[2].entities[0].encoded, 12u);
  const auto newest = read_nights(store_, 1);
  ASSERT_EQ(newest->nights.size(), 1u);
  EXPECT_EQ(newest->nights[0].began, second(100));
  EXPECT_TRUE(newest->has_more);
}

TEST_F(NightRecordsTest, AreWrittenAnewAsANightGoesOn) {
  publish(1000, {1});
  auto account = NightAccount::open(store_, NightWork::kForget, second(0));
  ASSERT_OK(account);
  account->of(cam_).forgotten = 2;
  publish(800, {2});
  ASSERT_OK(account->write(second(1)));
  account->of(cam_).forgotten += 3;
  publish(500, {3});
  ASSERT_OK(account->write(second(2)));
  EXPECT_EQ(files(), 1u);
  const NightRecord night = read_nights(store_, 1)->nights.at(0);
  EXPECT_EQ(night.ended, second(2));
  EXPECT_EQ(night.entities.at(0).forgotten, 5u);
  EXPECT_EQ(night.entities[0].bytes_before, 1100u);
  EXPECT_EQ(night.entities[0].bytes_after, 600u);
  EXPECT_EQ(night.entities[0].models_added, std::vector{3});
  EXPECT_EQ(night.entities[0].models_removed, std::vector{1});
}

TEST_F(NightRecordsTest, TakeALittlePartOfTheStoreAndTheOldestGoFirst) {
  publish(1000, {});
  const std::string reason(4000, 'x');
  for (int64_t night = 0; night < 20; ++night) {
    auto account = NightAccount::open(store_, NightWork::kConsolidate, second(night));
    ASSERT_OK(account);
    account->of(cam_).skipped = reason;
    ASSERT_OK(account->write(second(night)));
  }
  EXPECT_EQ(files(), 7u);
  EXPECT_EQ(read_nights(store_, 1)->nights[0].began, second(19));
  // A single night is kept whatever it takes.
  auto account = NightAccount::open(store_, NightWork::kConsolidate, second(50));
  account->of(cam_).skipped = std::string(50'000, 'x');
  ASSERT_OK(account->write(second(50)));
  EXPECT_EQ(files(), 1u);
  // A larger store remembers longer.
  publish(200 << 20, {});
  for (int64_t night = 60; night < 80; ++night) write(NightWork::kForget, second(night), 1);
  EXPECT_EQ(files(), 21u);
}

TEST_F(NightRecordsTest, ThatAreDamagedAreCountedAndTheOthersTold) {
  publish(1000, {});
  write(NightWork::kConsolidate, second(0), 5);
  const std::string good =
      R"({"work":"forget","began_ns":1,"ended_ns":2,"failure":"","bytes_before":1,"bytes_after":2,)";
  int number = 0;
  for (const std::string& text :
       {std::string("{"), std::string("[]"), std::string(), good, good + R"("entities":{}})",
        good + R"("entities":[3]})", good + R"("entities":[{"id":"A/B"}]})",
        good + R"("entities":[{"id":"A/B/C/D","encoded":-1}]})",
        good + R"("entities":[{"id":"A/B/C/D","models_added":["x"]}]})",
        good + R"("entities":[{"id":"A/B/C/D","psnr":"x"}]})",
        std::string(R"({"work":"sleep","began_ns":1,"ended_ns":2,"entities":[]})"),
        std::string(R"({"work":"forget","ended_ns":2,"entities":[]})")})
    std::ofstream(store_ / kNightsFolder / fmt::format("{}.json", number++)) << text;
  std::ofstream(store_ / kNightsFolder / "other.txt") << "no record";
  const auto found = read_nights(store_, 10);
  ASSERT_OK(found);
  EXPECT_EQ(found->nights.size(), 1u);
  EXPECT_EQ(found->unreadable, 12u);
}

}  // namespace
}  // namespace engram::ltm
