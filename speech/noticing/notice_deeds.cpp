// SPDX-License-Identifier: Apache-2.0
#include "speech/noticing/notice_deeds.h"

#include <algorithm>
#include <map>

#include "speech/noticing/hand_joints.h"
#include "speech/noticing/hand_motion.h"
#include "speech/noticing/task_words.h"

namespace engram::speech {

namespace {

/// More samples of a hand than 20 a second tell nothing more of grasps.
constexpr Duration kMinStep = std::chrono::milliseconds(45);
constexpr Duration kPause = std::chrono::seconds(5);

/// Of more cameras nobody looks at the images.
constexpr size_t kMaxImages = 4;

struct Episode {
  ltm::MemoryId id;
  Time begins{};
  std::string task;
};

/// What was read of the hands of one entity.
struct HandSeries {
  HandJoints joints;
  std::vector<HandSample> samples;
  bool is_within_one = true;  ///< No number of it left 0..1.
  double sign = 1;            ///< -1: its numbers are smaller where it is more open.
};

/// One search; a method per stage.
class DeedSearch {
 public:
  DeedSearch(Memory& memory, const NoticeOptions& options, const ProgressSink& progress,
             const std::stop_token& stop)
      : memory_(memory), options_(options), progress_(progress), stop_(stop) {}

  Result<Noticed> run() {
    ENGRAM_RETURN_IF_ERROR(find_joints());
    ENGRAM_RETURN_IF_ERROR(read_episodes());
    for (const ltm::MemoryId& entity : noticed_.joints) {
      ENGRAM_ASSIGN_OR_RETURN(std::vector<HandSeries> hands, read_hands(entity));
      for (HandSeries& hand : hands) find_grasps(entity, hand);
    }
    for (NoticedDeed& deed : noticed_.deeds) ENGRAM_RETURN_IF_ERROR(find_images(deed));
    std::sort(noticed_.deeds.begin(), noticed_.deeds.end(),
              [](const NoticedDeed& a, const NoticedDeed& b) {
                return *a.close_began.time() < *b.close_began.time();
              });
    return std::move(noticed_);
  }

 private:
  Result<ltm::QueryResult> query(const std::string& text) {
    auto found = memory_.query(text);
    if (!found.ok() && found.status().code() == StatusCode::kNotFound) return ltm::QueryResult();
    return found;
  }

  Status find_joints() {
    const std::string names =
        options_.joints ? options_.joints->to_string() : std::string("RobotState");
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult latest, query(names + " @ latest"));
    ENGRAM_RETURN_IF_ERROR(read_description());
    for (const ltm::EntityResult* entity : latest.entities()) {
      if (entity->snapshots.empty() || entity->snapshots.back().instances.empty()) continue;
      const idf::Data& value = entity->snapshots.back().instances.front().data;
      std::vector<HandJoints> hands = hands_among(joint_names(value, described_));
      if (hands.empty()) continue;
      noticed_.joints.push_back(entity->id);
      hands_[entity->id] = std::move(hands);
    }
    if (noticed_.joints.empty())
      return not_found(
          "{}: no value has joints of a hand: names with left or right and hand, "
          "finger, thumb or gripper, or a description with joint_names",
          options_.joints ? options_.joints->printable() : "RobotState");
    return {};
  }

  /// The names of joints, which arrays do not have.
  Status read_description() {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult latest,
                            query("RobotState/Description @ latest"));
    for (const ltm::EntityResult* entity : latest.entities()) {
      if (entity->snapshots.empty() || entity->snapshots.back().instances.empty()) continue;
      const idf::Data* names = entity->snapshots.back().instances.front().data.at("joint_names");
      const auto* list = names == nullptr ? nullptr : names->get_if<idf::List>();
      if (list == nullptr) continue;
      described_.clear();
      for (const idf::Data& name : *list)
        described_.push_back(name.is<std::string>() ? name.get<std::string>() : std::string());
    }
    return {};
  }

  Status read_episodes() {
    ENGRAM_ASSIGN_OR_RETURN(const ltm::QueryResult found, query("Recording/Episodes @ all"));
    for (const ltm::EntityResult* entity : found.entities())
      for (const ltm::SnapshotResult& snapshot : entity->snapshots) {
        if (snapshot.instances.empty()) continue;
        Episode episode{entity->id.at(snapshot.time).instance(0), snapshot.time, {}};
        const idf::Data* tasks = snapshot.instances.front().data.at("attributes/tasks");
        const auto* list = tasks == nullptr ? nullptr : tasks->get_if<idf::List>();
        if (list != nullptr && list->size() == 1 && list->front().is<std::string>())
          episode.task = list->front().get<std::string>();
        episodes_.push_back(std::move(episode));
      }
    std::sort(episodes_.begin(), episodes_.end(),
              [](const Episode& a, const Episode& b) { return a.begins < b.begins; });
    noticed_.episodes = episodes_.size();
    return {};
  }

