// SPDX-License-Identifier: Apache-2.0
// The values that C++ and Python both read and write: tests/golden/idf. ENGRAM_WRITE_GOLDEN=1 in
// the environment writes them anew.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "ltm/core/file.h"
#include "ltm/idf/binary.h"
#include "ltm/idf/json.h"
#include "ltm/idf/type_check.h"
#include "tests/ltm/typed/kitchen_values.h"

namespace engram::typed {
namespace {

std::filesystem::path golden(const std::string& name) {
  return std::filesystem::path(ENGRAM_SOURCE_DIR) / "tests/golden/idf" / name;
}

bool is_writing() {
  const char* wish = std::getenv("ENGRAM_WRITE_GOLDEN");
  return wish != nullptr && std::string_view(wish) == "1";
}

std::string bytes_text(const idf::Data& data) {
  const auto bytes = idf::encode(data).value();
  return std::string(as_text(bytes));
}

std::string json_text(const idf::Data& data) {
  return idf::to_json_text(data, 2).value() + "\n";
}

/// The text of a golden file; written before where that is wished for.
std::string golden_text(const std::string& name, const std::string& now) {
  if (is_writing()) {
    EXPECT_TRUE(replace_file(golden(name), as_bytes(now)).ok());
  }
  const auto bytes = read_file(golden(name));
  EXPECT_TRUE(bytes.ok()) << bytes.status().message();
  return bytes.ok() ? std::string(as_text(bytes->bytes())) : "";
}

TEST(GoldenValues, AreWhatGeneratedCodeWrites) {
  for (const NamedScene& named : kitchen_scenes()) {
    const idf::Data data = named.scene.to_idf();
    EXPECT_EQ(golden_text(named.name + ".idf", bytes_text(data)), bytes_text(data)) << named.name;
    EXPECT_EQ(golden_text(named.name + ".json", json_text(data)), json_text(data)) << named.name;
  }
}

TEST(GoldenValues, ReadBackToTheObjectsFromBothForms) {
  for (const NamedScene& named : kitchen_scenes()) {
    const auto binary = idf::decode(read_file(golden(named.name + ".idf")).value());
    ASSERT_TRUE(binary.ok()) << binary.status().message();
    const Buffer text = read_file(golden(named.name + ".json")).value();
    const auto json = idf::from_json_text(as_text(text.bytes()));
    ASSERT_TRUE(json.ok()) << json.status().message();
    EXPECT_TRUE(*binary == *json) << named.name;
    const auto scene = kitchen::Scene::from_idf(*binary);
    ASSERT_TRUE(scene.ok()) << scene.status().message();
    EXPECT_TRUE(*scene == named.scene) << named.name;
    EXPECT_EQ(bytes_text(scene->to_idf()), bytes_text(*binary)) << named.name;
  }
}

TEST(GoldenValues, AreOfTheirType) {
  for (const NamedScene& named : kitchen_scenes()) {
    const auto mismatches = idf::check(named.scene.to_idf(), kitchen::Scene::idf_type());
    EXPECT_TRUE(mismatches.empty()) << named.name << ": " << mismatches.front().to_string();
  }
}

}  // namespace
}  // namespace engram::typed
