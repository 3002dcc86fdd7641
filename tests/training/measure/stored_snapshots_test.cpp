// SPDX-License-Identifier: Apache-2.0
#include "training/measure/stored_snapshots.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/training/recorded_scene.h"

namespace engram::training {
namespace {

using engram::testing::id;
using engram::testing::quick_consolidation;
using engram::testing::quick_options;
using engram::testing::record;
using engram::testing::ScratchPath;

std::vector<StoredSnapshot> snapshots_of(const std::filesystem::path& store) {
  const auto reader = *ltm::StoreReader::open(store);
  std::vector<StoredSnapshot> all;
  const Status listed = list_stored_snapshots(*reader, id("Test/Scene/sim/square"),
                                              [&](const StoredSnapshot& one) -> Status {
                                                all.push_back(one);
                                                return {};
                                              });
  EXPECT_TRUE(listed.ok()) << listed.to_string();
  return all;
}

TEST(StoredSnapshots, TellFormBytesAndErrorOfEach) {
  const ScratchPath store("stored_snapshots");
  record(store.path(), "Test/Scene/sim/square", 0, 40);
  auto chosen = quick_consolidation();
  chosen.train = quick_options(300);
  chosen.representation.kind = Representation::kAuto;
  chosen.representation.bound_db = 26;
  chosen.representation.video_effort = 1;
  chosen.representation.few_refine_steps = 2;
  chosen.representation.nights = 100000;  // Networks are worth trying.
  const auto report = consolidate(store.path(), chosen, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().to_string();
  const EntityReport& entity = report->entities[0];

  const auto snapshots = snapshots_of(store.path());
  ASSERT_EQ(snapshots.size(), 40u);
  std::map<KeptForm, int64_t> rows;
  double bytes = 0;
  double lowest_db = 60;
  for (const StoredSnapshot& snapshot : snapshots) {
    ASSERT_EQ(snapshot.images.size(), 1u);
    const StoredImage& image = snapshot.images[0];
    EXPECT_EQ(image.member, "image");
    EXPECT_EQ(image.residual_bytes > 0, image.form == KeptForm::kResidual);
    EXPECT_GT(image.bytes, static_cast<double>(image.residual_bytes));
    EXPECT_GT(snapshot.bytes, image.bytes);
    EXPECT_EQ(snapshot.model_version, 1);
    ++rows[image.form];
    bytes += snapshot.bytes;
    lowest_db = std::min(lowest_db, snapshot.psnr_db);
  }
  EXPECT_NEAR(bytes, static_cast<double>(entity.latent_bytes), 1e-3);
  EXPECT_DOUBLE_EQ(lowest_db, entity.minimum_psnr_db);
  EXPECT_GE(lowest_db, 26);
  EXPECT_EQ(rows[KeptForm::kLatents], entity.forms.latent_rows);
  EXPECT_EQ(rows[KeptForm::kRefined], entity.forms.refined_rows);
  EXPECT_EQ(rows[KeptForm::kResidual], entity.forms.residual_rows);
  EXPECT_EQ(rows[KeptForm::kVideo], entity.forms.video_rows);
  EXPECT_EQ(rows[KeptForm::kLossless], entity.forms.lossless_rows);
}

TEST(StoredSnapshots, AreNoneBeforeThereIsAModel) {
  const ScratchPath store("no_stored_snapshots");
  record(store.path(), "Test/Scene/sim/square", 0, 3);
  EXPECT_TRUE(snapshots_of(store.path()).empty());
}

}  // namespace
}  // namespace engram::training
