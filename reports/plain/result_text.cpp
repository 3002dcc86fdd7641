// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/result_text.h"

#include <numeric>

#include "ltm/idf/json.h"
#include "ltm/idf/layout.h"
#include "reports/plain/members_text.h"
#include "reports/plain/save.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

/// Such as "31.84 dB"; for a prediction "31.84 dB, 90 %: 28.20 dB", and for what faded from latents
/// "31.84 dB, certainly 28.20 dB": the expected error and its bound.
std::string first_error_text(const ltm::SnapshotResult& snapshot) {
  if (snapshot.instances.empty() || !snapshot.instances.front().error) return "-";
  const ltm::InstanceResult& first = snapshot.instances.front();
  const std::string bound = first.bound ? error_text(*first.bound) : "-";
  if (bound == "-") return error_text(*first.error);
  if (snapshot.source == ltm::Source::kReconstructed)
    return fmt::format("{}, certainly {}", error_text(*first.error), bound);
  return fmt::format("{}, {:.0f} %: {}", error_text(*first.error), 100 * ltm::kBoundProbability,
                     bound);
}

/// Returns the text of a value that is short enough to be shown whole, else an empty text.
std::string whole_text(const idf::Data& data) {
  constexpr size_t kLongest = 60;
  // Checked first, so that a long value is not formatted in vain.
  if (ltm::Snapshot{{}, {}, {{data, {}}}}.raw_bytes() > 4 * kLongest) return "";
  const std::string text = idf::to_json_text(data).value_or("");
  return text.size() <= kLongest ? text : "";
}

/// Returns the beginning of a value that consists of texts and the like: "{\"text\":\"Put the
/// sa...".
std::string beginning_text(const idf::Data& data) {
  constexpr size_t kLongest = 57;
  std::string text = idf::to_json_text(data).value_or("");
  if (text.size() <= kLongest) return text;
  size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  return text.substr(0, end) + "...";
}

/// Such as "image uint8 [128, 128, 3]", "52 numbers", a short value itself, or the beginning of a
/// longer one.
std::string content_text(const idf::Data& data) {
  if (std::string whole = whole_text(data); !whole.empty()) return whole;
  const idf::Layout layout = idf::Layout::of(data);
  int64_t numbers = 0;
  std::string text;
  for (const idf::TensorMember& member : layout.members()) {
    if (member.kind == idf::MemberKind::kImage)
      text += fmt::format("{}{} {} {}", text.empty() ? "" : ", ",
                          member.path.empty() ? "value" : member.path, to_string(member.type),
                          idf::to_string(member.shape));
    else
      numbers += std::accumulate(member.shape.begin(), member.shape.end(), int64_t{1},
                                 std::multiplies<>());
  }
  if (numbers > 0)
    text +=
        fmt::format("{}{} number{}", text.empty() ? "" : ", ", numbers, numbers == 1 ? "" : "s");
  return text.empty() ? beginning_text(data) : text;
}

std::string content_text(const ltm::SnapshotResult& snapshot) {
  std::string text;
  for (const ltm::InstanceResult& instance : snapshot.instances)
    text += (text.empty() ? "" : " | ") + content_text(instance.data);
  return text;
}

std::string source_text(const ltm::SnapshotResult& recalled) {
  std::string text(ltm::to_string(recalled.source));
  if (!recalled.predictor.empty())
    text += fmt::format(" {} ahead ({})", to_string(recalled.horizon), recalled.predictor);
  return text;
}

Result<Json> result_json(const ltm::QueryResult& result) {
  Json entities = Json::array();
  for (const ltm::EntityResult* entity : result.entities()) {
    Json snapshots = Json::array();
    for (const ltm::SnapshotResult& recalled : entity->snapshots) {
      ENGRAM_ASSIGN_OR_RETURN(Json snapshot, snapshot_json(entity->id, recalled));
      snapshots.push_back(std::move(snapshot));
    }
    entities.push_back({{"id", entity->id.to_string()}, {"snapshots", std::move(snapshots)}});
  }
  return Json{{"entities", std::move(entities)}};
}

void print_ids(const ltm::QueryResult& result, bool is_json) {
  Json ids = Json::array();
  for (const ltm::MemoryId& id : result.ids()) {
    if (is_json)
      ids.push_back(id.to_string());
    else
      print(id.printable());
  }
  if (is_json) print_json({{"ids", std::move(ids)}});
}

void print_result(const ltm::QueryResult& result) {
  for (const ltm::EntityResult* entity : result.entities()) {
    print(entity->id.printable());
    if (entity->snapshots.empty()) {
      print("  no snapshot matches");
      continue;
    }
    TextTable table({"time", "source", "model", "error", "content"});
    for (const ltm::SnapshotResult& recalled : entity->snapshots) {
      const size_t space = recalled.model.rfind(' ');
      table.add({to_string(recalled.time), source_text(recalled),
                 space == std::string::npos ? "-" : recalled.model.substr(space + 1),
                 first_error_text(recalled), content_text(recalled)});
    }
    print(table.to_string("  "));
    for (const ltm::SnapshotResult& recalled : entity->snapshots)
      if (const std::string members = members_text(recalled); !members.empty())
        print(fmt::format("  {} ahead: {}", to_string(recalled.horizon), members));
  }
}

Status save_result(const ltm::QueryResult& result, const std::string& directory, bool is_json) {
  size_t count = 0;
  for (const ltm::EntityResult* entity : result.entities()) {
    for (const ltm::SnapshotResult& recalled : entity->snapshots) {
      ENGRAM_ASSIGN_OR_RETURN(const auto files, save_snapshot(entity->id, recalled, directory));
      count += files.size();
    }
  }
  if (!is_json) print(fmt::format("{} files written below {}", count, directory));
  return {};
}

}  // namespace

std::string content_text(const ltm::Snapshot& snapshot) {
  std::string text;
  for (const ltm::Instance& instance : snapshot.instances)
    text += (text.empty() ? "" : " | ") + content_text(instance.data);
  return text;
}

Status show_result(const ltm::QueryResult& result, const std::string& save, bool is_json) {
  if (result.is_ids_only()) {
    print_ids(result, is_json);
  } else if (is_json) {
    ENGRAM_ASSIGN_OR_RETURN(const Json json, result_json(result));
    print_json(json);
  } else {
    print_result(result);
  }
  return save.empty() ? Status() : save_result(result, save, is_json);
}

}  // namespace engram::reports
