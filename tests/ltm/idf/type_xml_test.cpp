// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type_xml.h"

#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_types.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::idf {

namespace {

constexpr std::string_view kKitchen = R"(<?xml version="1.0" encoding="utf-8"?>
<!-- A file about a kitchen. -->
<AronTypeDefinition>
  <CodeIncludes>
    <Include include="<Eigen/Core>" />
  </CodeIncludes>
  <GenerateTypes>
    <!-- A thing that holds water. -->
    <Object name="kitchen::Cup" extends="kitchen::Thing">
      <!-- Where it is. -->
      <ObjectChild key="pose"><Pose type="float64"/></ObjectChild>
      <ObjectChild key="height" doc="without handle">
        <Float32 unit="m" min="0" max="1.5" />
      </ObjectChild>
      <ObjectChild key="state"><kitchen::State /></ObjectChild>
      <ObjectChild key="picture"><Image pixelType="rgb24" optional="true" /></ObjectChild>
      <ObjectChild key="scan"><PointCloud type="PointXYZRGB" shared_ptr="true" /></ObjectChild>
      <ObjectChild key="m"><Matrix rows="4" cols="-1" type="float32" /></ObjectChild>
      <ObjectChild key="raw"><NDArray shape="3, -1" type="uint8" /></ObjectChild>
      <ObjectChild key="volume"><ndarray dimensions="3" type="double" /></ObjectChild>
      <ObjectChild key="seen"><List><Time /></List></ObjectChild>
      <ObjectChild key="names"><Dict><string /></Dict></ObjectChild>
      <ObjectChild key="range"><Pair><Int /><Int64 /></Pair></ObjectChild>
      <ObjectChild key="mixed"><Tuple><Bool /><MemoryLink optional="1" /></Tuple></ObjectChild>
      <ObjectChild key="at" optional="true"><Position /></ObjectChild>
      <ObjectChild key="q"><Quaternion /></ObjectChild>
      <ObjectChild key="o"><Orientation /></ObjectChild>
      <ObjectChild key="three"><List size="3"><Double /></List></ObjectChild>
    </Object>
    <Object name="kitchen::Thing">
      <ObjectChild key="name"><String /></ObjectChild>
    </Object>
    <IntEnum name="kitchen::State">
      <EnumValue key="EMPTY" value="0" /><!-- to the brim --><EnumValue key="FULL" value="-7" />
    </IntEnum>
  </GenerateTypes>
</AronTypeDefinition>
)";

/// The members of one object around what is being tested; line 1 is the first of `members`.
Result<TypeFile> parse_members(const std::string& members) {
  return parse_type_xml("<AronTypeDefinition><GenerateTypes><Object name=\"a::O\">" + members +
                            "</Object></GenerateTypes></AronTypeDefinition>",
                        "t.xml");
}

Result<TypeFile> parse_types(const std::string& types) {
  return parse_type_xml(
      "<AronTypeDefinition><GenerateTypes>" + types + "</GenerateTypes></AronTypeDefinition>",
      "t.xml");
}

TEST(TypeXml, ReadsEveryKindOfType) {
  const auto file = parse_type_xml(kKitchen, "kitchen.xml");
  ASSERT_OK(file);
  ASSERT_EQ(file->types.size(), 3u);
  EXPECT_EQ(to_string(file->types[0]),
            "kitchen::Cup extends kitchen::Thing{name: String}{pose: Pose<float64>, height: "
            "Float[m, 0..1.5], state: IntEnum kitchen::State{EMPTY = 0, FULL = -7}, picture: "
            "optional Image<rgb24>, scan: PointCloud<XYZRGB>, m: Matrix<float32, 4x*>, raw: "
            "NDArray<uint8, [3, *]>, volume: NDArray<float64, [*, *, *]>, seen: List<Time>, names: "
            "Dict<String>, range: Pair<Int, Long>, mixed: Tuple<Bool, optional MemoryLink>, at: "
            "optional NDArray<float32, [3]>[m], q: Quaternion<float32>, o: Orientation<float32>, "
            "three: List<Double, 3>}");
  EXPECT_EQ(file->types[1].name(), "kitchen::Thing");
  ASSERT_NE(file->find("kitchen::State"), nullptr);
  EXPECT_EQ(file->find("kitchen::Bowl"), nullptr);
}

