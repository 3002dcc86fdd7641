// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "memory/live/event_hub.h"
#include "memory/live/memory_service.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/memory/live/served_memory.h"

namespace engram::memory {
namespace {

using ltm::testing::has_secret;
using ltm::testing::has_secret_file;
using ltm::testing::image_with_secret;
using ltm::testing::marker_redaction;
using testing::ServedMemory;

constexpr const char* kCamera = "Vision/RGB/head/cam";

class ServiceRedactionTest : public ::testing::Test {
 protected:
  void open(bool redacts = true, const std::string& mode = "finds") {
    ltm::EntityRule rule{"cameras", *ltm::EntityPattern::parse("Vision"), {}, {}, {}, {}};
    rule.pack.rules = {ltm::PackRule{.codec = "none"}};
    if (redacts) rule.redact = marker_redaction(service_.folder.path(), mode);
    service_.options.store->recording.rules = {rule};
    service_.open();
  }

  /// Whether any image that a question is answered with holds the secret.
  bool is_answered(const std::string& query) {
    const auto answer = service_->query(*ltm::Query::parse(query));
    EXPECT_OK(answer);
    bool is_found = false;
    for (const auto& entity : answer->entities)
      for (const auto& moment : entity.snapshots) {
        const auto look = [&](const idf::Data& data) {
          const auto* array = data.at("image")->get_if<idf::NdArray>();
          is_found = is_found || (array != nullptr && has_secret(*array));
        };
        if (moment.held)
          for (const auto& instance : moment.held->instances) look(instance.data);
        for (const auto& instance : moment.answer.instances)
          if (instance.data.at("image") != nullptr) look(instance.data);
      }
    return is_found;
  }

  static idf::Data value(int x) {
    return idf::Dict{{"image", image_with_secret(64, 48, x, 5)},
                     {"mask", image_with_secret(64, 48, -1, 0)}};
  }

