// SPDX-License-Identifier: Apache-2.0
// Clients of a body in its own process.
#include <utility>

#include "datasets/kitchen/live_body.h"

namespace engram::datasets::kitchen {

namespace {

/// A client in the process of the body.
class NearBus final : public RobotBus {
 public:
  NearBus(LiveBody& body, LiveBody::Client client) : body_(body), client_(std::move(client)) {}
  ~NearBus() override { body_.leave(client_); }
  NearBus(const NearBus&) = delete;
  NearBus& operator=(const NearBus&) = delete;

  Result<BodyDescription> describe() override { return body_.describe(client_.name); }
  Result<std::vector<BodyState>> wait(uint64_t until, const std::stop_token& stop) override {
    while (true) {
      auto states = body_.wait(client_, until, {.stop = stop});
      if (!states.ok() || !states->empty()) return states;
    }
  }
  Result<BodyState> now() override {
    if (body_.has_ended()) return cancelled("the robot's body has ended");
    return body_.now();
  }
  Result<BodyPicture> draw(uint64_t until, uint64_t committed,
                           const std::stop_token& stop) override {
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(auto picture, body_.draw(client_, until, committed, {.stop = stop}));
      if (picture) return *std::move(picture);
    }
  }
  Result<double> command(const BodyCommand& command) override { return body_.command(command); }
  Result<std::string> poke(const std::string& what) override { return body_.poke(what); }

 private:
  LiveBody& body_;
  const LiveBody::Client client_;
};

class NearSteps final : public BodySteps {
 public:
  explicit NearSteps(LiveBody& body) : body_(body) {}

  Status tell(SkillStep step) override { return body_.step(step); }
  Result<uint64_t> pass(const PassWish& wish, const std::stop_token& stop) override {
    while (!stop.stop_requested()) {
      ENGRAM_ASSIGN_OR_RETURN(const auto sample, body_.pass(wish, {.stop = stop}));
      if (sample) return *sample;
    }
    ENGRAM_RETURN_IF_ERROR(body_.pass({.id = wish.id, .samples = 0}, {.stop = stop}).status());
    return cancelled("told to stop");
  }

 private:
  LiveBody& body_;
};

}  // namespace

std::unique_ptr<RobotBus> LiveBody::bus(std::string client) {
  return std::make_unique<NearBus>(*this, Client{std::move(client), next_bus()});
}

std::unique_ptr<BodySteps> LiveBody::steps() {
  return std::make_unique<NearSteps>(*this);
}

}  // namespace engram::datasets::kitchen
