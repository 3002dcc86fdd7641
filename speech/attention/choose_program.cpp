// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/choose_program.h"

#include <algorithm>
#include <cmath>

#include "speech/attention/program_symbols.h"

namespace engram::speech {

namespace {

/// How surely the groups of a source are told apart as the program does: that of the least sure.
double min_sureness(const Program& program, const std::vector<float>& logits,
                    const std::vector<EpisodeGroup>& groups, const AskedNames& names) {
  double min_found = 1;
  for (size_t i = 0; i < groups.size() && i < logits.size(); ++i) {
    if (groups[i].source != program.source) continue;
    const double sign = keeps(program, groups[i], names) ? 1 : -1;
    min_found = std::min(min_found, 1 / (1 + std::exp(-sign * static_cast<double>(logits[i]))));
  }
  return min_found;
}

bool has_name(const Program& program, const std::string& name,
              std::initializer_list<FilterKey> keys) {
  for (const ProgramFilter& filter : program.filters) {
    const bool is_of_kind = std::find(keys.begin(), keys.end(), filter.key) != keys.end();
    if (is_of_kind && ("," + filter.value.text + ",").find("," + name + ",") != std::string::npos)
      return true;
  }
  const Program* within = program_within(program);
  return within != nullptr && has_name(*within, name, keys);
}

bool says_all_names(const Program& program, const AskedNames& names) {
  const auto says = [&](const std::vector<std::string>& all,
                        std::initializer_list<FilterKey> keys) {
    return std::all_of(all.begin(), all.end(),
                       [&](const std::string& name) { return has_name(program, name, keys); });
  };
  return says(names.things, {FilterKey::kThing, FilterKey::kText}) &&
         says(names.places, {FilterKey::kPlace, FilterKey::kText}) &&
         says(names.persons, {FilterKey::kSpeaker});
}

}  // namespace

std::optional<AttendedProgram> choose_program(const AttentionScores& scores,
                                              const std::vector<EpisodeGroup>& groups,
                                              const AskedNames& names, const AskedTimes& times) {
  for (const AttentionScores::Reading& reading : scores.readings) {
    if (!reading.symbols.empty() && reading.symbols.front() == kRefusalSymbol) return {};
    auto program = program_told(reading.symbols, names, times);
    if (!program || !says_all_names(*program, names)) continue;
    double confidence =
        std::exp(reading.log_probability) * min_sureness(*program, reading.main, groups, names);
    if (const Program* within = program_within(*program))
      confidence *= min_sureness(*within, reading.other, groups, names);
    return AttendedProgram{*std::move(program), confidence};
  }
  return {};
}

}  // namespace engram::speech
