// SPDX-License-Identifier: Apache-2.0
#include "training/fit/view_change.h"

#include <gtest/gtest.h>

namespace engram::training {
namespace {

using torch::Tensor;

TEST(ViewChange, ShiftsAndRepeatsTheEdge) {
  const Tensor images = torch::rand({2, 3, 20, 40}) * 200;
  ViewChange change;
  change.right = 0.1;
  change.down = -0.05;
  const Tensor changed = change.of(images);
  ASSERT_EQ(changed.sizes(), images.sizes());
  EXPECT_TRUE(changed.slice(2, 1).slice(3, 0, 36).equal(images.slice(2, 0, 19).slice(3, 4)));
  EXPECT_TRUE(changed.select(2, 0).equal(changed.select(2, 1)));
  EXPECT_TRUE(changed.select(3, 39).equal(changed.select(3, 36)) ||
              changed.select(3, 39).equal(changed.select(3, 35)));
}

TEST(ViewChange, ChangesLightAndMirrors) {
  const Tensor images = torch::rand({1, 1, 8, 8}) * 100;
  ViewChange change;
  change.contrast = 1.5;
  change.brightness = 7;
  change.is_mirrored = true;
  EXPECT_TRUE(torch::allclose(change.of(images), images.flip(3) * 1.5 + 7));
}

TEST(ViewChange, IsDrawnFromASeed) {
  torch::manual_seed(3);
  const ViewChange one = ViewChange::draw(true);
  const ViewChange two = ViewChange::draw(true);
  torch::manual_seed(3);
  const ViewChange again = ViewChange::draw(true);
  EXPECT_EQ(one.right, again.right);
  EXPECT_EQ(one.brightness, again.brightness);
  EXPECT_NE(one.right, two.right);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(ViewChange::draw(false).is_mirrored);
}

}  // namespace
}  // namespace engram::training
