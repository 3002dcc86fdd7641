// SPDX-License-Identifier: Apache-2.0
// Segments and stores of many entities with few snapshots each: they share groups.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "ltm/codec/zstd.h"
#include "ltm/core/file.h"
#include "ltm/h5/h5.h"
#include "ltm/idf/binary.h"
#include "ltm/store/checksum.h"
#include "ltm/store/entity_index.h"
#include "ltm/store/packed_entities.h"
#include "ltm/store/recover.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/segment_blobs.h"
#include "ltm/store/shared_directory.h"
#include "ltm/store/store_check.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/random_values.h"
#include "tests/ltm/store/full_store.h"
#include "tests/ltm/store/segment_files.h"

namespace engram::ltm {
namespace {

using ::testing::HasSubstr;

MemoryId thing(int64_t i) {
  return *MemoryId::from_names(
      {"Objects", "Things", "room " + std::to_string(i % 7), fmt::format("thing {:05}", i)});
}

/// Things of three kinds, and of one that has no other like it.
idf::Data value_of(int64_t i, int64_t row) {
  const auto x = static_cast<double>(i) + 0.25 * static_cast<double>(row);
  if (i % 97 == 5) return idf::Dict{{"only of " + std::to_string(i), x}, {"row", row}};
  if (i % 3 == 0) return idf::Dict{{"x", x}, {"name", "thing " + std::to_string(i)}};
  if (i % 3 == 1)
    return idf::Dict{{"pose", idf::NdArray::take<double>({3}, {x, 1, 2})},
                     {"is_held", i % 2 == 0},
                     {"picture", example_image(9, 8, 3, i)}};
  return x;
}

Snapshot snapshot_of(int64_t i, int64_t row) {
  Snapshot made{thing(i), example_time(row), {{value_of(i, row), example_metadata(i)}}};
  if (i % 11 == 0) made.instances.push_back({value_of(i, row + 100), example_metadata(row)});
  return made;
}

Entities things(int64_t count) {
  Entities entities;
  for (int64_t i = 0; i < count; ++i)
    for (int64_t row = 0; row <= i % 4; ++row) entities[thing(i)].push_back(snapshot_of(i, row));
  return entities;
}

int64_t version_of(const std::filesystem::path& file) {
  return *h5::File::open(file)->int_attribute("/", "format_version");
}

TEST(ManyEntities, ShareGroups) {
  expect_round_trip(things(500));
  const ScratchDirectory scratch;
  ASSERT_OK(write_entities(scratch / "s.h5", things(500)));
  EXPECT_EQ(version_of(scratch / "s.h5"), 2);
  const auto groups = h5::File::open(scratch / "s.h5")->list("/");
  ASSERT_OK(groups);
  EXPECT_EQ(*groups, std::vector<std::string>{"#shared"});
}

TEST(ManyEntities, AreFoundByTimeAndRow) {
  const ScratchDirectory scratch;
  const Entities entities = things(300);
  ASSERT_OK(write_entities(scratch / "s.h5", entities));
  const auto reader = *SegmentReader::open(scratch / "s.h5");
  for (const auto& [id, snapshots] : entities) {
    const size_t each = snapshots.front().instances.size();
    EXPECT_EQ(reader->row_count(id).value_or(0), snapshots.size() * each);
    for (size_t i = 0; i < snapshots.size(); ++i) {
      EXPECT_EQ(reader->lower_bound(id, snapshots[i].time).value_or(99), i * each);
      const auto span = reader->snapshot_at(id, i * each);
      ASSERT_OK(span);
      ASSERT_TRUE(span->has_value());
      EXPECT_EQ((*span)->time, snapshots[i].time);
      EXPECT_EQ((*span)->rows, each);
    }
    EXPECT_EQ(reader->lower_bound(id, Time::max()).value_or(99), snapshots.size() * each);
    const auto behind = reader->snapshot_at(id, snapshots.size() * each);
    EXPECT_TRUE(behind.ok() && !behind->has_value()) << "rows of the next entity follow";
    EXPECT_FALSE(reader->time_at(id, snapshots.size() * each).ok());
    EXPECT_FALSE(reader->read_recorded(id, {Time{}, snapshots.size() * each, 1}).ok());
    EXPECT_FALSE(reader->read_recorded(id, {Time{}, UINT64_MAX, 1}).ok());
  }
  EXPECT_FALSE(reader->row_count(thing(301)).ok());
  EXPECT_FALSE(reader->index(*MemoryId::parse("A/b/c/d")).ok());
}

TEST(ManyEntities, ListThemselves) {
  const ScratchDirectory scratch;
  Entities entities = things(300);
  for (int64_t row = 0; row < 50; ++row)
    entities[example_entity()].push_back(example_snapshot(example_entity(), row));
  const auto info = write_entities(scratch / "s.h5", entities);
  ASSERT_OK(info);
  const auto reader = *SegmentReader::open(scratch / "s.h5");
  const auto contents = reader->contents();
  ASSERT_OK(contents);
  EXPECT_TRUE(contents->damaged.empty());
  std::vector<MemoryId> found = contents->entities, expected;
  std::ranges::sort(found);
  for (const auto& [id, snapshots] : entities) expected.push_back(id);
  EXPECT_EQ(found, expected);
  // What has many rows has a group of its own.
  EXPECT_TRUE(*h5::File::open(scratch / "s.h5")->exists("/Vision/RGB/head/cam/timestamp"));
  uint64_t sum = 0;
  for (const MemoryId& id : found) sum += reader->stored_bytes(id).value_or(0);
  EXPECT_GT(sum, info->bytes / 2);
  EXPECT_LE(sum, info->bytes);
}

TEST(ManyEntities, AreFewUntilThereAreMany) {
  const ScratchDirectory scratch;
  ASSERT_OK(write_entities(scratch / "s.h5", things(31)));
  EXPECT_EQ(version_of(scratch / "s.h5"), 1) << "older programs read it";
}

TEST(ManyEntities, WithManyRowsShareWhereThereAreThousands) {
  Entities entities;
  for (int64_t i = 0; i < 1100; ++i)
    for (int64_t row = 0; row < 33; ++row)
      entities[thing(i)].push_back({thing(i), example_time(row), {{i + row, {}}}});
  const ScratchDirectory scratch;
  ASSERT_OK(write_entities(scratch / "s.h5", entities));
  EXPECT_EQ(version_of(scratch / "s.h5"), 2);
  const auto reader = *SegmentReader::open(scratch / "s.h5");
  EXPECT_EQ(read_entity(*reader, thing(1099)).value_or(std::vector<Snapshot>()),
            entities.at(thing(1099)));
}

TEST(ManyEntities, KeepDropsAndCompressedColumns) {
  std::map<MemoryId, RecordedEntity> recorded;
  for (int64_t i = 0; i < 100; ++i) {
    RecordedEntity& entity = recorded[thing(i)];
    if (i % 2 == 0) entity.snapshots.push_back(pack_snapshot(snapshot_of(3 * i, 1)));
    if (i % 4 == 0) entity.rules = SealRules::all_columns();
    entity.trailing_dropped = static_cast<uint64_t>(i);
  }
  const ScratchDirectory scratch;
  const auto info = write_recorded_segment(scratch / "s.h5", recorded);
  ASSERT_OK(info);
  const auto reader = *SegmentReader::open(scratch / "s.h5");
  for (int64_t i = 0; i < 100; ++i) {
    EXPECT_EQ(info->find(thing(i))->dropped, static_cast<uint64_t>(i));
    EXPECT_EQ(reader->row_count(thing(i)).value_or(99), i % 2 == 0 ? 1U + (3 * i % 11 == 0) : 0U);
    if (i % 2 != 0 || 3 * i % 97 == 5) continue;
    EXPECT_EQ(reader->forms(thing(i)).value_or(StoredForms()).has_columns(), i % 4 == 0) << i;
    const auto packed = reader->read_recorded(thing(i), *reader->index(thing(i))->begin());
    ASSERT_OK(packed);
    EXPECT_EQ(unpack(*packed)->instances[0].data, value_of(3 * i, 1));
  }
}

TEST(ManyEntities, WithMediaThatNoOthersHaveStayAlone) {
  Entities entities;
  for (int64_t i = 0; i < 200; ++i) {
    idf::Data value = i;
    if (i % 20 == 0) value = idf::Dict{{"view " + std::to_string(i), example_image(8, 8, 3, i)}};
    entities[thing(i)].push_back({thing(i), example_time(i), {{std::move(value), {}}}});
  }
  expect_round_trip(entities);
  const ScratchDirectory scratch;
  ASSERT_OK(write_entities(scratch / "s.h5", entities));
  EXPECT_EQ(h5::File::open(scratch / "s.h5")->list("/")->size(), 2U);
}

/// Replaces datasets of the directory, as somebody who means harm would.
class HostileDirectory : public ::testing::Test {
 protected:
  void expect_no_crash(const std::function<void(h5::File&)>& write) {
    const auto path = scratch_ / fmt::format("{}.h5", ++files_);
    h5::File file = *h5::File::create(path);
    EXPECT_OK(file.write_attribute("/", "format_version", int64_t{2}));
    EXPECT_OK(file.write_attribute("/", "kind", "recorded"));
    EXPECT_OK(write_column(file, shared_group(0) + "/timestamp", std::vector<int64_t>{1, 2, 3}));
    write(file);
    EXPECT_OK(file.close());
    const auto reader = *SegmentReader::open(path);
    EXPECT_FALSE(reader->index(thing(1)).ok());
    EXPECT_FALSE(reader->snapshot_at(thing(1), 0).ok());
    [[maybe_unused]] const auto listed = reader->contents();
    [[maybe_unused]] const auto bytes = reader->stored_bytes(thing(1));
  }

