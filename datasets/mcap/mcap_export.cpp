// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_export.h"

#include <algorithm>

#include "datasets/mcap/mcap_plan.h"
#include "datasets/mcap/mcap_writer.h"
#include "datasets/recordings/exported_streams.h"
#include "datasets/recordings/text_value.h"

namespace engram::datasets::mcap {

namespace {

class Export {
 public:
  Export(ExportPlan plan, McapWriter writer, const ExportRequest& request)
      : plan_(std::move(plan)), writer_(std::move(writer)), request_(request) {
    for (const SchemaRecord& schema : plan_.schemas) writer_.add(schema);
    for (const auto& [entity, planned] : plan_.channels) writer_.add(planned.channel);
  }

  Result<ExportReport> run() {
    for (const MetadataRecord& metadata : plan_.metadata)
      ENGRAM_RETURN_IF_ERROR(writer_.write(metadata));
    ENGRAM_RETURN_IF_ERROR(write_snapshots(
        request_, "mcap", report_,
        [this](const auto& entity, const auto& snapshot) { return write(entity, snapshot); }));
    ENGRAM_ASSIGN_OR_RETURN(report_.bytes, writer_.close());
    report_.files = 1;
    return report_;
  }

 private:
  Status write(const ltm::MemoryId& entity, const ltm::SnapshotResult& snapshot) {
    if (plan_.attachments.contains(entity)) return write_attachment(entity, snapshot);
    const auto planned = plan_.channels.find(entity);
    if (planned == plan_.channels.end()) return {};
    const ltm::InstanceResult* first = message_instance(snapshot, report_);
    if (first == nullptr) return {};
    const auto bytes = planned->second.coder.encode(first->data, request_.options.jpeg_quality);
    if (!bytes.ok()) return tell_misfit(entity, report_), Status();
    ++report_.instances;
    const uint16_t id = planned->second.channel.id;
    const auto log_time = static_cast<uint64_t>(to_ns(snapshot.time));
    const auto sent = static_cast<uint64_t>(std::max<int64_t>(to_ns(first->metadata.sent), 0));
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

  ExportPlan plan_;
  McapWriter writer_;
  const ExportRequest& request_;
  std::map<uint16_t, uint32_t> sequences_;
  ExportReport report_;
};

}  // namespace

Result<ExportReport> export_mcap(const ExportRequest& request, const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(ExportPlan plan,
                          plan_export(request.recall, request.query, request.options));
  McapWriter::Options file;
  file.profile = plan.profile;
  file.library = "engram";
  ENGRAM_ASSIGN_OR_RETURN(McapWriter writer, McapWriter::create(path, file));
  return Export(std::move(plan), std::move(writer), request).run();
}

}  // namespace engram::datasets::mcap
