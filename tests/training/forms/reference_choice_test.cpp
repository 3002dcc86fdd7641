// SPDX-License-Identifier: Apache-2.0
// Which pictures videos begin from.
#include "training/forms/reference_choice.h"

#include <gtest/gtest.h>

#include <array>

#include "ltm/codec/group_codec.h"
#include "training/forms/entity_videos.h"

namespace engram::training {
namespace {

constexpr const char* kSettings = "effort=3,depth=10,spread=2";

/// One of two places, each with its own texture, and something small that differs by image.
idf::NdArray place(int which, int moment) {
  constexpr int kSide = 64;
  std::vector<uint8_t> pixels;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c) {
        const int texture = which == 0 ? (x * x + 3 * y * x + 7 * y) % 61 : (x * y + 5 * x) % 47;
        const bool is_mark = x / 8 == moment % 8 && y / 8 == moment / 8;
        pixels.push_back(static_cast<uint8_t>(is_mark ? 240 : 50 + 60 * which + texture + 5 * c));
      }
  return idf::NdArray::take<uint8_t>({kSide, kSide, 3}, std::move(pixels));
}

std::vector<ReferenceSample> samples_of(const std::vector<int>& places) {
  std::vector<ReferenceSample> samples;
  for (size_t i = 0; i < places.size(); ++i)
    samples.push_back({Time(std::chrono::seconds(i)), place(places[i], static_cast<int>(i))});
  return samples;
}

class ReferenceChoiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!ltm::make_group_codec("av1").ok()) GTEST_SKIP() << "no AV1 encoder is installed";
  }
};

TEST_F(ReferenceChoiceTest, TakesPicturesOfEachPlace) {
  const auto samples = samples_of({0, 1, 0, 0, 1, 1, 0, 1});
  const auto chosen =
      choose_references(samples, {}, {.chains = 100, .crf = 30, .settings = kSettings}, {});
  ASSERT_TRUE(chosen.ok()) << chosen.status().to_string();
  ASSERT_GE(chosen->size(), 2u);
  EXPECT_LT(chosen->size(), samples.size());
  std::array<int, 2> reached{};
  for (const encoders::OpenReference& one : *chosen)
    for (const int which : {0, 1})
      if (encoders::reference_distance(one.picture, place(which, 63)) <= one.reference.reach)
        ++reached[static_cast<size_t>(which)];
  for (const int times : reached) EXPECT_GE(times, 1);
}

TEST_F(ReferenceChoiceTest, TakesNoneThatCostsMoreThanItSaves) {
  const auto samples = samples_of({0, 0, 0, 0});
  const auto few =
      choose_references(samples, {}, {.chains = 1, .crf = 30, .settings = kSettings}, {});
  ASSERT_TRUE(few.ok());
  EXPECT_TRUE(few->empty());
  const auto many =
      choose_references(samples, {}, {.chains = 20, .crf = 30, .settings = kSettings}, {});
  ASSERT_TRUE(many.ok());
  EXPECT_FALSE(many->empty());
}

TEST_F(ReferenceChoiceTest, KeepsWhatAnEarlierModelHas) {
  const auto samples = samples_of({0, 0, 0, 0, 0});
  const ReferenceChoiceOptions options{.chains = 20, .crf = 30, .settings = kSettings};
  const auto first = choose_references(samples, {}, options, {});
  ASSERT_TRUE(first.ok());
  ASSERT_FALSE(first->empty());
  const auto later = choose_references(samples_of({1, 0, 1, 0, 1, 0}), *first, options, {});
  ASSERT_TRUE(later.ok());
  ASSERT_GE(later->size(), 2u) << "the old place, and a new one";
  EXPECT_EQ(later->front().reference.hash(), first->front().reference.hash());
}

TEST_F(ReferenceChoiceTest, StopsWhenTold) {
  std::stop_source source;
  source.request_stop();
  const auto samples = samples_of({0, 0, 0, 0});
  EXPECT_EQ(choose_references(samples, {}, {.chains = 20, .crf = 30, .settings = kSettings},
                              source.get_token())
                .status()
                .code(),
            StatusCode::kCancelled);
}

TEST_F(ReferenceChoiceTest, ShortensTheVideosOfASearch) {
  EntityVideos videos(1, {.settings = kSettings, .bound_db = 38, .tolerance_db = 0.5});
  const std::vector<idf::NdArray> chain{place(0, 40), place(0, 41), place(0, 42)};
  const auto alone = videos.search_of(0).search(chain);
  ASSERT_TRUE(alone.ok() && alone->lossy);
  const auto chosen = choose_references(
      samples_of({0, 0, 0, 0}), {},
      {.chains = 50, .crf = static_cast<int>(alone->lossy->quality), .settings = kSettings}, {});
  ASSERT_TRUE(chosen.ok());
  ASSERT_FALSE(chosen->empty());
  videos.search_of(0).learn(*alone);

  videos.search_of(0).use_references(*chosen);
  const auto found = videos.search_of(0).search(chain);
  ASSERT_TRUE(found.ok() && found->lossy);
  EXPECT_FALSE(found->has_other_key_frame);
  EXPECT_LT(found->lossy->size(), alone->lossy->size());
  const auto reference = *encoders::reference_of_video(found->lossy->bytes);
  ASSERT_TRUE(reference.has_value());
  EXPECT_NE(videos.search_of(0).find_reference(*reference), nullptr);
  // A place that it does not reach.
  const auto other = videos.search_of(0).search(std::vector{place(1, 3), place(1, 4)});
  ASSERT_TRUE(other.ok() && other->lossy);
  EXPECT_FALSE(encoders::reference_of_video(other->lossy->bytes)->has_value());

  // What begins from a reference is known for as long as that is in use.
  videos.add(chain, *found);
  EXPECT_TRUE(videos.find(0, chain));
  ASSERT_TRUE(videos.add_stored(0, chain, found->lossy->form, found->lossy->bytes, {}).ok());
  videos.search_of(0).use_references({});
  EXPECT_FALSE(videos.find(0, chain));
  EXPECT_FALSE(videos.add_stored(0, chain, found->lossy->form, found->lossy->bytes, {}).ok());
}

}  // namespace
}  // namespace engram::training
