// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "ltm/core/progress.h"
#include "ltm/core/time.h"

namespace engram::datasets::vault {

/// Tells how much of a known amount of work is done, and how long the rest will take at the same
/// pace.
///
/// Threading: one thread. The sink must outlive it.
class WorkProgress {
 public:
  WorkProgress(std::string what, const ProgressSink& sink) : what_(std::move(what)), sink_(sink) {}

  void begin(uint64_t total);
  void add(uint64_t done, const std::string& detail);
  void end();

 private:
  void tell(const std::string& detail) const;

  std::string what_;
  const ProgressSink& sink_;
  uint64_t total_ = 0;
  uint64_t done_ = 0;
  uint64_t told_ = 0;
  SteadyTime begin_{};
};

}  // namespace engram::datasets::vault
