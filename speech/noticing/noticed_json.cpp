// SPDX-License-Identifier: Apache-2.0
#include "speech/noticing/noticed_json.h"

#include "ltm/core/printable.h"

namespace engram::speech {

namespace {

using Json = nlohmann::ordered_json;

Json to_json(const NoticedDeed& deed) {
  Json json{{"hand", deed.hand},
            {"thing", deed.thing},
            {"place", deed.place},
            {"task", deed.task},
            {"episode", deed.episode.depth() == 0 ? Json() : Json(deed.episode.to_string())},
            {"took", to_string(*deed.close_ended.time())},
            {"let_go", deed.open_began ? Json(to_string(*deed.open_began->time())) : Json()},
            {"open_before", deed.open_before},
            {"open_after", deed.open_after}};
  Json joints = Json::array({deed.close_began.to_string(), deed.close_ended.to_string()});
  if (deed.open_began && deed.open_ended) {
    joints.push_back(deed.open_began->to_string());
    joints.push_back(deed.open_ended->to_string());
  }
  json["joints"] = std::move(joints);
  return json;
}

}  // namespace

nlohmann::ordered_json to_json(const Noticed& noticed, size_t committed) {
  Json deeds = Json::array();
  for (const NoticedDeed& deed : noticed.deeds) deeds.push_back(to_json(deed));
  return {{"episodes", noticed.episodes},
          {"snapshots", noticed.snapshots},
          {"deeds", std::move(deeds)},
          {"committed", committed}};
}

Result<OpenHand> open_hand_named(std::string_view name) {
  if (name == "auto") return OpenHand::kAuto;
  if (name == "high") return OpenHand::kHigh;
  if (name == "low") return OpenHand::kLow;
  return invalid_argument("open: found '{}', needs auto, high or low", printable(name));
}

}  // namespace engram::speech