  ScratchDirectory scratch_;
  int files_ = 0;
};

TEST_F(HostileDirectory, NamesRowsAndGroupsThatAreNotThere) {
  for (const SharedEntity& bad :
       {SharedEntity{thing(1), 7, 0, 1}, SharedEntity{thing(1), -1, 0, 1},
        SharedEntity{thing(1), 0, 4, 1}, SharedEntity{thing(1), 0, 1, 3},
        SharedEntity{thing(1), 0, UINT64_MAX, 2}, SharedEntity{thing(1), 0, 2, UINT64_MAX}})
    expect_no_crash([&](h5::File& file) { EXPECT_OK(write_shared_directory(file, {bad})); });
}

TEST_F(HostileDirectory, HasNoNamesOrFewerRows) {
  expect_no_crash([](h5::File& file) { EXPECT_OK(write_shared_directory(file, {})); });
  expect_no_crash([](h5::File& file) {
    BlobColumn names;
    const idf::List two{thing(0).to_string(), thing(1).to_string()};
    names.append(compress_zstd(*idf::encode(two)));
    EXPECT_OK(names.write(file, "/#shared/entities"));
    EXPECT_OK(file.write_attribute("/#shared/entities", "names_per_block", int64_t{2}));
    EXPECT_OK(write_column(file, "/#shared/group", std::vector<int32_t>{0}));
    EXPECT_OK(write_column(file, "/#shared/first_row", std::vector<uint64_t>{0}));
    EXPECT_OK(write_column(file, "/#shared/rows", std::vector<uint64_t>{1}));
  });
  expect_no_crash([](h5::File& file) {
    BlobColumn names;
    names.append(as_bytes("no zstd"));
    EXPECT_OK(names.write(file, "/#shared/entities"));
    EXPECT_OK(file.write_attribute("/#shared/entities", "names_per_block", int64_t{1}));
  });
}

class ManyInAStore : public ::testing::Test {
 protected:
  static constexpr int64_t kCount = 1500;

