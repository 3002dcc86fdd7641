// SPDX-License-Identifier: Apache-2.0
#include "augmentation/image_change.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <opencv2/core.hpp>
#include <set>

#include "augmentation/augment.h"
#include "ltm/store/checksum.h"
#include "tests/augmentation/example_scene.h"
#include "tests/ltm/expect_status.h"

namespace engram::augmentation {
namespace {

const SceneMembers kMembers{{"labels"}, {"corner"}};

Recipe recipe_of(const ImageChange& kind, uint64_t seed, int strength_percent) {
  Random random(seed);
  Change change{std::string(kind.name()), {}};
  for (const auto& [name, value] : kind.draw(random, strength_percent))
    change.parameters.set(name, value);
  return {{change}};
}

const idf::NdArray& array_of(const idf::Data& value, const char* path) {
  return value.at(path)->get<idf::NdArray>();
}

uint64_t checksum_of(const idf::Data& value) {
  std::vector<std::byte> all;
  for (const char* path : {"image", "labels", "depth"})
    std::ranges::copy(array_of(value, path).bytes(), std::back_inserter(all));
  return ltm::checksum(all);
}

TEST(ImageChanges, HaveNamesBoundsAndWords) {
  std::set<std::string_view> names;
  for (const auto& kind : all_image_changes()) {
    EXPECT_TRUE(names.insert(kind->name()).second) << kind->name();
    EXPECT_FALSE(kind->about().empty());
    for (const Parameter& parameter : kind->parameters()) {
      EXPECT_LT(parameter.min, parameter.max) << parameter.name;
      EXPECT_FALSE(parameter.what.empty());
    }
    EXPECT_EQ(*find_image_change(kind->name()), kind.get());
  }
  EXPECT_EQ(names.size(), 10u);
  EXPECT_FAILS(find_image_change("brighness"), StatusCode::kInvalidArgument,
               "did you mean 'brightness'");
}

TEST(ImageChanges, DrawWithinTheirBounds) {
  for (const auto& kind : all_image_changes())
    for (const int strength : {1, 50, 100})
      for (uint64_t seed = 0; seed < 50; ++seed)
        EXPECT_OK(check_parameters(*kind, recipe_of(*kind, seed, strength).changes.front()));
}

TEST(ImageChanges, RefuseWhatIsOutOfBoundsMissingOrUnknown) {
  const ImageChange& kind = **find_image_change("contrast");
  EXPECT_FAILS(check_parameters(kind, {"contrast", idf::Dict{{"percent", int64_t{401}}}}),
               StatusCode::kInvalidArgument, "'percent' is 401, needs 0 to 400");
  EXPECT_FAILS(check_parameters(kind, {"contrast", {}}), StatusCode::kInvalidArgument,
               "has no 'percent'");
  EXPECT_FAILS(
      check_parameters(kind, {"contrast", idf::Dict{{"percent", int64_t{90}}, {"x", int64_t{1}}}}),
      StatusCode::kInvalidArgument, "knows no 'x'");
}

TEST(ImageChanges, MakeTheSameBytesWhateverTheNumberOfThreads) {
  const idf::Data value = example_value(96, 128);
  const int usual = cv::getNumThreads();
  for (const auto& kind : all_image_changes()) {
    const Recipe recipe = recipe_of(*kind, 11, 100);
    cv::setNumThreads(1);
    const auto one = augmented(value, nullptr, recipe, kMembers);
    ASSERT_OK(one);
    for (const int threads : {2, 4}) {
      cv::setNumThreads(threads);
      EXPECT_EQ(*augmented(value, nullptr, recipe, kMembers), *one) << kind->name();
    }
    EXPECT_NE(*one, value) << kind->name();
  }
  cv::setNumThreads(usual);
}

// What was published stays what it is: a recipe alone makes the same bytes for ever.
TEST(ImageChanges, MakeTheBytesThatTheyAlwaysMade) {
  const std::map<std::string_view, uint64_t> known{
      {"recolour", 11676658991046304445u}, {"replace", 15852594859817479811u},
      {"shift", 11410777500118091372u},    {"rotate", 8096510008850023335u},
      {"occlude", 16664843612321716543u},  {"brightness", 14888689916099372629u},
      {"contrast", 9813441935347254434u},  {"temperature", 9296488770543714149u},
      {"blur", 9477398052975020056u},      {"noise", 18381305902058654113u},
  };
  for (const auto& kind : all_image_changes()) {
    const auto changed = augmented(example_value(), nullptr, recipe_of(*kind, 5, 80), kMembers);
    ASSERT_OK(changed);
    const auto found = known.find(kind->name());
    EXPECT_EQ(checksum_of(*changed), found == known.end() ? 0 : found->second) << kind->name();
  }
}

TEST(ImageChanges, LeaveEverythingElseAsItWas) {
  const idf::Data value = example_value();
  for (const auto& kind : all_image_changes()) {
    const auto changed = augmented(value, nullptr, recipe_of(*kind, 3, 100), kMembers);
    ASSERT_OK(changed);
    EXPECT_EQ(*changed->at("width_m"), *value.at("width_m"));
    const bool moves = kind->name() == "shift" || kind->name() == "rotate";
    const bool covers = kind->name() == "occlude";
    EXPECT_EQ(*changed->at("corner") == *value.at("corner"), !moves) << kind->name();
    for (const char* path : {"labels", "depth"})
      EXPECT_EQ(*changed->at(path) == *value.at(path), !moves && !covers) << kind->name();
    EXPECT_EQ(array_of(*changed, "image").shape(), array_of(value, "image").shape());
  }
}

TEST(ImageChanges, TakeTheSmallestAndGreyImages) {
  for (const auto& kind : all_image_changes()) {
    const idf::Data grey =
        idf::Dict{{"image", idf::NdArray::take<uint8_t>({8, 9, 1}, std::vector<uint8_t>(72, 90))},
                  {"labels", idf::NdArray::take<uint8_t>({8, 9, 1}, std::vector<uint8_t>(72, 1))}};
    EXPECT_OK(augmented(grey, nullptr, recipe_of(*kind, 1, 100), {{"labels"}, {}}));
    const idf::Data alone = example_image(8, 8);
    if (!kind->needs_mask()) {
      EXPECT_OK(augmented(alone, nullptr, recipe_of(*kind, 1, 100), {}));
    }
  }
}

}  // namespace
}  // namespace engram::augmentation
