// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/prior.h"

#include <algorithm>

#include "ltm/core/file.h"
#include "ltm/idf/type_check.h"
#include "tests/memory/prior/prior_directory.h"

namespace engram::memory {
namespace {

using engram::testing::picture_file;
using engram::testing::PriorDirectory;
using idf::Data;
using idf::Dict;

constexpr const char* kThing = R"(<AronTypeDefinition><GenerateTypes>
  <Object name="Thing"><ObjectChild key="height"><Float32 min="0" /></ObjectChild></Object>
</GenerateTypes></AronTypeDefinition>)";

TEST(Prior, BecomesOneCommitForEachMemory) {
  PriorDirectory directory;
  directory.write("prior.yaml", "time: 2024-05-01 00:00:00");
  directory.write("Objects/Things/kitchen/cup.json", R"({"height": 0.5})");
  directory.write("Objects/Things/kitchen/pot.yaml", "height: 1");
  directory.write("Grasps/Known/hand/top.yaml", "[1, two]");
  const auto prior = directory.load();
  ASSERT_OK(prior);
  ASSERT_EQ(prior->commits.size(), 2u);
  const ltm::Commit& objects = prior->commits.at("Objects");
  EXPECT_OK(objects.check());
  ASSERT_EQ(objects.updates.size(), 2u);
  const ltm::Snapshot& cup = objects.updates[0];
  EXPECT_EQ(cup.id().to_string(), "Objects/Things/kitchen/cup/2024-05-01 00:00:00.000000");
  EXPECT_EQ(cup.instances[0].data, Data(Dict{{"height", 0.5}}));
  EXPECT_EQ(cup.instances[0].metadata.provider, "prior");
  EXPECT_EQ(cup.instances[0].metadata.created, cup.time);
  EXPECT_EQ(prior->commits.at("Grasps").updates[0].instances[0].data,
            Data(idf::List{int64_t{1}, "two"}));
  EXPECT_TRUE(prior->problems.empty());
}

TEST(Prior, IsAsOldAsItsFiles) {
  PriorDirectory directory;
  directory.write("A/b/c/d.json", "1");
  const auto changed = std::filesystem::file_time_type::clock::from_sys(
      std::chrono::sys_time<Duration>(std::chrono::seconds(1'600'000'000)));
  std::filesystem::last_write_time(directory / "A/b/c/d.json", changed);
  EXPECT_EQ(to_ns(directory.load()->commits.at("A").updates[0].time), 1'600'000'000'000'000'000);
}

TEST(Prior, HasSeveralInstancesWhereTheyAreListed) {
  PriorDirectory directory;
  directory.write("A/b/c/two.yaml", "instances: [1, {x: 2}]");
  directory.write("A/b/c/one.yaml", "instances: [1]\nother: 2");
  directory.write("A/b/c/text.yaml", "instances: 5");
  const auto prior = directory.load();
  ASSERT_OK(prior);
  const auto instances = [&](const char* id) { return PriorDirectory::instances_of(*prior, id); };
  ASSERT_EQ(instances("A/b/c/two").size(), 2u);
  EXPECT_EQ(instances("A/b/c/two")[1].data, Data(Dict{{"x", int64_t{2}}}));
  EXPECT_EQ(instances("A/b/c/one").size(), 1u);
  EXPECT_EQ(instances("A/b/c/text")[0].data, Data(Dict{{"instances", int64_t{5}}}));
  directory.write("A/b/c/none.json", "\n{\"instances\":\n []}");
  EXPECT_FAILS(directory.load(), StatusCode::kInvalidArgument, "none.json:3: has no instance");
}

TEST(Prior, HoldsImagesAndTheBytesOfOtherFiles) {
  PriorDirectory directory;
  directory.write("A/b/c/red.png", picture_file(".png", 2, 3, CV_8UC3, {0, 0, 255}));
  directory.write("A/b/c/mesh.stl", "solid");
  directory.write("A/b/c/empty.bin", "");
  const auto prior = directory.load();
  ASSERT_OK(prior);
  const Data picture = PriorDirectory::instances_of(*prior, "A/b/c/red")[0].data;
  EXPECT_EQ(picture.get<idf::NdArray>().values<uint8_t>()[0], 255);
  const Data mesh = PriorDirectory::instances_of(*prior, "A/b/c/mesh.stl")[0].data;
  EXPECT_EQ(*mesh.at("name"), Data("mesh.stl"));
  EXPECT_EQ(*mesh.at("bytes"), Data(idf::NdArray::take<uint8_t>({5}, {'s', 'o', 'l', 'i', 'd'})));
  EXPECT_EQ(PriorDirectory::instances_of(*prior, "A/b/c/empty.bin").size(), 1u);
}

TEST(Prior, IsOfTheTypesOfItsSegments) {
  PriorDirectory directory;
  directory.write("A/b.type.xml", kThing);
  directory.write("A/b/c.type.xml", R"(<AronTypeDefinition>
    <AronIncludes><Include include="<b.type.xml>" /></AronIncludes><GenerateTypes>
    <Object name="Cup" extends="Thing"><ObjectChild key="fill"><Long /></ObjectChild></Object>
    </GenerateTypes></AronTypeDefinition>)");
  directory.write("A/b/c/cup.yaml", "{fill: 3, height: 0.1}");
  directory.write("A/b/other/pot.json", R"({"height": 1})");
  const auto prior = directory.load();
  ASSERT_OK(prior);
  EXPECT_EQ(prior->types.all().size(), 2u);
  EXPECT_EQ(PriorDirectory::instances_of(*prior, "A/b/c/cup")[0].data,
            Data(Dict{{"height", 0.1f}, {"fill", int64_t{3}}}));
  EXPECT_EQ(PriorDirectory::instances_of(*prior, "A/b/other/pot")[0].data,
            Data(Dict{{"height", 1.0f}}));
}

TEST(Prior, TellsAllThatIsWrongWithFileAndLine) {
  PriorDirectory directory;
  directory.write("A/b.type.xml", kThing);
  directory.write("A/b/c/fine.json", R"({"height": 1})");
  directory.write("A/b/c/json.json", "{\n\"height\": }");
  directory.write("A/b/c/yaml.yaml", "height: 1\nheight: 2");
  directory.write("A/b/c/negative.yaml", "\nheight: -1");
  directory.write("A/b/c/text.json", "{\n\n\"height\": \"tall\"}");
  directory.write("A/b/c/more.yaml", "height: 1\nheigth: 1\nwidth: 2");
  directory.write("A/b/c/missing.json", "\n{}");
  directory.write("A/b/c/many.json", "{\"instances\": [\n{\"height\": 1},\n{\"height\": []}]}");
  directory.write("A/b/c/picture.png", "no picture");
  directory.write("A/b/bad.type.xml", "<AronTypeDefinition>\n<Nonsense/></AronTypeDefinition>");
  directory.write("A/stray.json", "1");
  directory.write("prior.yaml", "time: yesterday");
  const auto prior = directory.load();
  EXPECT_EQ(prior.status().code(), StatusCode::kInvalidArgument);
  for (const char* part :
       {"json.json:2: is no JSON", "yaml.yaml:2: ", "negative.yaml:2: 'height'",
        "text.json:3: ", "more.yaml:2: 'heigth'", "more.yaml:3: 'width'", "missing.json:2: ",
        "many.json:3: ", "picture.png: is no picture to take: needs a PNG or JPEG file",
        "bad.type.xml:2: ", "stray.json: stands below 1 names", "prior.yaml:1: 'time'"})
    EXPECT_THAT(prior.status().message(), ::testing::HasSubstr(part));
  EXPECT_EQ(std::ranges::count(prior.status().message(), '\n'), 12) << prior.status().message();
}

TEST(Prior, GoesOnWithWhatIsFineWhereItIsAskedTo) {
  PriorDirectory directory;
  directory.write("A/b.type.xml", kThing);
  directory.write("A/b/c/fine.json", R"({"height": 1})");
  directory.write("A/b/c/text.json", R"({"height": "tall"})");
  directory.write("A/b/c/broken.json", "{");
  const auto prior = directory.load({.goes_on = true});
  ASSERT_OK(prior);
  EXPECT_EQ(prior->problems.size(), 2u);
  EXPECT_EQ(prior->commits.at("A").updates.size(), 1u);
}

TEST(Prior, IsBounded) {
  PriorDirectory directory;
  for (int i = 0; i < 5; ++i)
    directory.write(fmt::format("A/b/c/{}.bin", i), std::string(1000, 'x'));
  EXPECT_FAILS(directory.load({.max_files = 4}), StatusCode::kInvalidArgument, "4.bin: is one too");
  EXPECT_FAILS(directory.load({.max_file_bytes = 999}), StatusCode::kInvalidArgument,
               "1000 bytes, at most 999");
  EXPECT_FAILS(directory.load({.max_bytes = 3500}), StatusCode::kInvalidArgument,
               "3.bin: makes more than 3500 bytes");
  EXPECT_EQ(directory.load({.goes_on = true, .max_bytes = 3500})->commits.at("A").updates.size(),
            3u);
  directory.write("A/b/c/large.json", "[" + std::string(1000, ' ') + "]");
  EXPECT_FAILS(directory.load({.max_json_bytes = 999}), StatusCode::kInvalidArgument,
               "large.json: has 1002 bytes, of JSON at most 999");
  directory.write("A/b/c/wide.png", picture_file(".png", 10, 10, CV_8UC1, 0));
  EXPECT_FAILS(directory.load({.max_pixels = 99}), StatusCode::kInvalidArgument,
               "wide.png: is no picture to take: png: found 10 x 10 pixels");
}

TEST(Prior, ToldAtOnceIsNotEndless) {
  PriorDirectory directory;
  for (int i = 0; i < 200; ++i) directory.write(fmt::format("A/b/c/{}.json", i), "{");
  const auto prior = directory.load();
  EXPECT_EQ(std::ranges::count(prior.status().message(), '\n'), 101);
  EXPECT_THAT(prior.status().message(), ::testing::EndsWith("... and 100 more"));
}

TEST(Prior, StaysInItsDirectory) {
  PriorDirectory outside;
  outside.write("prior.yaml", "time: 2024-05-01 00:00:00");
  outside.write("secret.json", "1");
  outside.write("Thing.xml", kThing);
  PriorDirectory directory;
  std::filesystem::create_symlink(outside / "prior.yaml", directory / "prior.yaml");
  directory.write(
      "A/b.type.xml",
      fmt::format("<AronTypeDefinition><AronIncludes><Include include=\"<{}>\" />"
                  "</AronIncludes><GenerateTypes><Object name=\"X\" extends=\"Thing\" />"
                  "</GenerateTypes></AronTypeDefinition>",
                  (outside / "Thing.xml").string()));
  directory.write("A/b/c/d.json", "1");
  std::filesystem::create_symlink(outside / "secret.json", directory / "A/b/c/e.json");
  const auto prior = directory.load({.goes_on = true});
  ASSERT_OK(prior);
  EXPECT_EQ(prior->problems.size(), 3u);
  EXPECT_TRUE(prior->types.all().empty());
  EXPECT_EQ(prior->commits.at("A").updates.size(), 1u);
  EXPECT_NE(prior->commits.at("A").updates[0].id().to_string(),
            "A/b/c/d/2024-05-01 00:00:00.000000");
}

TEST(Prior, IsNothingInAnEmptyDirectory) {
  const PriorDirectory directory;
  EXPECT_TRUE(directory.load()->commits.empty());
  EXPECT_FAILS(load_prior(directory / "none"), StatusCode::kNotFound, "none");
}

TEST(Prior, LoadsTheExampleOfTheDocumentation) {
  const auto page = read_file(std::filesystem::path(ENGRAM_SOURCE_DIR) / "docs/prior.md");
  ASSERT_OK(page);
  const std::string text(as_text(page->bytes()));
  const auto block = [&](const std::string& language) {
    const std::string start = "```" + language + "\n";
    const size_t at = text.find(start) + start.size();
    return text.substr(at, text.find("```", at) - at);
  };
  PriorDirectory directory;
  directory.write("Objects/Things.type.xml", block("xml"));
  directory.write("Objects/Things/kitchen/blue-cup.yaml", block("yaml"));
  const auto prior = directory.load();
  ASSERT_OK(prior);
  const auto cup = PriorDirectory::instances_of(*prior, "Objects/Things/kitchen/blue-cup");
  ASSERT_EQ(cup.size(), 1u);
  EXPECT_EQ(*cup[0].data.at("pose_world_thing/position"),
            Data(idf::NdArray::take<float>({3}, {1.2f, 0.4f, 0.9f})));
  EXPECT_EQ(*cup[0].data.at("material"), Data(int32_t{0}));
}

}  // namespace
}  // namespace engram::memory
