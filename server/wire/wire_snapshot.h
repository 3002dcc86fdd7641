// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include "ltm/memory/commit.h"
#include "ltm/memory/result.h"
#include "ltm/working/held_snapshot.h"
#include "server/wire/wire_writer.h"

namespace engram::server {

/// A snapshot of working memory as the body of a v1::Snapshot; without data only what names it.
/// The bytes as which data came are shared.
[[nodiscard]] WireBytes to_wire(const ltm::HeldSnapshot& snapshot, bool with_data);

/// The same with its data elsewhere: in a block, each instance from one of `offsets` on.
[[nodiscard]] WireBytes to_wire_in_block(const ltm::HeldSnapshot& snapshot, const v1::Block& block,
                                         const std::vector<uint64_t>& offsets);

/// One moment of an answer. Without `encoded` data are encoded here; else these are the bytes of
/// the instances.
/// Errors: kInvalidArgument where a value nests too deep.
Result<WireBytes> to_wire(const ltm::SnapshotResult& snapshot, bool with_data,
                          const std::vector<Buffer>* encoded = nullptr);

/// A commit as it came: values, and the bytes of each.
struct WireCommit {
  ltm::Commit commit;
  std::vector<std::vector<Buffer>> encoded;
};

/// Takes the bytes out of the messages; arrays view them. `block`: the shared memory that the
/// updates lie in, if any of them does. Safe on hostile messages.
/// Errors: kInvalidArgument naming the update; kDataLoss where data cannot be decoded.
Result<WireCommit> take_commit(v1::CommitRequest& request, const Buffer& block);

/// Reads an event or a moment of an answer in the same way. `entity`: what it is of where it does
/// not say so itself.
Result<ltm::Snapshot> take_snapshot(v1::Snapshot& message, const Buffer& block);
Result<ltm::SnapshotResult> take_answer(v1::Snapshot& message, const Buffer& block);

/// An update as a message, data encoded.
Result<v1::Snapshot> to_message(const ltm::Snapshot& snapshot);

/// Entity and time of an update; what an instance says of itself beside its data.
void set_head(v1::Snapshot& message, const ltm::Snapshot& snapshot);
void set_metadata(v1::Instance& message, const ltm::InstanceMetadata& metadata);

[[nodiscard]] v1::Error to_message(const ltm::MeasuredError& error);
[[nodiscard]] v1::MemberPrediction to_message(const ltm::MemberPrediction& member);
[[nodiscard]] ltm::MemberPrediction to_member(const v1::MemberPrediction& message);
[[nodiscard]] ltm::MeasuredError to_error(const v1::Error& message);

[[nodiscard]] v1::Outcome to_outcome(const Status& status);
[[nodiscard]] Status to_status(const v1::Outcome& outcome);

}  // namespace engram::server
