// SPDX-License-Identifier: Apache-2.0
#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

Result<std::map<std::string, uint64_t, std::less<>>> RecordingFormat::not_held(
    ltm::Recall& /*recall*/, const ltm::Query& /*query*/, const WritingOptions& /*options*/) const {
  return failed_precondition("format '{}' can be read, not written", name());
}

Result<ExportReport> RecordingFormat::write(ltm::Recall& /*recall*/, const ltm::Query& /*query*/,
                                            const std::filesystem::path& /*path*/,
                                            const WritingOptions& /*options*/,
                                            const ProgressSink& /*progress*/,
                                            const std::stop_token& /*stop*/) const {
  return failed_precondition("format '{}' can be read, not written", name());
}

}  // namespace engram::datasets
