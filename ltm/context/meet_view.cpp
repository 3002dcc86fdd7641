// SPDX-License-Identifier: Apache-2.0
#include "ltm/context/looking.h"

namespace engram::ltm {

Result<Met> meet_view(const Asked& asked, const where::InView& view, const EntityContext& other,
                      KnownContexts& contexts) {
  Met met(asked.context.times.size(), 0);
  const bool is_camera = asked.context.cameras.size() > 0;
  if (!is_camera && other.cameras.size() == 0) {
    if (!asked.is_named && other.places.size() > 0) return met;
    return failed_precondition(
        "neither '{}' nor '{}' is a camera: needs a pose, and fx, fy, cx, cy, width and height or "
        "a "
        "link to them in a member 'calibration'",
        asked.id.to_string(), view.entity.to_string());
  }
  Looking looking =
      is_camera ? Looking(asked.id, asked.context, view.entity, other, view.sighting, contexts)
                : Looking(view.entity, other, asked.id, asked.context, view.sighting, contexts);
  if (const Status checked = looking.check(); !checked.ok()) {
    if (asked.is_named) return checked;
    return met;
  }
  return is_camera ? looking.images_of_thing() : looking.things_in_images();
}

}  // namespace engram::ltm
