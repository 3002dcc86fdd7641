// SPDX-License-Identifier: Apache-2.0
// Code generated from tests/golden/idf/kitchen.xml, as a program uses it.
#include <gtest/gtest.h>

#include "ltm/idf/binary.h"
#include "ltm/idf/cast.h"
#include "ltm/idf/type_check.h"
#include "ltm/idf/type_xml.h"
#include "tests/ltm/typed/kitchen_values.h"

namespace engram::typed {
namespace {

idf::TypeFile kitchen_file() {
  auto file = idf::read_type_file(ENGRAM_SOURCE_DIR "/tests/golden/idf/kitchen.xml");
  EXPECT_TRUE(file.ok()) << file.status().message();
  return std::move(file).value();
}

TEST(Generated, HasTheTypesThatTheXmlSays) {
  const idf::TypeFile file = kitchen_file();
  for (const idf::Type* type :
       {&kitchen::Scene::idf_type(), &kitchen::Cup::idf_type(), &kitchen::Thing::idf_type(),
        &kitchen::Numbers::idf_type(), &kitchen::Arrays::idf_type(), &kitchen::Sensors::idf_type(),
        &kitchen::Containers::idf_type(), &odd::Words::idf_type(), &odd::Nothing::idf_type(),
        &kitchen::idf_type(kitchen::Fill{}), &kitchen::idf_type(kitchen::Material{})}) {
    const idf::Type* read = file.find(type->name());
    ASSERT_NE(read, nullptr) << type->name();
    EXPECT_TRUE(*read == *type) << idf::to_string(*read, idf::TypeText::kLines) << "\n"
                                << idf::to_string(*type, idf::TypeText::kLines);
  }
  EXPECT_EQ(file.types.size() + file.included_types.size(), 11u);
}

TEST(Generated, StartsAsTheDefaultOfItsType) {
  const idf::Data expected = idf::default_value(kitchen::Scene::idf_type());
  const idf::Data data = kitchen::Scene().to_idf();
  for (const idf::DictEntry& entry : expected.get<idf::Dict>())
    EXPECT_TRUE(*data.get<idf::Dict>().find(entry.key) == entry.value) << entry.key;
  EXPECT_TRUE(data == expected);
}

TEST(Generated, TellsApartObjectsThatDifferInOneMember) {
  const kitchen::Scene scene = filled_scene();
  kitchen::Scene other = scene;
  EXPECT_TRUE(scene == other);
  other.cups[1].mass = 0.5f;
  EXPECT_FALSE(scene == other);
  other = scene;
  other.sensors.rgb = other.sensors.rgb.clone();
  EXPECT_TRUE(scene == other);
  other.sensors.rgb.at<cv::Vec3b>(1, 2)[0] ^= 1;
  EXPECT_FALSE(scene == other);
}

TEST(Generated, ReadsMembersInAnyOrder) {
  const kitchen::Cup cup = filled_scene().cup;
  const idf::Data data = cup.to_idf();
  idf::Dict turned;
  const auto& dict = data.get<idf::Dict>();
  for (auto entry = dict.end(); entry != dict.begin();)
    turned.set((entry - 1)->key, (entry - 1)->value), --entry;
  const auto read = kitchen::Cup::from_idf(turned);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_TRUE(*read == cup);
}

TEST(Generated, CoreObjectReadsWhatAProviderExtended) {
  const kitchen::Cup cup = filled_scene().cup;
  const auto thing = kitchen::Thing::from_idf(cup.to_idf());
  ASSERT_TRUE(thing.ok()) << thing.status().message();
  EXPECT_TRUE(*thing == static_cast<const kitchen::Thing&>(cup));
}

TEST(Generated, WidensNumbersAndRefusesToRoundThem) {
  idf::Data data = kitchen::Numbers().to_idf();
  *data.at("a_long") = int32_t{5};
  *data.at("a_double") = 0.5f;
  *data.at("a_float") = 0.25;
  const auto read = kitchen::Numbers::from_idf(data);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->a_long, 5);
  EXPECT_EQ(read->a_double, 0.5);
  EXPECT_EQ(read->a_float, 0.25f);
  *data.at("a_float") = 0.1;
  *data.at("a_bool") = int32_t{1};
  const auto refused = kitchen::Numbers::from_idf(data);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.status().code(), StatusCode::kInvalidArgument);
  EXPECT_NE(refused.status().message().find("'a_float'"), std::string::npos);
  EXPECT_NE(refused.status().message().find("'a_bool'"), std::string::npos);
}

