// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/prior_files.h"

#include <sys/stat.h>

#include "tests/memory/prior/prior_directory.h"

namespace engram::memory {
namespace {

using engram::testing::PriorDirectory;

constexpr uint64_t kMiB = 1 << 20;

TEST(PriorFiles, AreEntitiesAndTypesOfSegments) {
  PriorDirectory directory;
  for (const char* name :
       {"Objects/Things.type.xml", "Objects/Things/kitchen.type.xml",
        "Objects/Things/kitchen/cup.json", "Objects/Things/kitchen/pot.yaml",
        "Objects/Things/kitchen/pan.yml", "Objects/Things/kitchen/a%2Fb.png",
        "Objects/Things/kitchen/c.d.jpeg", "Objects/Things/kitchen/mesh.stl", "prior.yaml"})
    directory.write(name, "x");
  const auto found = find_prior_files(directory.path(), 100, kMiB);
  ASSERT_OK(found);
  EXPECT_TRUE(found->problems.empty());
  EXPECT_EQ(found->settings, directory / "prior.yaml");
  std::map<std::string, PriorFileKind> kinds;
  for (const PriorFile& file : found->files) kinds[file.id.to_string()] = file.kind;
  EXPECT_EQ(kinds, (std::map<std::string, PriorFileKind>{
                       {"Objects/Things", PriorFileKind::kType},
                       {"Objects/Things/kitchen", PriorFileKind::kType},
                       {"Objects/Things/kitchen/cup", PriorFileKind::kJson},
                       {"Objects/Things/kitchen/pot", PriorFileKind::kYaml},
                       {"Objects/Things/kitchen/pan", PriorFileKind::kYaml},
                       {"Objects/Things/kitchen/a\\/b", PriorFileKind::kPicture},
                       {"Objects/Things/kitchen/c.d", PriorFileKind::kPicture},
                       {"Objects/Things/kitchen/mesh.stl", PriorFileKind::kBytes}}));
}

TEST(PriorFiles, HaveNamesOfAnyCharacters) {
  EXPECT_EQ(*prior_name("a%2Fb%25c%2f"), "a/b%c/");
  EXPECT_EQ(*prior_name("%2E%2E"), "..");
  EXPECT_EQ(*prior_name("gr\xc3\xbcn"), "gr\xc3\xbcn");
  for (const char* name : {"", "%", "a%", "a%2", "%zz", "100%", "%2", "%FF", "%+1"})
    EXPECT_FAILS(prior_name(name), StatusCode::kInvalidArgument, "name");
}

TEST(PriorFiles, ThatBelongNowhereAreToldWithTheirPlace) {
  PriorDirectory directory;
  const std::vector<std::string> strays{"README.md",
                                        "Objects/cup.json",
                                        "Objects/Things/cup.json",
                                        "Objects/Things/kitchen/deep/cup.json",
                                        "cup.type.xml",
                                        "Objects/Things/kitchen/100%.json"};
  for (const std::string& name : strays) directory.write(name, "x");
  directory.write(".git/config", "x");
  directory.write("Objects/.hidden", "x");
  const auto found = find_prior_files(directory.path(), 100, kMiB);
  ASSERT_OK(found);
  EXPECT_TRUE(found->files.empty());
  EXPECT_EQ(found->problems.size(), strays.size());
}

TEST(PriorFiles, OfOneEntityAreRefused) {
  PriorDirectory directory;
  directory.write("A/b/c/d.json", "1");
  directory.write("A/b/c/d.png", "1");
  const auto found = find_prior_files(directory.path(), 100, kMiB);
  ASSERT_EQ(found->problems.size(), 1u);
  EXPECT_THAT(found->problems[0], ::testing::HasSubstr("entity 'A/b/c/d' is in "));
}

TEST(PriorFiles, MayBeLinksWithinTheDirectoryAndNotOutOfIt) {
  PriorDirectory outside;
  outside.write("secret.json", "1");
  outside.write("folder/secret.json", "1");
  PriorDirectory directory;
  directory.write("A/b/c/d.json", "1");
  std::filesystem::create_symlink("d.json", directory / "A/b/c/e.json");
  std::filesystem::create_directory_symlink("c", directory / "A/b/other");
  std::filesystem::create_symlink(outside / "secret.json", directory / "A/b/c/f.json");
  std::filesystem::create_directory_symlink(outside / "folder", directory / "A/b/out");
  std::filesystem::create_symlink("/", directory / "A/root");
  std::filesystem::create_symlink("nowhere", directory / "A/b/c/g.json");
  std::filesystem::create_symlink("h.json", directory / "A/b/c/h.json");
  const auto found = find_prior_files(directory.path(), 100, kMiB);
  ASSERT_OK(found);
  EXPECT_EQ(found->files.size(), 4u) << "d and e, in two providers";
  // f, g and h in two providers, and two folders.
  EXPECT_EQ(found->problems.size(), 8u);
}

TEST(PriorFiles, InALinkToItsFolderEndAtTheEntities) {
  PriorDirectory directory;
  directory.write("A/b/c/d.json", "1");
  std::filesystem::create_directory_symlink(".", directory / "B");
  const auto found = find_prior_files(directory.path(), 100, kMiB);
  ASSERT_OK(found);
  EXPECT_FALSE(found->problems.empty());
}

TEST(PriorFiles, AreBoundedInNumberAndSize) {
  PriorDirectory directory;
  for (int i = 0; i < 20; ++i) directory.write(fmt::format("A/b/c/{:02}.json", i), "12345");
  const auto many = find_prior_files(directory.path(), 10, kMiB);
  EXPECT_EQ(many->files.size(), 10u);
  ASSERT_EQ(many->problems.size(), 1u);
  EXPECT_THAT(many->problems[0], ::testing::HasSubstr("10.json: is one too many, at most 10"));
  const auto large = find_prior_files(directory.path(), 100, 4);
  EXPECT_EQ(large->problems.size(), 20u);
}

TEST(PriorFiles, AreFiles) {
  PriorDirectory directory;
  directory.write("A/b/c/d.json", "1");
  ASSERT_EQ(::mkfifo((directory / "A/b/c/pipe.json").c_str(), 0600), 0);
  const auto found = find_prior_files(directory.path(), 100, kMiB);
  ASSERT_EQ(found->problems.size(), 1u);
  EXPECT_THAT(found->problems[0], ::testing::HasSubstr("neither a file nor a folder"));
  EXPECT_FAILS(find_prior_files(directory / "none", 1, 1), StatusCode::kNotFound, "none");
  EXPECT_FAILS(find_prior_files(directory / "A/b/c/d.json", 1, 1), StatusCode::kNotFound,
               "no directory");
}

}  // namespace
}  // namespace engram::memory
