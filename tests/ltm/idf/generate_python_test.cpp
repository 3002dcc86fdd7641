// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_python.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace engram::idf {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string text_of(const TypeFile& file) {
  const auto made = generate_python(file);
  EXPECT_TRUE(made.ok()) << made.status().to_string();
  return made.ok() ? made->at(0).text : "";
}

/// What `definitions` inside <GenerateTypes> become.
std::string generated(const std::string& definitions) {
  const auto file = parse_type_xml(
      "<AronTypeDefinition><GenerateTypes>" + definitions + "</GenerateTypes></AronTypeDefinition>",
      "made/up-types.xml");
  EXPECT_TRUE(file.ok()) << file.status().to_string();
  return file.ok() ? text_of(*file) : "";
}

/// A file whose only object has one member.
TypeFile file_with(const std::string& key, const Type& type, const std::string& doc = "") {
  return {.name = "a.xml", .types = {Type::object("a::Thing", {{key, type, doc}})}};
}

std::string error_of(const TypeFile& file) {
  const auto made = generate_python(file);
  EXPECT_FALSE(made.ok());
  EXPECT_EQ(made.status().code(), StatusCode::kInvalidArgument);
  return made.status().message();
}

TEST(GeneratePython, WritesAClassAsAPersonWould) {
  EXPECT_EQ(generated(R"(<!-- A cup. -->
      <Object name="kitchen::Cup">
        <!-- Of the rim. -->
        <ObjectChild key="height"><Float unit="m" min="0" max="1" /></ObjectChild>
        <ObjectChild key="class"><Int optional="true" /></ObjectChild>
      </Object>)"),
            R"x(# Generated from up-types.xml by engram idf generate: change that file, not this.
"""The types of up-types.xml."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from engram import idf

__all__ = ["Cup"]


@dataclass(kw_only=True, eq=False)
class Cup(idf.TypedObject):
    """A cup."""

    _idf_attributes = {"class": "class_"}

    height: float = 0.0
    """Of the rim.
    Unit: m. Range: 0..1.
    """
    class_: int | None = None

    @staticmethod
    @cache
    def idf_type() -> idf.types.Object:
        return idf.types.Object(
            name="kitchen::Cup",
            members=(
                idf.types.Member(
                    "height",
                    idf.types.Float(unit="m", minimum=0.0, maximum=1.0),
                    "Of the rim.",
                ),
                idf.types.Member("class", idf.types.Int(optional=True)),
            ),
            doc="A cup.",
            python=Cup,
        )
)x");
}

TEST(GeneratePython, NamesTheModuleAfterTheFile) {
  const auto made =
      generate_python({.name = "some/where/my-types.2.xml", .types = {Type::object("T", {})}});
  ASSERT_TRUE(made.ok());
  ASSERT_EQ(made->size(), 1u);
  EXPECT_EQ(made->at(0).name, "my_types_2.py");
  EXPECT_THAT(made->at(0).text, Not(HasSubstr("where")));
}

TEST(GeneratePython, GivesTheSameTextForTheSameFile) {
  const std::filesystem::path path(ENGRAM_SOURCE_DIR "/tests/golden/idf/kitchen.xml");
  const auto first = read_type_file(path);
  const auto second = read_type_file(path);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(text_of(*first), text_of(*second));
}

TEST(GeneratePython, PutsBasesAndUsedTypesFirst) {
  const std::string text = generated(R"(
      <Object name="Last" extends="Base"><ObjectChild key="m"><Mode /></ObjectChild></Object>
      <Object name="Base"/>
      <IntEnum name="Mode"><EnumValue key="A" value="0"/></IntEnum>)");
  EXPECT_LT(text.find("class Base("), text.find("class Last(Base)"));
  EXPECT_LT(text.find("class Mode("), text.find("class Last(Base)"));
  EXPECT_THAT(text, HasSubstr("m: Mode = Mode.A"));
}

TEST(GeneratePython, EscapesWhatWouldEndATextOrRun) {
  const std::string hostile = "\"\"\"; import os #\\ \x01\xff 'ü'\"";
  const std::string text = text_of(file_with("x", Type::int32().with_doc(hostile), hostile));
  EXPECT_THAT(text, HasSubstr(R"x("""\"\"\"; import os #\\ \x01\udcff 'ü'")x"));
  EXPECT_THAT(text, HasSubstr(R"x("\"\"\"; import os #\\ \x01\udcff 'ü'\"")x"));
  EXPECT_THAT(text_of(file_with("x", Type::int32(), "says \"hi\"")), HasSubstr("\"hi\" \"\"\"\n"));
}

TEST(GeneratePython, WrapsLongDocumentation) {
  std::string doc;
  for (int i = 0; i < 60; ++i) doc += "word ";
  const std::string text = text_of(file_with("x", Type::int32(), doc));
  EXPECT_THAT(text, HasSubstr("    \"\"\"word word"));
  EXPECT_THAT(text, HasSubstr("word\n    word"));
}

TEST(GeneratePython, RenamesWhatPythonWouldTakeForItsOwn) {
  for (const std::string key :
       {"None", "lambda", "self", "list", "np", "field", "to_idf", "from_idf", "idf_type"})
    EXPECT_THAT(text_of(file_with(key, Type::int32())), HasSubstr("    " + key + "_: int = 0"))
        << key;
  EXPECT_THAT(text_of(file_with("__init__", Type::int32())), HasSubstr("    __init___: int = 0"));
  EXPECT_THAT(text_of(file_with("_idf_attributes", Type::int32())),
              HasSubstr("    _idf_attributes___: int = 0"));
  EXPECT_THAT(text_of(file_with("__x", Type::int32())), HasSubstr("    __x___: int = 0"));
}

TEST(GeneratePython, KeepsNamesApart) {
  const std::string text = generated(R"(
      <Object name="Base"><ObjectChild key="class"><Int/></ObjectChild></Object>
      <Object name="Fill" />
      <Object name="Derived" extends="Base">
        <ObjectChild key="class_"><Int/></ObjectChild>
        <ObjectChild key="for"><Int/></ObjectChild>
        <ObjectChild key="for_"><Int/></ObjectChild>
        <ObjectChild key="Fill"><Fill/></ObjectChild>
      </Object>)");
  EXPECT_THAT(text, HasSubstr("    class__: int = 0"));
  EXPECT_THAT(text, HasSubstr("    for__: int = 0"));
  EXPECT_THAT(text, HasSubstr("    for_: int = 0"));
  EXPECT_THAT(text, HasSubstr("    Fill_: Fill = field(default_factory=Fill)"));
  EXPECT_THAT(text, HasSubstr("**Base._idf_attributes"));
}

TEST(GeneratePython, RenamesEnumValuesThatEnumsHave) {
  const std::string text = generated(R"(<IntEnum name="E">
      <EnumValue key="name" value="0"/><EnumValue key="_x_" value="1"/>
      <EnumValue key="real" value="-2"/><EnumValue key="None" value="3"/></IntEnum>)");
  for (const char* line :
       {"    name_ = 0\n", "    _x___ = 1\n", "    real_ = -2\n", "    None_ = 3\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST(GeneratePython, RefusesTwoTypesOfOneClass) {
  const std::string message = error_of(
      {.name = "a.xml", .types = {Type::object("a::Thing", {}), Type::object("b::Thing", {})}});
  EXPECT_THAT(message, HasSubstr("'a::Thing' and 'b::Thing'"));
  const std::string included = error_of({.name = "a.xml",
                                         .types = {Type::object("a::Thing", {})},
                                         .included_types = {Type::object("b::Thing", {})}});
  EXPECT_THAT(included, HasSubstr("'Thing'"));
}

TEST(GeneratePython, RefusesWhatItCannotName) {
  EXPECT_THAT(error_of(file_with("a b", Type::int32())), HasSubstr("'a b'"));
  EXPECT_THAT(error_of(file_with("", Type::int32())), HasSubstr("no identifier"));
  EXPECT_THAT(error_of({.name = "a.xml", .types = {Type::object("", {})}}),
              HasSubstr("without a name"));
  EXPECT_THAT(error_of({.name = "a.xml", .types = {Type::object("a::x(1)", {})}}),
              HasSubstr("'a::x(1)'"));
  EXPECT_THAT(error_of(file_with("x", Type::object("Unknown", {}))), HasSubstr("'Unknown'"));
}

TEST(GeneratePython, ImportsEachTypeFromTheIncludeThatBringsIt) {
  TypeFile file{.name = "a.xml", .types = {Type::object("A", {})}};
  file.included_types = {Type::object("k::B", {}), Type::object("k::C", {})};
  file.includes = {{"kitchen/Thing.xml", "", {"k::C", "k::B"}}, {"other.xml", "", {"k::B"}}};
  const std::string text = text_of(file);
  EXPECT_THAT(text, HasSubstr("from kitchen.Thing import B, C\n"));
  EXPECT_THAT(text, Not(HasSubstr("from other")));
  EXPECT_THAT(text, HasSubstr(R"(__all__ = ["A", "B", "C"])"));
  file.includes = {{"../Thing.xml", "", {"k::C", "k::B"}}};
  EXPECT_THAT(error_of(file), HasSubstr("'../Thing.xml'"));
}

TEST(GeneratePython, TellsWhichTypesAnIncludeBrings) {
  const auto file =
      read_type_file(std::filesystem::path(ENGRAM_SOURCE_DIR "/tests/golden/idf/kitchen.xml"));
  ASSERT_TRUE(file.ok()) << file.status().to_string();
  ASSERT_EQ(file->includes.size(), 1u);
  EXPECT_THAT(file->includes[0].type_names,
              ::testing::ElementsAre("kitchen::Material", "kitchen::Thing"));
}

}  // namespace
}  // namespace engram::idf
