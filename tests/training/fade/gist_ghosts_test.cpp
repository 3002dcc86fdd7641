// SPDX-License-Identifier: Apache-2.0
// Images of a gist that are told from one that is erased.
#include "training/fade/gist_ghosts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ltm/codec/group_codec.h"
#include "tests/training/moving_scene.h"

namespace engram::training {
namespace {

using ::testing::Eq;
using ::testing::Optional;

constexpr int kBrightest = 6, kRows = 13;

/// It gets brighter up to one row and darker again, so the first, that and the last row tell the
/// others.
idf::Data ramp_at(int row) {
  const int level = 40 + 25 * std::min(row, kRows - 1 - row);
  return idf::Dict{{"image", idf::NdArray::take(
                                 {32, 32, 3}, std::vector<uint8_t>(size_t{32} * 32 * 3,
                                                                   static_cast<uint8_t>(level)))}};
}

const idf::NdArray& image_of(const idf::Data& value) {
  return value.get<idf::Dict>().find("image")->get<idf::NdArray>();
}

class GistGhostsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ltm::make_group_codec("av1").ok()) GTEST_SKIP() << "no AV1 encoder is installed";
    TrainingSource source;
    source.entity = "Vision/RGB/head/cam";
    for (int row = 0; row < kRows; ++row) {
      values_.push_back(ramp_at(row));
      source.times.push_back(time_from_ns(int64_t{row} * 200'000'000));
    }
    source.read = [this](size_t i) -> Result<idf::Data> { return values_[i]; };
    TrainOptions options = engram::testing::quick_options(1);
    options.has_networks = false;
    auto fitted = fit_model(source, options, {}, {});
    ASSERT_TRUE(fitted.ok()) << fitted.status().to_string();
    model_ = fitted->model;
    auto latents = model_->encode_as_gist(values_, {});
    ASSERT_TRUE(latents.ok()) << latents.status().to_string();
    latent_ = latents->front();
  }

  /// The rows that would show one of `gone`, with what they show instead.
  std::vector<std::optional<int>> instead_of(const std::set<uint32_t>& gone) {
    const auto ghosts = find_ghosts(*model_, latent_, gone);
    EXPECT_TRUE(ghosts.ok()) << ghosts.status().to_string();
    return ghosts->instead.front();
  }

  std::vector<idf::Data> values_;
  std::shared_ptr<encoders::DeepModel> model_;
  ltm::Latent latent_;
};

TEST_F(GistGhostsTest, AreTheRowsThatAreToldFromWhatGoes) {
  const auto instead = instead_of({kBrightest});
  ASSERT_EQ(instead.size(), static_cast<size_t>(kRows));
  EXPECT_THAT(instead[0], Eq(std::nullopt)) << "it is kept itself";
  EXPECT_THAT(instead[2], Optional(0));
  EXPECT_THAT(instead[kRows - 3], Optional(kRows - 1));
  // What is told from the others shows nothing of a row that only was told, too.
  for (const auto& row : instead_of({3})) EXPECT_THAT(row, Eq(std::nullopt));
}

TEST_F(GistGhostsTest, ShowTheNearestKeptImageThatStays) {
  const auto ghosts = find_ghosts(*model_, latent_, {kBrightest});
  ASSERT_TRUE(ghosts.ok());
  std::vector<idf::Data> staying;
  std::vector<uint32_t> rows;
  for (uint32_t row = 0; row < kRows; ++row) {
    if (row == kBrightest) continue;
    rows.push_back(row);
    staying.push_back(values_[row]);
  }
  ASSERT_TRUE(replace_ghosts(*model_, *ghosts, rows, staying).ok());
  EXPECT_EQ(image_of(staying[2]), image_of(values_[0]));
  EXPECT_EQ(image_of(staying.back()), image_of(values_.back()));
  EXPECT_EQ(image_of(staying[staying.size() - 3]), image_of(values_.back()));
}

TEST_F(GistGhostsTest, AreGreyWhereNoKeptImageStays) {
  std::vector<idf::Data> alone{values_[2]};
  const auto ghosts = find_ghosts(*model_, latent_, {0, kBrightest, kRows - 1});
  ASSERT_TRUE(ghosts.ok());
  ASSERT_TRUE(replace_ghosts(*model_, *ghosts, {2}, alone).ok());
  for (const uint8_t level : image_of(alone[0]).values<uint8_t>()) ASSERT_EQ(level, 128);
}

}  // namespace
}  // namespace engram::training
