// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "datasets/export_file.h"
#include "datasets/export_formats.h"
#include "datasets/export_json.h"

namespace engram::datasets {

namespace {

/// Writes snapshots.jsonl: one snapshot per line, with everything that is known about it.
class JsonLinesSink : public SnapshotSink {
 public:
  explicit JsonLinesSink(std::filesystem::path directory) : directory_(std::move(directory)) {}

  Status begin(const ltm::MemoryId& entity) override {
    entity_ = entity;
    return {};
  }

  Status add(const ltm::SnapshotResult& snapshot) override {
    ENGRAM_RETURN_IF_ERROR(open());
    Json json = snapshot_head(entity_, snapshot);
    json["instances"] = Json::array();
    for (const ltm::InstanceResult& instance : snapshot.instances)
      json["instances"].push_back(instance_json(instance, {}, report_));
    ++report_.snapshots;
    report_.instances += snapshot.instances.size();
    return file_->write(json.dump() + "\n");
  }

  /// If no snapshot was added, the file is empty.
  Status finish() override {
    ENGRAM_RETURN_IF_ERROR(open());
    return file_->close(report_);
  }

 private:
  Status open() {
    if (file_) return {};
    ENGRAM_ASSIGN_OR_RETURN(ExportFile made, ExportFile::create(directory_ / "snapshots.jsonl"));
    file_.emplace(std::move(made));
    return {};
  }

  std::filesystem::path directory_;
  ltm::MemoryId entity_;
  std::optional<ExportFile> file_;
};

}  // namespace

std::unique_ptr<SnapshotSink> make_json_lines_sink(const std::filesystem::path& directory) {
  return std::make_unique<JsonLinesSink>(directory);
}

}  // namespace engram::datasets
