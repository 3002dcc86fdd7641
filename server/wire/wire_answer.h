// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "ltm/recall/answer.h"
#include "server/wire/wire_writer.h"

namespace engram::server {

/// Writes an answer as v1::QueryReply messages of about `part_bytes` each and passes each to
/// `send`. If `is_last`, the last one is marked as that of the whole answer.
/// Errors: kInvalidArgument if a value nests too deep; no message is marked as the last then.
Status write_answer(uint64_t number, const ltm::Answer& answer, size_t part_bytes,
                    bool is_last, const std::function<void(const WireBytes&)>& send);

}  // namespace engram::server
