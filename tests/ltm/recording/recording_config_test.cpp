// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/recording_config.h"

#include <fstream>
#include <sstream>

#include "ltm/codec/seal_rules.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Recorder::Options read(std::string_view text) {
  const auto options = parse_recording_config(text, "rec.yaml");
  EXPECT_OK(options);
  return options.value_or({});
}

void expect_refused(std::string_view text, const ::testing::Matcher<std::string>& message) {
  const auto options = parse_recording_config(text, "rec.yaml");
  EXPECT_EQ(options.status().code(), StatusCode::kInvalidArgument) << text;
  EXPECT_THAT(options.status().message(), message) << text;
}

TEST(RecordingConfig, ReadsEveryFilter) {
  const auto options = read(R"(
entities:
  - match: Vision/RGB/.*/cam
    name: cameras
    filters:
      - frequency: {rate: 2Hz}
      - equality
      - equality: {max_gap: 3s}
      - similarity:
          members:
            - {path: clock, measure: ignore}
            - {path: "state/.*", measure: rms, bound: 0.5}
          images: {measure: mse, bound: 7}
          numbers: {measure: cosine, bound: 0.9}
          orientations: {measure: angle, bound: 0.2}
          remainder: ignore
          max_gap: never
      - importance:
          events:
            - {path: force, bound: 20, crosses: either}
            - {entity: Action/.*}
          before: 1s
          after: 2s
          base_rate: 1Hz
          hold_limit: 1MiB
      - trigger:
          events: [{entity: Robot/Force, path: z, bound: -5, crosses: falling}]
          before: 9s
          after: forever
)");
  ASSERT_EQ(options.rules.size(), 1u);
  const EntityRule& rule = options.rules[0];
  EXPECT_EQ(rule.name, "cameras");
  EXPECT_TRUE(rule.match.matches(*MemoryId::parse("Vision/RGB/x/cam")));
  ASSERT_EQ(rule.filters.size(), 6u);
  EXPECT_EQ(std::get<FrequencyFilter::Options>(rule.filters[0]).max_rate_hz, 2);
  EXPECT_FALSE(std::get<EqualityFilter::Options>(rule.filters[1]).max_gap.has_value());
  EXPECT_EQ(std::get<EqualityFilter::Options>(rule.filters[2]).max_gap, std::chrono::seconds(3));
  const auto& similarity = std::get<SimilarityFilter::Options>(rule.filters[3]);
  ASSERT_EQ(similarity.members.size(), 2u);
  EXPECT_EQ(similarity.members[0].similarity.measure, Measure::kIgnore);
  EXPECT_EQ(similarity.members[1].similarity.bound, 0.5);
  EXPECT_TRUE(similarity.members[1].path.matches("state/arm"));
  EXPECT_EQ(similarity.images.measure, Measure::kMse);
  EXPECT_EQ(similarity.numbers.bound, 0.9);
  EXPECT_EQ(similarity.orientations.bound, 0.2);
  EXPECT_FALSE(similarity.compares_remainder);
  EXPECT_FALSE(similarity.max_gap.has_value());
  const auto& importance = std::get<ImportanceFilter::Options>(rule.filters[4]);
  ASSERT_EQ(importance.events.size(), 2u);
  EXPECT_EQ(importance.events[0].crossing, Crossing::kEither);
  EXPECT_EQ(importance.events[0].bound, 20);
  EXPECT_EQ(importance.events[1].entity->to_string(), "Action/.*");
  EXPECT_EQ(importance.before, std::chrono::seconds(1));
  EXPECT_EQ(importance.after, std::chrono::seconds(2));
  EXPECT_EQ(importance.base_rate_hz, 1);
  EXPECT_EQ(importance.max_held_bytes, uint64_t{1} << 20);
  const auto& trigger = std::get<TriggerFilter::Options>(rule.filters[5]);
  EXPECT_EQ(trigger.events[0].crossing, Crossing::kFalling);
  EXPECT_EQ(trigger.before, std::chrono::seconds(9));
  EXPECT_FALSE(trigger.after.has_value());
}

TEST(RecordingConfig, ReadsTheOptionsOfStoreAndRecorder) {
  const auto options = read(R"(
store: {durability: every, sync_interval: 50ms, seal_size: 8MiB, seal_after: 1min}
recording: {threads: 3, late: refuse, drop_note_interval: 1s}
)");
  EXPECT_EQ(options.store.durability, Durability::kEvery);
  EXPECT_EQ(options.store.sync_interval, std::chrono::milliseconds(50));
  EXPECT_EQ(options.store.seal_bytes, uint64_t{8} << 20);
  EXPECT_EQ(options.store.seal_after, std::chrono::minutes(1));
  EXPECT_EQ(options.threads, 3);
  EXPECT_EQ(options.late, LateSnapshots::kRefuse);
  EXPECT_EQ(options.drop_note_interval, std::chrono::seconds(1));
  EXPECT_TRUE(options.rules.empty());
}

