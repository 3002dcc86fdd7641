// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "store/scale_object.h"

namespace engram::experiments {

/// Opens the store cold and asks it the questions of a robot. Each question is asked `queries`
/// times at random moments, in two rounds: "cold", with nothing of the store in the system's cache,
/// and "warm", the same questions again. Every answer is compared with the world, outside of the
/// timing.
///
/// Returns "open_seconds" and "memory_bytes", and the latencies of both rounds per question.
/// Errors: those of StoreReader and Recall; kDataLoss naming the question with a wrong answer.
Result<nlohmann::json> read_scale(const ScaleWorld& world, const std::filesystem::path& store,
                                  int queries);

}  // namespace engram::experiments