TEST(TypeXml, CarriesDocumentationAndNotes) {
  const auto file = parse_type_xml(kKitchen, "kitchen.xml");
  ASSERT_OK(file);
  const auto& cup = file->types[0].get<types::Object>();
  EXPECT_EQ(file->types[0].doc(), "A thing that holds water.");
  EXPECT_EQ(cup.find("pose")->doc, "Where it is.");
  EXPECT_EQ(cup.find("height")->doc, "without handle");
  EXPECT_EQ(cup.find("state")->doc, "");
  EXPECT_EQ(file->types[2].get<types::IntEnum>().values[1].doc, "to the brim");
  ASSERT_EQ(file->notes.size(), 2u);
  EXPECT_EQ(file->notes[0], "kitchen.xml:4: <CodeIncludes> is for code alone");
  EXPECT_EQ(file->notes[1],
            "kitchen.xml:17: attribute 'shared_ptr' of <PointCloud> is for code alone");
}

TEST(TypeXml, NamesFileLineAndWhatWasNeeded) {
  const auto fails = [](const std::string& members, const char* part) {
    EXPECT_FAILS(parse_members(members), StatusCode::kInvalidArgument, part);
  };
  fails("\n\n<Child/>", "t.xml:3: found <Child> in <Object>, needs <ObjectChild");
  fails("\n<ObjectChild key='a'/>", "t.xml:2: <ObjectChild> has 0 elements, needs 1 exactly");
  fails("\n<ObjectChild><Int/></ObjectChild>", "t.xml:2: <ObjectChild> has no attribute 'key'");
  fails("<ObjectChild key='a b'><Int/></ObjectChild>", "key=\"a b\"");
  fails("<ObjectChild key='a'>\nInt</ObjectChild>", "found the text 'Int', needs");
  fails("<ObjectChild key='a'>\n<Apple/></ObjectChild>", "t.xml:2: <Apple> is not known");
  fails("<ObjectChild key='a'><Int minimun='3'/></ObjectChild>", "'minimun', needs one of");
  fails("<ObjectChild key='a'><Int min='x'/></ObjectChild>", "min=\"x\": needs a number");
  fails("<ObjectChild key='a'><Int min='3' max='2'/></ObjectChild>", "t.xml:1: type Int: no int32");
  fails("<ObjectChild key='a'><Int optional='maybe'/></ObjectChild>", "needs true or false");
  fails("<ObjectChild key='a'><Int><Int/></Int></ObjectChild>", "<Int>, which needs to be empty");
  fails("<ObjectChild key='a'><Matrix rows='-3'/></ObjectChild>", "rows=\"-3\"");
  fails("<ObjectChild key='a'><Matrix type='real'/></ObjectChild>", "type=\"real\": needs int8");
  fails("<ObjectChild key='a'><Image/></ObjectChild>", "no attribute 'pixeltype'");
  fails("<ObjectChild key='a'><Image pixelType='bgr'/></ObjectChild>", "pixeltype=\"bgr\"");
  fails("<ObjectChild key='a'><PointCloud type='XY'/></ObjectChild>", "type=\"XY\"");
  fails("<ObjectChild key='a'><NDArray/></ObjectChild>", "<NDArray> needs shape");
  fails("<ObjectChild key='a'><NDArray shape='3,a'/></ObjectChild>", "shape=\"3,a\"");
  fails("<ObjectChild key='a'><NDArray shape='3' dimensions='2'/></ObjectChild>", "needs 1");
  fails("<ObjectChild key='a'><Pose type='int8'/></ObjectChild>", "needs float32 or float64");
  fails("<ObjectChild key='a'><Pair><Int/></Pair></ObjectChild>", "1 elements, needs 2 exactly");
  fails("<ObjectChild key='a'><Tuple/></ObjectChild>", "0 elements, needs 1 at least");
  fails("<ObjectChild key='a'><Object name='b'/></ObjectChild>", "needs to stand in");
  fails("<ObjectChild key='a'><Int/></ObjectChild><ObjectChild key='a'><Int/></ObjectChild>",
        "member 'a' is there twice");
}

