// SPDX-License-Identifier: Apache-2.0
// Images that are sealed as groups: ltm/store/media_sorter.h.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "ltm/codec/codec.h"
#include "ltm/codec/group_codec.h"
#include "ltm/h5/h5.h"
#include "ltm/store/segment_format.h"
#include "tests/ltm/store/media_groups_fixture.h"

namespace engram::ltm {
namespace {

class MediaGroups : public MediaGroupsFixture {
 protected:
  /// Records pictures from `first` on, without end; reports each acknowledged one.
  [[noreturn]] void write_forever(int64_t first, int report) {
    const PackOptions options = group_options("ffv1:group=5");
    StoreWriter::Options writing{.durability = Durability::kNone, .seal_bytes = 8000};
    writing.seal_rules = [rules = *SealRules::create(options)](const MemoryId&) { return rules; };
    const auto writer = StoreWriter::open(store_, writing);
    if (!writer.ok()) ::_exit(3);
    for (int64_t i = first;; ++i) {
      if (!(*writer)->append({packed(snapshot(i, picture(i)), options)}, nullptr).ok()) ::_exit(4);
      if (::write(report, &i, sizeof(i)) != sizeof(i)) ::_exit(5);
    }
  }
};

TEST_F(MediaGroups, GiveBackWhatWasRecorded) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 25; ++i) snapshots.push_back(snapshot(i, picture(i)));
  seal(snapshots, "ffv1:group=10");
  expect_content(snapshots);
  expect_clean(store_);
  const auto names = codecs();
  EXPECT_EQ(names[0], "ffv1 0/10");
  EXPECT_EQ(names[19], "ffv1 9/10");
  EXPECT_EQ(names[24], "ffv1 4/5");
  const auto reader = *StoreReader::open(store_);
  EXPECT_EQ(reader->forms(example_entity(), 0)->media_codecs, std::set<std::string>{"ffv1"});
}

TEST_F(MediaGroups, LeaveOutRowsWithoutAnImage) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 40; ++i)
    snapshots.push_back(snapshot(i, i % 7 == 3 || i < 2 ? idf::Data() : idf::Data(picture(i))));
  seal(snapshots, "ffv1:group=10");
  expect_content(snapshots);
  expect_clean(store_);
}

TEST_F(MediaGroups, HoldOneInstanceAndOneShapeEach) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 24; ++i) {
    Snapshot made = snapshot(i, picture(i));
    if (i % 3 != 0) {
      const idf::NdArray right =
          i % 2 == 0 ? picture(i, 1) : smooth_image(16, 20, 1, static_cast<int>(i));
      made.instances.push_back({snapshot(i, right).instances[0].data, example_metadata(i)});
    }
    snapshots.push_back(made);
  }
  seal(snapshots, "ffv1:group=5");
  expect_content(snapshots);
  expect_clean(store_);
  EXPECT_EQ(codecs()[4], "ffv1 4/5");
}

TEST_F(MediaGroups, AreFewWhereShapesAreMany) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 60; ++i)
    snapshots.push_back(snapshot(i, smooth_image(16 + i, 16, 3, static_cast<int>(i))));
  seal(snapshots, "ffv1:group=5");
  expect_content(snapshots);
  const auto file = *h5::File::open(segment_file());
  EXPECT_LE(file.read_strings(segment_group(example_entity()) + "/media_groups")->size(), 17u);
}

TEST_F(MediaGroups, WithLossAreWhatTheCodecSays) {
  seal_pictures(0, 12, "h264:crf=23,group=10");
  const auto found = read();
  ASSERT_EQ(found.size(), 12u);
  for (int64_t i = 0; i < 12; ++i) {
    const auto& image =
        found[static_cast<size_t>(i)].instances[0].data.at("image")->get<idf::NdArray>();
    EXPECT_GE(psnr_db(image, picture(i)), find_group_codec("h264")->psnr_db());
    EXPECT_FALSE(image == picture(i));
  }
  expect_clean(store_);
}

TEST_F(MediaGroups, AreNotMadeOfImagesThatHaveLossAlready) {
  const auto writing = writer(group_options("h264"));
  const PackOptions jpeg{.rules = {{.kind = MediumKind::kImage, .codec = "jpeg"}}};
  for (int64_t i = 0; i < 5; ++i)
    ASSERT_OK(writing->append({packed(snapshot(i, picture(i)), jpeg)}, nullptr));
  ASSERT_OK(writing->seal());
  for (const std::string& name : codecs()) EXPECT_EQ(name, "jpeg");
}

