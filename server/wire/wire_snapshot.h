// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include "ltm/memory/commit.h"
#include "ltm/memory/result.h"
#include "ltm/working/held_snapshot.h"
#include "server/wire/wire_writer.h"

namespace engram::server {

/// Writes a snapshot of working memory as the body of a v1::Snapshot; without data, only what names
/// it. Data that arrived encoded are shared, not copied.
[[nodiscard]] WireBytes to_wire(const ltm::HeldSnapshot& snapshot, bool with_data);

/// Like to_wire(), with the data of each instance in a block, at its offset of `offsets`.
[[nodiscard]] WireBytes to_wire_in_block(const ltm::HeldSnapshot& snapshot, const v1::Block& block,
                                         const std::vector<uint64_t>& offsets);

/// Writes one snapshot of an answer. `encoded` holds the encoded data of the instances; if it is
/// null, the data are encoded here.
/// Errors: kInvalidArgument if a value nests too deep.
Result<WireBytes> to_wire(const ltm::SnapshotResult& snapshot, bool with_data,
                          const std::vector<Buffer>* encoded = nullptr);

/// A received commit: its values, and the encoded bytes of each.
struct WireCommit {
  ltm::Commit commit;
  std::vector<std::vector<Buffer>> encoded;
};

/// Moves the bytes out of the messages; arrays view them. `block` is the shared memory that holds
/// the updates' data, if any do. Safe on hostile messages.
/// Errors: kInvalidArgument naming the update; kDataLoss if data cannot be decoded.
Result<WireCommit> take_commit(v1::CommitRequest& request, const Buffer& block);

/// Reads an event or a snapshot of an answer, in the same way as take_commit().
Result<ltm::Snapshot> take_snapshot(v1::Snapshot& message, const Buffer& block);
Result<ltm::SnapshotResult> take_answer(v1::Snapshot& message, const Buffer& block);

/// Converts an update to a message with encoded data.
Result<v1::Snapshot> to_message(const ltm::Snapshot& snapshot);

/// Sets the entity and time of an update, or the metadata of an instance.
void set_head(v1::Snapshot& message, const ltm::Snapshot& snapshot);
void set_metadata(v1::Instance& message, const ltm::InstanceMetadata& metadata);

[[nodiscard]] v1::Error to_message(const ltm::MeasuredError& error);
[[nodiscard]] v1::MemberPrediction to_message(const ltm::MemberPrediction& member);
[[nodiscard]] ltm::MemberPrediction to_member(const v1::MemberPrediction& message);
[[nodiscard]] ltm::MeasuredError to_error(const v1::Error& message);

[[nodiscard]] v1::Outcome to_outcome(const Status& status);
[[nodiscard]] Status to_status(const v1::Outcome& outcome);

}  // namespace engram::server
