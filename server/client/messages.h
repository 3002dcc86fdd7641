// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <engram/v1/memory.pb.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "memory/memory.h"
#include "server/client/sent_context.h"

// Private to this room.

namespace engram::server {

/// What a client asks, as messages.
[[nodiscard]] v1::QueryRequest to_request(const ltm::Query& query, const std::string& engine,
                                          std::span<const SentContext> contexts = {});
[[nodiscard]] v1::PredictionRequest to_request(const ltm::MemoryId& entity,
                                               std::span<const Duration> horizons,
                                               const PredictOptions& options);
[[nodiscard]] v1::EnginesRequest to_request(const ltm::MemoryId& entity,
                                            std::span<const Duration> horizons,
                                            std::optional<Time> at);

/// Adds one part of an answer to the parts that arrived before it.
/// Errors: that of the answer; kDataLoss if it names no entity.
Status take_part(v1::QueryReply& reply, ltm::QueryResult& answer);

/// Takes one prediction per horizon out of an answer to a v1::PredictionRequest.
/// Errors: kNotFound; kFailedPrecondition if the server is of an earlier version.
Result<std::vector<ltm::SnapshotResult>> predictions_in(const ltm::QueryResult& answer,
                                                        const ltm::MemoryId& entity,
                                                        std::span<const Duration> horizons,
                                                        const PredictOptions& options);

/// Takes one list per horizon out of an answer to a v1::EnginesRequest.
/// Errors: kFailedPrecondition if `at` is set and the server is of an earlier version.
Result<std::vector<std::vector<ltm::EngineRecord>>> engines_in(const v1::EnginesReply& reply,
                                                               const ltm::MemoryId& entity,
                                                               std::span<const Duration> horizons,
                                                               std::optional<Time> at);

}  // namespace engram::server
