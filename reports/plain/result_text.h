// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "ltm/memory/result.h"
#include "reports/plain/output.h"
#include "reports/plain/text.h"

namespace engram::reports {

/// Describes what a snapshot holds: "image uint8 [128, 128, 3]", "52 numbers", or a short value
/// itself.
[[nodiscard]] std::string content_text(const ltm::Snapshot& snapshot);

/// Prints the parts of an answer as they come (Memory::query_parts), as tables or as JSON, so that
/// an answer of any size takes little memory. A non-empty `save` names a folder below which its
/// data are written.
///
/// Threading: one thread.
class ResultWriter {
 public:
  ResultWriter(std::string save, bool is_json);

  /// Errors: those of snapshot_json and save_snapshot.
  Status add(const ltm::QueryResult& part);

  /// Call it after the last part.
  void finish(bool is_ids_only);

 private:
  void begin(const ltm::MemoryId& entity);
  void end();
  void add_text(const char* list, const std::string& json);
  void add_id(const ltm::MemoryId& id);
  Status add_json(const ltm::EntityResult& entity);
  Status add_rows(const ltm::EntityResult& entity);

  const std::string save_;
  const bool is_json_;
  bool is_begun_ = false;                ///< The outermost list has an element.
  std::optional<ltm::MemoryId> entity_;  ///< The one at hand.
  size_t snapshots_ = 0;                 ///< Of it.
  TextTable table_{{}};
  size_t files_ = 0;
};

}  // namespace engram::reports
