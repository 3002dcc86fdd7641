// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "datasets/export_sink.h"
#include "ltm/core/progress.h"
#include "ltm/recall/recall.h"

namespace engram::datasets {

/// Makes `directory` ready to be written into.
/// Errors: kAlreadyExists where it is a file, or not empty and `may_have_files` is false;
/// kUnavailable.
Status prepare_export(const std::filesystem::path& directory, bool may_have_files);

/// Hands everything that a query asks for to a sink, snapshot by snapshot: memory is bounded by the
/// largest one. Latents are decoded by `recall`. Where `stop` is asked for, what was handed over
/// until then is finished: all files are whole.
/// Errors: kNotFound where no entity matches; kInvalidArgument where the query asks for IDs alone;
/// kCancelled after a stop; those of Recall::query and of the sink.
Status export_snapshots(ltm::Recall& recall, const ltm::Query& query,
                        const ltm::Recall::Options& options, SnapshotSink& sink,
                        const ProgressSink& progress = {}, const std::stop_token& stop = {});

}  // namespace engram::datasets
