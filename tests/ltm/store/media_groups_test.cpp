// SPDX-License-Identifier: Apache-2.0
// Images that are sealed as groups: ltm/store/media_sorter.h and segment_media_reader.h.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "ltm/codec/codec.h"
#include "ltm/codec/group_codec.h"
#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "ltm/store/check.h"
#include "ltm/store/publish.h"
#include "ltm/store/recover.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/segment_format.h"
#include "ltm/store/segment_media.h"
#include "ltm/store/segment_media_reader.h"
#include "ltm/store/segment_reader.h"
#include "ltm/store/segment_writer.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/codec/test_images.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

constexpr int64_t kHeight = 24, kWidth = 32;

PackOptions options_for(const std::string& codec) {
  return {.rules = {{.kind = MediumKind::kImage, .codec = codec},
                    {.kind = MediumKind::kNumber, .codec = "columns"}}};
}

idf::NdArray picture(int64_t index, int64_t side = 0) {
  return smooth_image(kHeight, kWidth, 3, static_cast<int>(index * 3 + side * 40));
}

class MediaGroups : public ::testing::Test {
 protected:
  MediaGroups() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  static Snapshot snapshot(int64_t index, const idf::Data& image) {
    const idf::Dict value{{"image", image},
                          {"x", 0.5 * static_cast<double>(index)},
                          {"label", "number " + std::to_string(index)}};
    return {example_entity(), example_time(index), {{value, example_metadata(index)}}};
  }

  static PackedSnapshot packed(const Snapshot& snapshot, const PackOptions& options) {
    PackedSnapshot made{snapshot.entity, snapshot.time, {}, snapshot.raw_bytes(), 0, 0};
    for (const Instance& instance : snapshot.instances)
      made.instances.push_back({*pack(instance.data, options), instance.metadata});
    return made;
  }

  std::unique_ptr<StoreWriter> writer(const PackOptions& options) {
    StoreWriter::Options writing;
    writing.seal_rules = [rules = *SealRules::create(options)](const MemoryId&) { return rules; };
    return *StoreWriter::open(store_, writing);
  }

  void seal(const std::vector<Snapshot>& snapshots, const std::string& codec) {
    const auto writing = writer(options_for(codec));
    for (const Snapshot& each : snapshots)
      ASSERT_OK(writing->append({packed(each, options_for(codec))}, nullptr));
    ASSERT_OK(writing->seal());
  }

  /// Records pictures from `first` on, without end; reports each acknowledged one.
  [[noreturn]] void write_forever(int64_t first, int report) {
    const PackOptions options = options_for("ffv1:group=5");
    StoreWriter::Options writing{.durability = Durability::kNone, .seal_bytes = 8000};
    writing.seal_rules = [rules = *SealRules::create(options)](const MemoryId&) { return rules; };
    const auto writer = StoreWriter::open(store_, writing);
    if (!writer.ok()) ::_exit(3);
    for (int64_t i = first;; ++i) {
      if (!(*writer)->append({packed(snapshot(i, picture(i)), options)}, nullptr).ok()) ::_exit(4);
      if (::write(report, &i, sizeof(i)) != sizeof(i)) ::_exit(5);
    }
  }

  void seal_pictures(int64_t first, int64_t end, const std::string& codec) {
    std::vector<Snapshot> snapshots;
    for (int64_t i = first; i < end; ++i) snapshots.push_back(snapshot(i, picture(i)));
    seal(snapshots, codec);
  }

  std::vector<Snapshot> read() {
    const auto reader = *StoreReader::open(store_);
    auto found = read_all(*reader, example_entity());
    EXPECT_OK(found);
    return found.ok() ? *std::move(found) : std::vector<Snapshot>();
  }

