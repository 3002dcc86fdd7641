// SPDX-License-Identifier: Apache-2.0
#include "server/names/registration.h"

#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

Registration plain() {
  return {"vision-on-head", {"Vision"}, {"unix:/run/vision.sock", "head:50051"}, 1};
}

TEST(Registration, TakesNamesInAnyScriptAndAServerWithoutMemories) {
  EXPECT_OK(plain().check({}));
  Registration other = plain();
  other.server = "öffnung";
  other.memories = {};
  EXPECT_OK(other.check({}));
  other.memories = {"Vision/with a slash", "line\nbreak"};
  EXPECT_OK(other.check({}));
}

TEST(Registration, RefusesTextsThatAreNone) {
  Registration one = plain();
  one.server = "";
  EXPECT_FAILS(one.check({}), StatusCode::kInvalidArgument, "its name is empty");
  one.server = "line\nbreak";
  EXPECT_FAILS(one.check({}), StatusCode::kInvalidArgument, "control characters");
  one.server = "\xff";
  EXPECT_FAILS(one.check({}), StatusCode::kInvalidArgument, "no UTF-8");
  one = plain();
  one.endpoints[1] = std::string("host\0:1", 7);
  EXPECT_FAILS(one.check({}), StatusCode::kInvalidArgument,
               "server 'vision-on-head': an endpoint has control characters");
  one = plain();
  one.memories.push_back("");
  EXPECT_FAILS(one.check({}), StatusCode::kInvalidArgument, "name of a memory is empty");
}

TEST(Registration, RefusesWhatIsThereTwice) {
  Registration one = plain();
  one.memories.push_back("Vision");
  EXPECT_FAILS(one.check({}), StatusCode::kInvalidArgument, "memory 'Vision' twice");
  one = plain();
  one.endpoints.push_back(one.endpoints[0]);
  EXPECT_FAILS(one.check({}), StatusCode::kInvalidArgument, "twice");
}

TEST(Registration, IsBounded) {
  const RegistrationLimits limits{.memories = 2, .endpoints = 2, .text_bytes = 30};
  EXPECT_OK(plain().check(limits));
  Registration one = plain();
  one.memories = {"a", "b", "c"};
  EXPECT_FAILS(one.check(limits), StatusCode::kInvalidArgument, "3 memories, at most 2");
  one = plain();
  one.endpoints = {"a", "b", "c"};
  EXPECT_FAILS(one.check(limits), StatusCode::kInvalidArgument, "3 endpoints, at most 2");
  one.endpoints = {};
  EXPECT_FAILS(one.check(limits), StatusCode::kInvalidArgument, "no endpoint");
  one = plain();
  one.memories = {std::string(31, 'x')};
  EXPECT_FAILS(one.check(limits), StatusCode::kInvalidArgument, "31 bytes, at most 30");
  EXPECT_FAILS((RegistrationLimits{.memories = 0}.validate()), StatusCode::kInvalidArgument, "");
}

}  // namespace
}  // namespace engram::server
