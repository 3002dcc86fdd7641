// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/written_as.h"

#include "ltm/idf/cast.h"
#include "tests/ltm/expect_status.h"

namespace engram::memory {
namespace {

using idf::Data;
using idf::Dict;
using idf::List;
using idf::NdArray;
using idf::Type;

List numbers(std::initializer_list<double> values) {
  List list;
  for (const double value : values) list.push_back(value);
  return list;
}

TEST(WrittenAs, MakesArraysOfListsWhereTheTypeHasThem) {
  const Data written = List{List{int64_t{1}, int64_t{2}}, List{int64_t{3}, int64_t{4}}};
  EXPECT_EQ(written_as(Type::matrix(2, 2), written),
            Data(NdArray::take<int64_t>({2, 2}, {1, 2, 3, 4})));
  EXPECT_EQ(written_as(Type::list(Type::list(Type::int64())), written), written);
  EXPECT_EQ(written_as(Type::ndarray_of_rank(idf::ElementType::kFloat32, 1), List{int64_t{1}, 0.5}),
            Data(NdArray::take<double>({2}, {1, 0.5})));
}

TEST(WrittenAs, MakesPosesThatFit) {
  const Data written = Dict{
      {"pose", Dict{{"position", numbers({1, 2, 3})}, {"orientation", numbers({1, 0, 0, 0})}}}};
  const Type type = Type::object("Cup", {{"pose", Type::pose()}});
  EXPECT_TRUE(idf::cast(written_as(type, written), type).is_complete());
}

TEST(WrittenAs, LeavesListsThatAreNoArrays) {
  const Type type = Type::matrix(2, 2);
  for (const Data& written :
       {Data(List{List{1.0, 2.0}, List{3.0}}), Data(List{1.0, List{2.0}}), Data(List{"1", "2"}),
        Data(List{List{1.0}, 2.0}), Data(List{true, false}), Data("1"), Data(1.0),
        Data(List{List{}, List{1.0}}), Data(List{idf::None{}})})
    EXPECT_EQ(written_as(type, written), written);
}

TEST(WrittenAs, ReadsNamesOfEnumsAndTimes) {
  const Type type =
      Type::object("State", {{"mood", Type::int_enum("Mood", {{"happy", 0}, {"sad", 7}})},
                             {"since", Type::time()},
                             {"all", Type::dict(Type::time())},
                             {"two", Type::tuple({Type::time(), Type::string()})}});
  const std::string time = "1970-01-01 00:00:01.000000";
  const Data written = written_as(type, Dict{{"mood", "sad"},
                                             {"since", time},
                                             {"all", Dict{{"a", time}, {"b", "no time"}}},
                                             {"two", List{time, time, time}},
                                             {"unknown", time}});
  constexpr int64_t kSecond = 1'000'000'000;
  EXPECT_EQ(written, Data(Dict{{"mood", int32_t{7}},
                               {"since", kSecond},
                               {"all", Dict{{"a", kSecond}, {"b", "no time"}}},
                               {"two", List{kSecond, time, time}},
                               {"unknown", time}}));
  EXPECT_EQ(written_as(type, Dict{{"mood", "angry"}}), Data(Dict{{"mood", "angry"}}));
  EXPECT_EQ(written_as(type, "no object"), Data("no object"));
}

}  // namespace
}  // namespace engram::memory