TEST(RecordingConfig, PutsTheFilesRulesBeforeThoseOfItsPreset) {
  const auto preset = read(*recording_preset("balanced"));
  const auto options = read(R"(
preset: balanced
entities:
  - match: Robot
    filters: []
)");
  ASSERT_EQ(options.rules.size(), preset.rules.size() + 1);
  EXPECT_EQ(options.rules[0].name, "Robot");
  EXPECT_TRUE(options.rules[0].filters.empty());
  EXPECT_EQ(options.rules[1].name, preset.rules[0].name);
}

TEST(RecordingConfig, HasPresetsThatParse) {
  ASSERT_EQ(all_recording_presets().size(), 3u);
  for (const RecordingPreset& preset : all_recording_presets()) {
    const auto options = parse_recording_config(preset.yaml, std::string(preset.name));
    ASSERT_OK(options);
    ASSERT_FALSE(options->rules.empty());
    EXPECT_TRUE(options->rules.back().match.matches(*MemoryId::parse("a/b/c/d")));
    EXPECT_EQ(options->rules.back().filters.empty(), preset.name == "recorder");
    // An end that follows a report within a frame must not be filtered out.
    for (const char* deed : {"Skill/Event/arm/grasp", "Skills/Actions/robot/pick",
                             "Speech/Commands/human/text", "Navigation/Plan/robot/drive"})
      EXPECT_TRUE(options->rules.front().match.matches(*MemoryId::parse(deed)) &&
                  options->rules.front().filters.empty())
          << preset.name << " " << deed;
  }
  EXPECT_FAILS(recording_preset("tiny"), StatusCode::kNotFound, "recorder, balanced, small");
  const auto small = read(*recording_preset("small"));
  EXPECT_FALSE(SealRules::create(small.rules.back().pack)->empty());
}

TEST(RecordingConfig, NamesFileLineAndKeyOfWhatIsWrong) {
  expect_refused("entites: []\n", AllOf(HasSubstr("rec.yaml:1"), HasSubstr("'entities'?")));
  expect_refused("preset: tiny\n", AllOf(HasSubstr("rec.yaml:1: 'preset'"), HasSubstr("small")));
  expect_refused("recording: {threads: 0}\n", HasSubstr("'recording.threads'"));
  expect_refused("store:\n  durability: always\n",
                 AllOf(HasSubstr("rec.yaml:2: 'store.durability'"), HasSubstr("interval")));
  expect_refused("entities:\n  - name: x\n", HasSubstr("no key 'match'"));
  expect_refused("entities:\n  - match: a/b/c/d/e\n", HasSubstr("rec.yaml:2: 'entities[0].match'"));
}

TEST(RecordingConfig, NamesWhatIsWrongWithAFilter) {
  const auto refuse = [](const std::string& filter, const auto& message) {
    expect_refused("entities:\n  - match: .*\n    filters:\n      - " + filter + "\n", message);
  };
  refuse("frequence: {rate: 5Hz}", AllOf(HasSubstr("rec.yaml:4"), HasSubstr("'frequency'?")));
  refuse("frequency: {rate: 5}", HasSubstr("'entities[0].filters[0].frequency.rate'"));
  refuse("frequency", HasSubstr("needs options"));
  refuse("{frequency: {rate: 1Hz}, equality: {}}", HasSubstr("found 2 keys"));
  refuse("frequency: {rate: 1Hz, max: 3}", HasSubstr("'entities[0].filters[0].frequency.max'"));
  refuse("similarity: {images: {measure: psnr, bound: 1}}", HasSubstr("'psnr'"));
  refuse("similarity: {images: {measure: ssim}}", HasSubstr("no key 'bound'"));
  refuse("similarity: {images: {measure: ssim, bound: 3}}", HasSubstr("needs -1 to 1"));
  refuse("similarity: {max_gap: 0s}", HasSubstr("more than 0s"));
  refuse("similarity: {members: [{path: \"(\", measure: equal}]}", HasSubstr("members[0].path"));
  refuse("importance: {}", HasSubstr("needs one event"));
  refuse("trigger: {events: [{path: x}]}", HasSubstr("no key 'bound'"));
  refuse("trigger: {events: [{tells: [joy]}]}", HasSubstr("found 'joy', needs one of failure, stop"));
  refuse("trigger: {events: [{path: x, bound: 1, tells: [stop]}]}",
         HasSubstr("'path' and 'tells'"));
  refuse("trigger: {events: [{}]}", HasSubstr("neither an entity nor a path"));
}

