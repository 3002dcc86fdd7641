// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the sinks behind make_snapshot_sink.

#include "datasets/export_sink.h"

namespace engram::datasets {

std::unique_ptr<SnapshotSink> make_json_lines_sink(const std::filesystem::path& directory);
std::unique_ptr<SnapshotSink> make_csv_sink(const std::filesystem::path& directory);
std::unique_ptr<SnapshotSink> make_png_sink(const std::filesystem::path& directory);
std::unique_ptr<SnapshotSink> make_mp4_sink(const std::filesystem::path& directory,
                                            const ExportOptions& options);
std::unique_ptr<SnapshotSink> make_armarx_sink(const std::filesystem::path& directory);

}  // namespace engram::datasets
