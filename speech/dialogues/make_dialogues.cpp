// SPDX-License-Identifier: Apache-2.0
#include "speech/dialogues/make_dialogues.h"

#include "speech/dialogues/chosen_dialogues.h"

namespace engram::speech {

Status DialogueOptions::validate() const {
  if (!(careless >= 0 && careless <= 1))
    return invalid_argument("dialogues: careless is {}, needs 0 to 1", careless);
  if (count && *count > 1'000'000)
    return invalid_argument("dialogues: count is {}, needs at most 1000000", *count);
  return {};
}

Result<std::vector<Dialogue>> make_dialogues(Memory& memory, const DialogueOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(const dialogues::LivedPast past, dialogues::read_past(memory, options));
  return dialogues::chosen_dialogues(past, options);
}

}  // namespace engram::speech