TEST(RecordingConfig, ReadsCodecsByPathAndKind) {
  const auto options = read(R"(
entities:
  - match: .*
    codecs:
      - {path: "**/mask", codec: zstd}
      - {kind: image, codec: "jpeg:80"}
      - {path: left, kind: depth, codec: png}
)");
  const std::vector<PackRule>& rules = options.rules[0].pack.rules;
  ASSERT_EQ(rules.size(), 3u);
  EXPECT_EQ(rules[0].path, "**/mask");
  EXPECT_FALSE(rules[0].kind.has_value());
  EXPECT_EQ(rules[1].path, "**");
  EXPECT_EQ(rules[1].kind, MediumKind::kImage);
  EXPECT_EQ(rules[1].codec, "jpeg:80");
  EXPECT_EQ(rules[2].kind, MediumKind::kDepth);
  const auto refuse = [](const std::string& codec, const auto& message) {
    expect_refused("entities:\n  - match: .*\n    codecs:\n      - " + codec + "\n", message);
  };
  refuse("{codec: gif}",
         AllOf(HasSubstr("rec.yaml:4: 'entities[0].codecs[0].codec'"), HasSubstr("gif")));
  refuse("{codec: \"jpeg:900\"}", HasSubstr("codecs[0].codec"));
  refuse("{kind: images, codec: png}", HasSubstr("needs one of image, depth"));
  refuse("{kind: image}", HasSubstr("no key 'codec'"));
  refuse("{kind: image, codec: png, quality: 3}", HasSubstr("codecs[0].quality"));
}

/// Reads the fenced YAML blocks of a document and counts them.
int read_examples(const std::string& document) {
  std::ifstream file(std::string(ENGRAM_SOURCE_DIR) + "/" + document);
  std::stringstream whole;
  whole << file.rdbuf();
  const std::string text = whole.str();
  int examples = 0;
  for (size_t at = text.find("```yaml\n"); at != std::string::npos;
       at = text.find("```yaml\n", at)) {
    at += 8;
    const size_t end = text.find("```", at);
    EXPECT_OK(parse_recording_config(text.substr(at, end - at), document));
    at = end + 3;
    ++examples;
  }
  return examples;
}

TEST(RecordingConfig, ReadsTheExamplesOfTheDocumentation) {
  EXPECT_GE(read_examples("docs/recording.md"), 6);
}

TEST(RecordingConfig, LeavesTheSectionOnForgettingToOthers) {
  const auto options = read("forget: {rules: [{older_than: 30d}]}\nrecording: {threads: 3}\n");
  EXPECT_EQ(options.threads, 3);
}

TEST(RecordingConfig, ReadsWhatBecomesOfValuesWhenTheyAreSealed) {
  const auto options = read(R"(
entities:
  - match: .*
    codecs:
      - {kind: image, codec: "h264:crf=20,group=10", journal: png}
      - {path: raw/**, kind: number, codec: none}
      - {kind: number, codec: columns}
)");
  ASSERT_EQ(options.rules.size(), 1u);
  const auto rules = SealRules::create(options.rules[0].pack);
  ASSERT_OK(rules);
  const GroupCodec* codec = rules->group_codec("image", idf::ElementType::kUInt8, {24, 32, 3});
  ASSERT_NE(codec, nullptr);
  EXPECT_EQ(codec->name(), "h264");
  EXPECT_EQ(codec->group_size(), 10u);
  EXPECT_TRUE(rules->are_columns("x"));
  EXPECT_FALSE(rules->are_columns("raw/x"));
}

TEST(RecordingConfig, TakesACodecOfAList) {
  const auto rule_of = [](const std::string& rule) {
    const auto options = read("entities: [{match: .*, codecs: [{kind: image, " + rule + "}]}]");
    return options.rules.at(0).pack.rules.at(0);
  };
  EXPECT_EQ(rule_of("codec: [jpeg, png]").codec, "jpeg");
  EXPECT_EQ(rule_of(R"(codec: ["ffv1:group=4", png])").codec, "ffv1:group=4");
  const PackRule with_journal = rule_of(R"(codec: ["ffv1:group=4", "jpeg:95"], journal: png)");
  EXPECT_EQ(with_journal.codec, "ffv1:group=4");
  EXPECT_EQ(with_journal.journal, "png");
}

TEST(RecordingConfig, RefusesCodecsForWhatTheyAreNot) {
  const auto refused = [](const std::string& rule, const std::string& part) {
    expect_refused("entities:\n  - match: .*\n    codecs:\n      - " + rule,
                   AllOf(HasSubstr("rec.yaml:4"), HasSubstr(part)));
  };
  refused("{kind: number, codec: h264}", "not for numbers");
  refused("{kind: image, codec: columns}", "needs kind: number");
  refused("{kind: cloud, codec: h264}", "is for images");
  refused("{codec: h264, journal: jpeg}", "has loss");
  refused("{codec: png, journal: png}", "that of the journal already");
  refused("{codec: [png, jpeg], journal: png}", "that of the journal already");
  refused("{codec: []}", "needs one or more");
  refused("{codec: [png, gif]}", "unknown codec 'gif'");
}

}  // namespace
}  // namespace engram::ltm