TEST(Generated, NamesWhatIsMissingAndWhatIsNoLink) {
  const auto missing = kitchen::Thing::from_idf(idf::Dict{{"name", "x"}});
  ASSERT_FALSE(missing.ok());
  EXPECT_NE(missing.status().message().find("'mass'"), std::string::npos);
  idf::Data data = kitchen::Cup().to_idf();
  *data.at("owner") = "a//b";
  const auto no_link = kitchen::Cup::from_idf(data);
  ASSERT_FALSE(no_link.ok());
  EXPECT_NE(no_link.status().message().find("'owner'"), std::string::npos);
}

TEST(Generated, RefusesNumbersThatNameNoEnumValue) {
  idf::Data data = kitchen::Cup().to_idf();
  *data.at("fill") = int32_t{2};
  EXPECT_FALSE(kitchen::Cup::from_idf(data).ok());
}

TEST(Generated, RefusesOtherShapesAndLengths) {
  const idf::Data good = filled_scene().to_idf();
  for (const char* path :
       {"arrays/int8_of_3", "arrays/matrix_3_4", "arrays/matrix_free_2", "arrays/matrix_20_20",
        "arrays/quaternion_f32", "arrays/pose_world_f64/position", "sensors/rgb_fixed",
        "sensors/depth_m", "sensors/cloud_rgb", "sensors/cloud_xyz"}) {
    idf::Data data = good;
    const auto& array = data.at(path)->get<idf::NdArray>();
    idf::Shape shape = array.shape();
    shape.push_back(2);
    idf::Data wrong = filled<float>(shape);
    *data.at(path) = wrong;
    const auto read = kitchen::Scene::from_idf(data);
    ASSERT_FALSE(read.ok()) << path;
    EXPECT_NE(read.status().message().find(path), std::string::npos) << read.status().message();
  }
  for (const char* path : {"containers/three_ints", "containers/hundred_floats", "containers/range",
                           "containers/mixed"}) {
    idf::Data data = good;
    data.at(path)->get_if<idf::List>()->pop_back();
    EXPECT_FALSE(kitchen::Scene::from_idf(data).ok()) << path;
  }
}

TEST(Generated, BoundsAreForCheckToFind) {
  kitchen::Cup cup;
  cup.height = 2.0f;
  const idf::Data data = cup.to_idf();
  EXPECT_TRUE(kitchen::Cup::from_idf(data).ok());
  EXPECT_EQ(idf::check(data, kitchen::Cup::idf_type()).size(), 1u);
}

TEST(Generated, SaysWhatEnumValuesAreCalled) {
  EXPECT_EQ(to_string(kitchen::Fill::class_), "class");
  EXPECT_EQ(to_string(static_cast<kitchen::Fill>(99)), "");
}

TEST(Generated, PixelsAndPointsLieWithinTheDecodedBytes) {
  const Buffer bytes = Buffer::take(idf::encode(filled_scene().to_idf()).value());
  const idf::Data data = idf::decode(bytes).value();
  const auto scene = kitchen::Scene::from_idf(data);
  ASSERT_TRUE(scene.ok()) << scene.status().message();
  const auto is_within = [&](const void* part) {
    const auto* at = static_cast<const std::byte*>(part);
    return at >= bytes.data() && at < bytes.data() + bytes.size();
  };
  EXPECT_TRUE(is_within(scene->sensors.rgb.data));
  EXPECT_TRUE(is_within(scene->sensors.depth_m.data));
  EXPECT_TRUE(is_within(scene->sensors.cloud_rgb.points().data()));
  EXPECT_TRUE(is_within(scene->arrays.uint8_volume.bytes().data()));
  const idf::Data again = scene->to_idf();
  EXPECT_TRUE(is_within(again.at("sensors/rgb")->get<idf::NdArray>().bytes().data()));
}

TEST(Generated, KeepsKeysThatAreReservedWords) {
  odd::Words words;
  words.class_ = 1;
  words.class__ = 2;
  words.to_idf_ = 3;
  words.Words_ = 4;
  const idf::Data data = words.to_idf();
  EXPECT_EQ(data.at("class")->get<int32_t>(), 1);
  EXPECT_EQ(data.at("class_")->get<int32_t>(), 2);
  EXPECT_EQ(data.at("to_idf")->get<int32_t>(), 3);
  EXPECT_EQ(data.at("Words")->get<int32_t>(), 4);
}

}  // namespace
}  // namespace engram::typed