  Status find_images(NoticedDeed& deed) {
    ENGRAM_ASSIGN_OR_RETURN(
        const ltm::QueryResult found,
        query(fmt::format("?ids Vision @ at-or-before:{}", to_string(*deed.close_ended.time()))));
    for (const ltm::EntityResult* entity : found.entities())
      if (!entity->snapshots.empty() && deed.images.size() < kMaxImages)
        deed.images.push_back(entity->id.at(entity->snapshots.back().time).instance(0));
    return {};
  }

  Result<std::vector<HandSeries>> read_hands(const ltm::MemoryId& entity) {
    std::vector<HandSeries> hands;
    for (const HandJoints& joints : hands_[entity]) hands.push_back({.joints = joints});
    std::optional<Time> last;
    uint64_t read = 0;
    ENGRAM_ASSIGN_OR_RETURN(const ltm::Query all, ltm::Query::parse(entity.to_string() + " @ all"));
    ENGRAM_RETURN_IF_ERROR(memory_.query_parts(all, [&](const ltm::QueryResult& part) -> Status {
      if (stop_.stop_requested()) return cancelled("noticing was stopped");
      for (const ltm::EntityResult* one : part.entities())
        for (const ltm::SnapshotResult& snapshot : one->snapshots) {
          ++read;
          if (snapshot.instances.empty() || (last && snapshot.time - *last < kMinStep)) continue;
          last = snapshot.time;
          take(hands, snapshot.time, joint_numbers(snapshot.instances.front().data));
        }
      if (progress_)
        progress_({.what = "read " + entity.printable(),
                   .done = read,
                   .detail = last ? to_string(*last) : std::string()});
      return {};
    }));
    noticed_.snapshots += read;
    return hands;
  }

  static void take(std::vector<HandSeries>& hands, Time time, const std::vector<double>& numbers) {
    for (HandSeries& hand : hands) {
      const auto mean = mean_of(hand.joints, numbers);
      if (!mean) continue;
      hand.samples.push_back({time, *mean});
      for (const size_t column : hand.joints.columns)
        hand.is_within_one = hand.is_within_one && numbers[column] >= 0 && numbers[column] <= 1;
    }
  }

  [[nodiscard]] bool is_open_high(const HandSeries& hand) const {
    if (options_.open != OpenHand::kAuto) return options_.open == OpenHand::kHigh;
    // Whoever describes a robot tells its joints as angles.
    return hand.joints.is_gripper || (described_.empty() && hand.is_within_one);
  }

  /// The episode at a time; null: there is none.
  [[nodiscard]] const Episode* episode_at(Time time) const {
    const auto after =
        std::upper_bound(episodes_.begin(), episodes_.end(), time,
                         [](Time asked, const Episode& one) { return asked < one.begins; });
    return after == episodes_.begin() ? nullptr : &*std::prev(after);
  }

  void find_grasps(const ltm::MemoryId& entity, HandSeries& hand) {
    std::vector<HandSample>& samples = hand.samples;
    hand.sign = is_open_high(hand) ? 1 : -1;
    for (HandSample& sample : samples) sample.open *= hand.sign;
    const double min_change = min_swing(samples);
    size_t begin = 0;
    for (size_t i = 1; i <= samples.size(); ++i) {
      const Episode* episode = episode_at(samples[i - 1].time);
      const bool is_over = i == samples.size() || episode_at(samples[i].time) != episode ||
                           samples[i].time - samples[i - 1].time >= kPause;
      if (!is_over) continue;
      const auto part = std::span(samples).subspan(begin, i - begin);
      for (const Grasp& grasp : grasps_in(part, min_change))
        add(entity, hand, part, grasp, episode);
      begin = i;
    }
  }

  void add(const ltm::MemoryId& entity, const HandSeries& hand, std::span<const HandSample> samples,
           const Grasp& grasp, const Episode* episode) {
    const auto snapshot = [&](size_t at) { return entity.at(samples[at].time).instance(0); };
    NoticedDeed deed;
    deed.hand = hand.joints.hand;
    deed.episode_begins = samples.front().time;
    if (episode != nullptr) {
      const TaskWords words = task_words(episode->task);
      deed.task = episode->task;
      deed.thing = words.thing;
      deed.place = words.place;
      deed.episode = episode->id;
      deed.episode_begins = episode->begins;
    }
    deed.close_began = snapshot(grasp.close.began);
    deed.close_ended = snapshot(grasp.close.ended);
    deed.open_before = hand.sign * grasp.close.before;
    deed.open_after = hand.sign * grasp.close.after;
    if (grasp.has_let_go) {
      deed.open_began = snapshot(grasp.open.began);
      deed.open_ended = snapshot(grasp.open.ended);
    }
    noticed_.deeds.push_back(std::move(deed));
  }

  Memory& memory_;
  const NoticeOptions& options_;
  const ProgressSink& progress_;
  const std::stop_token& stop_;
  std::vector<std::string> described_;
  std::map<ltm::MemoryId, std::vector<HandJoints>> hands_;
  std::vector<Episode> episodes_;
  Noticed noticed_;
};

}  // namespace

Result<Noticed> notice_deeds(Memory& memory, const NoticeOptions& options,
                             const ProgressSink& progress, const std::stop_token& stop) {
  return DeedSearch(memory, options, progress, stop).run();
}

}  // namespace engram::speech
