// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/rosbag_format.h"

#include "datasets/recordings/file_format.h"
#include "datasets/rosbag/bag_export.h"
#include "datasets/rosbag/bag_plan.h"
#include "datasets/rosbag/bag_reader.h"

namespace engram::datasets {

namespace {

Result<NotHeld> not_held(ltm::Recall& recall, const ltm::Query& query,
                         const WritingOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(auto plan, rosbag::plan_export(recall, query, options));
  return std::move(plan.not_held);
}

}  // namespace

std::unique_ptr<const RecordingFormat> make_rosbag_format() {
  return make_file_format({.name = "rosbag",
                           .about = "bags of ROS 1: messages of any type, as rosbag records them",
                           .start = "#ROSBAG V",  // Opening reports a version that is not 2.0.
                           .extension = ".bag",
                           .open = rosbag::BagReader::open,
                           .not_held = not_held,
                           .write = rosbag::export_bag});
}

}  // namespace engram::datasets
