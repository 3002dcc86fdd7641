// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>

#include "speech/facts/known_facts.h"
#include "speech/noticing/notice_deeds.h"
#include "speech/noticing/task_words.h"

namespace engram::speech {

namespace {

constexpr const char* kProvider = "noticed";
constexpr const char* kTakes = "pick";
constexpr const char* kLetsGo = "release";
/// A hand that closes on nothing looks the same.
constexpr float kConfidence = 0.8F;

enum class Stage : int32_t { kStarted = 0, kEnded = 2 };

ltm::MemoryId named(const char* memory, const char* core, const std::string& entity) {
  return ltm::MemoryId::from_names({memory, core, kProvider, entity}).value();
}

idf::Data text(const std::string& words) {
  return idf::Data(words);
}

std::string link(const std::optional<ltm::MemoryId>& id) {
  return id ? id->to_string() : std::string();
}

/// The executions that were noticed before. What a hand did is found a little earlier or later once
/// more is known of its range, so a deed is known where one begins about when it does.
class KnownDeeds {
 public:
  explicit KnownDeeds(const std::vector<Execution>& executions) {
    for (const Execution& one : executions)
      if (one.provider == kProvider) starts_[{one.skill, one.hand}].insert(one.started);
  }

  [[nodiscard]] bool has(const char* skill, const std::string& hand, Time began, Time ended) const {
    constexpr Duration kAbout = std::chrono::milliseconds(500);
    const auto starts = starts_.find({skill, hand});
    if (starts == starts_.end()) return false;
    const auto found = starts->second.lower_bound(began - kAbout);
    return found != starts->second.end() && *found <= ended;
  }

 private:
  std::map<std::pair<std::string, std::string>, std::set<Time>> starts_;
};

/// The snapshots of deeds, in the order of their times.
class DeedCommits {
 public:
  explicit DeedCommits(const KnownFacts& facts)
      : world_(facts.world()), known_(facts.executions()) {}

  /// Returns whether something of it was not known.
  bool add(const NoticedDeed& deed) {
    const bool has_let_go = deed.open_began && deed.open_ended;
    const bool is_taking_new =
        !known_.has(kTakes, deed.hand, *deed.close_began.time(), *deed.close_ended.time());
    const bool is_letting_go_new =
        has_let_go &&
        !known_.has(kLetsGo, deed.hand, *deed.open_began->time(), *deed.open_ended->time());
    if (!is_taking_new && !is_letting_go_new) return false;
    const std::optional<ltm::MemoryId> thing = thing_of(deed);
    const std::optional<ltm::MemoryId> place = place_of(deed);
    const std::optional<ltm::MemoryId> plan = plan_of(deed, thing, place);
    const auto tell = [&](const char* skill, const ltm::MemoryId& began, const ltm::MemoryId& ended,
                          const std::string& reason) {
      // Both hands may do something at the same moment.
      const ltm::MemoryId entity = named("Skill", "Event", std::string(skill) + "_" + deed.hand);
      idf::Dict event{{"skill", std::string(kProvider) + "/" + skill},
                      {"stage", static_cast<int32_t>(Stage::kStarted)},
                      {"outcome", int32_t{0}},
                      {"reason", ""},
                      {"started", to_ns(*began.time())},
                      {"hand", text(deed.hand)},
                      {"object", text(link(thing))},
                      {"surface", text(link(place))},
                      {"plan", text(link(plan))},
                      {"read_from", idf::Data(read_from(deed, began, ended))}};
      put(entity, *began.time(), event);
      event.set("stage", static_cast<int32_t>(Stage::kEnded));
      event.set("outcome", int32_t{1});
      event.set("reason", text(reason));
      event.set("ended", to_ns(*ended.time()));
      put(entity, *ended.time(), event);
      if (thing) put_state(*thing, *ended.time(), began == deed.close_began ? deed.hand : "");
    };
    if (is_taking_new)
      tell(kTakes, deed.close_began, deed.close_ended,
           fmt::format("the {} closed from {:.2f} to {:.2f}", spoken_hand(deed.hand),
                       deed.open_before, deed.open_after));
    if (is_letting_go_new)
      tell(kLetsGo, *deed.open_began, *deed.open_ended,
           fmt::format("the {} opened again", spoken_hand(deed.hand)));
    return true;
  }

  [[nodiscard]] ltm::Commit take() {
    std::stable_sort(commit_.updates.begin(), commit_.updates.end(),
                     [](const auto& a, const auto& b) { return a.time < b.time; });
    return std::move(commit_);
  }

