// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/export_text.h"

#include "reports/plain/text.h"

namespace engram::reports {

Json export_json(const datasets::ExportReport& report) {
  Json left_out = Json::object();
  for (const auto& [what, count] : report.not_carried) left_out[what] = count;
  return {{"snapshots", report.snapshots},
          {"instances", report.instances},
          {"files", report.files},
          {"bytes", report.bytes},
          {"not_carried", std::move(left_out)}};
}

void print_export(const datasets::ExportReport& report, const std::string& format,
                  const std::string& directory) {
  print(fmt::format("{} snapshots with {} instances: {} files, {}, below {}",
                    count_text(report.snapshots), count_text(report.instances),
                    count_text(report.files), bytes_text(static_cast<double>(report.bytes)),
                    directory));
  if (!report.not_carried.empty()) print(fmt::format("Left out, as {} does not carry it:", format));
  for (const auto& [what, count] : report.not_carried)
    print(fmt::format("  {:>10}  {}", count_text(count), what));
}

}  // namespace engram::reports
