// SPDX-License-Identifier: Apache-2.0
#include "datasets/export_images.h"

#include "ltm/idf/layout.h"

namespace engram::datasets {

namespace {

/// Counts all members except the images.
void count_other_members(const idf::Data& data, ExportReport& report) {
  const idf::Layout layout = idf::Layout::of(data);
  const auto parts = layout.split(data);
  if (!parts.ok()) return;
  for (const idf::TensorMember& member : layout.members())
    if (member.kind != idf::MemberKind::kImage)
      ++report.not_carried[member.kind == idf::MemberKind::kArray ? "arrays" : "numbers"];
  for (const idf::Data& rest : parts->remainder)
    if (!rest.is<idf::None>()) ++report.not_carried[rest.is<idf::List>() ? "lists" : "texts"];
}

}  // namespace

std::vector<ImageMember> image_members(const idf::Data& data) {
  std::vector<ImageMember> images;
  const idf::Layout layout = idf::Layout::of(data);
  for (const idf::TensorMember& member : layout.members())
    if (member.kind == idf::MemberKind::kImage)
      images.push_back({member.path, data.at(member.path)->get<idf::NdArray>()});
  return images;
}

Status for_each_image(const ltm::SnapshotResult& snapshot, ExportReport& report,
                      const std::function<Status(int32_t, const ImageMember&)>& write) {
  ++report.snapshots;
  for (const ltm::InstanceResult& instance : snapshot.instances) {
    ++report.instances;
    count_other_members(instance.data, report);
    for (const ImageMember& member : image_members(instance.data))
      ENGRAM_RETURN_IF_ERROR(write(instance.index, member));
  }
  return {};
}

}  // namespace engram::datasets
