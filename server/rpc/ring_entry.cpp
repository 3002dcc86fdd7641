// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/ring_entry.h"

#include <algorithm>
#include <vector>

namespace engram::server {

namespace {

/// Smaller data are told by plain bytes, for which a block would be waste.
constexpr size_t kMinBlockBytes = size_t{16} << 10;

constexpr uint64_t aligned_in_block(uint64_t bytes) {
  return (bytes + 7) / 8 * 8;
}

Status overwritten(const SensoryEntry& entry) {
  return not_found("entry {} was overwritten", entry.sequence);
}

}  // namespace

Result<v1::CommitRequest> read_ring_head(const SensoryRingReader& reader, const SensoryEntry& entry,
                                         size_t& budget) {
  if (entry.head_bytes > kMaxHeadBytes || entry.head_bytes > budget)
    return data_loss("found a head of {} bytes, needs at most {}", entry.head_bytes,
                     std::min<uint64_t>(kMaxHeadBytes, budget));
  budget -= entry.head_bytes;
  std::vector<std::byte> head(entry.head_bytes);
  if (!reader.copy(entry, entry.data_bytes, head)) return overwritten(entry);
  v1::CommitRequest message;
  if (!message.ParseFromArray(head.data(), static_cast<int>(head.size())))
    return data_loss("found a head that is no message");
  return message;
}

Result<Buffer> copy_ring_data(RpcContext& context, const std::string& memory,
                              const SensoryRingReader& reader, const SensoryEntry& entry,
                              v1::CommitRequest& message, size_t& budget) {
  uint64_t bytes = 0;
  for (const v1::Snapshot& update : message.updates())
    for (const v1::Instance& instance : update.instances()) {
      const v1::Span& span = instance.shared();
      if (!instance.has_shared() || span.offset() > entry.data_bytes ||
          span.size() > entry.data_bytes - span.offset() || span.size() > budget)
        return data_loss("found {} bytes at {} of an entry's data, which have {}", span.size(),
                         span.offset(), entry.data_bytes);
      budget -= span.size();
      bytes += aligned_in_block(span.size());
    }
  // What others may map must hold nothing that is redacted later.
  std::optional<SharedSessions::OwnBlock> block;
  if (bytes >= kMinBlockBytes && !context.service.may_redact_in(memory)) {
    auto leased = context.sharing->lease_own(memory, bytes);
    if (leased.ok()) block = *leased;
  }
  std::shared_ptr<std::byte[]> own;
  if (!block) own = std::make_shared_for_overwrite<std::byte[]>(bytes);
  const std::span<std::byte> to =
      block ? block->bytes : std::span<std::byte>(own.get(), static_cast<size_t>(bytes));
  uint64_t at = 0;
  bool is_whole = true;
  for (v1::Snapshot& update : *message.mutable_updates())
    for (v1::Instance& instance : *update.mutable_instances()) {
      v1::Span& span = *instance.mutable_shared();
      is_whole = is_whole && reader.copy(entry, span.offset(), to.subspan(at, span.size()));
      span.set_offset(at);
      at += aligned_in_block(span.size());
    }
  if (is_whole && block) return context.sharing->commit_own(memory, *block);
  if (is_whole) return Buffer(own, to);
  if (block) context.sharing->abandon_own(*block);
  return overwritten(entry);
}

}  // namespace engram::server
