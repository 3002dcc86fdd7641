// SPDX-License-Identifier: Apache-2.0
#include "encoders/view.h"

#include <gtest/gtest.h>

#include "encoders/autoencoder.h"

namespace engram::encoders {
namespace {

using torch::Tensor;

const ImageShape kShape{3, 32, 48, 1};

NetworkShape network_of(int scenes) {
  NetworkShape shape;
  shape.sizes.width = 16;
  shape.sizes.scenes = scenes;
  shape.images = {kShape};
  return shape;
}

Tensor scene_of(int64_t scene) {
  return torch::full({1}, scene, torch::kLong);
}

TEST(PlaceFeatures, KnowByHeartOnlyScenesThatWereTrainedOn) {
  PlaceFeatures places(kShape, network_of(2).sizes);
  const Tensor background = torch::rand({1, 3, 32, 48});
  const View before = places(background, scene_of(-1));
  torch::NoGradGuard no_grad;
  for (Tensor weights :
       {places->sixteenth_by_heart, places->eighth_by_heart, places->quarter_by_heart})
    weights.fill_(1);
  const View none = places(background, scene_of(-1));
  const View known = places(background, scene_of(1));
  EXPECT_TRUE(none.sixteenth.equal(before.sixteenth));
  EXPECT_TRUE(none.eighth.equal(before.eighth));
  EXPECT_TRUE(none.quarter.equal(before.quarter));
  EXPECT_TRUE(torch::allclose(known.sixteenth, none.sixteenth + 1));
  EXPECT_TRUE(torch::allclose(known.eighth, none.eighth + 1));
  EXPECT_TRUE(torch::allclose(known.quarter, none.quarter + 1));
}

TEST(PlaceFeatures, FollowTheBackground) {
  PlaceFeatures places(kShape, network_of(1).sizes);
  const View one = places(torch::rand({1, 3, 32, 48}), scene_of(-1));
  const View other = places(torch::rand({1, 3, 32, 48}), scene_of(-1));
  EXPECT_FALSE(torch::allclose(one.quarter, other.quarter));
  EXPECT_FALSE(torch::allclose(one.sixteenth, other.sixteenth));
}

TEST(Views, AreMadeAnewWhereTheWeightsChanged) {
  Autoencoder autoencoder(network_of(2));
  torch::NoGradGuard no_grad;
  const auto background = [&] {
    return autoencoder->views_of(scene_of(1), {}).front().background.clone();
  };
  const Tensor before = background();
  EXPECT_TRUE(background().equal(before));
  autoencoder->images[0]->background.add_(0.5);
  EXPECT_TRUE(torch::allclose(background(), before + 0.5));
}

TEST(Views, OfABackgroundOfItsOwnAreNotTheScene) {
  Autoencoder autoencoder(network_of(2));
  torch::NoGradGuard no_grad;
  const Tensor own = torch::full({1, 3, 32, 48}, 128.0);
  const Views views = autoencoder->views_of(scene_of(1), {own});
  EXPECT_TRUE(torch::allclose(views.front().background * kGreyLevels, own));
  EXPECT_TRUE(autoencoder->views_of(scene_of(1), {})
                  .front()
                  .background.equal(autoencoder->images[0]->background.slice(0, 1, 2)));
}

TEST(Views, StandForSeveralRowsEach) {
  Autoencoder autoencoder(network_of(2));
  torch::NoGradGuard no_grad;
  autoencoder->images[0]->background.copy_(torch::rand({2, 3, 32, 48}));
  autoencoder->images[0]->places->sixteenth_by_heart.slice(0, 1).fill_(0.5);
  const Tensor images = torch::rand({6, 3, 32, 48}) * 255;
  const Tensor scenes = torch::tensor({0, 1}, torch::kLong);
  const auto rows = [&](const Tensor& x) { return Parts{{x}, Tensor(), scenes}; };
  const Views both = autoencoder->look(scenes, {});
  const Latents together = autoencoder->encode(rows(images), both);
  const Tensor decoded = autoencoder->decode(together, both).images[0];
  for (int64_t row = 0; row < 6; ++row) {
    const Views own = autoencoder->look(scene_of(row / 3), {});
    const Latents alone = autoencoder->encode(rows(images.slice(0, row, row + 1)), own);
    EXPECT_TRUE(torch::allclose(together.images[0].coarse.slice(0, row, row + 1),
                                alone.images[0].coarse, 1e-4, 1e-4));
    EXPECT_TRUE(torch::allclose(decoded.slice(0, row, row + 1),
                                autoencoder->decode(alone, own).images[0], 1e-4, 1e-2));
  }
}

}  // namespace
}  // namespace engram::encoders
