// SPDX-License-Identifier: Apache-2.0
// Random bit flips in every kind of file: found by check_store, never a crash, never wrong data,
// and recover_store saves all the rest.
#include <set>

#include "ltm/recall/recall.h"
#include "ltm/store/journal.h"
#include "ltm/store/recover.h"
#include "ltm/store/store_check.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/store/full_store.h"

namespace engram::ltm {
namespace {

/// Flips per kind of file; every so many of them the store is recovered, too.
constexpr int kFlips = 200;
constexpr int kRecoverEvery = 8;

class BitFlip : public ::testing::Test {
 protected:
  BitFlip() : store_(FullStore::make(scratch_ / "store")) {}

  /// Flips bits of `file`; `is_unused` says of which bytes nobody needs to know. `held` snapshots
  /// lie in the file, `latents` of them as latents, too.
  void flip_many(const std::string& file, uint64_t held, uint64_t latents,
                 const std::set<uint64_t>& unused = {}) {
    const Buffer whole = *read_file(store_.path / file);
    RandomValues random(static_cast<uint32_t>(whole.size()));
    for (int i = 0; i < kFlips && !HasFatalFailure(); ++i) {
      const uint64_t bit = random.below(whole.size() * 8);
      SCOPED_TRACE(file + " bit " + std::to_string(bit));
      flip_bit(store_.path / file, bit);
      if (!unused.contains(bit / 8)) expect_found(file);
      expect_nothing_wrong();
      if (i % kRecoverEvery == 0) expect_recovered(held, latents);
      overwrite_file(store_.path / file, whole.bytes());
    }
    EXPECT_TRUE(check_store(store_.path)->is_clean());
  }

  void expect_found(const std::string& file) {
    const auto report = check_store(store_.path);
    // A flip in the number of the format makes it a newer one, which no program may judge.
    if (report.status().code() == StatusCode::kFailedPrecondition) return;
    ASSERT_OK(report);
    EXPECT_TRUE(std::ranges::any_of(report->findings, [&](const Finding& finding) {
      return finding.severity == Severity::kFault && finding.file == file;
    }));
  }

  void expect_nothing_wrong() {
    EXPECT_EQ(read_back(store_, store_.path).wrong, 0u);
    auto reader = StoreReader::open(store_.path);
    if (!reader.ok()) return;
    Recall recall(std::move(*reader), {});
    const auto answer = recall.query(*Query::parse("@ latest:60"));
    if (!answer.ok()) return;
    for (const EntityResult* entity : answer->entities())
      for (const SnapshotResult& found : entity->snapshots)
        for (size_t i = 0; i < found.instances.size(); ++i)
          EXPECT_EQ(found.instances[i].data,
                    store_.snapshots.at(entity->id).at(found.time).instances.at(i).data);
  }

  void expect_recovered(uint64_t held, uint64_t latents) {
    const auto copy = scratch_ / "copy";
    const auto report = recover_store(store_.path, copy);
    if (report.status().code() == StatusCode::kFailedPrecondition) return;
    ASSERT_OK(report);
    const ReadBack found = read_back(store_, copy);
    EXPECT_EQ(found.wrong, 0u);
    EXPECT_EQ(found.failed, 0u);
    EXPECT_GE(found.recorded, kFullRecorded - held);
    EXPECT_GE(found.latent, kFullLatent - latents);
    const bool is_all = found.recorded == kFullRecorded && found.latent == kFullLatent;
    EXPECT_EQ(report->has_loss(), !is_all);
    EXPECT_TRUE(check_store(copy, {true, {}})->is_clean());
    std::filesystem::remove_all(copy);
  }

  /// Bytes between the frames of a journal.
  [[nodiscard]] std::set<uint64_t> padding(const std::string& file) const {
    std::set<uint64_t> bytes;
    const auto scan =
        scan_journal(store_.path / file, [&](uint64_t offset, const Buffer& payload) -> Status {
          for (uint64_t at = offset + Journal::kFrameOverheadBytes + payload.size(); at % 8 != 0;
               ++at)
            bytes.insert(at);
          return {};
        });
    EXPECT_OK(scan);
    return bytes;
  }

  ScratchDirectory scratch_;
  FullStore store_;
};

TEST_F(BitFlip, OfTheManifestIsFoundAndCostsNothing) {
  flip_many("MANIFEST.json", 0, 0);
}

TEST_F(BitFlip, OfAJournalCostsOneSnapshotAtMost) {
  const std::string file = Journal::file_name(3).string();
  flip_many(file, 1, 0, padding(file));
}

TEST_F(BitFlip, OfASegmentWithPngsIsFound) {
  flip_many("segments/000001.h5", FullStore::kSealed, 0);
}

TEST_F(BitFlip, OfASegmentWithZstandardMediaIsFound) {
  flip_many("segments/000002.h5", FullStore::kSealed, 0);
}

TEST_F(BitFlip, OfALatentSegmentIsFound) {
  flip_many("segments/000003.h5", 0, kFullLatent);
}

TEST_F(BitFlip, OfBlocksOfLatentsIsFound) {
  std::filesystem::remove_all(store_.path);
  store_ = FullStore::make(scratch_ / "store", true);
  flip_many("segments/000003.h5", 0, kFullLatent);
}

TEST_F(BitFlip, OfAModelIsFound) {
  flip_many(model_file_name(example_entity(), 1), 0, kFullLatent);
}

}  // namespace
}  // namespace engram::ltm
