// SPDX-License-Identifier: Apache-2.0
#include "speech/learning/dialogue_examples.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/ascii.h"
#include "speech/attention/attention_reader.h"
#include "speech/attention/program_symbols.h"
#include "speech/language/grammar.h"
#include "speech/program/execute.h"

namespace engram::speech {

namespace {

constexpr float kParts = 64;
/// AttentionExample::main of a group that the program does not look at.
constexpr uint8_t kOtherSource = 2;

bool is_near(double a, double b, double max_apart) {
  return std::abs(a - b) <= max_apart;
}

/// Whether an answer is the one that is known: times within half a second, amounts within a tenth.
bool is_same(const AnswerValue& a, const AnswerValue& b) {
  if (a.index() != b.index()) return false;
  if (const auto* moment = std::get_if<answers::Moment>(&a))
    return is_near(to_seconds(moment->value - std::get<answers::Moment>(b).value), 0, 0.5);
  if (const auto* span = std::get_if<answers::Span>(&a)) {
    const auto& other = std::get<answers::Span>(b);
    return is_near(to_seconds(span->from - other.from), 0, 0.5) &&
           is_near(to_seconds(span->to - other.to), 0, 0.5);
  }
  if (const auto* seconds = std::get_if<answers::Seconds>(&a))
    return is_near(seconds->value, std::get<answers::Seconds>(b).value, 0.1);
  if (const auto* metres = std::get_if<answers::Metres>(&a))
    return is_near(metres->value, std::get<answers::Metres>(b).value, 0.1);
  if (const auto* reason = std::get_if<answers::Reason>(&a)) {
    const auto& links = std::get<answers::Reason>(b).links;
    return std::any_of(reason->links.begin(), reason->links.end(), [&](const ltm::MemoryId& link) {
      return std::find(links.begin(), links.end(), link) != links.end();
    });
  }
  if (const auto* names = std::get_if<answers::Names>(&a)) {
    auto lower = [](const answers::Names& all) {
      std::vector<std::string> texts;
      for (const std::string& name : all.value) texts.push_back(lower_ascii(name));
      std::sort(texts.begin(), texts.end());
      return texts;
    };
    return lower(*names) == lower(std::get<answers::Names>(b));
  }
  return a == b;
}

bool is_right(const AnswerValue& value, const Dialogue& dialogue) {
  return is_same(value, dialogue.value) ||
         std::any_of(dialogue.also.begin(), dialogue.also.end(), [&](const AnswerValue& also) {
           return !is_unknown(also) && is_same(value, also);
         });
}

class ExampleMaker {
 public:
  explicit ExampleMaker(std::unique_ptr<KnownFacts> facts)
      : facts_(std::move(facts)), lexicon_(*facts_), tagger_(make_word_tagger()) {}

  Status add(const Dialogue& dialogue, std::vector<AttentionExample>& examples,
             ExampleCounts& counts) {
    ++counts.dialogues;
    const auto words = in_words(dialogue.question, dialogue.now);
    // What is no text to read is refused before any network is asked.
    if (!words.ok()) return {};
    auto asked = attended_question(*words, *facts_, lexicon_, dialogue.now, DayZone::kUtc);
    if (asked.status().code() == StatusCode::kInvalidArgument) return {};
    ENGRAM_RETURN_IF_ERROR(asked.status());
    if (asked->input.words.empty()) return {};
    AttentionExample example{.words = asked->input.words, .attended = asked->input.attended};
    for (const AttentionInput::Traits& traits : asked->input.groups)
      example.groups.push_back(packed(traits));
    std::optional<Program> told;
    if (is_unknown(dialogue.value)) {
      example.symbols = {kRefusalSymbol, kEndSymbol};
      example.main.assign(example.groups.size(), kOtherSource);
      ++counts.refusals;
    } else {
      ENGRAM_ASSIGN_OR_RETURN(const auto program, right_program(dialogue));
      if (!program) {
        ++counts.unread;
        return {};
      }
      ENGRAM_ASSIGN_OR_RETURN(told, tell(*program, dialogue, *asked, example));
      if (!told) {
        ++counts.unlike;
        return {};
      }
      ++counts.programs;
    }
    keep(std::move(example), dialogue, {*std::move(asked), std::move(told)}, examples);
    return {};
  }

 private:
  Result<QuestionInWords> in_words(const std::string& question, Time now) const {
    return question_in_words(question, lexicon_, *tagger_, now, DayZone::kUtc);
  }

