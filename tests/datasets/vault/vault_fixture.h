// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "datasets/vault/day_records.h"
#include "datasets/vault/vault_check.h"
#include "datasets/vault/vault_forget.h"
#include "datasets/vault/vault_import.h"
#include "ltm/core/file.h"
#include "ltm/idf/type.h"
#include "ltm/store/store_check.h"
#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::datasets::vault {

inline constexpr Day kFirstDay = 18'000;  // 2019-04-14
inline constexpr int kDays = 3;
inline constexpr int64_t kPerDay = 12;

inline ltm::MemoryId camera() {
  return ltm::example_entity("cam");
}
inline ltm::MemoryId arm() {
  return *ltm::MemoryId::from_names({"Body", "Arm", "left", "arm"});
}
/// A name that a terminal, a path or a parser might take for something else.
inline ltm::MemoryId odd() {
  return *ltm::MemoryId::from_names({"../..", "a/b @ all", "\x1b[31m\n", "%2F\\#"});
}

inline std::string text_of(std::span<const std::byte> bytes) {
  return std::string(as_text(bytes));
}

inline std::string content(const std::filesystem::path& path) {
  const auto bytes = read_file(path);
  EXPECT_OK(bytes);
  return bytes.ok() ? text_of(bytes->bytes()) : std::string();
}

inline void overwrite(const std::filesystem::path& path, std::string_view bytes) {
  const auto mode = std::filesystem::status(path).permissions();
  EXPECT_OK(replace_file(path, as_bytes(bytes)));
  std::filesystem::permissions(path, mode);
}

/// A store of three entities over three days, the last of which is in its journal yet, and a vault.
class VaultFixture : public ::testing::Test {
 protected:
  VaultFixture()
      : store_(scratch_ / "store"), places_{scratch_ / "vault", scratch_ / "robot.keys"} {}

  static ltm::Snapshot snapshot(const ltm::MemoryId& entity, Time time, int64_t index) {
    const auto x = static_cast<double>(index);
    idf::Dict value{{"x", 0.25 * x},
                    {"label", "number " + std::to_string(index)},
                    {"hand", arm().at(time).to_string()}};
    if (entity == camera()) value.set("image", ltm::example_image(12, 10, 3, index));
    ltm::InstanceMetadata metadata{time, time + Duration(1), time + Duration(2), "a driver", 0.5F};
    ltm::Snapshot made{entity, time, {{value, metadata}}};
    if (entity == arm() && index % 3 == 0) made.instances.push_back(made.instances.front());
    if (entity == odd() && index % 4 == 0) {
      made.instances[0].metadata.origin = arm().at(time).instance(0);
      made.instances[0].metadata.recipe = R"({"blur": 2})";
    }
    return made;
  }

  static Time time_at(Day day, int64_t index) {
    return day_begin(day) + std::chrono::hours(2 * index) + Duration(index * 7);
  }

  static std::vector<ltm::PackedSnapshot> packed_day(const ltm::MemoryId& entity, Day day) {
    std::vector<ltm::PackedSnapshot> all;
    for (int64_t i = 0; i < kPerDay; ++i)
      all.push_back(ltm::pack_snapshot(snapshot(entity, time_at(day, i), day * 100 + i)));
    for (auto& packed : all)
      for (auto& instance : packed.instances)
        if (packed.entity == camera())
          instance.value =
              *ltm::pack(*ltm::unpack(instance.value), ltm::PackOptions{.image_codec = "zstd"});
    all.front().dropped = 3;
    all.front().dropped_bytes = 300;
    return all;
  }

  void make_store() {
    ASSERT_OK(ltm::create_store(store_));
    const auto writer = *ltm::StoreWriter::open(store_, {});
    ASSERT_OK(writer->declare(arm().parent(), arm_type()));
    for (Day day = kFirstDay; day < kFirstDay + kDays; ++day) {
      for (const auto& entity : {camera(), arm(), odd()})
        ASSERT_OK(writer->append(packed_day(entity, day), nullptr));
      if (day + 1 < kFirstDay + kDays) ASSERT_OK(writer->seal());
    }
  }

  static idf::Type arm_type() {
    using idf::Type;
    return Type::object(
        "Arm",
        {{"x", Type::float64({"m"})}, {"label", Type::string()}, {"hand", Type::memory_link()}});
  }

  Result<VaultExportReport> try_export(const std::string& query = "@ all",
                                       const std::stop_token& stop = {}) {
    ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(store_));
    ltm::Recall recall(std::move(reader), loader_);
    return export_to_vault(recall, *ltm::Query::parse(query), places_, options_, {}, stop);
  }

  VaultExportReport exported(const std::string& query = "@ all") {
    auto report = try_export(query);
    EXPECT_OK(report);
    return report.ok() ? *std::move(report) : VaultExportReport();
  }

  VaultImportReport imported(const std::filesystem::path& store) {
    auto report = import_from_vault(places_, store, {}, {});
    EXPECT_OK(report);
    return report.ok() ? *std::move(report) : VaultImportReport();
  }

  VaultCheckReport checked() {
    auto report = check_vault(places_, {}, {});
    EXPECT_OK(report);
    return report.ok() ? *std::move(report) : VaultCheckReport();
  }

  [[nodiscard]] VaultKeys keys() const {
    auto found = read_keys(places_.keys);
    EXPECT_OK(found);
    return found.ok() ? *std::move(found) : VaultKeys();
  }

  [[nodiscard]] std::filesystem::path file_of(const ltm::MemoryId& entity, Day day) const {
    return day_file(places_.vault, keys().find(entity, day)->file);
  }

  static ltm::QueryResult answers(const std::filesystem::path& store,
                                  const std::string& query = "@ all",
                                  const ltm::ModelLoader& loader = {}) {
    auto reader = ltm::StoreReader::open(store);
    EXPECT_OK(reader);
    if (!reader.ok()) return ltm::QueryResult();
    ltm::Recall recall(*std::move(reader), loader);
    auto answer = recall.query(*ltm::Query::parse(query));
    EXPECT_OK(answer);
    return answer.ok() ? *std::move(answer) : ltm::QueryResult();
  }

  static void expect_whole_store(const std::filesystem::path& store) {
    const auto report = ltm::check_store(store, {true, {}});
    ASSERT_OK(report);
    for (const ltm::Finding& finding : report->findings)
      ADD_FAILURE() << finding.file << ": " << finding.object << ": " << finding.what;
  }

  /// The names in the vault's directory.
  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(places_.vault))
      found.insert(entry.path().filename().string());
    return found;
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_;
  VaultPlaces places_;
  VaultExportOptions options_;
  ltm::ModelLoader loader_;
};

}  // namespace engram::datasets::vault
