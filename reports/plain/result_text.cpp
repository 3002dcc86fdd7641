// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/result_text.h"

#include <numeric>

#include "ltm/core/printable.h"
#include "ltm/core/utf8.h"
#include "ltm/idf/json.h"
#include "ltm/idf/layout.h"
#include "reports/plain/members_text.h"
#include "reports/plain/save.h"

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
  return text.size() <= kLongest ? text : std::string(cut_utf8(text, kLongest)) + "...";
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

}  // namespace

std::string content_text(const ltm::Snapshot& snapshot) {
  std::string text;
  for (const ltm::Instance& instance : snapshot.instances)
    text += (text.empty() ? "" : " | ") + content_text(instance.data);
  return text;
}

ResultWriter::ResultWriter(std::string save, bool is_json)
    : save_(std::move(save)), is_json_(is_json) {}

Status ResultWriter::add(const ltm::QueryResult& part) {
  if (part.is_ids_only()) {
    for (const ltm::MemoryId& id : part.ids()) add_id(id);
    return {};
  }
  for (const ltm::EntityResult* entity : part.entities()) {
    if (!entity_ || *entity_ != entity->id) begin(entity->id);
    ENGRAM_RETURN_IF_ERROR(is_json_ ? add_json(*entity) : add_rows(*entity));
    snapshots_ += entity->snapshots.size();
    if (save_.empty()) continue;
    for (const ltm::SnapshotResult& recalled : entity->snapshots) {
      ENGRAM_ASSIGN_OR_RETURN(const auto files, save_snapshot(entity->id, recalled, save_));
      files_ += files.size();
    }
  }
  return {};
}

void ResultWriter::finish(bool is_ids_only) {
  end();
  if (is_json_) {
    if (is_begun_)
      fmt::print("\n  ]\n}}\n");
    else
      print_json({{is_ids_only ? "ids" : "entities", Json::array()}});
  } else if (!save_.empty()) {
    print(fmt::format("{} files written below {}", files_, save_));
  }
}

void ResultWriter::begin(const ltm::MemoryId& entity) {
  end();
  entity_ = entity;
  snapshots_ = 0;
  table_ = TextTable({"time", "source", "model", "error", "content"});
  if (is_json_)
    add_text("entities", fmt::format("{{\n      \"id\": {},\n      \"snapshots\": [",
                                     Json(entity.to_string()).dump()));
  else
    print(entity.printable());
}

void ResultWriter::end() {
  if (!entity_) return;
  if (is_json_)
    fmt::print("{}]\n    }}", snapshots_ == 0 ? "" : "\n      ");
  else if (snapshots_ == 0)
    print("  no snapshot matches");
  entity_.reset();
}

/// Adds an element of the outermost list.
void ResultWriter::add_text(const char* list, const std::string& json) {
  if (!is_begun_) fmt::print("{{\n  \"{}\": [", list);
  fmt::print("{}\n    {}", is_begun_ ? "," : "", printable_json(json));
  is_begun_ = true;
}

void ResultWriter::add_id(const ltm::MemoryId& id) {
  if (is_json_)
    add_text("ids", Json(id.to_string()).dump());
  else
    print(id.printable());
}

Status ResultWriter::add_json(const ltm::EntityResult& entity) {
  constexpr const char* kIndent = "\n        ";
  bool is_first = snapshots_ == 0;
  for (const ltm::SnapshotResult& recalled : entity.snapshots) {
    ENGRAM_ASSIGN_OR_RETURN(const Json json, snapshot_json(entity.id, recalled));
    std::string text;
    for (const char c : json.dump(2)) text += c == '\n' ? kIndent : std::string(1, c);
    fmt::print("{}{}{}", is_first ? "" : ",", kIndent, printable_json(text));
    is_first = false;
  }
  return {};
}

Status ResultWriter::add_rows(const ltm::EntityResult& entity) {
  if (entity.snapshots.empty()) return {};
  for (const ltm::SnapshotResult& recalled : entity.snapshots) {
    const size_t space = recalled.model.rfind(' ');
    table_.add({to_string(recalled.time), source_text(recalled),
                space == std::string::npos ? "-" : recalled.model.substr(space + 1),
                first_error_text(recalled), content_text(recalled)});
  }
  print(table_.take("  "));
  for (const ltm::SnapshotResult& recalled : entity.snapshots)
    if (const std::string members = members_text(recalled); !members.empty())
      print(fmt::format("  {} ahead: {}", to_string(recalled.horizon), members));
  return {};
}

}  // namespace engram::reports
