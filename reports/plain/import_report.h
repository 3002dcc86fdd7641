// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "datasets/recordings/import_recording.h"
#include "datasets/video_table.h"
#include "ltm/recording/recorder.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// What an import did, and what became of it in the recorder.
[[nodiscard]] Json import_json(const datasets::ImportReport& report, const ltm::Recorder& recorder);
[[nodiscard]] Json import_json(const datasets::RecordingImportReport& report,
                               const ltm::Recorder& recorder);

void print_import(const datasets::ImportReport& report, const ltm::Recorder& recorder);
void print_import(const datasets::RecordingImportReport& report, const ltm::Recorder& recorder);

}  // namespace engram::reports