  void SetUp() override {
    ASSERT_OK(create_store(store_));
    for (int64_t row = 0; row < 2; ++row) {
      const auto writer = *StoreWriter::open(store_, {});
      std::vector<PackedSnapshot> all;
      for (int64_t i = 0; i < kCount; ++i) all.push_back(pack_snapshot(snapshot_of(i, row)));
      ASSERT_OK(writer->append(std::move(all), nullptr));
      ASSERT_OK(writer->seal());
    }
  }

  /// Compares everything that a store gives back. Returns the number of snapshots.
  static uint64_t read_all_of(const std::filesystem::path& store, uint64_t& failed) {
    const auto reader = StoreReader::open(store);
    if (!reader.ok()) return ++failed, 0;
    uint64_t found = 0;
    for (int64_t i = 0; i < kCount; ++i) {
      const auto index = (*reader)->index(thing(i));
      if (!index.ok()) {
        ++failed;
        continue;
      }
      for (const SnapshotEntry& entry : **index) {
        const auto snapshot = (*reader)->read_recorded(thing(i), entry);
        if (!snapshot.ok()) {
          ++failed;
          continue;
        }
        const int64_t row = (to_ns(entry.time) - kExampleStart_ns) / 200'000'000;
        EXPECT_EQ(*snapshot, snapshot_of(i, row));
        ++found;
      }
    }
    return found;
  }

