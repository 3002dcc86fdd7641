// SPDX-License-Identifier: Apache-2.0
#include "ltm/forgetting/pending_redaction.h"

#include <nlohmann/json.hpp>

#include "ltm/core/file.h"
#include "ltm/idf/strict_json.h"

namespace engram::ltm {

namespace {

constexpr const char* kPendingFile = "erasures/redaction.pending";

Status damaged_pending(const std::filesystem::path& file, std::string_view what) {
  return data_loss("'{}': {}; it says which originals a redaction has still to take", file.string(),
                   what);
}

}  // namespace

Result<ForgetSet> read_pending_redaction(const std::filesystem::path& store) {
  ForgetSet pending;
  const std::filesystem::path path = store / kPendingFile;
  const auto file = File::open(path, File::Mode::kRead);
  if (file.status().code() == StatusCode::kNotFound) return pending;
  ENGRAM_RETURN_IF_ERROR(file.status());
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file->size());
  std::string text(size, '\0');
  ENGRAM_RETURN_IF_ERROR(file->read_at(0, std::as_writable_bytes(std::span(text))));
  const auto json = idf::parse_json(text, 3);
  if (!json.ok()) return damaged_pending(path, json.status().message());
  if (!json->is_object()) return damaged_pending(path, "needs an object");
  for (const auto& [name, times] : json->items()) {
    const auto entity = MemoryId::parse(name);
    if (!entity.ok() || !entity->is_entity() || !times.is_array())
      return damaged_pending(path, "needs lists of times by entity");
    std::vector<Time> all;
    for (const auto& time : times) {
      if (!time.is_number_integer()) return damaged_pending(path, "found a time that is none");
      all.push_back(time_from_ns(time.get<int64_t>()));
    }
    pending[*entity] = TimeSet(std::move(all));
  }
  return pending;
}

Status write_pending_redaction(const std::filesystem::path& store, const ForgetSet& pending) {
  const std::filesystem::path path = store / kPendingFile;
  std::error_code failed;
  if (pending.empty()) {
    if (!std::filesystem::exists(path, failed)) return {};
    return remove_file(path);
  }
  std::filesystem::create_directories(path.parent_path(), failed);
  if (failed) return unavailable("'{}': {}", path.parent_path().string(), failed.message());
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [entity, times] : pending) {
    auto& list = json[entity.to_string()] = nlohmann::ordered_json::array();
    for (const Time time : times) list.push_back(to_ns(time));
  }
  const std::string text = json.dump() + "\n";
  return replace_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace engram::ltm
