// SPDX-License-Identifier: Apache-2.0
#include "datasets/export_file.h"
#include "datasets/export_formats.h"
#include "datasets/export_images.h"
#include "datasets/export_json.h"
#include "datasets/export_names.h"
#include "ltm/codec/png.h"

namespace engram::datasets {

namespace {

/// Writes <entity>/<time in microseconds>/<instance>/<member>.png, and beside it data.json with
/// everything else.
class ArmarxSink : public SnapshotSink {
 public:
  explicit ArmarxSink(std::filesystem::path directory) : directory_(std::move(directory)) {}

  Status begin(const ltm::MemoryId& entity) override {
    entity_ = entity;
    last_us_.reset();
    return {};
  }

  Status add(const ltm::SnapshotResult& snapshot) override {
    ++report_.snapshots;
    const int64_t time_us =
        std::chrono::floor<std::chrono::microseconds>(snapshot.time).time_since_epoch().count();
    if (last_us_ == time_us) {
      ++report_.not_carried["snapshots in the same microsecond as another"];
      return {};
    }
    last_us_ = time_us;
    const auto folder = directory_ / export_folder(entity_) / std::to_string(time_us);
    for (const ltm::InstanceResult& instance : snapshot.instances)
      ENGRAM_RETURN_IF_ERROR(add(snapshot, instance, folder / std::to_string(instance.index)));
    return {};
  }

  Status finish() override { return {}; }

 private:
  Status add(const ltm::SnapshotResult& snapshot, const ltm::InstanceResult& instance,
             const std::filesystem::path& folder) {
    ++report_.instances;
    std::vector<ImageFile> files;
    for (const ImageMember& member : image_members(instance.data)) {
      files.push_back({member.path, export_member(member.path) + ".png"});
      ENGRAM_ASSIGN_OR_RETURN(const auto png, ltm::png_codec().encode(member.image));
      ENGRAM_RETURN_IF_ERROR(write_export_file(folder / files.back().file, png, report_));
    }
    Json json = snapshot_head(entity_, snapshot);
    json.update(instance_json(instance, files, report_));
    return write_export_file(folder / "data.json", as_bytes(json.dump(1) + "\n"), report_);
  }

  std::filesystem::path directory_;
  ltm::MemoryId entity_;
  std::optional<int64_t> last_us_;
};

}  // namespace

std::unique_ptr<SnapshotSink> make_armarx_sink(const std::filesystem::path& directory) {
  return std::make_unique<ArmarxSink>(directory);
}

}  // namespace engram::datasets