  static void expect_all_in(const std::filesystem::path& store) {
    uint64_t failed = 0;
    EXPECT_EQ(read_all_of(store, failed), 2U * kCount);
    EXPECT_EQ(failed, 0U);
    const auto report = check_store(store, {true, {}});
    ASSERT_OK(report);
    EXPECT_TRUE(report->is_clean()) << (report->findings.empty() ? "" : report->findings[0].what);
    EXPECT_EQ(report->entities, static_cast<uint64_t>(kCount));
  }

  [[nodiscard]] nlohmann::json manifest() const {
    return nlohmann::json::parse(as_text(read_file(store_ / "MANIFEST.json")->bytes()));
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_ = scratch_ / "store";
};

TEST_F(ManyInAStore, ReadAsTheyWereWritten) {
  expect_all_in(store_);
  EXPECT_EQ(manifest()["format_version"], 3);
  EXPECT_LT(std::filesystem::file_size(store_ / "MANIFEST.json"), 100U * kCount);
  const auto reader = *StoreReader::open(store_);
  const auto summary = reader->summary(thing(77));
  ASSERT_OK(summary);
  EXPECT_EQ(summary->snapshots, 2U);
  EXPECT_EQ(summary->first, example_time(0));
  EXPECT_GT(summary->stored_bytes, 0U);
  EXPECT_THAT(reader->index(*MemoryId::parse("No/such/thing/here")).status().message(),
              HasSubstr("and 1480 more"));
}

TEST_F(ManyInAStore, AreCompactedAndForgotten) {
  ASSERT_OK(compact(store_, {}));
  EXPECT_EQ(manifest()["segments"].size(), 1U);
  expect_all_in(store_);
  ForgetSet gone;
  for (int64_t i = 0; i < kCount; ++i)
    if (i % 2 == 0) gone[thing(i)] = {example_time(0), example_time(1)};
  const auto report = forget_snapshots(store_, gone);
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, static_cast<uint64_t>(kCount));
  uint64_t failed = 0;
  EXPECT_EQ(read_all_of(store_, failed), static_cast<uint64_t>(kCount));
  EXPECT_EQ(manifest()["format_version"], 1) << "few enough to be listed";
  EXPECT_TRUE(check_store(store_, {true, {}})->is_clean());
}

TEST_F(ManyInAStore, AreRecoveredWithoutAManifest) {
  std::filesystem::remove(store_ / "MANIFEST.json");
  const auto report = recover_store(store_, scratch_ / "copy");
  ASSERT_OK(report);
  EXPECT_FALSE(report->has_loss());
  expect_all_in(scratch_ / "copy");
}

TEST_F(ManyInAStore, FlippedBitsAreFoundAndNeverGiveWrongData) {
  const std::string file = "segments/000001.h5";
  const Buffer whole = *read_file(store_ / file);
  RandomValues random(7);
  for (int i = 0; i < 24 && !HasFailure(); ++i) {
    const uint64_t bit = random.below(whole.size() * 8);
    SCOPED_TRACE(bit);
    std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
    damaged[bit / 8] ^= std::byte{1} << bit % 8;
    overwrite_file(store_ / file, damaged);
    uint64_t failed = 0;
    read_all_of(store_, failed);
    const auto report = check_store(store_, {});
    EXPECT_TRUE(report.status().code() == StatusCode::kFailedPrecondition ||
                (report.ok() && report->faults() > 0));
    if (i % 6 != 0 || !report.ok()) continue;
    std::filesystem::remove_all(scratch_ / "copy");
    const auto recovered = recover_store(store_, scratch_ / "copy");
    ASSERT_OK(recovered);
    uint64_t lost = 0;
    EXPECT_GE(read_all_of(scratch_ / "copy", lost), static_cast<uint64_t>(kCount));
    EXPECT_TRUE(check_store(scratch_ / "copy", {true, {}})->is_clean());
  }
}

TEST_F(ManyInAStore, WhoseNamesAreDamagedInPartsLoseThoseAlone) {
  const std::string file = "segments/000001.h5";
  const auto info = h5::File::open(store_ / file)->info("/#shared/entities/bytes");
  ASSERT_OK(info);
  // Bytes of the first block of names.
  flip_bit(store_ / file, (*info->offset + 20) * 8);
  uint64_t failed = 0;
  const uint64_t found = read_all_of(store_, failed);
  EXPECT_GT(failed, 0U);
  const auto recovered = recover_store(store_, scratch_ / "copy");
  ASSERT_OK(recovered);
  EXPECT_TRUE(recovered->has_loss());
  uint64_t lost = 0;
  // The second segment has another snapshot of each.
  EXPECT_EQ(read_all_of(scratch_ / "copy", lost), 2U * kCount - 128);
  EXPECT_LE(found, 2U * kCount - 128);
}

/// A writer of earlier days, or somebody who means harm, may have made blocks that are no blocks,
/// with a checksum that holds.
class DamagedBlocks : public ManyInAStore {
 protected:
  void change_blocks(const std::function<void(nlohmann::ordered_json&)>& change) {
    auto json =
        nlohmann::ordered_json::parse(as_text(read_file(store_ / "MANIFEST.json")->bytes()));
    change(json["segments"][0]["entity_blocks"]);
    json["checksum"] = std::string(16, '0');
    std::string text = json.dump(1) + "\n";
    const size_t digits = text.size() - 20;
    text.replace(digits, 16, fmt::format("{:016x}", checksum(as_bytes(text.substr(0, digits)))));
    overwrite_file(store_ / "MANIFEST.json", as_bytes(text));
  }
};

TEST_F(DamagedBlocks, AreTold) {
  change_blocks([](auto& blocks) { blocks[1]["packed_entities"] = "bm8gYmxvY2s="; });
  const auto report = check_store(store_, {});
  ASSERT_OK(report);
  EXPECT_TRUE(std::ranges::any_of(report->findings, [](const Finding& finding) {
    return finding.file == "MANIFEST.json" &&
           finding.what.find("block 1 of packed entities") != std::string::npos;
  }));
  // What cannot be found cannot be forgotten.
  EXPECT_FAILS(forget_snapshots(store_, {{thing(3), {example_time(0)}}}), StatusCode::kDataLoss,
               "segments/000001.h5");
  EXPECT_FAILS(compact(store_, {}), StatusCode::kDataLoss, "block 1 of packed entities");
}

TEST_F(DamagedBlocks, MayClaimAnyNumberOfEntities) {
  change_blocks([](auto& blocks) { blocks[1]["count"] = uint64_t{1} << 31; });
  const auto report = check_store(store_, {});
  ASSERT_OK(report);
  EXPECT_GT(report->faults(), 0U);
  const auto reader = *StoreReader::open(store_);
  EXPECT_OK(reader->summary(thing(0)));
  EXPECT_EQ(reader->entities().size(), static_cast<size_t>(kCount))
      << "the second segment is whole";
  change_blocks([](auto& blocks) { blocks[1]["count"] = UINT64_MAX; });
  EXPECT_FAILS(read_manifest(store_), StatusCode::kDataLoss, "claims");
}

TEST_F(DamagedBlocks, LoseNothingWhenTheStoreIsRecovered) {
  change_blocks([](auto& blocks) { blocks[0]["count"] = 511; });
  const auto report = recover_store(store_, scratch_ / "copy");
  ASSERT_OK(report);
  EXPECT_TRUE(report->is_rebuilt);
  expect_all_in(scratch_ / "copy");
}

TEST_F(DamagedBlocks, OthersAreFoundAndRecordedTo) {
  change_blocks([](auto& blocks) { blocks[1]["first"] = blocks[0]["first"]; });
  EXPECT_FAILS(read_manifest(store_), StatusCode::kDataLoss, "not in the order of IDs");
  change_blocks([](auto& blocks) { blocks[1]["first"] = "Objects/Things/room 2/other"; });
  {
    const auto reader = *StoreReader::open(store_);
    EXPECT_OK(reader->summary(thing(0)));
  }
  // What nobody unpacked is written as it was.
  const auto before = manifest()["segments"][0]["entity_blocks"];
  {
    auto writer = *StoreWriter::open(store_, {});
    ASSERT_OK(writer->append({pack_snapshot(snapshot_of(0, 9))}, nullptr));
    ASSERT_OK(writer->seal());
  }
  EXPECT_EQ(manifest()["segments"][0]["entity_blocks"], before);
}

TEST_F(ManyInAStore, WrittenByEarlierProgramsAreReadAndPackedAnew) {
  // Format 2 had all entities of a segment in one text.
  auto json = nlohmann::ordered_json::parse(as_text(read_file(store_ / "MANIFEST.json")->bytes()));
  const Manifest manifest = *read_manifest(store_);
  for (size_t i = 0; i < manifest.segments.size(); ++i) {
    auto& segment = json["segments"][i];
    segment.erase("entity_blocks");
    segment["packed_entities"] = *pack_entities(std::vector<SegmentEntity>(
        manifest.segments[i].entities.begin(), manifest.segments[i].entities.end()));
  }
  json["format_version"] = 2;
  json.erase("checksum");
  json["models"] = nlohmann::ordered_json::array();
  overwrite_file(store_ / "MANIFEST.json", as_bytes(json.dump(1) + "\n"));
  expect_all_in(store_);
  ASSERT_OK(edit_manifest(store_, [](Manifest&) { return Status(); }));
  EXPECT_EQ(this->manifest()["format_version"], 3);
  expect_all_in(store_);
}

TEST(SegmentEntities, ArePackedAndFound) {
  std::vector<SegmentEntity> listed;
  for (int64_t i = 0; i < 2000; ++i)
    listed.push_back({thing(i),
                      static_cast<uint64_t>(i) + 1,
                      2,
                      example_time(i),
                      example_time(i + 1),
                      50,
                      60,
                      7,
                      8,
                      {},
                      1});
  std::ranges::sort(listed, {}, &SegmentEntity::id);
  const SegmentEntities plain = listed;
  const SegmentEntities packed = *SegmentEntities::from_blocks(*pack_in_blocks(listed));
  EXPECT_EQ(packed.blocks()->size(), 4U);
  EXPECT_EQ(packed.size(), 2000U);
  for (const SegmentEntity& each : plain) {
    const SegmentEntity* found = packed.find(each.id);
    ASSERT_NE(found, nullptr);
    ASSERT_EQ(found->snapshots, each.snapshots);
  }
  for (const char* other : {"A/b/c/d", "Objects/Things/room 3/nothing", "Z/b/c/d"})
    EXPECT_EQ(packed.find(*MemoryId::parse(other)), nullptr);
  EXPECT_TRUE(std::ranges::equal(packed, plain, {}, &SegmentEntity::id, &SegmentEntity::id));
  SegmentEntities changed = packed;
  changed.edit()[5].snapshots = 77'777;
  EXPECT_EQ(changed.blocks(), nullptr);
  EXPECT_EQ(changed[5].snapshots, 77'777U);
  EXPECT_EQ(packed[5].snapshots, plain[5].snapshots);
}

TEST(EntityIndex, TellsOneAndAll) {
  std::vector<SegmentInfo> segments(3);
  for (int64_t i = 0; i < 30; ++i)
    for (size_t segment = 0; segment < 3; ++segment)
      if (static_cast<size_t>(i) % 3 >= segment)
        segments[segment].entities.edit().push_back({thing(i),
                                                     segment == 2 ? 0U : 4U,
                                                     4,
                                                     example_time(0),
                                                     example_time(i),
                                                     0,
                                                     0,
                                                     0,
                                                     0,
                                                     {}});
  for (SegmentInfo& segment : segments)
    std::ranges::sort(segment.entities.edit(), {}, &SegmentEntity::id);
  const auto expect_right = [](EntityIndex& index) {
    for (int64_t i = 0; i < 30; ++i) {
      const EntityIndex::Entries& entries = index.of(thing(i));
      ASSERT_EQ(entries.size(), static_cast<size_t>(i) % 3 + 1);
      EXPECT_EQ(entries.back().first, static_cast<size_t>(i) % 3);
      EXPECT_EQ(last_time_in(entries), example_time(i));
    }
    EXPECT_TRUE(index.of(thing(99)).empty());
  };
  EntityIndex index(segments);
  EXPECT_GE(index.max_size(), 30U);
  expect_right(index);
  EXPECT_EQ(index.all().size(), 30U);
  EXPECT_EQ(index.max_size(), 30U);
  expect_right(index);
  // Asked often enough it reads them all.
  EntityIndex busy(segments);
  for (int i = 0; i < 200'000; ++i) EXPECT_TRUE(busy.of(thing(99)).empty());
  EXPECT_EQ(busy.max_size(), 30U);
  expect_right(busy);
}

TEST(PackedEntities, AreUnpackedOrRefused) {
  std::vector<SegmentEntity> entities;
  for (int64_t i = 0; i < 100; ++i)
    entities.push_back({thing(i), 1, 2, example_time(i), example_time(i + 1), 50, 60, 7, 8, {}, 1});
  const std::string text = *pack_entities(entities);
  const auto unpacked = unpack_entities(text);
  ASSERT_OK(unpacked);
  ASSERT_EQ(unpacked->size(), entities.size());
  const SegmentEntity& last = unpacked->back();
  EXPECT_EQ(last.id, thing(99));
  EXPECT_EQ(std::tie(last.snapshots, last.rows, last.raw_bytes, last.stored_bytes, last.dropped,
                     last.dropped_bytes, last.augmented),
            std::make_tuple(1U, 2U, 50U, 60U, 7U, 8U, 1U));
  EXPECT_EQ(last.first, example_time(99));
  EXPECT_EQ(last.last, example_time(100));
  for (size_t size = 0; size < text.size(); ++size)
    EXPECT_FALSE(unpack_entities(std::string_view(text).substr(0, size)).ok()) << size;
  RandomValues random(3);
  for (int i = 0; i < 2000; ++i) {
    std::string changed = text;
    changed[random.below(changed.size())] = static_cast<char>(random.below(256));
    [[maybe_unused]] const auto ignored = unpack_entities(changed);
  }
}

}  // namespace
}  // namespace engram::ltm
