// SPDX-License-Identifier: Apache-2.0
#include "training/fade/gist_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace engram::training {
namespace {

constexpr size_t kImages = 100;

/// Encodes images that take `bytes` each at crf 60, and 10 % fewer with each step. It counts the
/// qualities.
class Encoder {
 public:
  explicit Encoder(double bytes) : bytes_(bytes) {}

  Result<std::vector<ltm::Latent>> operator()(const encoders::GistOptions& options) {
    EXPECT_TRUE(tried.emplace(options.crf, options.gain_db).second) << "nothing is tried twice";
    const double each = bytes_ * std::pow(0.9, options.crf - 60 + options.gain_db - 3);
    const auto size = static_cast<size_t>(each * kImages);
    last = std::max(last, size <= kMaxGistBytes * kImages ? size : 0);
    return std::vector<ltm::Latent>{{Buffer::take(std::vector<std::byte>(size)), {}}};
  }

  std::set<std::pair<int, double>> tried;
  size_t last = 0;  ///< The largest size that fits.

 private:
  double bytes_;
};

TEST(GistQuality, IsTheBestThatFits) {
  for (const double bytes : {1.0, 5.0, 12.0, 20.0, 24.0, 26.0}) {
    GistQuality quality;
    Encoder encoder(bytes);
    const auto found = quality.find(kImages, std::ref(encoder));
    ASSERT_TRUE(found.ok());
    EXPECT_EQ(found->front().code.size(), encoder.last) << bytes;
    EXPECT_LE(encoder.tried.size(), 5u) << "each encode takes half a minute";
    Encoder again(bytes);
    ASSERT_TRUE(quality.find(kImages, std::ref(again)).ok());
    EXPECT_LE(again.tried.size(), 2u) << "it begins where the block before ended";
    EXPECT_EQ(again.last, encoder.last);
  }
}

TEST(GistQuality, FollowsWhatChanges) {
  GistQuality quality;
  for (const double bytes : {20.0, 1.0, 40.0, 3.0, 26.0, 1000.0, 20.0}) {
    Encoder encoder(bytes);
    const auto found = quality.find(kImages, std::ref(encoder));
    ASSERT_TRUE(found.ok());
    if (encoder.last > 0) {
      EXPECT_EQ(found->front().code.size(), encoder.last) << bytes;
    }
  }
}

TEST(GistQuality, IsTheSmallestWhereNoneFits) {
  GistQuality quality;
  Encoder encoder(1000);
  const auto found = quality.find(kImages, std::ref(encoder));
  ASSERT_TRUE(found.ok());
  EXPECT_GT(found->front().code.size(), kMaxGistBytes * kImages);
  EXPECT_TRUE(encoder.tried.contains({63, 4.0}));
}

}  // namespace
}  // namespace engram::training
