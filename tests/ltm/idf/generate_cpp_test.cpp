// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/generate_cpp.h"

#include <gtest/gtest.h>

#include "ltm/idf/generate_cpp_names.h"
#include "ltm/idf/generate_cpp_text.h"

namespace engram::idf {
namespace {

TypeFile file_of(const std::string& definitions) {
  auto file = parse_type_xml(
      "<AronTypeDefinition><GenerateTypes>" + definitions + "</GenerateTypes></AronTypeDefinition>",
      "some/folder/types.xml");
  EXPECT_TRUE(file.ok()) << file.status().message();
  return std::move(file).value();
}

TEST(GenerateCpp, WritesAHeaderAndASourceThatNameTheirXmlWithoutItsPath) {
  const auto files = generate_cpp(file_of("<Object name='A'/>"));
  ASSERT_TRUE(files.ok()) << files.status().message();
  ASSERT_EQ(files->size(), 2u);
  EXPECT_EQ((*files)[0].name, "types.h");
  EXPECT_EQ((*files)[1].name, "types.cpp");
  for (const GeneratedFile& file : *files) {
    EXPECT_TRUE(file.text.starts_with("// Generated from types.xml by `engram idf generate`;"));
    EXPECT_EQ(file.text.find("some/folder"), std::string::npos);
  }
}

TEST(GenerateCpp, SaysTheSameForTheSameFile) {
  const TypeFile file = read_type_file(ENGRAM_SOURCE_DIR "/tests/golden/idf/kitchen.xml").value();
  EXPECT_EQ(generate_cpp(file).value(), generate_cpp(file).value());
}

TEST(GenerateCpp, KeepsLinesShort) {
  const TypeFile file = read_type_file(ENGRAM_SOURCE_DIR "/tests/golden/idf/kitchen.xml").value();
  const std::vector<GeneratedFile> files = generate_cpp(file).value();
  for (const GeneratedFile& generated : files)
    for (size_t at = 0; at < generated.text.size();) {
      const size_t end = generated.text.find('\n', at);
      EXPECT_LE(end - at, kCodeColumns) << generated.text.substr(at, end - at);
      at = end + 1;
    }
}

TEST(GenerateCpp, PutsTypesBeforeTheirUsers) {
  const auto files =
      generate_cpp(file_of("<Object name='A'><ObjectChild key='b'><List><B/></List>"
                           "</ObjectChild></Object><Object name='B'/>"));
  const std::string& header = files.value()[0].text;
  EXPECT_LT(header.find("struct B "), header.find("struct A "));
}

TEST(GenerateCpp, RefusesTypesOfOneName) {
  const auto files = generate_cpp(file_of("<Object name='a::class'/><Object name='a::class_'/>"));
  ASSERT_FALSE(files.ok());
  EXPECT_NE(files.status().message().find("'a::class'"), std::string::npos);
  EXPECT_NE(files.status().message().find("'a::class_'"), std::string::npos);
}

TEST(GenerateCpp, RefusesATypeThatIsANamespaceToo) {
  EXPECT_FALSE(generate_cpp(file_of("<Object name='a::B'/><Object name='a::B::C'/>")).ok());
}

TEST(GenerateCpp, RefusesTypesThatTheFileDoesNotKnow) {
  TypeFile file;
  file.name = "x.xml";
  file.types = {Type::object("A", {{"b", Type::list(Type::object("B", {}))}})};
  EXPECT_FALSE(generate_cpp(file).ok());
  file.types = {Type::object("A", {{"no identifier", Type::int32()}})};
  EXPECT_FALSE(generate_cpp(file).ok());
}

TEST(GenerateCpp, RefusesFileNamesThatNoIncludeCanHold) {
  TypeFile file;
  file.name = "x\".xml";
  EXPECT_FALSE(generate_cpp(file).ok());
}

TEST(GenerateCppText, CommentsCannotBeLeft) {
  EXPECT_EQ(cpp_comment("a */ b\n  c \\ \n?\?/\nd\re", 2),
            "  /// a */ b\n  /// c \\ .\n  /// ?\?/ .\n  /// d e\n");
  EXPECT_EQ(cpp_comment("", 2), "");
  EXPECT_EQ(cpp_comment("a\u202eb", 0), "/// ab\n");
}

TEST(GenerateCppText, LiteralsHoldAnyBytes) {
  EXPECT_EQ(cpp_literal("a\"b\\c\x01?\?/").flat(), "\"a\\\"b\\\\c\\001?\\?/\"");
  EXPECT_EQ(cpp_literal("a\nb").flat(), "\"a\\n\" \"b\"");
  EXPECT_EQ(cpp_literal("").flat(), "\"\"");
}

TEST(GenerateCppText, NumbersReadBack) {
  EXPECT_EQ(cpp_number(1.0), "1.0");
  EXPECT_EQ(cpp_number(0.1f), "0.1f");
  EXPECT_EQ(cpp_number(1e300), "1e+300");
  EXPECT_EQ(cpp_number(std::numeric_limits<int64_t>::min()), "-9223372036854775807 - 1");
}

TEST(GenerateCppNames, StayOutOfTheWayOfTheLanguageAndItsLibraries) {
  EXPECT_EQ(cpp_identifier("class"), "class_");
  EXPECT_EQ(cpp_path("std::Cup"), (std::vector<std::string>{"std_", "Cup"}));
  EXPECT_EQ(cpp_path("engram::Cup"), (std::vector<std::string>{"engram", "Cup"}));
  EXPECT_EQ(cpp_path("a::engram::Cup"), (std::vector<std::string>{"a", "engram_", "Cup"}));
  EXPECT_EQ(cpp_reference("a::Cup", "a"), "Cup");
  EXPECT_EQ(cpp_reference("a::Cup", "b"), "::a::Cup");
}

}  // namespace
}  // namespace engram::idf
