// SPDX-License-Identifier: Apache-2.0
// Images that a store keeps as groups, and values that are only latents.
#include "ltm/codec/codec.h"
#include "ltm/forgetting/redact_store.h"
#include "tests/datasets/vault/vault_fixture.h"
#include "tests/ltm/recall/recalled_store.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/ltm/store/media_groups_fixture.h"

namespace engram::datasets::vault {
namespace {

using ltm::PackedMedium;
using ltm::Snapshot;

/// Example times are five a second from this index on the next day.
int64_t first_of_next_day() {
  const Time midnight = day_end(day_of(ltm::example_time(0))) + Duration(1);
  return (to_ns(midnight) - ltm::kExampleStart_ns) / 200'000'000;
}

class VaultGroups : public ltm::MediaGroupsFixture {
 protected:
  VaultExportReport export_all() {
    ltm::Recall recall(*ltm::StoreReader::open(store_), ltm::ModelLoader());
    auto report = export_to_vault(recall, *ltm::Query::parse("@ all"), places_, {}, {}, {});
    EXPECT_OK(report);
    return report.ok() ? *report : VaultExportReport();
  }

  /// The store is what the vault gives back from here on.
  void bring_back() {
    const auto back = scratch_ / "back";
    EXPECT_OK(import_from_vault(places_, back, {}, {}));
    store_ = back;
  }