  ServedMemory service_;
};

TEST_F(ServiceRedactionTest, ShowsNobodyWhatIsFound) {
  open(false);
  ASSERT_OK(service_.commit_durably(ServedMemory::commit(kCamera, 1, value(20))));
  ASSERT_TRUE(is_answered("Vision @ all")) << "else nothing would be proven below";
  // The journal has arrays as they are, segments compress them.
  ASSERT_TRUE(has_secret_file(service_.options.store->store));
  service_.close();
  std::filesystem::remove_all(service_.options.store->store);

  open();
  const auto admission = service_->commit(ServedMemory::commit(kCamera, 1, value(20)), {},
                                          MemoryService::Durability::kJournal);
  ASSERT_OK(admission);
  // What subscribers are told of.
  ASSERT_EQ(admission->snapshots.size(), 1u);
  const idf::Data& told = admission->snapshots[0]->instances[0].data;
  EXPECT_FALSE(has_secret(told.at("image")->get<idf::NdArray>()));
  ASSERT_OK(service_->wait_stored(*admission));
  EXPECT_FALSE(is_answered("Vision @ all"));
  EXPECT_FALSE(is_answered("Vision @ latest, +100ms"));
  // Once, and not for the store again; the mask of the same size follows the image.
  EXPECT_EQ(service_->counters().redaction.images, 2u);
  EXPECT_EQ(service_->counters().redaction.boxes, 1u);
  EXPECT_EQ(service_->counters().redaction.redacted, 2u);
  EXPECT_FALSE(has_secret_file(service_.options.store->store));
  service_.close();
  EXPECT_FALSE(has_secret_file(service_.options.store->store));
}

TEST_F(ServiceRedactionTest, KeepsNoBytesOfAMessageWithWhatWasFound) {
  open();
  // Both updates lie in one block of bytes, as they come by shared memory.
  const idf::NdArray secret = image_with_secret(64, 48, 20, 5);
  const idf::NdArray plain = image_with_secret(64, 48, -1, 0);
  std::vector<std::byte> all(secret.bytes().begin(), secret.bytes().end());
  all.insert(all.end(), plain.bytes().begin(), plain.bytes().end());
  const Buffer block = Buffer::take(std::move(all));
  const size_t size = secret.bytes().size();
  const auto part = [&](size_t at) {
    return *idf::NdArray::create(idf::ElementType::kUInt8, {48, 64, 3}, block.slice(at, size));
  };
  ltm::Commit commit = ServedMemory::commit(kCamera, 1, idf::Dict{{"image", part(0)}});
  commit.updates.push_back(
      ServedMemory::commit("Robot/a/b/c", 1, idf::Dict{{"image", part(size)}}).updates[0]);
  std::vector<std::vector<Buffer>> encoded{{block.slice(0, size)}, {block.slice(size, size)}};
  const std::weak_ptr<const void> owner = block.owner();
  const long before = owner.use_count();
  auto admission = service_->commit(commit, std::move(encoded));
  ASSERT_OK(admission);
  commit = {};
  ASSERT_EQ(admission->snapshots.size(), 2u);
  for (const ltm::SharedSnapshot& snapshot : admission->snapshots) {
    EXPECT_TRUE(snapshot->encoded.empty());
    const auto& image = snapshot->instances[0].data.at("image")->get<idf::NdArray>();
    EXPECT_FALSE(has_secret(image));
    EXPECT_NE(image.buffer().owner(), block.owner());
  }
  EXPECT_LT(owner.use_count(), before) << "only this test has it";
}

TEST_F(ServiceRedactionTest, LooksAtWhatTheCastMakesOfValues) {
  open();
  using idf::Type;
  const auto type =
      Type::object("Seen", {{"images", Type::ndarray(idf::ElementType::kUInt8, {6, 48, 64})}});
  ASSERT_OK(service_->declare(*ltm::MemoryId::parse("Vision/RGB"), type));
  std::vector<uint8_t> jpeg(500);
  jpeg[0] = 0xFF, jpeg[1] = 0xD8, jpeg[2] = 0xFF;
  const Buffer came = Buffer::copy(std::as_bytes(std::span(jpeg)));
  const auto admission = service_->commit(
      ServedMemory::commit(
          kCamera, 1,
          idf::Dict{{"images", ltm::testing::grey_images_with_secret<double>(6, 64, 48, 20, 5)},
                    {"a file that the type has no place for", idf::NdArray::take({500}, jpeg)}}),
      {{came}});
  ASSERT_OK(admission);
  ASSERT_EQ(admission->snapshots.size(), 1u);
  EXPECT_TRUE(admission->snapshots[0]->encoded.empty());
  const idf::Data& data = admission->snapshots[0]->instances[0].data;
  EXPECT_EQ(data.get<idf::Dict>().size(), 1u);
  EXPECT_EQ(data.at("images")->get<idf::NdArray>().type(), idf::ElementType::kUInt8);
  EXPECT_FALSE(has_secret(data.at("images")->get<idf::NdArray>()));
  EXPECT_EQ(service_->counters().redaction.boxes, 1u);
  EXPECT_EQ(service_->counters().memory.reinterpreted, 1u);
}

TEST_F(ServiceRedactionTest, LooksAtNothingThatIsRefused) {
  open();
  ltm::Commit ahead = ServedMemory::commit(kCamera, 1, value(20));
  ahead.updates[0].time = system_now() + std::chrono::hours(1000);
  EXPECT_EQ(service_->commit(ahead).status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(service_->counters().redaction.images, 0u);
}

TEST_F(ServiceRedactionTest, KeepsTheBytesOfWhatShowsNothing) {
  open();
  const idf::NdArray plain = image_with_secret(64, 48, -1, 0);
  const auto admission = service_->commit(
      ServedMemory::commit(kCamera, 1, idf::Dict{{"image", plain}}), {{plain.buffer()}});
  ASSERT_OK(admission);
  EXPECT_EQ(admission->snapshots[0]->encoded.size(), 1u);
}

TEST_F(ServiceRedactionTest, AdmitsNothingWithoutAnAnswer) {
  open(true, "silent");
  const auto first = service_->commit(ServedMemory::commit(kCamera, 1, value(20)), {},
                                      MemoryService::Durability::kJournal);
  ASSERT_OK(first);
  EXPECT_TRUE(first->snapshots.empty());
  EXPECT_OK(service_->wait_stored(*first));
  EXPECT_EQ(service_->counters().redaction.unanswered, 1u);
  EXPECT_EQ(service_->counters().redaction.dropped, 1u);
  EXPECT_EQ(service_->counters().memory.committed, 0u);
  ltm::Commit both = ServedMemory::commit(kCamera, 2, value(20));
  both.updates.push_back(ServedMemory::commit("Robot/a/b/c", 2).updates[0]);
  const auto second = service_->commit(both);
  ASSERT_OK(second);
  EXPECT_EQ(second->snapshots.size(), 1u);
}

TEST_F(ServiceRedactionTest, RefusesCommitsThatAreNoneAsBefore) {
  open();
  ltm::Commit wrong;
  wrong.updates.push_back({*ltm::MemoryId::parse("Vision/RGB"), Time{}, {{value(20), {}}}});
  EXPECT_EQ(service_->commit(wrong).status().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::memory
