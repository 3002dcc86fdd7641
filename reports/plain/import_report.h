// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "datasets/recordings/import_recording.h"
#include "ltm/recording/recorder.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Prints the streams of a recording and what becomes of them, as a table or as JSON.
void show_streams(std::string_view format, const std::vector<datasets::RecordingStream>& streams,
                  bool is_json);

/// Reports what an import read and what the recorder made of it.
[[nodiscard]] Json import_json(const datasets::RecordingImportReport& report,
                               const ltm::Recorder& recorder);
void print_import(const datasets::RecordingImportReport& report, const ltm::Recorder& recorder);

}  // namespace engram::reports
