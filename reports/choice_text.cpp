// SPDX-License-Identifier: Apache-2.0
#include "reports/choice_text.h"

#include "reports/plain/text.h"

namespace engram::reports {

namespace {

Json bytes_json(const encoders::ModelBytes& bytes, int64_t nights) {
  return {{"known_bytes", bytes.known},
          {"new_bytes", bytes.news},
          {"model_bytes", bytes.model},
          {"total_bytes", bytes.total(nights)}};
}

}  // namespace

std::string choice_text(const encoders::ModelChoice& choice) {
  if (choice.previous_version == 0) return {};
  const auto known = static_cast<uint64_t>(choice.snapshots - choice.new_snapshots);
  const auto news = static_cast<uint64_t>(choice.new_snapshots);
  std::string text =
      fmt::format("    {:<14} {:>14} {:>14} {:>10} {:>14}", "chosen from",
                  count_text(known) + " known", count_text(news) + " new", "model",
                  fmt::format("{} night{}", choice.nights, choice.nights == 1 ? "" : "s"));
  const auto add = [&](std::string_view name, const encoders::ModelBytes& bytes) {
    const auto each = [](int64_t count) { return bytes_text(static_cast<double>(count)); };
    text +=
        fmt::format("\n    {:<14} {:>14} {:>14} {:>10} {:>14}", name, each(bytes.known),
                    each(bytes.news), each(bytes.model), bytes_text(bytes.total(choice.nights)));
  };
  add("previous model", choice.previous);
  add("new model", choice.made);
  return text;
}

Json choice_json(const encoders::ModelChoice& choice) {
  if (choice.previous_version == 0) return nullptr;
  return {{"previous_version", choice.previous_version},
          {"snapshots", choice.snapshots},
          {"new_snapshots", choice.new_snapshots},
          {"nights", choice.nights},
          {"previous_model", bytes_json(choice.previous, choice.nights)},
          {"new_model", bytes_json(choice.made, choice.nights)},
          {"keeps_previous_model", choice.keeps_previous()}};
}

}  // namespace engram::reports
