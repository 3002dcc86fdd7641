// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/similar_text.h"

#include "reports/plain/text.h"

namespace engram::reports {

std::string similar_text(const ltm::SimilarAnswer& answer) {
  std::string text;
  if (answer.moments.empty()) {
    text = fmt::format("no moment of {} is left to compare", answer.entity.printable());
  } else {
    TextTable table({answer.entity.printable(), "distance", "into its recording"});
    for (const ltm::SimilarMoment& moment : answer.moments)
      table.add({to_string(moment.time), fmt::format("{:.3f}", moment.distance),
                 fmt::format("{:.1f} s", to_seconds(moment.time - moment.recording_first))});
    text = table.to_string();
  }
  text += fmt::format("\n{} moments were compared by {}; 0 is equal, 1 as far as two at random",
                      count_text(answer.compared), answer.space);
  if (answer.computed > 0)
    text += fmt::format(
        "\n{} images had no code yet and were decoded: a night codes them (engram consolidate), "
        "or, in a store, --keep now",
        count_text(answer.computed));
  return text;
}

Json similar_json(const ltm::SimilarAnswer& answer) {
  Json moments = Json::array();
  for (const ltm::SimilarMoment& moment : answer.moments)
    moments.push_back({{"id", answer.entity.at(moment.time).to_string()},
                       {"time_ns", to_ns(moment.time)},
                       {"distance", moment.distance},
                       {"recording",
                        {{"first_ns", to_ns(moment.recording_first)},
                         {"last_ns", to_ns(moment.recording_last)}}}});
  return {{"entity", answer.entity.to_string()},
          {"space", answer.space},
          {"is_stored_space", answer.is_stored_space},
          {"compared", answer.compared},
          {"computed", answer.computed},
          {"moments", std::move(moments)}};
}

}  // namespace engram::reports