  /// The grammar's program for the question in plain words, if it answers it rightly.
  Result<std::optional<Program>> right_program(const Dialogue& dialogue) {
    for (const std::string& words : dialogue.plain) {
      const auto plain = in_words(words, dialogue.now);
      if (!plain.ok()) continue;
      const ParsedQuestion parsed = parse_question(*plain, lexicon_);
      if (!parsed.program) continue;
      const auto outcome = execute(*parsed.program, *facts_, dialogue.now, DayZone::kUtc);
      if (!outcome.ok() && outcome.status().code() == StatusCode::kInvalidArgument) continue;
      ENGRAM_RETURN_IF_ERROR(outcome.status());
      if (is_right(outcome->value, dialogue)) return std::optional(*parsed.program);
    }
    return std::optional<Program>();
  }

  static std::vector<uint8_t> kept(const Program& program, const AttendedQuestion& asked) {
    std::vector<uint8_t> flags;
    for (const EpisodeGroup& group : asked.groups)
      flags.push_back(group.source != program.source       ? kOtherSource
                      : keeps(program, group, asked.names) ? 1
                                                           : 0);
    return flags;
  }

  /// Tells the program as an example, and returns what that tells; nothing where it has another
  /// answer.
  Result<std::optional<Program>> tell(const Program& program, const Dialogue& dialogue,
                                      const AttendedQuestion& asked, AttentionExample& example) {
    const auto symbols = symbols_of(program, asked.names, asked.times);
    if (!symbols) return std::optional<Program>();
    example.symbols = *symbols;
    example.main = kept(program, asked);
    if (const Program* within = program_within(program)) example.other = kept(*within, asked);
    // What the words of others name may be less than what the plain words do.
    auto told = program_told(*symbols, asked.names, asked.times);
    if (!told || *told == program) return told;
    const auto outcome = execute(*told, *facts_, dialogue.now, DayZone::kUtc);
    if (outcome.status().code() == StatusCode::kInvalidArgument) return std::optional<Program>();
    ENGRAM_RETURN_IF_ERROR(outcome.status());
    return is_right(outcome->value, dialogue) ? told : std::nullopt;
  }

  /// Of what is held out some are kept, to measure with.
  void keep(AttentionExample example, const Dialogue& dialogue, AttentionTrial trial,
            std::vector<AttentionExample>& examples) {
    constexpr size_t kHeldOutForOneTrial = 8;
    if (!dialogue.held_out.empty()) {
      if (held_out_++ % kHeldOutForOneTrial != 0) return;
      example.is_new_wording = std::find(dialogue.held_out.begin(), dialogue.held_out.end(),
                                         "phrasing") != dialogue.held_out.end();
      example.trial = std::make_shared<const AttentionTrial>(std::move(trial));
    }
    examples.push_back(std::move(example));
  }

  size_t held_out_ = 0;
  std::unique_ptr<KnownFacts> facts_;
  Lexicon lexicon_;
  std::unique_ptr<Tagger> tagger_;
};

}  // namespace

std::array<uint8_t, AttentionInput::kTraits> packed(const AttentionInput::Traits& traits) {
  std::array<uint8_t, AttentionInput::kTraits> bytes{};
  for (size_t i = 0; i < traits.size(); ++i)
    bytes[i] = static_cast<uint8_t>(std::clamp(std::lround(traits[i] * kParts), 0L, 255L));
  return bytes;
}

AttentionInput::Traits unpacked(const std::array<uint8_t, AttentionInput::kTraits>& traits) {
  AttentionInput::Traits numbers{};
  for (size_t i = 0; i < traits.size(); ++i) numbers[i] = static_cast<float>(traits[i]) / kParts;
  return numbers;
}

Result<ExampleCounts> add_examples(Memory& memory, const ExampleOptions& options,
                                   const std::stop_token& stop,
                                   std::vector<AttentionExample>& examples) {
  DialogueOptions asked = options.dialogues;
  asked.tells_plainly = true;
  ENGRAM_ASSIGN_OR_RETURN(std::vector<Dialogue> dialogues, make_dialogues(memory, asked));
  asked.count.reset();
  if (options.has_written) {
    ENGRAM_ASSIGN_OR_RETURN(std::vector<Dialogue> written, make_written_dialogues(memory, asked));
    std::move(written.begin(), written.end(), std::back_inserter(dialogues));
  }
  for (const std::filesystem::path& file : options.wordings) {
    ++asked.seed;
    ENGRAM_ASSIGN_OR_RETURN(std::vector<Dialogue> more, make_dialogues_with(memory, asked, file));
    std::move(more.begin(), more.end(), std::back_inserter(dialogues));
  }
  ENGRAM_ASSIGN_OR_RETURN(std::unique_ptr<KnownFacts> facts, KnownFacts::read(memory));
  ExampleMaker maker(std::move(facts));
  ExampleCounts counts;
  for (const Dialogue& dialogue : dialogues) {
    if (stop.stop_requested()) return cancelled("making dialogues was stopped");
    ENGRAM_RETURN_IF_ERROR(maker.add(dialogue, examples, counts));
  }
  return counts;
}

}  // namespace engram::speech
