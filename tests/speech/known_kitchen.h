// SPDX-License-Identifier: Apache-2.0
// The minute of a remembered kitchen, and what is known of it.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "speech/facts/known_facts.h"
#include "tests/ltm/expect_status.h"
#include "tests/speech/remembered_kitchen.h"

namespace engram::speech::testing {

class KnownKitchen : public ::testing::Test {
 protected:
  void SetUp() override {
    kitchen_.live_one_minute();
    auto facts = KnownFacts::read(kitchen_.memory());
    ASSERT_OK(facts);
    facts_ = *std::move(facts);
  }

  RememberedKitchen kitchen_;
  std::unique_ptr<KnownFacts> facts_;
};

}  // namespace engram::speech::testing
