// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/live_body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "datasets/kitchen/drivers.h"
#include "datasets/kitchen/kitchen_types.h"
#include "ltm/memory/links.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets::kitchen {
namespace {

using ::testing::HasSubstr;

LiveBody::Options stepped(std::vector<std::string> clients) {
  LiveBody::Options options;
  options.kitchen = KitchenOptions::fast();
  options.kitchen.width = options.kitchen.height = 64;
  options.is_stepped = true;
  options.clients = std::move(clients);
  return options;
}

/// All that both drivers commit in some seconds, by snapshot.
std::map<ltm::MemoryId, ltm::EntityUpdate> driven(const LiveBody::Options& options) {
  auto body = LiveBody::start(options);
  EXPECT_OK(body);
  std::map<ltm::MemoryId, ltm::EntityUpdate> all;
  std::mutex mutex;
  const DriverOptions drivers{.commit =
                                  [&](const ltm::Commit& commit) {
                                    const std::lock_guard lock(mutex);
                                    EXPECT_OK(commit.check());
                                    for (const ltm::EntityUpdate& update : commit.updates)
                                      all[update.id()] = update;
                                    return Status();
                                  },
                              .declare = [] { return Status(); },
                              .say = [](const std::string&) {},
                              .tell = [](const std::map<std::string, double>&) {}};
  {
    const std::jthread state([&](const std::stop_token& stop) {
      EXPECT_OK(drive_state(*(*body)->bus("state"), drivers, stop));
    });
    const std::jthread camera([&](const std::stop_token& stop) {
      EXPECT_OK(drive_camera(*(*body)->bus("camera"), drivers, stop));
    });
    EXPECT_TRUE((*body)->wait_for_end(std::stop_token()));
  }
  return all;
}

TEST(LiveBody, GivesEqualSnapshotsInStepsWhoseLinksResolve) {
  LiveBody::Options options = stepped({"state", "camera"});
  options.seconds = 1;
  options.pokes = {"chair to 0.6,0", "person to -0.6,-1.0,90"};
  const auto first = driven(options);
  EXPECT_TRUE(first == driven(options));
  std::map<std::string, int> counts;
  int links = 0;
  for (const auto& [id, update] : first) {
    ++counts[update.entity.to_string()];
    for (const auto& instance : update.instances)
      for (const ltm::Link& link : ltm::find_links(instance.data)) {
        ++links;
        EXPECT_TRUE(first.contains(link.id.parent())) << link.id.to_string();
      }
  }
  EXPECT_GT(links, 300);
  EXPECT_EQ(counts["RobotState/Proprioception/robot/joints"], 101);
  EXPECT_EQ(counts["RobotState/Localization/robot/platform"], 101);
  EXPECT_EQ(counts["Vision/RGB/head/stereo"], 21);
  EXPECT_EQ(counts["Objects/Instances/kitchen/chair_1"], 6);
  EXPECT_EQ(counts["Objects/Instances/kitchen/person_1"], 6);
  EXPECT_EQ(counts["Objects/Classes/kitchen/chair"], 1);
  EXPECT_EQ(counts["Objects/Classes/kitchen/salt_box"], 1);
  EXPECT_EQ(counts["Objects/Surfaces/kitchen/table"], 1);
  EXPECT_EQ(counts["RobotState/Description/robot/body"], 1);
  EXPECT_EQ(counts["Vision/Calibration/head/left"], 1);
}

TEST(LiveBody, WaitsForEachClientOfASteppedBody) {
  auto body = LiveBody::start(stepped({"one", "other"}));
  ASSERT_OK(body);
  const auto one = (*body)->bus("one");
  const auto other = (*body)->bus("other");
  std::atomic<bool> is_there = false;
  std::jthread waiting([&] {
    EXPECT_OK(one->wait(3, {}));
    is_there = true;
  });
  ASSERT_OK(other->wait(2, {}));
  EXPECT_FALSE(is_there) << "the other one has not said that it is done with sample 2";
  const auto states = other->wait(3, {});
  waiting.join();
  ASSERT_OK(states);
  EXPECT_EQ(states->back().sample, 3u);
}

TEST(LiveBody, ShowsChairAndPersonWhereTheyArePoked) {
  auto body = LiveBody::start(stepped({"eye"}));
  ASSERT_OK(body);
  const auto bus = (*body)->bus("eye");
  const auto image = [&](uint64_t until) {
    const auto picture = bus->draw(until, 0, {});
    EXPECT_OK(picture);
    const auto pixels = picture->left.values<uint8_t>();
    return std::vector<uint8_t>(pixels.begin(), pixels.end());
  };
  const auto changed = [](const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
    size_t count = 0;
    for (size_t i = 0; i < a.size(); ++i) count += std::abs(a[i] - b[i]) > 8;
    return static_cast<double>(count) / static_cast<double>(a.size());
  };
  const auto object = [&](const std::string& name, uint64_t until) {
    const auto states = bus->wait(until, {});
    EXPECT_OK(states);
    for (const SensedObject& one : states->back().objects)
      if (one.name == name) return one;
    ADD_FAILURE() << name;
    return SensedObject();
  };
  const auto empty = image(1);
  EXPECT_FALSE(object("chair", 2).is_visible);
  // The robot looks at the table, from between it and the counter.
  const auto poked = bus->poke("person to -0.85,0.2");
  ASSERT_OK(poked);
  EXPECT_EQ(*poked, "the person is at -0.85,0.2");
  EXPECT_GT(changed(empty, image(3)), 0.05);
  const SensedObject person = object("person", 4);
  EXPECT_TRUE(person.is_visible);
  EXPECT_NEAR(person.pose.translation().x(), -0.85, 1e-9);
  ASSERT_OK(bus->poke("person away"));
  EXPECT_LT(changed(empty, image(5)), 0.02);
  ASSERT_OK(bus->poke("chair to -0.9,0,45"));
  EXPECT_GT(changed(empty, image(6)), 0.02);
  EXPECT_TRUE(object("chair", 7).is_visible);
}

TEST(LiveBody, TellsWhatIsWrongWithAPoke) {
  auto body = LiveBody::start(stepped({"one"}));
  ASSERT_OK(body);
  const auto bus = (*body)->bus("one");
  const auto message = [&](const std::string& what) {
    const auto poked = bus->poke(what);
    EXPECT_FALSE(poked.ok()) << what;
    return poked.status().message();
  };
  EXPECT_THAT(message("char to 1,0"), HasSubstr("has no 'char'; it has"));
  EXPECT_THAT(message("char to 1,0"), HasSubstr("chair, person"));
  EXPECT_THAT(message("chair"), HasSubstr("neither 'to' nor 'away'"));
  EXPECT_THAT(message("chair to 1"), HasSubstr("found the place '1'"));
  EXPECT_THAT(message("chair to 1,nan"), HasSubstr("found the place"));
  EXPECT_THAT(message("chair to 9,0"), HasSubstr("needs x from"));
  EXPECT_THAT(message("person to 0,1.5"), HasSubstr("the counter is there"));
  EXPECT_THAT(message("chair to table"), HasSubstr("needs a place on the floor"));
  EXPECT_THAT(message(std::string(300, 'x')), HasSubstr("300 letters"));
  const auto states = bus->wait(0, {});
  ASSERT_OK(states);
  const RobotVector& at = states->back().positions;
  EXPECT_THAT(message(fmt::format("chair to {:.2f},{:.2f}", at[0], at[1])),
              HasSubstr("the robot is there"));
  ASSERT_OK(bus->poke("chair to 1,0"));
  EXPECT_THAT(message("person to 1.1,0"), HasSubstr("the chair is there"));
  const std::string thing = states->back().objects.front().name;
  ASSERT_OK(bus->poke(thing + " to table"));
  const auto later = bus->wait(50, {});
  ASSERT_OK(later);
  EXPECT_LT(later->back().objects.front().pose.translation().x(), -1);
  EXPECT_NEAR(later->back().objects.front().pose.linear()(2, 2), 1, 1e-3) << "it stands";
}

TEST(LiveBody, RefusesCommandsThatItCannotCarryOut) {
  auto body = LiveBody::start(stepped({"one"}));
  ASSERT_OK(body);
  const auto bus = (*body)->bus("one");
  EXPECT_FAILS(bus->command(MoveJoints{{3}, {1.0, 2.0}, 1}), StatusCode::kInvalidArgument,
               "1 joints and 2");
  EXPECT_FAILS(bus->command(MoveJoints{{0}, {1.0}, 1}), StatusCode::kInvalidArgument, "joint 0");
  EXPECT_FAILS(bus->command(MoveJoints{{46}, {1.0}, 1}), StatusCode::kInvalidArgument, "joint 46");
  EXPECT_FAILS(bus->command(MoveJoints{{5}, {NAN}, 1}), StatusCode::kInvalidArgument, "nan");
  EXPECT_FAILS(bus->command(MoveJoints{{5}, {1.0}, 0}), StatusCode::kInvalidArgument, "0 s");
  EXPECT_FAILS(bus->command(Drive{{NAN, 0, 0}}), StatusCode::kInvalidArgument, "nan");
  EXPECT_FAILS(bus->command(DriveTo{{1e9, 0, 0}, 1}), StatusCode::kInvalidArgument, "below 100");
  EXPECT_FAILS(bus->command(LookAt{"dog", {0, 0, 0}}), StatusCode::kNotFound, "has no 'dog'");
  EXPECT_FAILS(bus->command(Hold{Side::kLeft, "chair", {0, 0, 0}}), StatusCode::kInvalidArgument,
               "chair");
  Pose skewed = Pose::Identity();
  skewed.linear() *= 2;
  EXPECT_FAILS(bus->command(MoveHand{Side::kLeft, skewed, 1}), StatusCode::kInvalidArgument,
               "rotation");
}

TEST(LiveBody, StopsThePlatformBeforeAChairAndWhenItsDriverIsSilent) {
  auto body = LiveBody::start(stepped({"one"}));
  ASSERT_OK(body);
  const auto bus = (*body)->bus("one");
  uint64_t now = 0;
  const auto pass = [&](uint64_t samples) {
    const auto states = bus->wait(now += samples, {});
    EXPECT_OK(states);
    return states->back();
  };
  const BodyState begin = pass(1);
  const Eigen::Vector2d from = begin.positions.head<2>();
  const double heading = begin.positions[2];
  const Eigen::Vector2d ahead(std::cos(heading), std::sin(heading));
  // Nobody repeats the velocity, so it ends.
  ASSERT_OK(bus->command(Drive{{0.2, 0, 0}}));
  const BodyState silent = pass(100);
  EXPECT_LT(silent.velocities.head<3>().norm(), 1e-3);
  EXPECT_GT((silent.positions.head<2>() - from).norm(), 0.03);

  const Eigen::Vector2d chair = from - 0.9 * ahead;
  ASSERT_OK(bus->poke(fmt::format("chair to {},{}", chair.x(), chair.y())));
  BodyState state;
  for (int i = 0; i < 60; ++i) {
    ASSERT_OK(bus->command(Drive{{-0.6, 0, 0}}));
    state = pass(5);
  }
  EXPECT_EQ(state.blocked_by, "chair");
  EXPECT_LT(state.velocities.head<3>().norm(), 1e-3);
  const double gap = (state.positions.head<2>() - chair).norm() - 0.28 - 0.22;
  EXPECT_GT(gap, 0.0);
  EXPECT_LT(gap, 0.25);
  // It may drive away.
  ASSERT_OK(bus->command(Drive{{0.3, 0, 0}}));
  state = pass(20);
  EXPECT_EQ(state.blocked_by, "");
  EXPECT_GT((state.positions.head<2>() - chair).norm() - 0.5, gap);
}

TEST(LiveBody, BrakesWhenAVelocityIsRefused) {
  auto body = LiveBody::start(stepped({"one"}));
  ASSERT_OK(body);
  const auto bus = (*body)->bus("one");
  uint64_t now = 0;
  const auto pass = [&](uint64_t samples) {
    const auto states = bus->wait(now += samples, {});
    EXPECT_OK(states);
    return states->back();
  };
  const BodyState begin = pass(1);
  const auto speed = [](const BodyState& state) { return state.velocities.head<2>().norm(); };
  for (int i = 0; i < 4; ++i) {
    ASSERT_OK(bus->command(Drive{{-0.3, 0, 0}}));
    pass(10);
  }
  // What is refused is no reason to go on with what was wanted before.
  EXPECT_FAILS(bus->command(Drive{{NAN, 0, 0}}), StatusCode::kInvalidArgument, "nan");
  EXPECT_LT(speed(pass(25)), 0.15) << "it would hold for 0.3 s";

  // Before a chair a quicker velocity is refused; the one before would go on for 0.3 s.
  const BodyState rest = pass(40);
  const double heading = begin.positions[2];
  const Eigen::Vector2d ahead(std::cos(heading), std::sin(heading));
  const Eigen::Vector2d chair = rest.positions.head<2>() - 0.75 * ahead;
  ASSERT_OK(bus->poke(fmt::format("chair to {},{}", chair.x(), chair.y())));
  ASSERT_OK(bus->command(Drive{{-0.2, 0, 0}}));
  pass(10);
  ASSERT_OK(bus->command(Drive{{-1, 0, 0}}));
  const BodyState refused = pass(1);
  EXPECT_EQ(refused.blocked_by, "chair");
  const BodyState later = pass(39);
  EXPECT_LT(speed(later), 1e-3);
  EXPECT_LT((later.positions - refused.positions).head<2>().norm(), 0.05);
}

TEST(LiveBody, TellsADriverThatDiedWhatItMissed) {
  LiveBody::Options options = stepped({"state"});
  options.is_stepped = false;
  options.speed = 20;
  auto body = LiveBody::start(options);
  ASSERT_OK(body);
  {
    const auto bus = (*body)->bus("state");
    EXPECT_EQ(bus->describe()->begin, 0u);
    const auto states = bus->wait(0, {});
    ASSERT_OK(states);
    EXPECT_EQ(states->front().sample, 0u);
    ASSERT_OK(bus->wait(7, {}));
  }
  const auto watch = (*body)->bus("one");
  ASSERT_OK(watch->wait(200, {}));
  const auto bus = (*body)->bus("state");
  const auto about = bus->describe();
  ASSERT_OK(about);
  EXPECT_EQ(about->begin, 7u) << "it asked for 7, and nobody knows what became of that";
  const auto missed = bus->wait(7, {});
  ASSERT_OK(missed);
  EXPECT_EQ(missed->front().sample, 7u);
  EXPECT_GE(missed->back().sample, 200u);
  EXPECT_LE(missed->size(), RobotBus::kMaxStates);
  // Whoever only steers needs the newest alone.
  EXPECT_EQ(watch->wait(0, {})->size(), 1u);
}

TEST(LiveBody, SaysWhatItsStateDriverLost) {
  LiveBody::Options options = stepped({"state", "camera"});
  options.is_stepped = false;
  options.speed = 100;
  options.seconds = 15;
  auto body = LiveBody::start(options);
  ASSERT_OK(body);
  ASSERT_OK((*body)->bus("one")->wait(1300, {}));
  std::vector<std::string> words;
  std::map<std::string, double> figures;
  const DriverOptions driver{.commit = [](const ltm::Commit&) { return Status(); },
                             .declare = [] { return Status(); },
                             .say = [&](const std::string& text) { words.push_back(text); },
                             .tell = [&](const auto& told) { figures = told; }};
  EXPECT_OK(drive_state(*(*body)->bus("state"), driver, {}));
  EXPECT_GE(figures["lost"], 300);
  EXPECT_EQ(figures["samples"] + figures["lost"], 1501);
  ASSERT_FALSE(words.empty());
  EXPECT_THAT(words.front(), HasSubstr("samples from"));
}

TEST(LiveBody, TellsThatAChairLeftWhileTheMemoryWasAway) {
  LiveBody::Options options = stepped({"state"});
  options.seconds = 1;
  options.is_stepped = false;
  auto body = LiveBody::start(options);
  ASSERT_OK(body);
  ASSERT_OK((*body)->poke("chair to 0.6,0"));
  bool memory_is_away = false;
  double last_x = 0;
  int after = 0;
  const ltm::MemoryId chair = *ltm::MemoryId::parse("Objects/Instances/kitchen/chair_1");
  const auto keep = [&](const ltm::Commit& commit) -> Status {
    if (memory_is_away) {
      // It comes back once the chair has left, and what told that is lost.
      for (const ltm::EntityUpdate& update : commit.updates)
        memory_is_away = memory_is_away && update.entity != chair;
      return unavailable("away");
    }
    for (const ltm::EntityUpdate& update : commit.updates) {
      if (update.entity != chair) continue;
      last_x = ::kitchen::ObjectInstance::from_idf(update.instances.front().data)
                   ->pose_world_object.position.x();
      if (after++ > 0) continue;
      memory_is_away = true;
      EXPECT_OK((*body)->poke("chair away"));
    }
    return {};
  };
  const DriverOptions driver{.commit = keep,
                             .declare = [] { return Status(); },
                             .say = [](const std::string&) {},
                             .tell = [](const auto&) {}};
  EXPECT_OK(drive_state(*(*body)->bus("state"), driver, {}));
  EXPECT_EQ(after, 2) << "once where it was, and once that it is gone";
  EXPECT_GT(last_x, 3);
}

TEST(LiveBody, TakesTheTimeOfItsBeginOnceItIsBuilt) {
  LiveBody::Options options = stepped({"one"});
  options.start = system_now;
  const Time before = system_now();
  auto body = LiveBody::start(options);
  ASSERT_OK(body);
  // Building takes half a second or more, and reading the clock nothing.
  const Time begin = (*body)->describe().start;
  EXPECT_GT(begin - before, std::chrono::milliseconds(20));
  EXPECT_LE(begin, system_now());
}

/// A stepped body with skills, whose only driver goes on by itself.
class LiveBodySkills : public ::testing::Test {
 protected:
  void start(bool is_held) {
    LiveBody::Options options = stepped({"state"});
    options.awaits_skills = true;
    options.is_held = is_held;
    auto body = LiveBody::start(options);
    ASSERT_OK(body);
    body_ = *std::move(body);
    steps_ = body_->steps();
    state_ = std::jthread([bus = body_->bus("state")](const std::stop_token& stop) {
      for (uint64_t next = 0; bus->wait(next, stop).ok(); ++next) {
      }
    });
  }
  uint64_t now() { return body_->now().sample; }
  /// Whether time stands still, as far as a while tells.
  bool stands() {
    const uint64_t before = now();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return now() == before;
  }

