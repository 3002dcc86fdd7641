// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/saliency_text.h"

#include "reports/plain/text.h"

namespace engram::reports {

std::string saliency_text(const ltm::SalientMoment& moment) {
  std::string text = fmt::format("{}\nsaliency {:.3f}, rank {} of {} snapshots of its entity\n\n",
                                 moment.entity.at(moment.time).printable(), moment.saliency,
                                 count_text(moment.rank), count_text(moment.count));
  TextTable table({"part", "value", "weight", "counts", "found"});
  for (const ltm::SalientPart& part : moment.parts)
    table.add({std::string(name_of(part.part)), fmt::format("{:.3f}", part.value),
               fmt::format("{:.3f}", part.weight), fmt::format("{:.3f}", part.contribution),
               part.found});
  text += table.to_string() + "\n";
  for (const ltm::SalientPart& part : moment.parts)
    if (!part.expected.empty())
      text += fmt::format("\n{}: expected {}", name_of(part.part), part.expected);
  text += moment.learned_from == 0
              ? std::string("\nweights: the standard ones")
              : fmt::format("\nweights: learned from {} snapshots that were read",
                            count_text(moment.learned_from));
  if (!moment.is_stored)
    text +=
        "\nno night has looked at it yet: a night keeps its saliency (engram consolidate), or "
        "--keep now";
  return text;
}

Json saliency_json(const ltm::SalientMoment& moment) {
  Json parts = Json::array();
  for (const ltm::SalientPart& part : moment.parts)
    parts.push_back({{"part", std::string(name_of(part.part))},
                     {"value", part.value},
                     {"weight", part.weight},
                     {"contribution", part.contribution},
                     {"found", part.found},
                     {"expected", part.expected}});
  return {{"id", moment.entity.at(moment.time).to_string()},
          {"time_ns", to_ns(moment.time)},
          {"saliency", moment.saliency},
          {"rank", moment.rank},
          {"count", moment.count},
          {"is_stored", moment.is_stored},
          {"learned_from", moment.learned_from},
          {"parts", std::move(parts)}};
}

}  // namespace engram::reports
