// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "datasets/export_sink.h"
#include "ltm/core/progress.h"
#include "ltm/recall/recall.h"

namespace engram::datasets {

/// Prepares `directory` for writing.
/// Errors: kAlreadyExists if it is a file, or is not empty and `may_have_files` is false;
/// kUnavailable.
Status prepare_export(const std::filesystem::path& directory, bool may_have_files);

/// Passes everything that a query selects to a sink, snapshot by snapshot, so memory is bounded by
/// the largest snapshot. Latents are decoded by `recall`. After a stop request, the snapshots that
/// were passed so far are finished: all files are complete.
/// Errors: kNotFound if no entity matches; kInvalidArgument if the query asks only for IDs;
/// kCancelled after a stop; those of Recall::query and of the sink.
Status export_snapshots(ltm::Recall& recall, const ltm::Query& query,
                        const ltm::Recall::Options& options, SnapshotSink& sink,
                        const ProgressSink& progress = {}, const std::stop_token& stop = {});

}  // namespace engram::datasets