  void expect_content(const std::vector<Snapshot>& expected) {
    const auto found = read();
    ASSERT_EQ(found.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(found[i], expected[i]) << i;
  }

  /// The first medium of each snapshot, as it is stored.
  std::vector<PackedMedium> media() {
    const auto reader = *StoreReader::open(store_);
    std::vector<PackedMedium> found;
    for (const SnapshotEntry& entry : **reader->index(example_entity())) {
      const PackedSnapshot packed = *reader->read_packed(example_entity(), entry);
      for (const PackedMedium& medium : packed.instances[0].value.media) found.push_back(medium);
    }
    return found;
  }

  std::vector<std::string> codecs() {
    std::vector<std::string> names;
    for (const PackedMedium& medium : media())
      names.push_back(medium.group ? fmt::format("{} {}/{}", medium.codec, medium.group->index,
                                                 medium.group->count)
                                   : medium.codec);
    return names;
  }

  void expect_clean(const std::filesystem::path& store) {
    const auto report = check_store(store, {true, {}});
    ASSERT_OK(report);
    for (const Finding& finding : report->findings)
      ADD_FAILURE() << finding.file << ": " << finding.object << ": " << finding.what;
  }

  std::filesystem::path segment_file() {
    return store_ / read_manifest(store_)->segments.back().file;
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
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

TEST_F(MediaGroups, AreCopiedWholeByCompaction) {
  seal_pictures(0, 20, "h264:group=10");
  seal_pictures(20, 30, "h264:group=10");
  const auto before = read();
  const auto media_before = media();
  ASSERT_OK(compact(store_, {}));
  ASSERT_EQ(read_manifest(store_)->segments.size(), 1u);
  expect_content(before);
  const auto media_after = media();
  ASSERT_EQ(media_after.size(), media_before.size());
  for (size_t i = 0; i < media_after.size(); ++i) {
    EXPECT_EQ(media_after[i].codec, "h264");
    EXPECT_TRUE(std::ranges::equal(media_after[i].bytes.bytes(), media_before[i].bytes.bytes()));
  }
  expect_clean(store_);
}

TEST_F(MediaGroups, AreTakenApartWithoutLossWhereOneImageIsForgotten) {
  seal_pictures(0, 30, "h264:group=10");
  auto expected = read();
  const Buffer gone = media()[13].bytes;
  ASSERT_OK(forget_snapshots(store_, {{example_entity(), {example_time(13)}}}));
  expected.erase(expected.begin() + 13);
  expect_content(expected);
  const auto names = codecs();
  EXPECT_EQ(names[9], "h264 9/10");
  EXPECT_EQ(names[10], "rowpred");
  EXPECT_EQ(names[18], "rowpred");
  EXPECT_EQ(names[19], "h264 0/10");
  const Buffer whole = *read_file(segment_file());
  EXPECT_TRUE(std::ranges::search(whole.bytes(), gone.bytes().last(64)).empty());
  EXPECT_FALSE(std::ranges::search(whole.bytes(), media()[0].bytes.bytes().last(64)).empty());
  expect_clean(store_);
  EXPECT_EQ((*StoreReader::open(store_))->forms(example_entity(), 0)->media_codecs,
            (std::set<std::string>{"h264", "rowpred"}));
}

TEST_F(MediaGroups, LoseOneImageToAnUpdate) {
  seal_pictures(0, 10, "ffv1:group=10");
  const Snapshot update = snapshot(4, picture(77));
  seal({update}, "ffv1:group=10");
  auto expected = read();
  EXPECT_EQ(expected[4], update);
  ASSERT_OK(compact(store_, {}));
  expect_content(expected);
  EXPECT_EQ(codecs()[3], "rowpred");
  EXPECT_EQ(codecs()[4], "ffv1 0/1");
  expect_clean(store_);
}

TEST_F(MediaGroups, AreNotMadeOfImagesThatHaveLossAlready) {
  const auto writing = writer(options_for("h264"));
  const PackOptions jpeg{.rules = {{.kind = MediumKind::kImage, .codec = "jpeg"}}};
  for (int64_t i = 0; i < 5; ++i)
    ASSERT_OK(writing->append({packed(snapshot(i, picture(i)), jpeg)}, nullptr));
  ASSERT_OK(writing->seal());
  for (const std::string& name : codecs()) EXPECT_EQ(name, "jpeg");
}

TEST_F(MediaGroups, AreNotMadeOfWhatAnotherSessionRecorded) {
  {
    const auto killed = writer(options_for("h264"));
    for (int64_t i = 0; i < 5; ++i)
      ASSERT_OK(killed->append({packed(snapshot(i, picture(i)), options_for("h264"))}, nullptr));
  }
  seal_pictures(5, 10, "ffv1:group=5");
  std::vector<Snapshot> expected;
  for (int64_t i = 0; i < 10; ++i) expected.push_back(snapshot(i, picture(i)));
  expect_content(expected);
  EXPECT_EQ(codecs()[4], "rowpred");
  EXPECT_EQ(codecs()[5], "ffv1 0/5");
}

TEST_F(MediaGroups, AreNotMadeOfWhatDoesNotDecode) {
  const auto writing = writer(options_for("ffv1:group=5"));
  for (int64_t i = 0; i < 5; ++i) {
    PackedSnapshot made = packed(snapshot(i, picture(i)), options_for("ffv1:group=5"));
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

TEST_F(MediaGroups, AreRecoveredButForTheDamagedOne) {
  seal_pictures(0, 30, "h264:group=10");
  const auto before = read();
  const Buffer group = media()[10].bytes;
  const Buffer whole = *read_file(segment_file());
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  const auto place = std::ranges::search(damaged, group.bytes());
  ASSERT_FALSE(place.empty());
  *(place.begin() + 20) ^= std::byte{1};
  overwrite_file(segment_file(), damaged);
  EXPECT_FALSE(check_store(store_)->is_clean());
  const auto copy = scratch_ / "copy";
  const auto report = recover_store(store_, copy);
  ASSERT_OK(report);
  EXPECT_EQ(report->entities.at(example_entity()).recorded, 20u);
  EXPECT_EQ(report->entities.at(example_entity()).recorded_lost, 10u);
  std::filesystem::remove_all(store_);
  std::filesystem::rename(copy, store_);
  auto expected = before;
  expected.erase(expected.begin() + 10, expected.begin() + 20);
  expect_content(expected);
  EXPECT_EQ(codecs()[0], "h264 0/10");
  EXPECT_EQ(codecs()[19], "h264 9/10");
  EXPECT_TRUE((*StoreReader::open(store_))->forms(example_entity(), 0)->has_columns());
  expect_clean(store_);
}

TEST_F(MediaGroups, ThatDoNotDecodeAreLostAloneWhereTheirSegmentIsDamaged) {
  const Buffer nothing = Buffer::copy(as_bytes("no group of images"));
  RecordedEntity recorded;
  std::vector<Snapshot> expected;
  for (int64_t i = 0; i < 30; ++i) {
    Snapshot made = snapshot(i, picture(i));
    made.instances[0].data.get_if<idf::Dict>()->set("other", picture(i, 1));
    recorded.snapshots.push_back(packed(made, {}));
    if (i < 10 || i >= 20) expected.push_back(made);
    if (i < 10 || i >= 20) continue;
    PackedMedium& medium = recorded.snapshots.back().instances[0].value.media[0];
    ASSERT_EQ(medium.path, "image");
    medium.codec = "h264";
    medium.bytes = nothing;
    medium.group = {static_cast<uint32_t>(i - 10), 10};
  }
  auto info =
      *write_recorded_segment(store_ / "segments/000001.h5", {{example_entity(), recorded}});
  info.file = "segments/000001.h5";
  ASSERT_OK(edit_manifest(store_, [&info](Manifest& manifest) {
    manifest.segments.push_back(info);
    manifest.next_segment = 2;
    return Status();
  }));
  // The group is cut where the other image of a row is damaged.
  const Buffer other = recorded.snapshots[13].instances[0].value.media[1].bytes;
  const Buffer whole = *read_file(segment_file());
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  const auto place = std::ranges::search(damaged, other.bytes());
  ASSERT_FALSE(place.empty());
  place.front() ^= std::byte{1};
  overwrite_file(segment_file(), damaged);
  const auto copy = scratch_ / "copy";
  const auto report = recover_store(store_, copy);
  ASSERT_OK(report);
  EXPECT_EQ(report->entities.at(example_entity()).recorded, 20u);
  EXPECT_EQ(report->entities.at(example_entity()).recorded_lost, 10u);
  EXPECT_EQ(*read_all(**StoreReader::open(copy), example_entity()), expected);
}

TEST_F(MediaGroups, WithFlippedBitsAreFoundAndNeverWrong) {
  std::vector<Snapshot> snapshots;
  for (int64_t i = 0; i < 120; ++i)
    snapshots.push_back(snapshot(i, i % 5 == 2 ? idf::Data() : idf::Data(picture(i))));
  seal(snapshots, "h264:group=6");
  const auto expected = read();
  const Buffer whole = *read_file(segment_file());
  RandomValues random(5);
  for (int flip = 0; flip < 150; ++flip) {
    std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
    const uint64_t bit = random.below(damaged.size() * 8);
    damaged[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
    overwrite_file(segment_file(), damaged);
    const auto report = check_store(store_);
    EXPECT_TRUE(!report.ok() || !report->is_clean()) << bit;
    const auto reader = StoreReader::open(store_);
    const auto entries = reader.ok() ? (*reader)->index(example_entity()) : reader.status();
    if (!entries.ok()) continue;
    ASSERT_EQ((*entries)->size(), expected.size()) << bit;
    for (size_t i = 0; i < expected.size(); ++i) {
      const auto found = (*reader)->read_recorded(example_entity(), (**entries)[i]);
      if (found.ok()) {
        EXPECT_EQ(*found, expected[i]) << bit;
      }
    }
  }
}

TEST_F(MediaGroups, LoseNothingAcknowledgedWhereTheWriterIsKilledWhileSealing) {
  int64_t next = 0;
  for (int round = 0; round < 12; ++round) {
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
  const auto names = codecs();
  EXPECT_TRUE(
      std::ranges::any_of(names, [](const auto& name) { return name.starts_with("ffv1"); }));
}

/// A media group written by hand.
class HostileGroups : public ::testing::Test {
 protected:
  Result<std::vector<PackedMedium>> read(const std::vector<uint64_t>& first_images,
                                         const std::vector<uint64_t>& rows, uint64_t row,
                                         const std::string& shape_of = "one") {
    const auto path = scratch_ / ("s" + std::to_string(++files_) + ".h5");
    auto file = *h5::File::create(path);
    BlobColumn blobs;
    for (size_t i = 1; i < first_images.size(); ++i) blobs.append(as_bytes("bytes of a group"));
    EXPECT_OK(blobs.write(file, "/e/media/image"));
    EXPECT_OK(file.write_attribute("/e/media/image", "path", "image"));
    EXPECT_OK(file.write_attribute("/e/media/image", "codec", "h264"));
    EXPECT_OK(file.write_attribute("/e/media/image", "element_type", "uint8"));
    const std::vector<int64_t> shape{24, 32, 3};
    const std::vector<uint64_t> size{1, 3};
    EXPECT_OK(file.write("/e/media/image/shape", h5::Type::kInt64,
                         shape_of == "one" ? std::vector<uint64_t>{3} : size,
                         std::as_bytes(std::span(shape)), h5::Storage::kCompressed));
    EXPECT_OK(write_column(file, "/e/media/image/first_image", first_images));
    if (!rows.empty()) {
      EXPECT_OK(write_column(file, "/e/media/image/row", rows));
    }
    const std::string name = "/e/media/image";
    EXPECT_OK(file.write_strings("/e/media_groups", {&name, 1}));
    EXPECT_OK(file.close());
    SegmentSource source(*h5::File::open(path), *File::open(path, File::Mode::kRead));
    return SegmentMediaReader(source).media("/e", row);
  }

  ScratchDirectory scratch_;
  int files_ = 0;
};

TEST_F(HostileGroups, AreReadWhereTheyAreValid) {
  const auto found = read({0, 3, 5}, {1, 2, 4, 6, 9}, 6);
  ASSERT_OK(found);
  ASSERT_EQ(found->size(), 1u);
  EXPECT_EQ((*found)[0].group->index, 0u);
  EXPECT_EQ((*found)[0].group->count, 2u);
  EXPECT_TRUE(read({0, 3, 5}, {1, 2, 4, 6, 9}, 3)->empty());
  EXPECT_TRUE(read({0, 3, 5}, {1, 2, 4, 6, 9}, 0)->empty());
  EXPECT_TRUE(read({0, 3, 5}, {1, 2, 4, 6, 9}, 99)->empty());
}

TEST_F(HostileGroups, AreRefusedWhereTheyContradictThemselves) {
  EXPECT_FAILS(read({}, {}, 0), StatusCode::kDataLoss, "needs two rows");
  EXPECT_FAILS(read({0}, {}, 0), StatusCode::kDataLoss, "needs two rows");
  EXPECT_FAILS(read({0, 3}, {}, 3), StatusCode::kDataLoss, "needs one of row 3");
  EXPECT_FAILS(read({0, 3}, {0, 1}, 1), StatusCode::kDataLoss, "needs 3");
  EXPECT_FAILS(read({5, 3, 4}, {}, 1), StatusCode::kDataLoss, "no valid group");
  EXPECT_FAILS(read({0, 9, 4}, {}, 2), StatusCode::kDataLoss, "");
  EXPECT_FAILS(read({0, 5000}, {}, 2), StatusCode::kDataLoss, "no valid group");
  EXPECT_FAILS(read({0, UINT64_MAX}, {}, 2), StatusCode::kDataLoss, "no valid group");
  EXPECT_FAILS(read({0, 3}, {}, 2, "many"), StatusCode::kDataLoss, "one shape");
}

}  // namespace
}  // namespace engram::ltm
