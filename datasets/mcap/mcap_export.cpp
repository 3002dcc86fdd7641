// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_export.h"

#include <algorithm>

#include "datasets/mcap/mcap_plan.h"
#include "datasets/mcap/mcap_writer.h"
#include "datasets/recordings/merged_snapshots.h"
#include "datasets/recordings/stored_streams.h"
#include "datasets/recordings/text_value.h"

namespace engram::datasets::mcap {

namespace {

constexpr uint64_t kValuesPerProgress = 16;

class Export {
 public:
  Export(ExportPlan plan, McapWriter writer, const WritingOptions& options,
         const ProgressSink& progress)
      : plan_(std::move(plan)), writer_(std::move(writer)), options_(options), progress_(progress) {
    for (const SchemaRecord& schema : plan_.schemas) writer_.add(schema);
    for (const auto& [entity, planned] : plan_.channels) writer_.add(planned.channel);
  }

  Result<ExportReport> run(MergedSnapshots& snapshots, const std::stop_token& stop) {
    for (const MetadataRecord& metadata : plan_.metadata)
      ENGRAM_RETURN_IF_ERROR(writer_.write(metadata));
    while (true) {
      if (stop.stop_requested()) return cancelled("stopped after {} values", report_.snapshots);
      ENGRAM_ASSIGN_OR_RETURN(const auto item, snapshots.next());
      if (!item) break;
      if (is_description(item->entity)) continue;
      ENGRAM_RETURN_IF_ERROR(write(item->entity, item->snapshot));
      tell(item->snapshot.time);
    }
    ENGRAM_ASSIGN_OR_RETURN(report_.bytes, writer_.close());
    report_.files = 1;
    return report_;
  }

 private:
  Status write(const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot) {
    ++report_.snapshots;
    if (plan_.attachments.contains(entity)) return write_attachment(entity, snapshot);
    const auto planned = plan_.channels.find(entity);
    if (planned == plan_.channels.end() || snapshot.instances.empty()) return {};
    if (snapshot.instances.size() > 1)
      report_.not_carried["instances beyond the first of a snapshot"] +=
          snapshot.instances.size() - 1;
    if (to_ns(snapshot.time) < 0) {
      ++report_.not_carried["values before 1970"];
      return {};
    }
    const ltm::InstanceResult& first = snapshot.instances.front();
    const auto bytes = planned->second.coder.encode(first.data, options_.jpeg_quality);
    if (!bytes.ok()) {
      ++report_.not_carried[fmt::format("values of '{}' that are no messages of its type",
                                        entity.to_string())];
      return {};
    }
    ++report_.instances;
    const uint16_t id = planned->second.channel.id;
    const auto log_time = static_cast<uint64_t>(to_ns(snapshot.time));
    const auto sent = static_cast<uint64_t>(std::max<int64_t>(to_ns(first.metadata.sent), 0));
    return writer_.write(MessageRecord{id, sequences_[id]++, log_time, sent, *bytes});
  }

  Status write_attachment(const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot) {
    const ltm::InstanceResult* first = snapshot.find(0);
    const idf::Data* data = first == nullptr ? nullptr : first->data.at("data");
    if (data == nullptr || !data->is<idf::NdArray>() || to_ns(snapshot.time) < 0) {
      ++report_
            .not_carried[fmt::format("values of '{}' that are no attachments", entity.to_string())];
      return {};
    }
    ++report_.instances;
    const idf::Data* is_created = first->data.at("has_create_time");
    const bool has_time = is_created != nullptr && *is_created == idf::Data(true);
    return writer_.write(AttachmentRecord{
        static_cast<uint64_t>(to_ns(snapshot.time)),
        has_time ? static_cast<uint64_t>(std::max<int64_t>(to_ns(first->metadata.created), 0)) : 0,
        text_of(first->data.at("name")), text_of(first->data.at("media_type")),
        data->get<idf::NdArray>().bytes()});
  }

  void tell(Time time) const {
    if (!progress_ || report_.snapshots % kValuesPerProgress != 0) return;
    progress_(
        {.what = "export mcap", .done = report_.snapshots, .total = 0, .detail = to_string(time)});
  }

  ExportPlan plan_;
  McapWriter writer_;
  const WritingOptions& options_;
  const ProgressSink& progress_;
  std::map<uint16_t, uint32_t> sequences_;
  ExportReport report_;
};

}  // namespace

Result<ExportReport> export_mcap(ltm::Recall& recall, const ltm::Query& query,
                                 const std::filesystem::path& path, const WritingOptions& options,
                                 const ProgressSink& progress, const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(ExportPlan plan, plan_export(recall, query, options));
  ENGRAM_ASSIGN_OR_RETURN(auto snapshots, MergedSnapshots::create(recall, query, options.recall));
  McapWriter::Options file;
  file.profile = plan.profile;
  file.library = "engram";
  ENGRAM_ASSIGN_OR_RETURN(McapWriter writer, McapWriter::create(path, file));
  return Export(std::move(plan), std::move(writer), options, progress).run(snapshots, stop);
}

}  // namespace engram::datasets::mcap
