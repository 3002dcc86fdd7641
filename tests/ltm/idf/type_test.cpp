// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type.h"

#include "ltm/idf/binary.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/print_values.h"
#include "tests/ltm/random_types.h"

namespace engram::idf {

namespace {

Type cup() {
  const Type thing = Type::object("kitchen::Thing", {{"name", Type::string(), "what people say"}});
  return Type::object("kitchen::Cup",
                      {{"pose", Type::pose()},
                       {"height", Type::float32({.unit = "m", .minimum = 0, .maximum = 1})},
                       {"state", Type::int_enum("kitchen::State", {{"FULL", 1}, {"EMPTY", 0}})},
                       {"picture", Type::image(PixelType::kRgb24).optional()}},
                      thing);
}

TEST(Type, PrintsOnOneLine) {
  EXPECT_EQ(to_string(cup()),
            "kitchen::Cup extends kitchen::Thing{name: String}{pose: Pose<float32>, "
            "height: Float[m, 0..1], state: IntEnum kitchen::State{FULL = 1, EMPTY = 0}, "
            "picture: optional Image<rgb24>}");
  EXPECT_EQ(to_string(Type::ndarray(ElementType::kUInt8, {3, kFreeSize})),
            "NDArray<uint8, [3, *]>");
  EXPECT_EQ(to_string(Type::matrix(4, kFreeSize)), "Matrix<float32, 4x*>");
  EXPECT_EQ(to_string(Type::image(PixelType::kDepth16, 480, 640)), "Image<depth16, 480x640>");
  EXPECT_EQ(to_string(Type::point_cloud(PointType::kXyzRgb)), "PointCloud<XYZRGB>");
  EXPECT_EQ(to_string(Type::list(Type::pair(Type::time(), Type::dict(Type::int64())), 3)),
            "List<Pair<Time, Dict<Long>>, 3>");
  EXPECT_EQ(to_string(Type::tuple({Type::float64({.minimum = -1}), Type::quaternion()})),
            "Tuple<Double[-1..], Quaternion<float32>>");
}

TEST(Type, PrintsOnLinesWithItsDocumentation) {
  EXPECT_EQ(to_string(cup().get<types::Object>().base.value(), TypeText::kLines),
            "kitchen::Thing {\n  name: String  # what people say\n}");
  EXPECT_THAT(to_string(cup(), TypeText::kLines),
              ::testing::HasSubstr("  state: IntEnum kitchen::State {\n    FULL = 1\n"));
}

TEST(Type, HasTheMembersOfItsBaseFirst) {
  const Type type = cup();
  const auto& object = type.get<types::Object>();
  ASSERT_EQ(object.members.size(), 5u);
  EXPECT_EQ(object.members[0].name, "name");
  EXPECT_EQ(object.own_members.size(), 4u);
  ASSERT_NE(object.find("height"), nullptr);
  EXPECT_EQ(object.find("height")->type.quantity()->unit, "m");
  EXPECT_EQ(object.find("nothing"), nullptr);
}

TEST(Type, SaysWhichArrayItIs) {
  EXPECT_EQ(Type::image(PixelType::kDepth32, 2, 3).as_array(),
            (ArrayType{ElementType::kFloat32, {2, 3, 1}}));
  EXPECT_EQ(Type::point_cloud(PointType::kXyzi).as_array(),
            (ArrayType{ElementType::kFloat32, {kFreeSize, 4}}));
  EXPECT_FALSE(Type::pose().as_array().has_value());
  EXPECT_FALSE(Type::point_cloud(PointType::kXyz).as_array()->is_fixed());
}

TEST(Type, EveryNameIsReadBack) {
  for (uint8_t i = 0; i < 4; ++i)
    EXPECT_EQ(pixel_type_from_name(to_string(static_cast<PixelType>(i))),
              static_cast<PixelType>(i));
  for (uint8_t i = 0; i < 8; ++i)
    EXPECT_EQ(point_type_from_name(to_string(static_cast<PointType>(i))),
              static_cast<PointType>(i));
  EXPECT_FALSE(pixel_type_from_name("rgb").has_value());
  EXPECT_FALSE(point_type_from_name("").has_value());
}

TEST(Type, RefusesWhatNoValueCanBe) {
  const auto fails = [](TypeValue value, const char* part) {
    EXPECT_FAILS(Type::create(std::move(value)), StatusCode::kInvalidArgument, part);
  };
  fails(types::Int{{.minimum = 0.2, .maximum = 0.8}}, "no int32");
  fails(types::Int{{.minimum = 1e12}}, "no int32");
  fails(types::Float{{.minimum = 2, .maximum = 1}}, "no float32");
  fails(types::Float{{.minimum = 0.1, .maximum = 0.1}}, "no float32");
  fails(types::Double{{.minimum = NAN}}, "not finite");
  fails(types::NdArray{ElementType::kUInt8, {3}, {.maximum = -1}}, "no uint8");
  fails(types::NdArray{ElementType::kUInt8, {-2}}, "size -2");
  fails(types::NdArray{ElementType::kUInt8, Shape(17, 1)}, "17 axes");
  fails(types::NdArray{ElementType::kUInt8, {int64_t{1} << 62, 8}}, "bytes");
  fails(types::Pose{ElementType::kInt8}, "int8");
  fails(types::IntEnum{"E", {}}, "no value");
  fails(types::IntEnum{"E", {{"A", 1}, {"B", 1}}}, "two names");
  fails(types::IntEnum{"E", {{"A", 1}, {"A", 2}}}, "'A' is there twice");
  fails(types::List{Type::string(), -7}, "size -7");
  fails(types::List{Type::string(), 1 << 24}, "nodes");
  fails(types::Object{"O", {{"a", Type::time()}, {"a", Type::time()}}, std::nullopt, {}}, "twice");
  fails(types::Object{"O", {{"name", Type::time()}}, cup().get<types::Object>().base, {}}, "'O'");
  fails(types::Object{"O", {}, Type::time(), {}}, "extends Time");
}

TEST(Type, RefusesToNestOrMultiplyWithoutEnd) {
  Type deep = Type::boolean();
  for (int i = 1; i < kMaxTypeDepth; ++i) deep = Type::list(deep);
  EXPECT_EQ(deep.depth(), kMaxTypeDepth);
  EXPECT_FAILS(Type::create(types::List{deep}), StatusCode::kInvalidArgument, "65 levels");
  Type wide = Type::boolean();
  for (int i = 0; i < 19; ++i) wide = Type::pair(wide, wide);
  EXPECT_FAILS(Type::create(types::Pair{wide, wide}), StatusCode::kInvalidArgument, "nodes");
}

TEST(Type, IsEqualWhereEverythingIs) {
  EXPECT_EQ(cup(), cup());
  EXPECT_NE(cup(), cup().optional());
  EXPECT_EQ(cup(), cup().optional().required());
  EXPECT_NE(cup(), cup().with_doc("a cup"));
  EXPECT_NE(Type::int32(), Type::int32({.unit = "m"}));
  EXPECT_NE(Type::int32(), Type::int64());
}

TEST(Type, IsAValueItself) {
  RandomTypes random(1);
  for (int i = 0; i < 3000; ++i) {
    const Type type = random.type(4);
    const auto bytes = encode(to_data(type));
    ASSERT_OK(bytes);
    const auto data = decode(Buffer::take(*bytes));
    ASSERT_OK(data);
    const auto read = type_from_data(*data);
    ASSERT_OK(read);
    EXPECT_EQ(*read, type);
  }
}

TEST(Type, IsStoredOnceHoweverOftenItIsUsed) {
  std::vector<Member> members;
  for (int i = 0; i < 50; ++i) members.push_back({std::to_string(i), cup()});
  const Data data = to_data(Type::object("Many", std::move(members)));
  EXPECT_EQ(data.at("types")->get<List>().size(),
            to_data(cup()).at("types")->get<List>().size() + 1);
}

TEST(Type, RefusesToReadWhatIsNone) {
  const auto table = [](List entries) {
    return Data(Dict{{"idf_type", 1}, {"types", std::move(entries)}});
  };
  const auto fails = [](const Data& data, const char* part) {
    EXPECT_FAILS(type_from_data(data), StatusCode::kDataLoss, part);
  };
  fails(5, "int32");
  fails(Dict{{"idf_type", 2}, {"types", List{}}}, "version");
  fails(table({}), "empty");
  fails(table({7}), "entry 0");
  fails(table({Dict{{"kind", "Apple"}}}), "'Apple'");
  fails(table({Dict{{"kind", "List"}, {"element", 0}, {"size", int64_t{-1}}}}), "entry before");
  fails(table({Dict{{"kind", "List"}, {"element", -1}, {"size", int64_t{-1}}}}), "entry before");
  fails(table({Dict{{"kind", "Quaternion"}, {"element", "float8"}}}), "'float8'");
  fails(table({Dict{{"kind", "NDArray"}, {"element", "int8"}, {"shape", List{"a"}}}}), "size");
  fails(table({Dict{{"kind", "Int"}, {"unit", 5}}}), "'unit'");
  fails(table({Dict{{"kind", "Object"}, {"name", "A"}, {"members", List{5}}}}), "list of dicts");
  fails(table({Dict{{"kind", "Bool"}, {"optional", "yes"}}}), "'optional'");
}

TEST(Type, TableThatMultipliesItselfIsRefused) {
  List entries{Dict{{"kind", "Bool"}}};
  for (int i = 0; i < 40; ++i)
    entries.emplace_back(Dict{{"kind", "Pair"}, {"first", i}, {"second", i}});
  EXPECT_FAILS(type_from_data(Dict{{"idf_type", 1}, {"types", entries}}), StatusCode::kDataLoss,
               "nodes");
}

/// `data` with something changed somewhere.
Data damaged(const Data& data, RandomValues& random) {
  if (random.below(12) == 0) return random.value(2);
  if (const List* list = data.get_if<List>()) {
    List made;
    for (const Data& element : *list) made.push_back(damaged(element, random));
    return made;
  }
  const Dict* dict = data.get_if<Dict>();
  if (dict == nullptr) return data;
  Dict made;
  for (const auto& [key, value] : *dict)
    if (random.below(20) != 0) made.set(key, damaged(value, random));
  return made;
}

TEST(Type, SurvivesDamagedTables) {
  RandomTypes random(2);
  int read = 0;
  for (int i = 0; i < 5000; ++i)
    if (type_from_data(damaged(to_data(random.type(4)), random.values())).ok()) ++read;
  EXPECT_GT(read, 0);
}

TEST(Type, OfAValueIsWhatItShows) {
  const auto type = type_of(Dict{{"x", 1},
                                 {"l", List{1.0, 2.0}},
                                 {"t", List{1.0, "a"}},
                                 {"n", None{}},
                                 {"e", List{}},
                                 {"v", NdArray::take<float>({2}, {1, 2})}});
  ASSERT_OK(type);
  EXPECT_EQ(to_string(*type),
            "Object{x: Int, l: List<Double>, t: Tuple<Double, String>, n: optional String, "
            "e: Tuple<>, v: NDArray<float32, [2]>}");
  EXPECT_FAILS(type_of(nested_lists(80)), StatusCode::kInvalidArgument, "64 levels");
}

}  // namespace
}  // namespace engram::idf
