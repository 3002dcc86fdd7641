// SPDX-License-Identifier: Apache-2.0
// Videos that begin from pictures of their model, over whole nights.
#include <gtest/gtest.h>

#include "encoders/deep_model_file.h"
#include "encoders/load_model.h"
#include "encoders/packed_video.h"
#include "ltm/codec/group_codec.h"
#include "ltm/recall/recall.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_check.h"
#include "ltm/store/store_reader.h"
#include "tests/training/textured_room.h"
#include "training/night/consolidate.h"
#include "training/night/drop_raw.h"
#include "training/quality/psnr.h"
#include "training/quality/quality_metrics.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::kRoomCamera;
using engram::testing::kRoomRows;
using engram::testing::night;
using engram::testing::record_rooms;
using engram::testing::ScratchPath;
using engram::testing::view_of_room;

constexpr double kReferenceBoundDb = 32;

ConsolidateOptions as_video() {
  return engram::testing::as_video(kReferenceBoundDb);
}

/// References of the newest model.
std::vector<encoders::VideoReference> references_of(const std::filesystem::path& store) {
  const auto manifest = ltm::read_manifest(store);
  const ltm::ModelInfo* newest = manifest->newest_model(id(kRoomCamera));
  if (newest == nullptr) return {};
  const auto model = encoders::read_model(store / newest->file);
  EXPECT_TRUE(model.ok()) << model.status().to_string();
  if (!model.ok()) return {};
  const auto references = (*model)->codec.chain.references_of(0);
  return {references.begin(), references.end()};
}

/// How many chains begin from a reference, of all.
std::pair<int, int> chains_from_references(const std::filesystem::path& store) {
  auto reader = ltm::StoreReader::open(store);
  EXPECT_TRUE(reader.ok());
  std::pair<int, int> chains;
  for (const ltm::SnapshotEntry& entry : **(*reader)->index(id(kRoomCamera))) {
    if (!entry.latent) continue;
    const auto latents = (*reader)->read_latent(id(kRoomCamera), entry);
    EXPECT_TRUE(latents.ok()) << latents.status().to_string();
    const ltm::Latent& latent = latents->instances.front().latent;
    if (latent.place.index != 0) continue;
    const auto block = encoders::describe_block(latent.code.bytes(), latent.place.count, 1);
    EXPECT_TRUE(block.ok()) << block.status().to_string();
    for (const auto& codes : block->chains) {
      EXPECT_EQ(codes.front().form, encoders::ImageForm::kPackedAv1);
      ++chains.second;
      if (encoders::reference_of_video(codes.front().code)->has_value()) ++chains.first;
    }
  }
  return chains;
}

/// All latents decode within the bound, in a fresh reader.
void expect_within_bound(const std::filesystem::path& store, int moments) {
  ltm::Recall recall(*ltm::StoreReader::open(store), encoders::load_model);
  const auto answer =
      recall.query(*ltm::Query::parse("Vision @ all"), {.prefer = ltm::Recall::Prefer::kLatent});
  ASSERT_TRUE(answer.ok()) << answer.status().to_string();
  const auto& found = answer->entities()[0]->snapshots;
  ASSERT_EQ(found.size(), static_cast<size_t>(moments));
  for (size_t i = 0; i < found.size(); ++i) {
    const auto error = compare(view_of_room(static_cast<int>(i)), found[i].instances[0].data);
    ASSERT_TRUE(error.ok()) << error.status().to_string();
    EXPECT_GE(psnr_db(error->image_mse), kReferenceBoundDb) << i;
  }
}

class References : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ltm::make_group_codec("av1").ok()) GTEST_SKIP() << "no AV1 encoder is installed";
  }
};

TEST_F(References, ShortenManyShortRecordings) {
  const ScratchPath store("references");
  record_rooms(store.path(), 0, 12);
  const EntityReport first = night(store.path(), as_video());
  ASSERT_EQ(references_of(store.path()).size(), 1u);
  const auto [from, all] = chains_from_references(store.path());
  EXPECT_EQ(all, 12);
  EXPECT_GE(from, 6);
  expect_within_bound(store.path(), 12 * kRoomRows);

  // The next night begins from the same picture, without a new model.
  record_rooms(store.path(), 12, 4);
  const EntityReport second = night(store.path(), as_video());
  EXPECT_FALSE(second.is_model_new);
  EXPECT_EQ(chains_from_references(store.path()).second, 16);
  EXPECT_GE(chains_from_references(store.path()).first, from + 1);
  expect_within_bound(store.path(), 16 * kRoomRows);

  const ltm::CheckOptions deep{.is_deep = true,
                               .test_model = [](const std::filesystem::path& file) -> Status {
                                 return encoders::load_model(file).status();
                               }};
  const auto checked = ltm::check_store(store.path(), deep);
  ASSERT_TRUE(checked.ok()) << checked.status().to_string();
  EXPECT_TRUE(checked->is_clean());
}

TEST_F(References, AreTakenOverByANewModel) {
  const ScratchPath store("references_again");
  record_rooms(store.path(), 0, 12);
  night(store.path(), as_video());
  const auto before = references_of(store.path());
  ASSERT_EQ(before.size(), 1u);
  ConsolidateOptions options = as_video();
  options.force = true;
  const EntityReport again = night(store.path(), options);
  EXPECT_TRUE(again.is_model_new);
  ASSERT_EQ(references_of(store.path()).size(), 1u);
  EXPECT_EQ(references_of(store.path()).front().hash(), before.front().hash());
  options.starts_anew = true;
  night(store.path(), options);
  EXPECT_EQ(references_of(store.path()).size(), 1u);
  expect_within_bound(store.path(), 12 * kRoomRows);
}

TEST_F(References, GoWithWhatWasForgottenInTheNextNight) {
  const ScratchPath store("references_forgotten");
  record_rooms(store.path(), 0, 12);
  night(store.path(), as_video());
  const auto before = references_of(store.path());
  ASSERT_EQ(before.size(), 1u);
  const ltm::ForgetSet gone{{id(kRoomCamera), {time_from_ns(before.front().time)}}};
  ASSERT_TRUE(ltm::forget_snapshots(store.path(), gone).ok());
  record_rooms(store.path(), 12, 1);
  EXPECT_TRUE(night(store.path(), as_video()).is_model_new);
  for (const encoders::VideoReference& reference : references_of(store.path()))
    EXPECT_NE(reference.hash(), before.front().hash());
  // What began from it was still recorded and is coded anew, so that its model went, too.
  EXPECT_EQ(ltm::read_manifest(store.path())->models.size(), 1u);
}

TEST_F(References, AreNotWorthItInFewRecordings) {
  const ScratchPath store("no_references");
  record_rooms(store.path(), 0, 3);
  ConsolidateOptions options = as_video();

  night(store.path(), options);
  EXPECT_TRUE(references_of(store.path()).empty());
  EXPECT_EQ(chains_from_references(store.path()).first, 0);
  expect_within_bound(store.path(), 3 * kRoomRows);
}

}  // namespace
}  // namespace engram::training
