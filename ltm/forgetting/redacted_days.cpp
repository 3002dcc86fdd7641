// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/redacted_days.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "ltm/core/file.h"
#include "ltm/core/printable.h"
#include "ltm/forgetting/erasure.h"
#include "ltm/idf/strict_json.h"
#include "ltm/store/checksum.h"

namespace engram::ltm {

namespace {

/// A report names entities and days; a larger file is none.
constexpr uint64_t kMaxReportBytes = uint64_t{256} << 20;
constexpr int kReportLevels = 6;

/// In the order of their numbers, which is that of time.
Result<std::set<std::filesystem::path>> report_files(const std::filesystem::path& store) {
  std::set<std::filesystem::path> files;
  const auto folder = store / kErasureFolder;
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) return files;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->path().extension() == ".json") files.insert(entry->path());
  if (error) return unavailable("'{}': {}", printable(folder.string()), error.message());
  return files;
}

/// Errors: kDataLoss saying what is wrong.
Status add_report(std::string_view text, RedactedDays& days) {
  const auto json = idf::parse_json(text, kReportLevels);
  if (!json.ok()) return data_loss("{}", json.status().message());
  const auto when = json->is_object() ? json->find("when_ns") : json->end();
  const auto entities = json->is_object() ? json->find("entities") : json->end();
  if (when == json->end() || !when->is_number_integer() || entities == json->end() ||
      !entities->is_array())
    return data_loss("needs a time and a list of entities");
  for (const auto& each : *entities) {
    if (!each.is_object() || !each.contains("redacted_days")) continue;
    const auto id = each.find("id");
    const auto& named = each.at("redacted_days");
    if (id == each.end() || !id->is_string() || !named.is_array())
      return data_loss("needs an entity with a list of days");
    const auto entity = MemoryId::parse(id->get<std::string>());
    if (!entity.ok()) return data_loss("{}", entity.status().message());
    for (const auto& day : named) {
      if (!day.is_string()) return data_loss("needs days as texts");
      uint64_t& mark = days[*entity][day.get<std::string>()];
      const std::array<int64_t, 2> chained{static_cast<int64_t>(mark), when->get<int64_t>()};
      mark = checksum(std::as_bytes(std::span(chained)));
    }
  }
  return {};
}

}  // namespace

std::string redacted_day(Time time) {
  const std::string text = to_string(time);
  return text.substr(0, text.find(' '));
}

Result<RedactedDays> read_redacted_days(const std::filesystem::path& store) {
  RedactedDays days;
  ENGRAM_ASSIGN_OR_RETURN(const auto files, report_files(store));
  for (const std::filesystem::path& path : files) {
    ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(path, File::Mode::kRead));
    ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
    std::string text(std::min(size, kMaxReportBytes), '\0');
    ENGRAM_RETURN_IF_ERROR(file.read_at(0, std::as_writable_bytes(std::span(text))));
    if (const Status added = add_report(text, days); !added.ok())
      return data_loss("'{}': {}; it says which days a redaction replaced originals of",
                       printable(path.string()), added.message());
  }
  return days;
}

}  // namespace engram::ltm