TEST(TypeXml, RefusesBrokenDocuments) {
  const auto fails = [](const std::string& text, const char* part) {
    EXPECT_FAILS(parse_type_xml(text, "t.xml"), StatusCode::kInvalidArgument, part);
  };
  fails("", "t.xml:1: no XML");
  fails("<AronTypeDefinition>\n<GenerateTypes>\n</AronTypeDefinition>", "t.xml:3: no XML");
  fails("<Other/>", "found <Other>, needs <AronTypeDefinition>");
  fails("<AronTypeDefinition>\n<Types/></AronTypeDefinition>", "t.xml:2: found 'Types'");
  fails(std::string(kMaxXmlBytes + 1, ' '), "bytes");
  EXPECT_FAILS(parse_types("<Enum/>"), StatusCode::kInvalidArgument, "found 'Enum'");
  EXPECT_FAILS(parse_types("<Object/>"), StatusCode::kInvalidArgument, "name=\"\"");
  EXPECT_FAILS(parse_types("<Object name='Matrix'/>"), StatusCode::kInvalidArgument, "built-in");
  EXPECT_FAILS(parse_types("<Object name='A'/><Object name='A'/>"), StatusCode::kInvalidArgument,
               "defined twice");
  EXPECT_FAILS(parse_types("<Object name='A' extends='B'/>"), StatusCode::kInvalidArgument,
               "extends=\"B\"");
  EXPECT_FAILS(parse_types("<IntEnum name='A'/>"), StatusCode::kInvalidArgument, "no value");
  EXPECT_FAILS(parse_types("<IntEnum name='A'><EnumValue key='B' value='x'/></IntEnum>"),
               StatusCode::kInvalidArgument, "needs an int32");
}

TEST(TypeXml, RefusesTypesThatContainThemselves) {
  EXPECT_FAILS(parse_types("<Object name='A'>\n<ObjectChild key='b'><List><B/></List></ObjectChild>"
                           "</Object><Object name='B' extends='A'/>"),
               StatusCode::kInvalidArgument, "'A' contains itself");
}

TEST(TypeXml, FindsNamesFromTheInsideOfANamespace) {
  const auto file = parse_types(
      "<Object name='a::b::User'><ObjectChild key='x'><Near/></ObjectChild>"
      "<ObjectChild key='y'><b::Near optional='true'/></ObjectChild></Object>"
      "<Object name='a::b::Near'/><Object name='Near'/>");
  ASSERT_OK(file);
  const auto& user = file->types[0].get<types::Object>();
  EXPECT_EQ(user.find("x")->type.name(), "a::b::Near");
  EXPECT_EQ(user.find("y")->type.name(), "a::b::Near");
  EXPECT_TRUE(user.find("y")->type.is_optional());
}

TEST(TypeXml, RefusesDepthAndMultiplication) {
  std::string deep = "<Int/>";
  for (int i = 0; i < 100; ++i) deep = "<List>" + deep + "</List>";
  EXPECT_FAILS(parse_members("<ObjectChild key='a'>" + deep + "</ObjectChild>"),
               StatusCode::kInvalidArgument, "64");
  std::string chain = "<Object name='T0'/>", pairs = "<Object name='T0'/>";
  for (int i = 1; i < 100; ++i) {
    const std::string use = fmt::format("<T{}/>", i - 1);
    chain =
        fmt::format("<Object name='T{}'><ObjectChild key='a'>{}</ObjectChild></Object>", i, use) +
        chain;
    pairs += fmt::format(
        "<Object name='T{0}'><ObjectChild key='a'>{1}</ObjectChild><ObjectChild key='b'>{1}"
        "</ObjectChild></Object>",
        i, use);
  }
  EXPECT_FAILS(parse_types(chain), StatusCode::kInvalidArgument, "64");
  EXPECT_FAILS(parse_types(pairs), StatusCode::kInvalidArgument, "nodes");
  std::string open;
  for (int i = 0; i < 200000; ++i) open += "<a>";
  EXPECT_FAILS(parse_type_xml(open, "t.xml"), StatusCode::kInvalidArgument, "no XML");
}

TEST(TypeXml, FetchesNoEntities) {
  const auto file = parse_type_xml(
      "<!DOCTYPE a [<!ENTITY x SYSTEM 'file:///etc/hostname'>]><AronTypeDefinition><GenerateTypes>"
      "<Object name='A' doc='&x;'/></GenerateTypes></AronTypeDefinition>",
      "t.xml");
  ASSERT_OK(file);
  EXPECT_EQ(file->types[0].doc(), "&x;");
}

