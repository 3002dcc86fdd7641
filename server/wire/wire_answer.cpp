// SPDX-License-Identifier: Apache-2.0
#include "server/wire/wire_answer.h"

#include "server/wire/wire_snapshot.h"

namespace engram::server {

namespace {

Result<WireBytes> snapshot_bytes(const ltm::RecalledSnapshot& served, bool with_data) {
  if (!with_data || !served.held || served.held->encoded.empty() ||
      served.answer.source != ltm::Source::kRecorded)
    return to_wire(served.answer, with_data);
  std::vector<Buffer> encoded;
  encoded.reserve(served.answer.instances.size());
  for (const ltm::InstanceResult& instance : served.answer.instances)
    encoded.push_back(served.held->encoded[static_cast<size_t>(instance.index)]);
  return to_wire(served.answer, with_data, &encoded);
}

}  // namespace

Status write_answer(uint64_t number, const ltm::Answer& answer, size_t part_bytes,
                    bool is_last, const std::function<void(const WireBytes&)>& send) {
  WireWriter part;
  WireWriter entity;
  const auto begin_part = [&] { part.field(v1::QueryReply::kNumberFieldNumber, number); };
  const auto begin_entity = [&](const ltm::RecalledEntity& one) {
    entity.field(v1::EntityAnswer::kEntityFieldNumber, one.id.to_string());
  };
  begin_part();
  for (const ltm::RecalledEntity& one : answer.entities) {
    begin_entity(one);
    for (const ltm::RecalledSnapshot& snapshot : one.snapshots) {
      if (part.size() + entity.size() > part_bytes) {
        part.field(v1::QueryReply::kEntitiesFieldNumber, entity.take());
        send(part.take());
        begin_part();
        begin_entity(one);
      }
      ENGRAM_ASSIGN_OR_RETURN(const WireBytes bytes, snapshot_bytes(snapshot, !answer.is_ids_only));
      entity.field(v1::EntityAnswer::kSnapshotsFieldNumber, bytes);
    }
    part.field(v1::QueryReply::kEntitiesFieldNumber, entity.take());
  }
  if (is_last) part.field(v1::QueryReply::kIsLastFieldNumber, uint64_t{1});
  send(part.take());
  return {};
}

}  // namespace engram::server
