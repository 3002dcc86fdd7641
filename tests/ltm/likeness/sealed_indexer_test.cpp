// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/sealed_indexer.h"

#include "ltm/likeness/make_codes.h"
#include "ltm/likeness/similar.h"
#include "ltm/likeness/stored_codes.h"
#include "ltm/store/segment_index.h"
#include "tests/ltm/likeness/drawn_moments.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

constexpr int64_t kInRoom = 60;

class SealedIndexerTest : public ::testing::Test {
 protected:
  SealedIndexerTest() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  /// Records moments of a new room and seals them, with a coder that is told of it.
  void record(SealedIndexer& coder, int64_t recording) {
    StoreWriter::Options options;
    options.after_seal = [&coder](const std::string& segment) { coder.add(segment); };
    const auto writer = StoreWriter::open(store_, options);
    ASSERT_OK(writer);
    for (int64_t i = 0; i < kInRoom; ++i)
      ASSERT_OK((*writer)->append(drawn_moment(recording, i), nullptr));
    ASSERT_OK((*writer)->seal());
  }

  [[nodiscard]] uint64_t computed() const {
    const auto past = StorePast::open(store_, {}, {});
    EXPECT_OK(past);
    const auto answer =
        LikenessSearch(**past).find({.entity = example_entity(), .moment = example_time(30)});
    EXPECT_OK(answer);
    return answer->computed;
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

TEST_F(SealedIndexerTest, CodesWhatIsSealedOnceTheEntityHasASpace) {
  SealedIndexer coder(store_);
  record(coder, 0);
  coder.finish();
  EXPECT_EQ(coder.counters().coded, 0u);
  // Places and links are indexed without a space.
  EXPECT_TRUE(std::filesystem::exists(store_ / kIndexFolder / "000001.context"));
  EXPECT_FALSE(std::filesystem::exists(store_ / kIndexFolder / "000001.codes"));
  ASSERT_OK(make_codes(store_, {}, {}, {}, {}));
  record(coder, 1);
  coder.finish();
  EXPECT_EQ(coder.counters().coded, static_cast<uint64_t>(kInRoom));
  EXPECT_EQ(coder.counters().left, 0u);
  EXPECT_EQ(computed(), 0u);
  // A night finds all of it done, and learns anew where there is twice as much.
  const auto night = make_codes(store_, {}, {}, {}, {});
  ASSERT_OK(night);
  EXPECT_TRUE(night->front().is_learned);
  record(coder, 2);
  coder.finish();
  const auto next = make_codes(store_, {}, {}, {}, {});
  ASSERT_OK(next);
  EXPECT_EQ(next->front().coded, 0u);
  EXPECT_EQ(next->front().kept, static_cast<uint64_t>(3 * kInRoom));
}

TEST_F(SealedIndexerTest, LeavesTheRestToTheNightWhenItEnds) {
  {
    SealedIndexer coder(store_);
    for (int64_t room = 0; room < 3; ++room) record(coder, room);
    ASSERT_OK(make_codes(store_, {}, {}, {}, {}));
    // Fewer than would have the night learn anew, and code all again.
    record(coder, 3);
    record(coder, 4);
  }
  const auto night = make_codes(store_, {}, {}, {}, {});
  ASSERT_OK(night);
  EXPECT_FALSE(night->front().is_learned);
  EXPECT_GT(night->front().coded, 0u) << "it was not stopped";
  EXPECT_EQ(night->front().kept + night->front().coded, static_cast<uint64_t>(5 * kInRoom));
  EXPECT_EQ(computed(), 0u);
}

TEST_F(SealedIndexerTest, DoesNotReplaceTheCodesOfANight) {
  SealedIndexer coder(store_);
  record(coder, 0);
  ASSERT_OK(make_codes(store_, {}, {}, {}, {}));
  const Manifest manifest = *read_manifest(store_);
  const auto before = read_segment_index(store_, manifest.segments.back(), kCodesIndex);
  ASSERT_OK(before);
  coder.add(manifest.segments.back().file);
  coder.add("segments/999999.h5");
  coder.finish();
  const auto after = read_segment_index(store_, manifest.segments.back(), kCodesIndex);
  ASSERT_OK(after);
  EXPECT_TRUE(std::ranges::equal(before->bytes(), after->bytes()));
  EXPECT_EQ(coder.counters().left, 0u);
}

}  // namespace
}  // namespace engram::ltm
