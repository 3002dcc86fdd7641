// SPDX-License-Identifier: Apache-2.0
// `engram idf`, through the program that holds it alone.
#include <gtest/gtest.h>

#include "ltm/core/file.h"
#include "tests/cli/run_program.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::cli {
namespace {

namespace fs = std::filesystem;

const std::string kGolden = ENGRAM_SOURCE_DIR "/tests/golden/idf/";
const std::string kKitchen = kGolden + "kitchen.xml";

std::string text_of(const fs::path& path) {
  const auto bytes = read_file(path);
  EXPECT_TRUE(bytes.ok()) << bytes.status().message();
  return bytes.ok() ? std::string(as_text(bytes->bytes())) : "";
}

TEST(IdfCommand, GeneratesAndWritesOnlyWhatChanges) {
  const ScratchDirectory scratch;
  const std::string out = scratch.path() / "out";
  const auto first = run_engram({"generate", kKitchen, "--cpp", out, "--python", out});
  EXPECT_EQ(first.exit_code, 0) << first.err;
  for (const char* name : {"kitchen.h", "kitchen.cpp", "kitchen.py"})
    EXPECT_NE(first.out.find(name), std::string::npos) << name;
  const auto second = run_engram({"generate", kKitchen, "--cpp", out, "--python", out});
  EXPECT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(second.out, "");
}

TEST(IdfCommand, CheckTellsOfFilesThatDifferAndWritesNothing) {
  const ScratchDirectory scratch;
  const fs::path out = scratch.path() / "out";
  EXPECT_EQ(run_engram({"generate", kKitchen, "--cpp", out, "--check"}).exit_code, 1);
  EXPECT_FALSE(fs::exists(out));
  ASSERT_EQ(run_engram({"generate", kKitchen, "--cpp", out}).exit_code, 0);
  EXPECT_EQ(run_engram({"generate", kKitchen, "--cpp", out, "--check"}).exit_code, 0);
  ASSERT_TRUE(replace_file(out / "kitchen.h", as_bytes("changed")).ok());
  const auto changed = run_engram({"generate", kKitchen, "--cpp", out, "--check"});
  EXPECT_EQ(changed.exit_code, 1);
  EXPECT_NE(changed.out.find("kitchen.h"), std::string::npos);
  EXPECT_EQ(text_of(out / "kitchen.h"), "changed");
}

TEST(IdfCommand, ConvertsBothWaysWithoutChange) {
  const ScratchDirectory scratch;
  const std::string json = scratch.path() / "cup.json";
  const std::string binary = scratch.path() / "cup.idf";
  const std::string golden = kGolden + "kitchen_filled.idf";
  ASSERT_EQ(run_engram({"convert", golden, json}).exit_code, 0);
  ASSERT_EQ(run_engram({"convert", json, binary}).exit_code, 0);
  EXPECT_EQ(text_of(binary), text_of(golden));
  EXPECT_EQ(text_of(json), text_of(kGolden + "kitchen_filled.json"));
  EXPECT_EQ(run_engram({"convert", golden, scratch.path() / "cup.txt"}).exit_code, 1);
}

TEST(IdfCommand, ChecksValuesAgainstTypes) {
  const std::string value = kGolden + "kitchen_filled.json";
  const auto fits = run_engram({"check", value, "--types", kKitchen, "--type", "kitchen::Scene"});
  EXPECT_EQ(fits.exit_code, 0) << fits.out << fits.err;
  const auto differs = run_engram({"check", value, "--types", kKitchen, "--type", "kitchen::Cup"});
  EXPECT_EQ(differs.exit_code, 1);
  EXPECT_NE(differs.out.find("'height'"), std::string::npos) << differs.out;
  const auto unknown = run_engram({"check", value, "--types", kKitchen, "--type", "Nothing"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.err.find("kitchen::Scene"), std::string::npos);
}

TEST(IdfCommand, ShowsTypesAndValues) {
  const auto types = run_engram({"show", kKitchen});
  EXPECT_EQ(types.exit_code, 0) << types.err;
  EXPECT_NE(types.out.find("kitchen::Cup"), std::string::npos);
  EXPECT_NE(types.out.find("Every scalar"), std::string::npos);
  const auto json = run_engram({"show", kKitchen, "kitchen::Fill", "--json"});
  EXPECT_NE(json.out.find("\"idf_type\""), std::string::npos) << json.out;
  const auto value = run_engram({"show", kGolden + "kitchen_filled.idf"});
  EXPECT_NE(value.out.find("blue cup"), std::string::npos);
}

TEST(IdfCommand, WrongUsageIsExitCodeTwo) {
  EXPECT_EQ(run_engram({"generate", kKitchen}).exit_code, 2);
  EXPECT_EQ(run_engram({"nonsense"}).exit_code, 2);
  EXPECT_EQ(run_engram({"generate", "missing.xml", "--cpp", "x", "--check"}).exit_code, 1);
}

}  // namespace
}  // namespace engram::cli