  std::unique_ptr<LiveBody> body_;
  std::unique_ptr<BodySteps> steps_;
  std::jthread state_;
};

TEST_F(LiveBodySkills, LetTimePassWhenEachExecutionWaits) {
  start(false);
  EXPECT_TRUE(stands()) << "its skills are not there yet";
  ASSERT_OK(steps_->tell(SkillStep::kCome));
  ASSERT_OK(steps_->tell(SkillStep::kReady));
  EXPECT_FALSE(stands()) << "nothing runs";
  ASSERT_OK(steps_->tell(SkillStep::kBegin));
  const uint64_t begin = now();
  EXPECT_TRUE(stands()) << "the execution has not waited yet";
  auto bus = body_->bus(std::string(RobotBus::kSkills));
  EXPECT_EQ(bus->now()->sample, begin);
  ASSERT_OK(bus->wait(begin + 30, {}));
  EXPECT_EQ(now(), begin + 30);
  EXPECT_TRUE(stands());
  // Another one.
  ASSERT_OK(steps_->tell(SkillStep::kBegin));
  auto other = body_->bus(std::string(RobotBus::kSkills));
  std::jthread waiting([&] { EXPECT_OK(bus->wait(begin + 40, {})); });
  EXPECT_TRUE(stands());
  ASSERT_OK(other->wait(begin + 35, {}));
  EXPECT_EQ(now(), begin + 35);
  other.reset();
  EXPECT_TRUE(stands()) << "it has left, and has not ended";
  ASSERT_OK(steps_->tell(SkillStep::kEnd));
  waiting.join();
  EXPECT_EQ(now(), begin + 40);
  // Its driver was killed, and there is another one.
  ASSERT_OK(steps_->tell(SkillStep::kCome));
  EXPECT_TRUE(stands());
  ASSERT_OK(steps_->tell(SkillStep::kReady));
  EXPECT_FALSE(stands());
  EXPECT_FAILS(steps_->tell(SkillStep::kEnd), StatusCode::kFailedPrecondition, "none has begun");
  EXPECT_FAILS(steps_->pass({}, {}), StatusCode::kFailedPrecondition, "not held");
}

TEST_F(LiveBodySkills, LetHeldTimePassAsLongAsSomebodyWants) {
  start(true);
  ASSERT_OK(steps_->tell(SkillStep::kCome));
  ASSERT_OK(steps_->tell(SkillStep::kReady));
  EXPECT_TRUE(stands());
  const auto passed = steps_->pass({.id = 1, .samples = 30}, {});
  ASSERT_OK(passed);
  EXPECT_EQ(*passed, 30u);
  EXPECT_TRUE(stands());
  EXPECT_EQ(*steps_->pass({.id = 1, .samples = 30}, {}), 30u) << "it is the same wish";
  // An execution that takes 12 samples.
  ASSERT_OK(steps_->tell(SkillStep::kBegin));
  std::jthread execution([this] {
    {
      const auto bus = body_->bus(std::string(RobotBus::kSkills));
      EXPECT_OK(bus->wait(42, {}));
    }
    EXPECT_OK(steps_->tell(SkillStep::kEnd));
  });
  const auto ended = steps_->pass({.id = 2, .samples = 1000, .until_end = true}, {});
  ASSERT_OK(ended);
  EXPECT_EQ(*ended, 42u);
  EXPECT_TRUE(stands());
  // A stop ends it while it passes, and somebody else may let time pass then.
  std::stop_source stop;
  std::jthread stopping([&] {
    EXPECT_OK(body_->bus("one")->wait(60, {}));
    stop.request_stop();
  });
  EXPECT_FAILS(steps_->pass({.id = 3, .samples = 1'000'000}, stop.get_token()),
               StatusCode::kCancelled, "told to stop");
  EXPECT_TRUE(stands());
  EXPECT_OK(steps_->pass({.id = 4, .samples = 5}, {}));
}

TEST(LiveBody, FollowsTheClockWhenItIsNotStepped) {
  LiveBody::Options options = stepped({});
  options.is_stepped = false;
  options.speed = 20;
  options.seconds = 4;
  auto body = LiveBody::start(options);
  ASSERT_OK(body);
  const auto bus = (*body)->bus("one");
  const auto first = bus->wait(10, {});
  ASSERT_OK(first);
  EXPECT_GE(first->back().sample, 10u);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FAILS(bus->wait(399, stop.get_token()), StatusCode::kCancelled, "stopped");
  EXPECT_TRUE((*body)->wait_for_end(std::stop_token()));
  EXPECT_FAILS(bus->wait(401, {}), StatusCode::kCancelled, "has ended");
  EXPECT_EQ((*body)->counters().samples, 401u);
}

TEST(LiveBody, ChecksItsOptions) {
  LiveBody::Options options = stepped({});
  EXPECT_FAILS(LiveBody::start(options), StatusCode::kInvalidArgument, "without clients");
  options = stepped({"one"});
  options.speed = 0;
  EXPECT_FAILS(LiveBody::start(options), StatusCode::kInvalidArgument, "speed 0");
  options.speed = 1;
  options.is_held = true;
  EXPECT_FAILS(LiveBody::start(options), StatusCode::kInvalidArgument, "held without skills");
  options.is_held = false;
  options.is_stepped = false;
  options.awaits_skills = true;
  EXPECT_FAILS(LiveBody::start(options), StatusCode::kInvalidArgument, "not stepped");
  options.is_stepped = true;
  options.awaits_skills = false;
  options.pokes = {"dog to 1,1"};
  EXPECT_FAILS(LiveBody::start(options), StatusCode::kNotFound, "no 'dog'");
}

}  // namespace
}  // namespace engram::datasets::kitchen