TEST_F(MediaGroups, AreNotMadeOfWhatAnotherSessionRecorded) {
  {
    const auto killed = writer(group_options("h264"));
    for (int64_t i = 0; i < 5; ++i)
      ASSERT_OK(killed->append({packed(snapshot(i, picture(i)), group_options("h264"))}, nullptr));
  }
  seal_pictures(5, 10, "ffv1:group=5");
  std::vector<Snapshot> expected;
  for (int64_t i = 0; i < 10; ++i) expected.push_back(snapshot(i, picture(i)));
  expect_content(expected);
  EXPECT_EQ(codecs()[4], "rowpred");
  EXPECT_EQ(codecs()[5], "ffv1 0/5");
}

TEST_F(MediaGroups, AreNotMadeOfWhatDoesNotDecode) {
  const auto writing = writer(group_options("ffv1:group=5"));
  for (int64_t i = 0; i < 5; ++i) {
    PackedSnapshot made = packed(snapshot(i, picture(i)), group_options("ffv1:group=5"));
    if (i == 2) made.instances[0].value.media[0].bytes = Buffer::copy(as_bytes("no picture"));
    ASSERT_OK(writing->append({made}, nullptr));
  }
  ASSERT_OK(writing->seal());
  EXPECT_EQ(codecs(), std::vector<std::string>(5, "rowpred"));
}

TEST_F(MediaGroups, WithoutLossGoIntoAJournalOneByOne) {
  seal_pictures(0, 10, "ffv1:group=10");
  const auto expected = read();
  const auto from = *StoreReader::open(store_);
  const auto other = scratch_ / "other";
  ASSERT_OK(create_store(other));
  const auto writing = *StoreWriter::open(other, {});
  for (const SnapshotEntry& entry : **from->index(example_entity()))
    ASSERT_OK(writing->append({*from->read_packed(example_entity(), entry)}, nullptr));
  EXPECT_EQ(*read_all(**StoreReader::open(other), example_entity()), expected);
}

TEST_F(MediaGroups, WithLossDoNotGoIntoAJournal) {
  seal_pictures(0, 2, "h264:group=2");
  const auto from = *StoreReader::open(store_);
  const SnapshotEntry& first = (*from->index(example_entity()))->front();
  const auto writing = *StoreWriter::open(store_, {});
  EXPECT_FAILS(writing->append({*from->read_packed(example_entity(), first)}, nullptr),
               StatusCode::kInvalidArgument, "'image': is of a group of 'h264', which has loss");
}

TEST_F(MediaGroups, LoseNothingAcknowledgedWhereTheWriterIsKilledWhileSealing) {
  const auto is_sealed = [&] {
    const auto names = codecs();
    return std::ranges::any_of(names, [](const auto& name) { return name.starts_with("ffv1"); });
  };
  int64_t next = 0;
  // On a slow machine it takes more rounds, which grow longer, until something was sealed at all.
  for (int round = 0; round < 12 || (round < 60 && !is_sealed()); ++round) {
    int ends[2] = {-1, -1};
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) write_forever(next, ends[1]);
    ::close(ends[1]);
    // Nothing is killed before the child has begun.
    int64_t last = next - 1, index = 0;
    if (::read(ends[0], &index, sizeof(index)) == sizeof(index)) last = index;
    std::jthread killer([child, round] {
      std::this_thread::sleep_for(std::chrono::milliseconds(15 + round * 7));
      ::kill(child, SIGKILL);
    });
    while (::read(ends[0], &index, sizeof(index)) == sizeof(index)) last = index;
    killer.join();
    int outcome = 0;
    ::waitpid(child, &outcome, 0);
    EXPECT_TRUE(WIFSIGNALED(outcome));
    ::close(ends[0]);
    const auto found = read();
    ASSERT_GE(static_cast<int64_t>(found.size()), last + 1);
    next = static_cast<int64_t>(found.size());
    for (int64_t i = 0; i < next; ++i)
      ASSERT_EQ(found[static_cast<size_t>(i)], snapshot(i, picture(i)));
  }
  EXPECT_TRUE(is_sealed());
}

}  // namespace
}  // namespace engram::ltm
