// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/similarity_filter.h"

#include <cmath>

#include "tests/ltm/filter/candidates.h"

namespace engram::ltm {
namespace {

idf::NdArray image(uint8_t grey, int64_t side = 32) {
  return idf::NdArray::take<uint8_t>({side, side, 1},
                                     std::vector<uint8_t>(static_cast<size_t>(side * side), grey));
}

NamePattern pattern(std::string_view text) {
  return *NamePattern::parse(text);
}

TEST(SimilarityFilter, KeepsWhatDiffersFromTheLastKeptNotFromTheLastOffered) {
  auto filter = *SimilarityFilter::create({.numbers = {Measure::kMaxAbs, 0.25}, .max_gap = {}});
  FilterRun run(filter);
  for (int i = 0; i < 10; ++i) run.offer(candidate(i, idf::Dict{{"x", 0.125 * i}}));
  EXPECT_EQ(run.kept(), (std::vector<double>{0, 3, 6, 9}));
  EXPECT_EQ(run.dropped("similar"), 6u);
}

TEST(SimilarityFilter, KeepsOneAfterTheLongestGap) {
  auto filter = *SimilarityFilter::create({.max_gap = std::chrono::seconds(3)});
  FilterRun run(filter);
  for (int i = 0; i < 8; ++i) run.offer(candidate(i, 1.0));
  EXPECT_EQ(run.kept(), (std::vector<double>{0, 3, 6}));
}

TEST(SimilarityFilter, ComparesImagesByTheirMeasure) {
  for (const auto& [measure, bound] : std::vector<std::pair<Measure, double>>{
           {Measure::kMse, 30}, {Measure::kMae, 5.5}, {Measure::kSsim, 0.99}}) {
    auto filter = *SimilarityFilter::create({.images = {measure, bound}});
    FilterRun run(filter);
    EXPECT_TRUE(run.keeps(candidate(0, idf::Dict{{"image", image(100)}})));
    EXPECT_FALSE(run.keeps(candidate(1, idf::Dict{{"image", image(105)}}))) << to_string(measure);
    EXPECT_TRUE(run.keeps(candidate(2, idf::Dict{{"image", image(140)}}))) << to_string(measure);
  }
}

TEST(SimilarityFilter, SeesOneImageOfManyThatChanged) {
  auto filter = *SimilarityFilter::create({.images = {Measure::kMse, 1}});
  FilterRun run(filter);
  EXPECT_TRUE(run.keeps(candidate(0, idf::Dict{{"l", image(1)}, {"r", image(1)}})));
  EXPECT_TRUE(run.keeps(candidate(1, idf::Dict{{"l", image(1)}, {"r", image(9)}})));
  EXPECT_FALSE(run.keeps(candidate(2, idf::Dict{{"l", image(1)}, {"r", image(9)}})));
}

TEST(SimilarityFilter, MeasuresTheNumbersOfOneRuleAsOneVector) {
  // RMS over four numbers, of which one moved by 2, is 1.
  for (const double bound : {0.99, 1.01}) {
    auto filter = *SimilarityFilter::create({.numbers = {Measure::kRms, bound}});
    FilterRun run(filter);
    const auto value = [](double x) {
      return idf::Dict{{"a", 1.0}, {"b", x}, {"c", idf::NdArray::take<double>({2}, {0, 0})}};
    };
    EXPECT_TRUE(run.keeps(candidate(0, value(0))));
    EXPECT_EQ(run.keeps(candidate(1, value(2))), bound < 1);
  }
}

TEST(SimilarityFilter, GoesByTheFirstRuleThatMatchesAMember) {
  auto filter =
      *SimilarityFilter::create({.members = {{pattern("clock"), {Measure::kIgnore}},
                                             {pattern("joints/.*"), {Measure::kMaxAbs, 1}},
                                             {pattern(".*"), {Measure::kEqual}}}});
  FilterRun run(filter);
  const auto value = [](int64_t clock, double joint, double other) {
    return idf::Dict{{"clock", clock}, {"joints", idf::Dict{{"arm", joint}}}, {"other", other}};
  };
  EXPECT_TRUE(run.keeps(candidate(0, value(0, 0, 0))));
  EXPECT_FALSE(run.keeps(candidate(1, value(99, 0.9, 0))));
  EXPECT_TRUE(run.keeps(candidate(2, value(0, 1.1, 0))));
  EXPECT_TRUE(run.keeps(candidate(3, value(0, 1.1, 1e-9))));
}

TEST(SimilarityFilter, ComparesTextsAndListsUnlessTold) {
  for (const bool compares : {true, false}) {
    auto filter = *SimilarityFilter::create({.compares_remainder = compares});
    FilterRun run(filter);
    EXPECT_TRUE(run.keeps(candidate(0, idf::Dict{{"label", "cup"}})));
    EXPECT_EQ(run.keeps(candidate(1, idf::Dict{{"label", "plate"}})), compares);
  }
}

TEST(SimilarityFilter, KeepsAnotherLayout) {
  auto filter = *SimilarityFilter::create({.numbers = {Measure::kMaxAbs, 100}});
  FilterRun run(filter);
  const std::vector<idf::Data> layouts{idf::Dict{{"x", 1.0}},
                                       idf::Dict{{"y", 1.0}},
                                       idf::Dict{{"y", 1.0f}},
                                       idf::Dict{{"y", 1.0f}, {"z", 1.0}},
                                       1.0,
                                       idf::List{1.0},
                                       idf::NdArray::take<double>({2}, {1, 2}),
                                       idf::NdArray::take<double>({1, 2}, {1, 2})};
  double second = 0;
  for (const idf::Data& value : layouts) {
    EXPECT_TRUE(run.keeps(candidate(++second, value))) << second;
    EXPECT_FALSE(run.keeps(candidate(second + 0.5, value))) << second;
  }
}

TEST(SimilarityFilter, ComparesRotationsByAngleWhereATypeTellsOfThem) {
  const auto rotation = [](double angle) {
    return idf::Data(
        idf::NdArray::take<double>({4}, {-std::cos(angle / 2), 0, 0, -std::sin(angle / 2)}));
  };
  const auto identity = idf::Data(idf::NdArray::take<double>({4}, {1, 0, 0, 0}));
  for (const bool is_typed : {true, false}) {
    auto filter = *SimilarityFilter::create({.orientations = {Measure::kAngle, 0.1}});
    FilterRun run(filter);
    const auto typed = [&](double second, const idf::Data& value) {
      Candidate made = candidate(second, value);
      if (is_typed) made.type = idf::Type::orientation(idf::ElementType::kFloat64);
      return made;
    };
    EXPECT_TRUE(run.keeps(typed(0, identity)));
    EXPECT_EQ(run.keeps(typed(1, rotation(0.09))), !is_typed) << "the same but for its sign";
    EXPECT_TRUE(run.keeps(typed(2, rotation(0.25))));
  }
}

TEST(SimilarityFilter, ComparesImagesWhoseTypeLeavesTheirSizeFree) {
  auto filter = *SimilarityFilter::create({.images = {Measure::kMse, 30}});
  FilterRun run(filter);
  const auto typed = [](double second, uint8_t grey, int64_t side) {
    Candidate made = candidate(second, idf::Dict{{"image", image(grey, side)}});
    made.type = idf::Type::object("View", {{"image", idf::Type::image(idf::PixelType::kMono8)}});
    return made;
  };
  EXPECT_TRUE(run.keeps(typed(0, 100, 32)));
  EXPECT_FALSE(run.keeps(typed(1, 105, 32)));
  EXPECT_TRUE(run.keeps(typed(2, 140, 32)));
  EXPECT_TRUE(run.keeps(typed(3, 140, 40))) << "another size is another layout";
}

TEST(SimilarityFilter, LooksAnewWhereATypeWasDeclared) {
  auto filter = *SimilarityFilter::create({});
  FilterRun run(filter);
  EXPECT_TRUE(run.keeps(candidate(0, 1.0)));
  Candidate typed = candidate(1, 1.0);
  typed.type = idf::Type::float64();
  EXPECT_TRUE(run.keeps(typed));
  typed.snapshot.time += Duration(1);
  EXPECT_FALSE(run.keeps(typed));
}

TEST(SimilarityFilter, RefusesOptionsThatAreWrong) {
  EXPECT_FAILS(SimilarityFilter::create({.images = {Measure::kSsim, 2}}),
               StatusCode::kInvalidArgument, "'ssim'");
  EXPECT_FAILS(SimilarityFilter::create({.members = {{pattern("a/b"), {Measure::kMse, -1}}}}),
               StatusCode::kInvalidArgument, "member 'a\\/b'");
  EXPECT_FAILS(SimilarityFilter::create({.max_gap = Duration(-1)}), StatusCode::kInvalidArgument,
               "max_gap");
}

}  // namespace
}  // namespace engram::ltm
