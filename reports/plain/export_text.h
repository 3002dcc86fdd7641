// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "datasets/recordings/export_report.h"
#include "reports/plain/output.h"

namespace engram::reports {

/// Reports what was written and what could not be.
[[nodiscard]] Json export_json(const datasets::ExportReport& report);
void print_export(const datasets::ExportReport& report, const std::string& format,
                  const std::string& directory);

}  // namespace engram::reports
