// SPDX-License-Identifier: Apache-2.0
#include "ltm/saliency/moment_content.h"

#include <cmath>
#include <limits>

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using idf::Dict;
using idf::List;
using idf::NdArray;

MomentContent content_of(const idf::Data& value, const std::optional<idf::Type>& type = {}) {
  ContentReader reader(type);
  reader.begin();
  reader.add(value);
  return reader.content();
}

TEST(MomentContent, NumbersAreComparedAndTimesAndImagesAreNot) {
  ContentReader reader({});
  reader.begin();
  reader.add(Dict{{"x", 0.5},
                  {"is_open", true},
                  {"count", 3},
                  {"started", int64_t{1'600'000'000'000'000'000}},
                  {"position", NdArray::take({3}, std::vector<float>{1, 2, NAN})},
                  {"image", NdArray::take({8, 8, 3}, std::vector<uint8_t>(192))}});
  EXPECT_EQ(reader.content().numbers, (std::vector<double>{0.5, 1, 3, 1, 2, 0}));
  ASSERT_EQ(reader.members().size(), 4u);
  EXPECT_EQ(reader.members()[3], (ContentMember{"position", 3, 3}));
}

TEST(MomentContent, OtherTextsAreOtherFactsAndMomentsOfOneEntityAreOneLink) {
  const auto link = [](const std::string& to) { return content_of(Dict{{"object", to}}); };
  const auto tea = link("Objects/Instances/kitchen/tea/2022-02-18 13:06:56.492182/0");
  EXPECT_EQ(tea.facts, 0u);
  EXPECT_NE(tea.links, 0u);
  EXPECT_EQ(tea.links, link("Objects/Instances/kitchen/tea/2022-02-18 13:06:57/0").links);
  EXPECT_NE(tea.links, link("Objects/Instances/kitchen/salt/2022-02-18 13:06:57/0").links);
  const auto held = content_of(Dict{{"held_by", "left"}});
  EXPECT_EQ(held.links, 0u);
  EXPECT_NE(held.facts, content_of(Dict{{"held_by", ""}}).facts);
  EXPECT_NE(held.facts, content_of(Dict{{"seen_by", "left"}}).facts);
}

TEST(MomentContent, ListsOfOtherLengthsHaveTheSameMembers) {
  const auto seen = [](size_t count) {
    List things;
    for (size_t i = 0; i < count; ++i)
      things.push_back(Dict{{"x", static_cast<double>(i)}, {"name", "thing"}});
    ContentReader reader({});
    reader.begin();
    reader.add(Dict{{"things", things}});
    return std::pair(reader.members(), reader.content().numbers);
  };
  EXPECT_EQ(seen(3).first, seen(5).first);
  EXPECT_EQ(seen(5).second, (std::vector<double>{5, 2}));  // How many, and their mean.
}

TEST(MomentContent, KnowsWordsAndOutcomes) {
  EXPECT_TRUE(content_of(Dict{{"speaker", "human"}, {"text", "Stop!"}}).is_speech);
  EXPECT_TRUE(content_of("Bring the salt.").is_speech);
  EXPECT_FALSE(content_of(Dict{{"text", ""}}).is_speech);
  EXPECT_FALSE(content_of(Dict{{"name", "salt"}}).is_speech);
  EXPECT_EQ(content_of(Dict{{"outcome", "ABORTED"}}).outcome, ActionOutcome::kFailure);
  EXPECT_EQ(content_of(Dict{{"success", false}}).outcome, ActionOutcome::kFailure);
  EXPECT_EQ(content_of(Dict{{"status", "preempted"}}).outcome, ActionOutcome::kStop);
  EXPECT_EQ(content_of(Dict{{"status", "ok"}}).outcome, ActionOutcome::kUnknown);
  EXPECT_EQ(content_of(Dict{{"outcome", 2}}).outcome, ActionOutcome::kUnknown);
}

TEST(MomentContent, ElementsWithoutTextsTellNoFactsAndNoLinks) {
  const auto seen = [](size_t count) {
    List things;
    for (size_t i = 0; i < count; ++i) things.push_back(Dict{{"x", static_cast<double>(i)}});
    return content_of(Dict{{"things", things}});
  };
  EXPECT_EQ(seen(3).facts, seen(5).facts);
  EXPECT_EQ(seen(3).links, 0u);
  EXPECT_EQ(seen(5).links, 0u);
}

TEST(MomentContent, WordsCountWhereverTheyAre) {
  EXPECT_TRUE(content_of(Dict{{"said", List{Dict{{"text", "Stop!"}}}}}).is_speech);
  EXPECT_FALSE(content_of(Dict{{"said", List{"left"}}}).is_speech);
  ContentReader reader({});
  reader.begin();
  reader.add(1.0);
  reader.add("Bring the salt.");  // The second instance.
  EXPECT_TRUE(reader.content().is_speech);
}

TEST(MomentContent, IntegersOfAnySizeAreNumbersAndTimesAreNot) {
  const auto numbers_in = [](const idf::Data& value) {
    return content_of(Dict{{"value", value}}).numbers;
  };
  const auto array = []<typename T>(std::vector<T> values) {
    const auto count = static_cast<int64_t>(values.size());
    return NdArray::take({count}, std::move(values));
  };
  EXPECT_EQ(numbers_in(array(std::vector<int64_t>{-4, 7})), (std::vector<double>{-4, 7}));
  EXPECT_EQ(numbers_in(array(std::vector<uint16_t>{4, 65535})), (std::vector<double>{4, 65535}));
  EXPECT_TRUE(numbers_in(array(std::vector<int64_t>{4, 1'600'000'000'000'000'000})).empty());
  EXPECT_TRUE(numbers_in(std::numeric_limits<int64_t>::min()).empty());
}

TEST(MomentContent, HostileDepthAndSizeEnd) {
  idf::Data deep = 1.0;
  for (int i = 0; i < 500; ++i) deep = Dict{{"in", deep}};
  EXPECT_TRUE(content_of(deep).numbers.empty());
  // What stands beside it is read all the same.
  EXPECT_EQ(content_of(Dict{{"deep", deep}, {"x", Dict{{"y", 2.0}}}}).numbers,
            std::vector<double>{2});
  Dict wide;
  for (int i = 0; i < 5000; ++i) wide.append_unique(std::to_string(i), 0.5);
  EXPECT_EQ(content_of(wide).numbers.size(), ContentReader::kMaxNumbers);
}

}  // namespace
}  // namespace engram::ltm
