// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/compact_text.h"

#include "reports/plain/text.h"

namespace engram::reports {

Json compact_json(const ltm::RewriteReport& report) {
  return {{"segments_before", report.segments_before},
          {"segments_after", report.segments_after},
          {"bytes_before", report.bytes_before},
          {"bytes_after", report.bytes_after},
          {"is_cancelled", report.is_cancelled}};
}

std::string compact_text(const ltm::RewriteReport& report) {
  if (report.segments_before == 0) return "There is nothing to join";
  return fmt::format("{} segments became {}: {} before, {} after",
                     count_text(report.segments_before), count_text(report.segments_after),
                     bytes_text(static_cast<double>(report.bytes_before)),
                     bytes_text(static_cast<double>(report.bytes_after)));
}

}  // namespace engram::reports
