// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "store/scale_object.h"

namespace engram::experiments {

/// Opens the store cold and asks it what a robot asks, each question so many times at random, in
/// two rounds: "cold", where the system had nothing of the store in its cache, and "warm", the same
/// questions again. Every answer is compared with the world, outside of the timing.
///
/// Gives "open_seconds" and "memory_bytes", and per question both rounds' latencies.
/// Errors: those of StoreReader and Recall; kDataLoss naming the question that was answered wrong.
Result<nlohmann::json> read_scale(const ScaleWorld& world, const std::filesystem::path& store,
                                  int queries);

}  // namespace engram::experiments
