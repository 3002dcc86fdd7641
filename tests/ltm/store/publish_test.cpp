// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/publish.h"

#include "ltm/core/file.h"
#include "ltm/store/store_reader.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {
namespace {

class PublishTest : public ::testing::Test {
 protected:
  PublishTest() : store_(scratch_ / "store") { EXPECT_OK(create_store(store_)); }

  /// Snapshots [first, end) of the entity, sealed as one segment.
  void record(int64_t first, int64_t end, const MemoryId& entity = example_entity()) {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = first; i < end; ++i)
      ASSERT_OK(writer->append({packed_example(i, entity)}, nullptr));
    ASSERT_OK(writer->seal());
  }

  Status publish(int version, const std::vector<LatentSnapshot>& latents,
                 const MemoryId& entity = example_entity()) {
    const auto file = temporary_file(store_, ".model");
    const std::string text = "weights " + std::to_string(version) + " of " + entity.to_string();
    EXPECT_OK(replace_file(*file, as_bytes(text)));
    return publish_model(store_, entity, version, *file, latents);
  }

  std::unique_ptr<StoreReader> open() { return *StoreReader::open(store_); }

  [[nodiscard]] size_t files_in(const char* folder) const {
    return static_cast<size_t>(
        std::distance(std::filesystem::directory_iterator(store_ / folder), {}));
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
};

TEST_F(PublishTest, AddsLatentsBesideTheRecordedForm) {
  record(0, 10);
  ASSERT_OK(publish(1, example_latents(0, 8, 1)));
  const auto reader = open();
  const auto& entries = *reader->index(example_entity()).value();
  ASSERT_EQ(entries.size(), 10u);
  for (size_t i = 0; i < entries.size(); ++i) {
    EXPECT_TRUE(entries[i].recorded);
    EXPECT_EQ(entries[i].latent.has_value(), i < 8);
  }
  const auto latent = reader->read_latent(example_entity(), entries[5]);
  ASSERT_OK(latent);
  const LatentSnapshot expected = example_latent(5, 1);
  EXPECT_EQ(latent->model_version, 1);
  EXPECT_TRUE(std::ranges::equal(latent->instances[0].latent.code.bytes(),
                                 expected.instances[0].latent.code.bytes()));
  const auto summary = reader->summary(example_entity());
  EXPECT_EQ(summary->latent_snapshots, 8u);
  EXPECT_EQ(summary->latent.image_rows, 8u);
  ASSERT_EQ(summary->models.size(), 1u);
  EXPECT_EQ(summary->model_bytes, std::filesystem::file_size(store_ / summary->models[0].file));
  EXPECT_EQ(summary->latent_bytes, std::filesystem::file_size(store_ / "segments/000002.h5"));
}

TEST_F(PublishTest, SupersedesOlderLatentsAndModels) {
  record(0, 10);
  ASSERT_OK(publish(1, example_latents(0, 5, 1)));
  EXPECT_EQ(next_model_version(*read_manifest(store_), example_entity()), 2);
  ASSERT_OK(publish(2, example_latents(0, 10, 2)));
  const auto manifest = read_manifest(store_);
  ASSERT_EQ(manifest->models.size(), 1u);
  EXPECT_EQ(manifest->models[0].version, 2);
  EXPECT_EQ(manifest->segments.size(), 2u);
  EXPECT_EQ(files_in("models"), 1u);
  EXPECT_EQ(files_in("segments"), 2u);
  const auto reader = open();
  for (const SnapshotEntry& entry : *reader->index(example_entity()).value())
    EXPECT_EQ(reader->read_latent(example_entity(), entry)->model_version, 2);
}

TEST_F(PublishTest, KeepsAModelThatLatentsStillName) {
  record(0, 10);
  ASSERT_OK(publish(1, example_latents(0, 10, 1)));
  ASSERT_OK(publish(2, example_latents(5, 10, 2)));
  EXPECT_EQ(read_manifest(store_)->models.size(), 2u);
  const auto reader = open();
  const auto& entries = *reader->index(example_entity()).value();
  EXPECT_EQ(reader->read_latent(example_entity(), entries[4])->model_version, 1);
  EXPECT_EQ(reader->read_latent(example_entity(), entries[5])->model_version, 2);
  EXPECT_EQ(reader->summary(example_entity())->latent_snapshots, 10u);
}

TEST_F(PublishTest, RefusesWhatContradictsItself) {
  record(0, 4);
  ASSERT_OK(publish(1, example_latents(0, 4, 1)));
  EXPECT_FAILS(publish(1, example_latents(0, 4, 1)), StatusCode::kAlreadyExists, "cam v1");
  EXPECT_FAILS(publish(2, {}), StatusCode::kInvalidArgument, "no latents");
  EXPECT_FAILS(publish(2, example_latents(0, 4, 1)), StatusCode::kInvalidArgument, "v1");
  auto unordered = example_latents(0, 4, 2);
  std::swap(unordered[0], unordered[1]);
  EXPECT_FAILS(publish(2, unordered), StatusCode::kInvalidArgument, "backwards");
  EXPECT_FAILS(
      publish_model(store_, example_entity(), 2, scratch_ / "none", example_latents(0, 4, 2)),
      StatusCode::kNotFound, "none");
  EXPECT_EQ(read_manifest(store_)->models.size(), 1u);
  EXPECT_EQ(files_in("models"), 1u);
}

TEST_F(PublishTest, KeepsModelsOfEntitiesApart) {
  const MemoryId one = *MemoryId::from_names({"a.b", "c", "d", "e"});
  const MemoryId two = *MemoryId::from_names({"a", "b.c", "d", "e"});
  for (const MemoryId& id : {one, two}) {
    record(0, 3, id);
    ASSERT_OK(publish(1, example_latents(0, 3, 1), id));
  }
  const auto manifest = read_manifest(store_);
  ASSERT_EQ(manifest->models.size(), 2u);
  EXPECT_NE(manifest->models[0].file, manifest->models[1].file);
  ASSERT_OK(drop_recorded(store_, one, {}));
  ASSERT_OK(drop_recorded(store_, two, {}));
}

TEST_F(PublishTest, DropsOnlyWhatHasLatents) {
  record(0, 6);
  record(6, 12);
  record(0, 5, example_entity("other"));
  ASSERT_OK(publish(1, example_latents(0, 9, 1)));
  const auto before = open()->summary(example_entity());
  const auto report = drop_recorded(store_, example_entity(), {});
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 9u);
  EXPECT_EQ(report->kept, 3u);
  const auto reader = open();
  const auto summary = reader->summary(example_entity());
  ASSERT_OK(summary);
  EXPECT_EQ(summary->snapshots, 12u);
  EXPECT_EQ(summary->recorded_snapshots, 3u);
  EXPECT_EQ(summary->latent_snapshots, 9u);
  EXPECT_EQ(summary->raw_bytes, before->raw_bytes);
  EXPECT_EQ(summary->offered, before->offered);
  EXPECT_EQ(summary->offered_bytes, before->offered_bytes);
  const auto kept = read_all(*reader, example_entity());
  ASSERT_OK(kept);
  for (int64_t i = 9; i < 12; ++i)
    EXPECT_EQ((*kept)[static_cast<size_t>(i - 9)], example_snapshot(example_entity(), i));
  EXPECT_EQ(read_all(*reader, example_entity("other"))->size(), 5u);
  EXPECT_EQ(files_in("segments"), reader->manifest().segments.size());
  // Once more: nothing is left to drop.
  EXPECT_EQ(drop_recorded(store_, example_entity(), {})->snapshots, 0u);
}

