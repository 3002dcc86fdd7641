// SPDX-License-Identifier: Apache-2.0
#include "cli/lesson_text.h"

namespace engram::cli {

std::string lesson_text(const speech::LessonReport& report, const std::filesystem::path& file) {
  const speech::ExampleCounts& made = report.dialogues;
  const speech::LearnReport& learned = report.learned;
  return fmt::format(
      "Answers: {} dialogues, {} with a program and {} that cannot be answered; left out {} that "
      "the grammar does not answer rightly in plain words, and {} that the network's language has "
      "not got\n"
      "  trained {:.0f} s: {} steps with {} examples, {:.2f} million parameters, loss {:.3f}\n"
      "  of {} held-out questions {:.1f} % are read rightly, of those in new words {:.1f} %; from "
      "a confidence of {:.3f} on {:.1f} "
      "% are told, of these {:.1f} % rightly, and {:.1f} % of what cannot be answered is refused\n"
      "  {}",
      made.dialogues, made.programs, made.refusals, made.unread, made.unlike, learned.seconds,
      learned.steps, learned.examples, static_cast<double>(learned.parameters) / 1e6, learned.loss,
      learned.held_out, 100 * learned.read_rightly, 100 * learned.new_wordings_read_rightly,
      learned.min_confidence, 100 * learned.told, 100 * learned.told_rightly, 100 * learned.refused,
      file.string());
}

Json lesson_json(const speech::LessonReport& report, const std::filesystem::path& file) {
  const speech::ExampleCounts& made = report.dialogues;
  const speech::LearnReport& learned = report.learned;
  return {{"file", file.string()},
          {"dialogues", made.dialogues},
          {"with_program", made.programs},
          {"refusals", made.refusals},
          {"unread", made.unread},
          {"unlike", made.unlike},
          {"examples", learned.examples},
          {"held_out", learned.held_out},
          {"parameters", learned.parameters},
          {"steps", learned.steps},
          {"seconds", learned.seconds},
          {"loss", learned.loss},
          {"read_rightly", learned.read_rightly},
          {"new_wordings_read_rightly", learned.new_wordings_read_rightly},
          {"min_confidence", learned.min_confidence},
          {"sure_confidence", learned.sure_confidence},
          {"told", learned.told},
          {"told_rightly", learned.told_rightly},
          {"refused", learned.refused}};
}

}  // namespace engram::cli
