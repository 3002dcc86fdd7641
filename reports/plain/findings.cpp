// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/findings.h"

#include <string_view>

#include "ltm/core/printable.h"
#include "reports/plain/text.h"

namespace engram::reports {

namespace {

std::string_view name_of(ltm::Severity severity) {
  return severity == ltm::Severity::kFault ? "fault" : "note";
}

void print_finding(const ltm::Finding& finding) {
  print(fmt::format("{}: {}{}{}", name_of(finding.severity), printable(finding.file),
                    finding.object.empty() ? "" : ": ", printable(finding.object)));
  print("  what    " + printable(finding.what));
  print("  to do   " + printable(finding.advice) + "\n");
}

}  // namespace

Json findings_json(const std::vector<ltm::Finding>& findings) {
  Json json = Json::array();
  for (const ltm::Finding& finding : findings)
    json.push_back({{"severity", name_of(finding.severity)},
                    {"file", finding.file},
                    {"object", finding.object},
                    {"what", finding.what},
                    {"advice", finding.advice}});
  return json;
}

Json check_json(const ltm::CheckReport& report, const std::string& store) {
  return {{"store", store},
          {"clean", report.is_clean()},
          {"generation", report.generation},
          {"segments", report.segments},
          {"models", report.models},
          {"journals", report.journals},
          {"frames", report.frames},
          {"entities", report.entities},
          {"snapshots", report.snapshots},
          {"instances", report.instances},
          {"media", report.media},
          {"bytes", report.bytes},
          {"unknown_ends", report.unknown_ends},
          {"findings", findings_json(report.findings)}};
}

void print_findings(const std::vector<ltm::Finding>& findings) {
  for (const ltm::Severity severity : {ltm::Severity::kFault, ltm::Severity::kNote})
    for (const ltm::Finding& finding : findings)
      if (finding.severity == severity) print_finding(finding);
}

void print_check(const ltm::CheckReport& report, const std::string& store) {
  print_findings(report.findings);
  print(
      fmt::format("Checked {}: {} segments, {} models, {} journals; {} entities, {} snapshots, {} "
                  "media, {} unsealed frames; {}",
                  store, report.segments, report.models, report.journals, report.entities,
                  count_text(report.snapshots), count_text(report.media), count_text(report.frames),
                  bytes_text(static_cast<double>(report.bytes))));
  if (!report.is_clean())
    print(fmt::format("{} faults: data is damaged or lost.", report.faults()));
  else if (report.unknown_ends > 0)
    print(
        "What is there is whole. Whether something is missing at the end is not known: see above.");
  else
    print("It is whole.");
}

}  // namespace engram::reports
