// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/cast.h"

#include <cmath>

#include "ltm/idf/extends.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/print_values.h"
#include "tests/ltm/random_types.h"

namespace engram::idf {
namespace {

TEST(Cast, KeepsWhatIsOfTheType) {
  RandomTypes random(5);
  for (int i = 0; i < 5000; ++i) {
    const Type type = random.type(4);
    const Data value = random.value_of(type);
    const CastResult result = cast(value, type);
    EXPECT_TRUE(result.is_complete()) << text_of(result.notes);
    EXPECT_EQ(result.value, value) << to_string(type);
  }
}

TEST(Cast, KeepsEveryValueAsTheTypeItShows) {
  RandomValues random(6);
  for (int i = 0; i < 5000; ++i) {
    const Data value = random.value(5);
    const auto type = type_of(value);
    ASSERT_OK(type);
    const CastResult result = cast(value, *type);
    EXPECT_TRUE(result.is_complete()) << text_of(result.notes);
    EXPECT_EQ(result.value, value);
  }
}

/// The value with parts replaced, dropped or added: mostly of its type.
Data disturbed(const Data& data, RandomValues& random) {
  if (random.below(10) == 0) return random.value(2);
  if (const List* list = data.get_if<List>()) {
    List made;
    for (const Data& element : *list) made.push_back(disturbed(element, random));
    if (random.below(5) == 0) made.push_back(random.value(1));
    return made;
  }
  const Dict* dict = data.get_if<Dict>();
  if (dict == nullptr) return data;
  Dict made;
  for (const auto& [key, value] : *dict)
    if (random.below(10) != 0) made.set(key, disturbed(value, random));
  if (random.below(5) == 0) made.set(random.key(), random.value(1));
  return made;
}

TEST(Cast, GivesAValueOfTheTypeWhateverItIsGiven) {
  RandomTypes random(7);
  for (int i = 0; i < 10000; ++i) {
    const Type type = random.type(4);
    const Data value = random.chance(4) ? random.values().value(4)
                                        : disturbed(random.value_of(type), random.values());
    const CastResult once = cast(value, type);
    const auto mismatches = check(once.value, type);
    ASSERT_TRUE(mismatches.empty()) << to_string(type) << "\n" << text_of(mismatches);
    const CastResult twice = cast(once.value, type);
    EXPECT_EQ(twice.value, once.value);
    EXPECT_TRUE(twice.is_complete()) << to_string(type) << "\n" << text_of(twice.notes);
    EXPECT_TRUE(once.is_complete() || !check(value, type).empty()) << text_of(once.notes);
  }
}

TEST(Cast, DefaultsAreOfTheirType) {
  RandomTypes random(8);
  for (int i = 0; i < 5000; ++i) {
    const Type type = random.type(4);
    EXPECT_TRUE(check(default_value(type), type).empty()) << to_string(type);
  }
  EXPECT_EQ(default_value(Type::int32({.minimum = 2.5})), Data(3));
  EXPECT_EQ(default_value(Type::int64({.maximum = -0.5})), Data(int64_t{-1}));
  EXPECT_EQ(default_value(Type::float32({.minimum = 0.1})), Data(0.1f));
  EXPECT_EQ(default_value(Type::float32({.maximum = -0.1})), Data(-0.1f));
  EXPECT_EQ(default_value(Type::orientation()), Data(NdArray::take<float>({4}, {1, 0, 0, 0})));
  EXPECT_EQ(default_value(Type::pose().optional()), Data(None{}));
}

TEST(Cast, WidensSilently) {
  RandomValues random(9);
  for (int i = 0; i < 5000; ++i) {
    const auto whole = static_cast<int32_t>(random.bits());
    const auto real = std::bit_cast<float>(static_cast<uint32_t>(random.bits()));
    EXPECT_TRUE(cast(whole, Type::int64()).is_complete());
    EXPECT_TRUE(cast(whole, Type::float64()).is_complete());
    EXPECT_TRUE(cast(real, Type::float64()).is_complete());
    EXPECT_EQ(cast(whole, Type::float64()).value, Data(static_cast<double>(whole)));
  }
  const auto bytes = NdArray::take<uint8_t>({2}, {0, 255});
  for (const auto element : {ElementType::kInt16, ElementType::kUInt64, ElementType::kFloat32})
    EXPECT_TRUE(cast(bytes, Type::ndarray(element, {2})).is_complete());
}

TEST(Cast, NarrowsSilentlyWhatStaysTheSame) {
  EXPECT_EQ(cast(int64_t{7}, Type::int32()).value, Data(7));
  EXPECT_EQ(cast(0.5, Type::float32()).value, Data(0.5f));
  EXPECT_EQ(cast(-3.0, Type::int32()).value, Data(-3));
  for (const Data& value : {Data(int64_t{7}), Data(7.0), Data(7.0f)})
    EXPECT_TRUE(cast(value, Type::int32()).is_complete());
  EXPECT_TRUE(cast(double{NAN}, Type::float32()).is_complete());
}

TEST(Cast, NotesWhatItRounds) {
  const CastResult result = cast(Dict{{"x", 0.1}}, Type::dict(Type::float32()));
  EXPECT_EQ(*result.value.at("x"), Data(0.1f));
  EXPECT_EQ(text_of(result.notes), "narrowed: 'x': found float64 0.1, needs float32\n");
  const int64_t large = (int64_t{1} << 53) + 1;
  EXPECT_EQ(cast(large, Type::float64()).notes[0].kind, CastNote::Kind::kNarrowed);
  EXPECT_EQ(cast(INT64_MAX, Type::float64()).notes[0].kind, CastNote::Kind::kNarrowed);
  const CastResult array = cast(NdArray::take<double>({2}, {0.5, 0.1}),
                                Type::ndarray(ElementType::kFloat32, {kFreeSize}));
  EXPECT_EQ(array.value, Data(NdArray::take<float>({2}, {0.5f, 0.1f})));
  EXPECT_EQ(array.notes.size(), 1u);
}

TEST(Cast, LeavesNumbersThatHaveNoPlace) {
  const auto is_default = [](const Data& value, const Type& type) {
    const CastResult result = cast(value, type);
    EXPECT_EQ(result.value, default_value(type));
    ASSERT_EQ(result.notes.size(), 1u);
    EXPECT_EQ(result.notes[0].kind, CastNote::Kind::kMismatch);
  };
  is_default(int64_t{1} << 40, Type::int32());
  is_default(1e300, Type::float32());
  is_default(9.3e18, Type::int64());
  is_default(0.5, Type::int32());
  is_default(double{NAN}, Type::int32());
  is_default(true, Type::int32());
  is_default(1, Type::boolean());
  is_default("1", Type::int32());
  is_default(7, Type::int32({.maximum = 5}));
  is_default(0.1, Type::float32({.maximum = 0.1}));
  is_default(NdArray::take<int16_t>({2}, {1, -1}), Type::ndarray(ElementType::kUInt8, {2}));
  is_default(NdArray::take<float>({3}, {1, 2, 3}), Type::ndarray(ElementType::kFloat32, {2}));
}

TEST(Cast, TakesTheMembersThatFit) {
  const Type type = Type::object("O", {{"a", Type::int64()},
                                       {"b", Type::string()},
                                       {"c", Type::float64({.minimum = 1})},
                                       {"d", Type::string().optional()}});
  const CastResult result = cast(Dict{{"b", 5}, {"new", 1}, {"a", 2}}, type);
  EXPECT_EQ(result.value, Data(Dict{{"a", int64_t{2}}, {"b", ""}, {"c", 1.0}, {"d", None{}}}));
  EXPECT_EQ(text_of(result.notes),
            "mismatch: 'b': found int32 5, needs string\n"
            "missing: 'c': found nothing, needs float64\n"
            "dropped: 'new': found int32 1, needs no such member in dict (Object O)\n");
}

TEST(Cast, FillsAndCutsListsOfFixedSize) {
  const CastResult result = cast(List{1, 2, 3}, Type::pair(Type::int32(), Type::int32()));
  EXPECT_EQ(result.value, Data(List{1, 2}));
  EXPECT_EQ(result.notes[0].kind, CastNote::Kind::kUnknown);
  const CastResult filled = cast(List{1}, Type::list(Type::int32(), 2));
  EXPECT_EQ(filled.value, Data(List{1, 0}));
  EXPECT_EQ(filled.notes[0].what.path, "1");
}

TEST(Cast, SharesArraysInsteadOfCopyingThem) {
  const auto image = NdArray::take<uint8_t>({8, 8, 3}, std::vector<uint8_t>(192));
  const CastResult result = cast(image, Type::image(PixelType::kRgb24));
  EXPECT_EQ(result.value.get<NdArray>().bytes().data(), image.bytes().data());
}

TEST(Cast, ManyDefaultsShareTheirArrays) {
  const Type type = Type::list(Type::image(PixelType::kRgb24, 1000, 1000));
  const CastResult result = cast(List(10000, None{}), type);
  const auto& list = result.value.get<List>();
  EXPECT_EQ(list.front().get<NdArray>().bytes().data(), list.back().get<NdArray>().bytes().data());
}

}  // namespace
}  // namespace engram::idf
