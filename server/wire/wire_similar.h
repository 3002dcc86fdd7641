// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include "ltm/likeness/similar_moments.h"

namespace engram::server {

/// The bounds of what may be asked of a server.
inline constexpr uint64_t kMaxSimilarMoments = 10'000;
inline constexpr int kMaxSimilarParts = 16;

/// A question about likeness, as a client sends it.
/// Errors: kInvalidArgument if it does not validate.
Result<v1::SimilarRequest> to_message(const ltm::SimilarRequest& request);

/// Reads what to_message() wrote; safe on hostile messages.
/// Errors: kInvalidArgument naming what was found and what is needed.
Result<ltm::SimilarRequest> to_request(const v1::SimilarRequest& message);

[[nodiscard]] v1::SimilarReply to_message(const ltm::SimilarAnswer& answer);

/// Reads an answer about an entity.
[[nodiscard]] ltm::SimilarAnswer to_answer(const v1::SimilarReply& message,
                                           const ltm::MemoryId& entity);

}  // namespace engram::server
