// SPDX-License-Identifier: Apache-2.0
#include "datasets/export_file.h"
#include "datasets/export_formats.h"
#include "datasets/export_images.h"
#include "datasets/export_names.h"
#include "ltm/codec/png.h"

namespace engram::datasets {

namespace {

/// Writes <entity>/<member>/<time>.png; further instances go to <time>#1.png.
class PngSink : public SnapshotSink {
 public:
  explicit PngSink(std::filesystem::path directory) : directory_(std::move(directory)) {}

  Status begin(const ltm::MemoryId& entity) override {
    folder_ = directory_ / export_folder(entity);
    return {};
  }

  Status add(const ltm::SnapshotResult& snapshot) override {
    return for_each_image(snapshot, report_, [&](int32_t index, const ImageMember& member) {
      return write(snapshot.time, index, member);
    });
  }

  Status finish() override { return {}; }

 private:
  Status write(Time time, int32_t index, const ImageMember& member) {
    const std::string number = index == 0 ? "" : fmt::format("#{}", index);
    ENGRAM_ASSIGN_OR_RETURN(const auto png, ltm::png_codec().encode(member.image));
    return write_export_file(
        folder_ / export_member(member.path) / (export_time(time) + number + ".png"), png, report_);
  }

  std::filesystem::path directory_;
  std::filesystem::path folder_;
};

}  // namespace

std::unique_ptr<SnapshotSink> make_png_sink(const std::filesystem::path& directory) {
  return std::make_unique<PngSink>(directory);
}

}  // namespace engram::datasets
