// SPDX-License-Identifier: Apache-2.0
#include "training/night/entity_images.h"

#include <utility>

namespace engram::training {

Status append_images(const EntityWork& work, const idf::Layout& layout,
                     const ltm::SnapshotEntry& entry, MemberImages& images) {
  ENGRAM_ASSIGN_OR_RETURN(const auto snapshot, work.reader.read_recorded(work.entity, entry));
  ENGRAM_ASSIGN_OR_RETURN(auto split, layout.split(snapshot.instances.front().data));
  size_t at = 0;
  for (size_t member = 0; member < split.tensors.size(); ++member) {
    if (layout.members()[member].kind != idf::MemberKind::kImage) continue;
    if (images.size() == at) images.emplace_back();
    images[at++].push_back(std::move(split.tensors[member]));
  }
  return {};
}

}  // namespace engram::training
