// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>

#include "ltm/context/segment_contexts.h"
#include "ltm/recall/model.h"

namespace engram::ltm {

/// Makes the index of places and links of each segment of a store that has none, see
/// index_contexts(). `is_over` is asked before each segment; empty: there is time for all.
/// Errors: those of StoreReader::open and index_contexts().
Result<ContextIndexing> index_store(const std::filesystem::path& store, const ModelLoader& loader,
                                    const std::function<bool()>& is_over,
                                    const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::ltm