  VaultPlaces places_{scratch_ / "vault", scratch_ / "keys"};
};

TEST_F(VaultGroups, StayGroupsAndAreNotCodedAgain) {
  for (const std::string codec : {"ffv1:group=10", "h264:crf=20,group=10"}) {
    SCOPED_TRACE(codec);
    if (!ltm::group_options(codec).validate().ok()) continue;
    store_ = scratch_ / ("store " + codec);
    places_ = {scratch_ / ("vault " + codec), scratch_ / ("keys " + codec)};
    ASSERT_OK(ltm::create_store(store_));
    std::filesystem::remove_all(scratch_ / "back");
    seal_pictures(0, 25, codec);
    const auto snapshots = read();
    const auto media_before = media();
    const auto codecs_before = codecs();
    const auto columns_before =
        (*ltm::StoreReader::open(store_))->newest_forms(ltm::example_entity());
    export_all();
    bring_back();
    expect_content(snapshots);
    EXPECT_EQ(codecs(), codecs_before);
    const auto media_after = media();
    ASSERT_EQ(media_after.size(), media_before.size());
    for (size_t i = 0; i < media_after.size(); ++i) {
      ASSERT_TRUE(media_before[i].group.has_value());
      EXPECT_EQ(text_of(media_after[i].bytes.bytes()), text_of(media_before[i].bytes.bytes())) << i;
    }
    EXPECT_EQ((*ltm::StoreReader::open(store_))->newest_forms(ltm::example_entity())->columns,
              columns_before->columns);
    EXPECT_FALSE(columns_before->columns.empty());
    expect_clean(store_);
  }
}

TEST_F(VaultGroups, GroupsOverMidnightLeaveNoImageInTheOtherDay) {
  const int64_t midnight = first_of_next_day();
  seal_pictures(midnight - 14, midnight + 16, "ffv1:group=10");
  const auto snapshots = read();
  // The group in the middle has images of both days.
  EXPECT_EQ(codecs()[13], "ffv1 3/10");
  EXPECT_EQ(codecs()[14], "ffv1 4/10");
  EXPECT_EQ(export_all().added, 2U);
  bring_back();
  expect_content(snapshots);
  const auto names = codecs();
  EXPECT_EQ(names[0], "ffv1 0/10");
  EXPECT_EQ(names[9], "ffv1 9/10");
  for (size_t i = 10; i < 20; ++i) EXPECT_EQ(names[i].find("ffv1"), std::string::npos) << i;
  EXPECT_EQ(names[20], "ffv1 0/10");
  expect_clean(store_);
}

TEST_F(VaultGroups, AnUpdateInAGroupTakesTheOthersOutOfIt) {
  seal_pictures(0, 20, "ffv1:group=10");
  seal({snapshot(5, ltm::picture(99))}, "ffv1:group=10");
  const auto snapshots = read();
  EXPECT_EQ(snapshots[5].instances[0].data, snapshot(5, ltm::picture(99)).instances[0].data);
  export_all();
  bring_back();
  expect_content(snapshots);
  EXPECT_EQ(codecs()[15], "ffv1 5/10");
  expect_clean(store_);
}

TEST_F(VaultGroups, AreNotTakenApartBecauseTheirImagesWouldBeLargeDecoded) {
  // A minute of 4K at one image a second: 1.5 GB decoded, far more than may wait.
  constexpr uint32_t kImages = 60;
  const std::vector<int64_t> shape{2160, 3840, 3};
  const Buffer group = Buffer::copy(as_bytes(std::string(2000, 'g')));
  VaultDay about;
  ASSERT_OK(fill_random(about.file));
  about.key = *SecretKey::random();
  const auto path = scratch_ / to_text(about.file);
  auto file = SealedFileWriter::create(path, about.file, about.key);
  ASSERT_OK(file);
  DayWriter writer(*file);
  for (uint32_t i = 0; i < kImages; ++i) {
    VaultSnapshot made{packed(snapshot(i, ltm::picture(i)), {.image_codec = "zstd"}), {}};
    ltm::PackedValue& value = made.packed.instances[0].value;
    ASSERT_EQ(value.media.size(), 1U);
    value.media[0].shape = shape;
    value.media[0].codec = "ffv1";
    value.media[0].bytes = group;
    value.media[0].group = {i, kImages};
    made.packed.raw_bytes += uint64_t{2160} * 3840 * 3;
    ASSERT_OK(writer.put(std::move(made)));
  }
  ASSERT_OK(writer.finish(about));
  const Day day = day_of(ltm::example_time(0));
  auto reader = DayReader::open(path, ltm::example_entity(), day, about);
  ASSERT_OK(reader);
  for (uint32_t i = 0; i < kImages; ++i) {
    const auto found = reader->next();
    ASSERT_OK(found);
    const PackedMedium& medium = (*found)->packed.instances[0].value.media[0];
    ASSERT_TRUE(medium.group.has_value()) << i;
    EXPECT_EQ(medium.group->index, i);
    EXPECT_EQ(text_of(medium.bytes.bytes()), text_of(group.bytes()));
  }
}

class VaultLatents : public ltm::RecalledStore {
 protected:
  VaultPlaces places_{scratch_ / "vault", scratch_ / "keys"};
};

TEST_F(VaultLatents, WhatIsOnlyALatentIsDecodedAndItsErrorIsNoted) {
  make_store(6, true);
  ltm::Recall recall = open(loader());
  const auto out = export_to_vault(recall, ask("all"), places_, {}, {}, {});
  ASSERT_OK(out);
  EXPECT_EQ(out->snapshots, 10U);
  EXPECT_EQ(out->reconstructed, 6U);
  EXPECT_TRUE(out->unread.empty());
  const auto keys = *read_keys(places_.keys);
  const Day day = day_of(ltm::example_time(0));
  const VaultDay& kept = *keys.find(ltm::example_entity(), day);
  EXPECT_EQ(kept.reconstructed, 6U);
  auto reader =
      *DayReader::open(day_file(places_.vault, kept.file), ltm::example_entity(), day, kept);
  const auto first = *reader.next();
  EXPECT_EQ(*first->reconstructed.at("model"), idf::Data("Vision/RGB/head/cam v1"));
  EXPECT_EQ(*first->reconstructed.at("errors/0/image_mse"), idf::Data(2.0));
  EXPECT_EQ(*first->reconstructed.at("errors/0/number_mse"), idf::Data(0.25));
  const auto in = import_from_vault(places_, scratch_ / "back", {}, {});
  ASSERT_OK(in);
  EXPECT_EQ(in->reconstructed, 6U);
  ltm::Recall back(*ltm::StoreReader::open(scratch_ / "back"), ltm::ModelLoader());
  const auto before = *recall.query(ask("all")), after = *back.query(ask("all"));
  const auto& snapshots = before.find_entity(ltm::example_entity())->snapshots;
  const auto& snapshots_back = after.find_entity(ltm::example_entity())->snapshots;
  ASSERT_EQ(snapshots.size(), snapshots_back.size());
  for (size_t i = 0; i < snapshots.size(); ++i) {
    EXPECT_EQ(snapshots[i].instances[0].data, snapshots_back[i].instances[0].data);
    EXPECT_EQ(snapshots[i].instances[0].metadata, snapshots_back[i].instances[0].metadata);
    EXPECT_EQ(snapshots_back[i].source, ltm::Source::kRecorded);
  }
}

TEST_F(VaultLatents, WhatTheVaultHasAsRecordedStaysWhenTheStoreDropsIt) {
  make_store(6, false);
  const auto export_all = [this] {
    ltm::Recall recall = open(loader());
    auto report = export_to_vault(recall, *ltm::Query::parse("@ all"), places_, {}, {}, {});
    EXPECT_OK(report);
    return report.ok() ? *report : VaultExportReport();
  };
  EXPECT_EQ(export_all().added, 2U);
  ASSERT_OK(ltm::drop_recorded(store_, ltm::example_entity(), {}));
  for (int i = 0; i < 2; ++i) {
    const auto again = export_all();
    EXPECT_EQ(again.unchanged, 2U);
    EXPECT_EQ(again.kept_recorded, 1U);
    EXPECT_EQ(again.replaced, 0U);
  }
  const auto in = import_from_vault(places_, scratch_ / "back", {}, {});
  ASSERT_OK(in);
  EXPECT_EQ(in->reconstructed, 0U);
  // A file that somebody removed is written from what there is.
  const auto keys = *read_keys(places_.keys);
  const Day day = day_of(ltm::example_time(0));
  std::filesystem::remove(day_file(places_.vault, keys.find(ltm::example_entity(), day)->file));
  EXPECT_EQ(export_all().reconstructed, 6U);
}

TEST_F(VaultLatents, ARedactionInTheStoreReachesADayThatTheVaultHasBetter) {
  using namespace ltm::testing;
  make_store(6, false);
  const Time shown = ltm::example_time(20);
  {
    const auto writer = *ltm::StoreWriter::open(store_, {});
    Snapshot secret = ltm::example_snapshot(ltm::example_entity(), 20);
    secret.instances[0].data.get_if<idf::Dict>()->set("image", image_with_secret(64, 48, 9, 5));
    ASSERT_OK(writer->append({ltm::pack_snapshot(secret)}, nullptr));
    ASSERT_OK(writer->seal());
  }
  const auto export_all = [this] {
    ltm::Recall recall = open(loader());
    auto report = export_to_vault(recall, *ltm::Query::parse("@ all"), places_, {}, {}, {});
    EXPECT_OK(report);
    return report.ok() ? *report : VaultExportReport();
  };
  const auto shows_secret = [&](const std::filesystem::path& back) {
    EXPECT_OK(import_from_vault(places_, back, {}, {}));
    ltm::Recall recall(*ltm::StoreReader::open(back), ltm::ModelLoader());
    const auto found = *recall.query(ask(to_string(shown)));
    const auto* snapshot = found.find_snapshot(ltm::example_entity().at(shown));
    return has_secret(snapshot->instances[0].data.at("image")->get<idf::NdArray>());
  };
  EXPECT_EQ(export_all().added, 2U);
  EXPECT_TRUE(shows_secret(scratch_ / "before"));
  ASSERT_OK(ltm::drop_recorded(store_, ltm::example_entity(), {}));
  EXPECT_EQ(export_all().kept_recorded, 1U);
  const Day day = day_of(shown);
  const VaultDay old = *read_keys(places_.keys)->find(ltm::example_entity(), day);
  ltm::StoreRedactionJob job{.store = store_, .options = marker_redaction(scratch_.path())};
  job.loader = loader();
  job.code_anew = [](const auto&, const auto&, const auto&, const auto&) -> Result<ltm::Erasures> {
    return ltm::Erasures();
  };
  const auto redacted = ltm::redact_store(job);
  ASSERT_OK(redacted);
  ASSERT_EQ(redacted->total().redacted, 1U);
  // The times are the same, and others of the day are only latents in the store.
  const auto out = export_all();
  EXPECT_EQ(out.replaced, 1U);
  EXPECT_EQ(out.kept_recorded, 0U);
  EXPECT_EQ(content(places_.keys).find(text_of(old.key.bytes())), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(day_file(places_.vault, old.file)));
  EXPECT_FALSE(shows_secret(scratch_ / "after"));
  EXPECT_EQ(export_all().unchanged, 2U);
}

TEST_F(VaultLatents, ADamagedReportOfARedactionIsNamed) {
  make_store(6, false);
  std::filesystem::create_directory(store_ / "erasures");
  const auto report = store_ / "erasures/000001.json";
  ltm::Recall recall = open(loader());
  for (const char* text : {"", "[]", "{\"when_ns\": 1}", "{\"when_ns\": 1, \"entities\": [3]",
                           R"({"when_ns": 1, "entities": [{"id": "a", "redacted_days": 7}]})",
                           R"({"when_ns": 1, "entities": [{"id": "a", "redacted_days": [7]}]})",
                           R"({"when_ns": 1, "entities": [{"redacted_days": []}]})"}) {
    overwrite_file(report, as_bytes(text));
    EXPECT_FAILS(export_to_vault(recall, *ltm::Query::parse("@ all"), places_, {}, {}, {}),
                 StatusCode::kDataLoss, "000001.json");
  }
  // One of an earlier program, or of forgetting, names no days.
  overwrite_file(report, as_bytes(R"({"when_ns": 1, "entities": [{"id": "a", "erased": 2}]})"));
  EXPECT_OK(export_to_vault(recall, *ltm::Query::parse("@ all"), places_, {}, {}, {}));
}

TEST_F(VaultLatents, WithoutTheModelTheDayIsLeftOutAndNamed) {
  make_store(6, true);
  ltm::Recall recall = open({});
  const auto out = export_to_vault(recall, *ltm::Query::parse("@ all"), places_, {}, {}, {});
  ASSERT_OK(out);
  EXPECT_EQ(out->added, 1U);
  ASSERT_EQ(out->unread.size(), 1U);
  EXPECT_EQ(out->unread[0].entity, ltm::example_entity());
}

}  // namespace
}  // namespace engram::datasets::vault
