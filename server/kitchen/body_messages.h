// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what goes over the bus, as messages.

#include <engram/v1/kitchen_body.pb.h>

#include "datasets/kitchen/body_steps.h"
#include "datasets/kitchen/robot_bus.h"

namespace engram::server {

[[nodiscard]] v1::BodyDescription to_message(const datasets::kitchen::BodyDescription& body);
[[nodiscard]] v1::BodyState to_message(const datasets::kitchen::BodyState& state);
[[nodiscard]] v1::BodyDrawReply to_message(const datasets::kitchen::BodyPicture& picture);
[[nodiscard]] v1::BodyCommandRequest to_message(const datasets::kitchen::BodyCommand& command);
[[nodiscard]] v1::BodyStepRequest to_message(datasets::kitchen::SkillStep step);
[[nodiscard]] v1::BodyPassRequest to_message(const datasets::kitchen::PassWish& wish);

/// These read what another process sent. Errors: kInvalidArgument naming what is wrong.
Result<datasets::kitchen::BodyDescription> read_description(const v1::BodyDescription& message);
Result<datasets::kitchen::BodyState> read_state(const v1::BodyState& message);
Result<datasets::kitchen::BodyPicture> read_picture(const v1::BodyDrawReply& message);
Result<datasets::kitchen::BodyCommand> read_command(const v1::BodyCommandRequest& message);
Result<datasets::kitchen::SkillStep> read_step(const v1::BodyStepRequest& message);
Result<datasets::kitchen::PassWish> read_wish(const v1::BodyPassRequest& message);
/// A sample that a body may be at. Errors: kInvalidArgument naming `what` it is of.
Result<uint64_t> read_sample(uint64_t sample, std::string_view what);

}  // namespace engram::server
