// SPDX-License-Identifier: Apache-2.0
// What a recorder may be told.
#include "ltm/recording/recorder.h"

namespace engram::ltm {

namespace {

constexpr Duration kMaxKeepLinked = std::chrono::hours(24);

}  // namespace

Status Recorder::Options::validate() const {
  if (max_rate_hz) ENGRAM_RETURN_IF_ERROR(FrequencyFilter::Options{*max_rate_hz}.validate());
  ENGRAM_RETURN_IF_ERROR(pack.validate());
  for (const EntityRule& rule : rules) {
    for (const FilterOptions& filter : rule.filters)
      if (Status status = ltm::validate(filter); !status.ok())
        return status.with_context(fmt::format("rule '{}'", rule.name));
    if (const Status status = rule.pack.validate(); !status.ok())
      return status.with_context(fmt::format("rule '{}'", rule.name));
    if (rule.redact)
      if (const Status status = rule.redact->validate(); !status.ok())
        return status.with_context(fmt::format("rule '{}': redact", rule.name));
    if (rule.keep_linked &&
        (*rule.keep_linked <= Duration(0) || *rule.keep_linked > kMaxKeepLinked))
      return invalid_argument("rule '{}': keep_linked is {}, needs more than 0s and at most {}",
                              rule.name, to_string(*rule.keep_linked), to_string(kMaxKeepLinked));
    if (rule.max_ahead && *rule.max_ahead < Duration(0))
      return invalid_argument("rule '{}': max_ahead is {}, needs 0s or more", rule.name,
                              to_string(*rule.max_ahead));
  }
  if (threads < 1 || threads > kMaxThreads)
    return invalid_argument("recorder: found {} threads, needs 1 to {}", threads, kMaxThreads);
  if (max_ahead < Duration(0))
    return invalid_argument("recorder: max_ahead is {}, needs 0s or more", to_string(max_ahead));
  if (drop_note_interval < Duration(0))
    return invalid_argument("recorder: drop_note_interval is {}, needs 0s or more",
                            to_string(drop_note_interval));
  return {};
}

}  // namespace engram::ltm
