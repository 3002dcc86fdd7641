// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::testing {

/// One line with a number: its name, its labels and the number.
struct PrometheusSample {
  std::string name;
  std::map<std::string, std::string> labels;
  double number = 0;
};

struct PrometheusFamily {
  std::string help;
  std::string kind;
  std::vector<PrometheusSample> samples;
};

/// Reads Prometheus's text format 0.0.4 as strictly as it is written: each family once, with HELP,
/// TYPE and then its samples, no label and no sample twice, buckets that add up.
/// Errors: kInvalidArgument naming the line.
Result<std::map<std::string, PrometheusFamily>> read_prometheus_text(std::string_view text);

}  // namespace engram::testing