TEST_F(PublishTest, DropsNothingThatIsToBeKept) {
  record(0, 6);
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  const auto report = drop_recorded(store_, example_entity(), {example_time(2), example_time(4)});
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 4u);
  EXPECT_EQ(report->kept, 2u);
  const auto kept = read_all(*open(), example_entity());
  ASSERT_EQ(kept->size(), 2u);
  EXPECT_EQ((*kept)[1], example_snapshot(example_entity(), 4));
}

TEST_F(PublishTest, DropsAWholeEntity) {
  record(0, 6);
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  {
    const auto writer = *StoreWriter::open(store_, {});
    EXPECT_EQ(writer->last_time(example_entity()), example_time(5));
    ASSERT_OK(writer->append({packed_example(6)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  const auto reader = open();
  const auto summary = reader->summary(example_entity());
  EXPECT_EQ(summary->snapshots, 7u);
  EXPECT_EQ(summary->recorded_snapshots, 1u);
  for (const SnapshotEntry& entry : *reader->index(example_entity()).value())
    if (entry.latent) {
      EXPECT_OK(reader->read_latent(example_entity(), entry));
    }
}

TEST_F(PublishTest, KeepsCountsOfWhatFiltersDropped) {
  {
    const auto writer = *StoreWriter::open(store_, {});
    for (int64_t i = 0; i < 6; ++i) {
      PackedSnapshot packed = packed_example(i);
      packed.dropped = 2;
      packed.dropped_bytes = 20;
      ASSERT_OK(writer->append({packed}, nullptr));
    }
    ASSERT_OK(writer->append_dropped(example_entity(), 1, 7));
    ASSERT_OK(writer->seal());
  }
  ASSERT_OK(publish(1, example_latents(0, 4, 1)));
  const auto before = open()->summary(example_entity());
  ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  const auto after = open()->summary(example_entity());
  EXPECT_EQ(after->offered, 6u + 13u);
  EXPECT_EQ(after->offered, before->offered);
  EXPECT_EQ(after->offered_bytes, before->offered_bytes);
}

TEST_F(PublishTest, DropsNothingWhereLatentsAreDamaged) {
  record(0, 100);
  record(100, 200);
  ASSERT_OK(publish(1, example_latents(0, 200, 1)));
  const auto manifest = read_manifest(store_);
  const std::filesystem::path file = store_ / manifest->segments.back().file;
  const Buffer whole = *read_file(file);
  // The codes lie as they are: the last one's bytes are found near their like.
  const LatentSnapshot last = example_latent(199, 1);
  const auto code = last.instances[0].latent.code.bytes();
  const size_t at = as_text(whole.bytes()).rfind(as_text(code));
  ASSERT_NE(at, std::string_view::npos);
  std::vector<std::byte> damaged(whole.bytes().begin(), whole.bytes().end());
  damaged[at] ^= std::byte{1};
  ASSERT_OK(replace_file(file, damaged));
  EXPECT_FAILS(drop_recorded(store_, example_entity(), {}), StatusCode::kDataLoss, "checksum");
  EXPECT_EQ(open()->summary(example_entity())->recorded_snapshots, 200u);
}

TEST_F(PublishTest, DropsNothingWhereTheModelIsDamaged) {
  record(0, 6);
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  ASSERT_OK(replace_file(store_ / read_manifest(store_)->models[0].file, as_bytes("damaged")));
  EXPECT_FAILS(drop_recorded(store_, example_entity(), {}), StatusCode::kDataLoss, "checksum");
  EXPECT_EQ(open()->summary(example_entity())->recorded_snapshots, 6u);
  EXPECT_FAILS(drop_recorded(store_, example_entity("none"), {}), StatusCode::kNotFound, "none");
}

TEST_F(PublishTest, TellsOpenReadersThatASegmentWasReplaced) {
  record(0, 6);
  const auto reader = open();
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  ASSERT_OK(drop_recorded(store_, example_entity(), {}));
  EXPECT_FAILS(reader->index(example_entity()), StatusCode::kUnavailable, "open the store again");
  EXPECT_OK(open()->index(example_entity()));
}

TEST(ModelFile, TellsItsEntityAndVersion) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"Vision", "RGB", "head", "cam"},
        {"a.b", ".", "..", "x/y"},
        {"%2E", "%", "#1", "机器人 \\\n"}}) {
    const MemoryId entity = *MemoryId::from_names(names);
    const auto model = model_of_file(model_file_name(entity, 12));
    ASSERT_TRUE(model) << entity.to_string();
    EXPECT_EQ(model->entity, entity);
    EXPECT_EQ(model->version, 12);
    EXPECT_EQ(model->file, model_file_name(entity, 12));
  }
  for (const char* name : {"", "models/", "models/a.b.c.v1.h5", "models/a.b.c.d.v0.h5",
                           "models/a.b.c.d.1.h5", "models/a.b.c.d.v1.h5.new", "a.b.c.d.v1.h5",
                           "models/a.b.c.%.v1.h5", "models/a.b.c.%2.v1.h5", "models/a.b.c.%zz.v1.h5",
                           "models/a.b.c.d.v99999999999.h5", "models/a.b.c.%41.v1.h5"})
    EXPECT_FALSE(model_of_file(name)) << name;
}

TEST_F(PublishTest, RunsBesideALiveWriter) {
  const auto writer = *StoreWriter::open(store_, {});
  for (int64_t i = 0; i < 10; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
  ASSERT_OK(writer->seal());
  for (int64_t i = 10; i < 15; ++i) ASSERT_OK(writer->append({packed_example(i)}, nullptr));
  ASSERT_OK(publish(1, example_latents(0, 15, 1)));
  const auto report = drop_recorded(store_, example_entity(), {});
  ASSERT_OK(report);
  EXPECT_EQ(report->snapshots, 10u);
  ASSERT_OK(writer->append({packed_example(15)}, nullptr));
  ASSERT_OK(writer->seal());
  const auto reader = open();
  EXPECT_EQ(reader->summary(example_entity())->snapshots, 16u);
  EXPECT_EQ(read_all(*reader, example_entity())->size(), 6u);
}

}  // namespace
}  // namespace engram::ltm
