// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/bag_export.h"

#include "datasets/rosbag/bag_plan.h"
#include "datasets/rosbag/bag_writer.h"

namespace engram::datasets::rosbag {

namespace {

class Export {
 public:
  Export(ExportPlan plan, BagWriter writer, int jpeg_quality)
      : plan_(std::move(plan)), writer_(std::move(writer)), jpeg_quality_(jpeg_quality) {
    for (const auto& [entity, planned] : plan_.connections) writer_.add(planned.connection);
  }

  Result<ExportReport> run(const ExportRequest& request) {
    const auto write = [this](const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot) {
      const auto planned = plan_.connections.find(entity);
      return planned == plan_.connections.end() ? Status() : put(planned->second, entity, snapshot);
    };
    ENGRAM_RETURN_IF_ERROR(write_snapshots(request, "rosbag", report_, write));
    ENGRAM_ASSIGN_OR_RETURN(report_.bytes, writer_.close());
    report_.files = 1;
    return report_;
  }

 private:
  Status put(const PlannedConnection& planned, const ltm::MemoryId& entity,
             const ltm::SnapshotResult& snapshot) {
    const ltm::InstanceResult* instance = message_instance(snapshot, report_);
    if (instance == nullptr) return {};
    const auto time = static_cast<uint64_t>(to_ns(snapshot.time));
    if (time >= kEndOfTime) {
      ++report_.not_carried["values from 2106 on"];
      return {};
    }
    const auto bytes =
        planned.coder.encode(instance->data, instance->metadata.created, jpeg_quality_);
    if (!bytes.ok()) {
      tell_misfit(entity, report_);
      return {};
    }
    if (bytes->size() > BagWriter::kMaxMessageBytes) {
      ++report_.not_carried["values of more than 256 MiB"];
      return {};
    }
    ++report_.instances;
    return writer_.write({planned.connection.id, time, *bytes});
  }

  ExportPlan plan_;
  BagWriter writer_;
  int jpeg_quality_;
  ExportReport report_;
};

}  // namespace

Result<ExportReport> export_bag(const ExportRequest& request, const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(ExportPlan plan,
                          plan_export(request.recall, request.query, request.options));
  ENGRAM_ASSIGN_OR_RETURN(BagWriter writer, BagWriter::create(path, {}));
  Export bag(std::move(plan), std::move(writer), request.options.jpeg_quality);
  return bag.run(request);
}

}  // namespace engram::datasets::rosbag
