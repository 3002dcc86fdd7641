// SPDX-License-Identifier: Apache-2.0
#include "training/forms/latent_refinement.h"

#include <gtest/gtest.h>

#include "encoders/deep_model_file.h"
#include "tests/training/moving_scene.h"
#include "training/quality/psnr.h"

namespace engram::training {
namespace {

using encoders::LatentRows;
using testing::quick_options;
using testing::scene_source;
using testing::ScratchPath;

/// A model that was trained briefly, and some consecutive values that it was trained on.
class LatentRefinement : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto source = scene_source(24, 1, true, false);
    ASSERT_TRUE(train_model(source, quick_options(120), file_.path(), {}, {}).ok());
    auto model = encoders::read_model(file_.path());
    ASSERT_TRUE(model.ok()) << model.status().to_string();
    model_ = *std::move(model);
    for (size_t i = 4; i < 10; ++i)
      values_.push_back(*model_->plan.layout().split(*source.read(i)));
    rows_ = *model_->to_rows(values_);
  }

  [[nodiscard]] size_t bytes_of(const LatentRows& rows) const {
    return model_->codec.chain.images[0].encode(rows.images[0].latents).size();
  }

  /// Squared error per row.
  [[nodiscard]] std::vector<double> errors_of(const LatentRows& rows) const {
    std::vector<double> errors;
    for (size_t row = 0; row < values_.size(); ++row) {
      const auto images = model_->decode_images(rows, row);
      errors.push_back(
          *image_mse(values_[row].tensors[model_->plan.images()[0].member], images->front()));
    }
    return errors;
  }

  [[nodiscard]] double cost_of(const LatentRows& rows) const {
    double error = 0;
    for (const double one : errors_of(rows)) error += one;
    constexpr double kSize = 48.0 * 48 * 3 / (128 * 128 * 3);
    return error * model_->provenance.error_price +
           static_cast<double>(bytes_of(rows)) / (1000 * kSize);
  }

  ScratchPath file_{"refinement"};
  std::shared_ptr<encoders::DeepModel> model_;
  std::vector<idf::SplitValue> values_;
  LatentRows rows_;
};

TEST_F(LatentRefinement, LowersWhatABlockCosts) {
  ASSERT_GT(model_->provenance.error_price, 0);
  const auto refined = refine_latents(*model_, values_, rows_, {40, 0}, {});
  ASSERT_TRUE(refined.ok()) << refined.status().to_string();
  EXPECT_FALSE(refined->images == rows_.images);
  EXPECT_LT(cost_of(*refined), cost_of(rows_));
}

TEST_F(LatentRefinement, ReachesABoundThatTheEncoderMissed) {
  const std::vector<double> before = errors_of(rows_);
  const double worst = psnr_db(*std::ranges::max_element(before));
  const double bound_db = worst + 0.7;
  const auto refined = refine_latents(*model_, values_, rows_, {80, bound_db}, {});
  ASSERT_TRUE(refined.ok()) << refined.status().to_string();
  const auto below = [&](const std::vector<double>& errors) {
    return std::ranges::count_if(errors, [&](double mse) { return psnr_db(mse) < bound_db; });
  };
  EXPECT_GT(below(before), 0);
  EXPECT_LT(below(errors_of(*refined)), below(before));
}

TEST_F(LatentRefinement, LeavesLatentsAsTheyAreWithoutSteps) {
  const auto refined = refine_latents(*model_, values_, rows_, {0, 0}, {});
  ASSERT_TRUE(refined.ok());
  EXPECT_TRUE(refined->images == rows_.images);
}

TEST_F(LatentRefinement, StopsOnRequest) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(refine_latents(*model_, values_, rows_, {10, 0}, stop.get_token()).status().code(),
            StatusCode::kCancelled);
}

}  // namespace
}  // namespace engram::training
