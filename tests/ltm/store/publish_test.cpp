// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/publish.h"

#include "ltm/core/file.h"
#include "tests/ltm/store/publish_fixture.h"

namespace engram::ltm {
namespace {

using PublishTest = PublishFixture;

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

TEST_F(PublishTest, LeavesOutWhatWasForgottenWhileTheModelWasMade) {
  record(0, 6);
  const uint64_t unseen = read_manifest(store_)->first_journal;
  ASSERT_OK(forget_snapshots(store_, {{example_entity(), {example_time(2)}}}));
  ASSERT_OK(publish(1, example_latents(0, 6, 1), example_entity(), unseen));
  const auto reader = open();
  EXPECT_EQ((*reader->index(example_entity()))->size(), 5u);
  EXPECT_EQ(reader->summary(example_entity())->latent_snapshots, 5u);
}

TEST_F(PublishTest, LeavesOutWhatWasUpdatedWhileTheModelWasMade) {
  record(0, 6);
  const uint64_t unseen = read_manifest(store_)->first_journal;
  Snapshot update = example_snapshot(example_entity(), 77);
  update.time = example_time(3);
  {
    const auto writer = *StoreWriter::open(store_, {});
    ASSERT_OK(writer->append({pack_snapshot(update)}, nullptr));
    ASSERT_OK(writer->seal());
    ASSERT_OK(writer->append({packed_example(4)}, nullptr));
  }
  // Joined: the update now lies in one segment with what the job has read.
  ASSERT_OK(compact(store_, {}));
  EXPECT_FAILS(publish(1, example_latents(0, 6, 1), example_entity(), unseen),
               StatusCode::kFailedPrecondition, "by compaction; train again");
  const uint64_t seen_all = read_manifest(store_)->first_journal;
  ASSERT_OK(publish(1, example_latents(0, 6, 1), example_entity(), seen_all));
  EXPECT_EQ(open()->summary(example_entity())->latent_snapshots, 5u) << "one is not sealed";
}

TEST_F(PublishTest, NeverLetsLatentsTakeThePlaceOfALaterUpdate) {
  record(0, 6);
  const uint64_t unseen = read_manifest(store_)->first_journal;
  Snapshot update = example_snapshot(example_entity(), 77);
  update.time = example_time(3);
  {
    const auto writer = *StoreWriter::open(store_, {});
    ASSERT_OK(writer->append({pack_snapshot(update)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  ASSERT_OK(publish(1, example_latents(0, 6, 1), example_entity(), unseen));
  EXPECT_EQ(drop_recorded(store_, example_entity(), {})->snapshots, 5u);
  const auto left = read_all(*open(), example_entity());
  ASSERT_OK(left);
  EXPECT_EQ(*left, std::vector<Snapshot>{update});
}

TEST_F(PublishTest, LeavesOnlyTheModelToItsOwnerWhereItFails) {
  record(0, 6);
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  EXPECT_FAILS(publish(1, example_latents(0, 6, 1)), StatusCode::kAlreadyExists, "exists");
  EXPECT_EQ(files_in("tmp"), 1u);
}

TEST_F(PublishTest, AddsLatentsOfAModelThatIsThere) {
  record(0, 6);
  ASSERT_OK(publish(1, example_latents(0, 6, 1)));
  record(6, 10);
  const auto before = read_manifest(store_);
  ASSERT_OK(publish_latents(store_, example_entity(), 1, example_latents(6, 10, 1)));
  const auto manifest = read_manifest(store_);
  EXPECT_EQ(manifest->generation, before->generation + 1);
  ASSERT_EQ(manifest->models.size(), 1u);
  EXPECT_EQ(manifest->models[0].checksum, before->models[0].checksum);
  EXPECT_EQ(files_in("models"), 1u);
  const auto reader = open();
  for (const SnapshotEntry& entry : *reader->index(example_entity()).value())
    EXPECT_EQ(reader->read_latent(example_entity(), entry)->model_version, 1);
  EXPECT_EQ(reader->summary(example_entity())->latent_snapshots, 10u);
  // Again: the same times are superseded, the model that made them stays.
  ASSERT_OK(publish_latents(store_, example_entity(), 1, example_latents(0, 10, 1)));
  EXPECT_EQ(read_manifest(store_)->segments.size(), 3u);
  EXPECT_EQ(files_in("models"), 1u);
}

TEST_F(PublishTest, RefusesLatentsOfNoModelAndLeavesNothingOfThem) {
  record(0, 6);
  ASSERT_OK(publish(2, example_latents(0, 6, 2)));
  const auto before = read_manifest(store_)->generation;
  EXPECT_FAILS(publish_latents(store_, example_entity(), 1, example_latents(0, 6, 1)),
               StatusCode::kNotFound, "cam v1");
  EXPECT_FAILS(publish_latents(store_, example_entity(), 3, example_latents(0, 6, 3)),
               StatusCode::kNotFound, "cam v3");
  EXPECT_FAILS(publish_latents(store_, example_entity(), 2, example_latents(0, 6, 1)),
               StatusCode::kInvalidArgument, "v1");
  EXPECT_EQ(read_manifest(store_)->generation, before);
  EXPECT_EQ(files_in("segments"), 2u);
  EXPECT_EQ(files_in("tmp"), 0u);
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
  for (const char* name :
       {"", "models/", "models/a.b.c.v1.h5", "models/a.b.c.d.v0.h5", "models/a.b.c.d.1.h5",
        "models/a.b.c.d.v1.h5.new", "a.b.c.d.v1.h5", "models/a.b.c.%.v1.h5",
        "models/a.b.c.%2.v1.h5", "models/a.b.c.%zz.v1.h5", "models/a.b.c.d.v99999999999.h5",
        "models/a.b.c.%41.v1.h5"})
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
