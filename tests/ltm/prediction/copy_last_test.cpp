// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/model.h"

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

TEST(CopyLast, AnswersWithTheLastValue) {
  const auto predictor = make_copy_last_predictor();
  EXPECT_EQ(predictor->name(), "copy-last");
  EXPECT_EQ(predictor->step(), Duration(0));
  EXPECT_EQ(predictor->context(), 1u);
  const std::vector<idf::Data> history{idf::Data(1), idf::Data("last")};
  const auto values = predictor->predict(history, 3);
  ASSERT_OK(values);
  ASSERT_EQ(values->size(), 3u);
  for (const Prediction& one : *values) {
    EXPECT_EQ(one.value, idf::Data("last"));
    EXPECT_EQ(one.error, ErrorEstimate{}) << "nothing is known of it";
  }
  EXPECT_TRUE(predictor->records(PredictorInputs::kConditions).empty());
  EXPECT_FAILS(predictor->predict({}, 1), StatusCode::kInvalidArgument, "at least one");
}

}  // namespace
}  // namespace engram::ltm