 private:
  /// Two moments of joints, and what cameras saw when something was taken.
  static idf::List read_from(const NoticedDeed& deed, const ltm::MemoryId& began,
                             const ltm::MemoryId& ended) {
    idf::List links{text(began.to_string()), text(ended.to_string())};
    if (began == deed.close_began)
      for (const ltm::MemoryId& image : deed.images) links.push_back(text(image.to_string()));
    return links;
  }

  /// A second snapshot of an entity at the same time says the same.
  void put(const ltm::MemoryId& entity, Time time, idf::Dict value) {
    if (!put_.emplace(entity, time).second) return;
    commit_.updates.push_back({entity, time, {{idf::Data(std::move(value)), {}}}});
    ltm::InstanceMetadata& metadata = commit_.updates.back().instances.front().metadata;
    metadata.created = time;
    metadata.provider = kProvider;
    metadata.confidence = kConfidence;
  }

  void put_state(const ltm::MemoryId& thing, Time time, const std::string& held_by) {
    // What others tell of a thing is known better.
    if (thing.names()[2] != kProvider) return;
    std::string kind = thing.names().back();
    kind.resize(kind.rfind('_'));
    idf::Dict state{{"object_class", named("Objects", "Classes", kind).to_string()},
                    {"pose_world_object", idf::Data()},
                    {"held_by", text(held_by)}};
    put(thing, time, std::move(state));
  }

  std::optional<ltm::MemoryId> thing_of(const NoticedDeed& deed) {
    if (deed.thing.empty()) return {};
    if (const auto known = world_.things_called(deed.thing); !known.empty()) return known.front();
    const std::string name = entity_name(deed.thing);
    const ltm::MemoryId thing = named("Objects", "Instances", name + "_1");
    if (!made_.insert(thing).second) return thing;
    put(named("Objects", "Classes", name), deed.episode_begins,
        {{"name", text(head_word(deed.thing))}, {"spoken_name", text(deed.thing)}});
    put_state(thing, deed.episode_begins, "");
    return thing;
  }

  std::optional<ltm::MemoryId> place_of(const NoticedDeed& deed) {
    if (deed.place.empty()) return {};
    if (const auto known = world_.places_called(deed.place); !known.empty()) return known.front();
    const ltm::MemoryId place = named("Navigation", "Locations", entity_name(deed.place));
    if (made_.insert(place).second)
      put(place, deed.episode_begins, {{"name", text(deed.place)}, {"aliases", idf::List{}}});
    return place;
  }

  std::optional<ltm::MemoryId> plan_of(const NoticedDeed& deed,
                                       const std::optional<ltm::MemoryId>& thing,
                                       const std::optional<ltm::MemoryId>& place) {
    if (deed.task.empty()) return {};
    const ltm::MemoryId entity = named("Tasks", "Plans", "plan");
    const std::string skill = task_words(deed.task).skill;
    put(entity, deed.episode_begins,
        {{"goal", text(deed.task)},
         {"command", ""},
         {"steps", idf::Data(idf::List{idf::Data(idf::Dict{{"skill", text(skill)},
                                                           {"object", text(link(thing))},
                                                           {"surface", text(link(place))}})})},
         {"episode", text(deed.episode.to_string())}});
    return entity.at(deed.episode_begins).instance(0);
  }

  const KnownWorld& world_;
  const KnownDeeds known_;
  ltm::Commit commit_;
  std::set<std::pair<ltm::MemoryId, Time>> put_;
  std::set<ltm::MemoryId> made_;  ///< Things and places that the memory did not know.
};

}  // namespace

Result<size_t> remember_deeds(Memory& memory, const std::vector<NoticedDeed>& deeds) {
  ENGRAM_ASSIGN_OR_RETURN(const auto facts, KnownFacts::read(memory));
  std::vector<const Execution*> told;
  for (const Execution& execution : facts->executions())
    if (execution.provider != kProvider) told.push_back(&execution);
  const auto teller_of = [&told](const NoticedDeed& deed) {
    return std::find_if(told.begin(), told.end(), [&](const Execution* execution) {
      return execution->is_within(deed.episode_begins, *deed.close_ended.time());
    });
  };
  DeedCommits commits(*facts);
  size_t count = 0;
  size_t left_out = 0;
  for (const NoticedDeed& deed : deeds)
    if (teller_of(deed) != told.end())
      ++left_out;
    else
      count += commits.add(deed) ? 1 : 0;
  if (!deeds.empty() && left_out == deeds.size()) {
    const Execution& execution = **teller_of(deeds.front());
    return failed_precondition(
        "the memory was told what the robot did: '{}' at {}; what is found in its joints would be "
        "the same deeds again",
        execution.skill, to_string(execution.started));
  }
  if (count > 0) ENGRAM_RETURN_IF_ERROR(memory.commit(commits.take()));
  return count;
}

}  // namespace engram::speech