class TypeXmlFiles : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& includes, const std::string& types) {
    std::filesystem::create_directories((scratch_ / name).parent_path());
    const std::string text = "<AronTypeDefinition>\n<AronIncludes>" + includes +
                             "</AronIncludes>\n<GenerateTypes>" + types +
                             "</GenerateTypes></AronTypeDefinition>";
    overwrite_file(scratch_ / name, as_bytes(text));
  }
  std::filesystem::path at(const std::string& name) { return scratch_ / name; }

  ScratchDirectory scratch_;
};

TEST_F(TypeXmlFiles, IncludesOtherFiles) {
  write("lib/pkg/base.xml", "", "<Object name='p::Base'/>");
  write("beside.xml", "<PackagePath package='pkg' path='base.xml'/>",
        "<Object name='p::Beside' extends='p::Base'/>");
  write("main.xml", "<Include include='<pkg/base.xml>'/><Include include='beside.xml'/>",
        "<Object name='p::Main' extends='p::Beside'><ObjectChild key='b'><Base/></ObjectChild>"
        "</Object>");
  const auto file = read_type_file(at("main.xml"), {at("lib")});
  ASSERT_OK(file);
  ASSERT_EQ(file->types.size(), 1u);
  ASSERT_EQ(file->includes.size(), 2u);
  EXPECT_EQ(file->includes[0].name, "pkg/base.xml");
  EXPECT_EQ(file->includes[0].path, at("lib") / "pkg/base.xml");
  ASSERT_EQ(file->included_types.size(), 2u);
  EXPECT_EQ(file->included_types[0].name(), "p::Base");
  EXPECT_NE(file->find("p::Beside"), nullptr);
}

TEST_F(TypeXmlFiles, RefusesIncludesThatAreMissingOrCircular) {
  write("a.xml", "\n<Include include='b.xml'/>", "");
  EXPECT_FAILS(read_type_file(at("a.xml")), StatusCode::kNotFound, "a.xml:3: the include 'b.xml'");
  write("b.xml", "<Include include='a.xml'/>", "");
  EXPECT_FAILS(read_type_file(at("a.xml")), StatusCode::kInvalidArgument, "includes itself");
  EXPECT_FAILS(read_type_file(at("c.xml")), StatusCode::kNotFound, "c.xml");
  write("d.xml", "<Link/>", "");
  EXPECT_FAILS(read_type_file(at("d.xml")), StatusCode::kInvalidArgument, "<AronIncludes>");
}

TEST_F(TypeXmlFiles, RefusesTwoTypesOfOneName) {
  write("a.xml", "", "<Object name='A'/>");
  write("b.xml", "", "<Object name='A'><ObjectChild key='x'><Int/></ObjectChild></Object>");
  write("both.xml", "<Include include='a.xml'/><Include include='b.xml'/>", "");
  EXPECT_FAILS(read_type_file(at("both.xml")), StatusCode::kInvalidArgument, "included twice");
  write("again.xml", "<Include include='a.xml'/>", "<Object name='A'/>");
  EXPECT_FAILS(read_type_file(at("again.xml")), StatusCode::kInvalidArgument, "already");
}

TEST_F(TypeXmlFiles, FindsIncludesOfATextInTheIncludePaths) {
  write("a.xml", "", "<Object name='A'/>");
  const std::string text =
      "<AronTypeDefinition><AronIncludes><Include include='a.xml'/></AronIncludes>"
      "</AronTypeDefinition>";
  EXPECT_OK(parse_type_xml(text, "t.xml", {at("")}));
  EXPECT_FAILS(parse_type_xml(text, "t.xml"), StatusCode::kNotFound, "a.xml");
}

TEST(TypeXml, SurvivesDamagedText) {
  RandomValues random(16);
  for (int i = 0; i < 5000; ++i) {
    std::string text(kKitchen);
    for (size_t change = 1 + random.below(4); change > 0; --change) {
      const size_t at = random.below(text.size());
      switch (random.below(3)) {
        case 0:
          text[at] = static_cast<char>(random.bits());
          break;
        case 1:
          text.erase(at, random.below(40));
          break;
        default:
          text.insert(at, text.substr(random.below(text.size()), random.below(60)));
      }
    }
    (void)parse_type_xml(text, "t.xml").ok();
  }
}

}  // namespace
}  // namespace engram::idf
