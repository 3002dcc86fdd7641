// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_format.h"

#include "datasets/mcap/mcap_export.h"
#include "datasets/mcap/mcap_plan.h"
#include "datasets/mcap/mcap_reader.h"
#include "datasets/recordings/file_format.h"

namespace engram::datasets {

namespace {

Result<NotHeld> not_held(ltm::Recall& recall, const ltm::Query& query,
                         const WritingOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(auto plan, mcap::plan_export(recall, query, options));
  return std::move(plan.not_held);
}

}  // namespace

std::unique_ptr<const RecordingFormat> make_mcap_format() {
  return make_file_format(
      {.name = "mcap",
       .about = "MCAP: messages of ROS 2, ROS 1 and others, as rosbag2 records them",
       .start = mcap::kMagic,
       .extension = ".mcap",
       .open = mcap::McapReader::open,
       .not_held = not_held,
       .write = mcap::export_mcap});
}

}  // namespace engram::datasets
