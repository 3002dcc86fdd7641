// SPDX-License-Identifier: Apache-2.0
#include "viewer/request_target.h"

#include "tests/ltm/expect_status.h"

namespace engram::viewer {
namespace {

using ::testing::ElementsAre;

TEST(RequestTarget, IsTakenApart) {
  const auto target = RequestTarget::parse("/api/find?text=blue%20cup&max=5&text=a+b&flag");
  ASSERT_OK(target);
  EXPECT_EQ(target->path(), "/api/find");
  EXPECT_EQ(target->find("text"), "blue cup");
  EXPECT_THAT(target->all("text"), ElementsAre("blue cup", "a b"));
  EXPECT_EQ(target->find("flag"), "");
  EXPECT_EQ(target->find("none"), std::nullopt);
  EXPECT_EQ(*target->integer("max", 1, 10), 5);
  EXPECT_EQ(*target->integer("other", 1, 10, 7), 7);
}

TEST(RequestTarget, KeepsTheRestOfAQueryAsItCame) {
  const auto target = RequestTarget::parse("/?a=%2F&token=secret&b=%25");
  ASSERT_OK(target);
  EXPECT_EQ(target->query_without("token"), "?a=%2F&b=%25");
  EXPECT_EQ(RequestTarget::parse("/?token=secret")->query_without("token"), "");
}

TEST(RequestTarget, IsRefusedWhereItIsNoText) {
  const auto refuses = [](const std::string& target) {
    EXPECT_FAILS(RequestTarget::parse(target), StatusCode::kInvalidArgument, "target");
  };
  refuses("");
  refuses("api");
  refuses("/%");
  refuses("/%4");
  refuses("/%zz");
  refuses("/?a=%ff");
  refuses("/?a=%00");
  refuses("/?" + std::string(RequestTarget::kMaxBytes, 'a'));
  std::string many = "/?";
  for (size_t i = 0; i <= RequestTarget::kMaxParameters; ++i) many += "a=1&";
  refuses(many);
}

TEST(RequestTarget, TakesNoNumberThatIsNone) {
  for (const char* text : {"", "nan", "inf", "1.5", "1e3", " 1", "1 ", "+1", "0x10",
                           "9223372036854775808", "-9223372036854775809", "99999999999999999999"}) {
    const auto target = RequestTarget::parse(std::string("/?from=") + text);
    ASSERT_OK(target);
    EXPECT_FAILS(target->time("from"), StatusCode::kInvalidArgument, "parameter 'from'");
  }
  EXPECT_EQ(to_ns(*RequestTarget::parse("/?from=-9223372036854775808")->time("from")), INT64_MIN);
  EXPECT_FAILS(RequestTarget::parse("/?pixels=0")->integer("pixels", 1, 9),
               StatusCode::kInvalidArgument, "needs an integer from 1 to 9");
  EXPECT_FAILS(RequestTarget::parse("/")->integer("pixels", 1, 9), StatusCode::kInvalidArgument,
               "parameter 'pixels' is missing");
}

TEST(RequestTarget, ReadsNumbersWithinBounds) {
  const auto number = [](const std::string& text) {
    return RequestTarget::parse("/?fx=" + text)->number("fx", 0.5, 100);
  };
  EXPECT_EQ(*number("96.5"), 96.5);
  EXPECT_EQ(*number("1e2"), 100);
  for (const char* bad : {"0", "101", "nan", "inf", "1x", "x", "0x10", "1,5", "1e999", "-1"})
    EXPECT_FAILS(number(bad), StatusCode::kInvalidArgument, "needs a number from 0.5 to 100");
  EXPECT_FAILS(number(""), StatusCode::kInvalidArgument, "fx");
}

TEST(RequestTarget, ReadsIds) {
  const auto target = RequestTarget::parse(
      "/?entity=A%2FB%2FC%2Fa%5C%2Fb&id=A%2FB%2FC%2FD%2F1970-01-01+00%3A00%3A01%2F2&entity=A");
  ASSERT_OK(target);
  EXPECT_EQ(target->entity("entity")->names().back(), "a/b");
  EXPECT_EQ(target->names("entity", 5)->size(), 2u);
  EXPECT_FAILS(target->names("entity", 1), StatusCode::kInvalidArgument, "at most 1");
  EXPECT_FAILS(target->names("id", 1), StatusCode::kInvalidArgument, "an entity");
  const auto id = target->moment("id");
  ASSERT_OK(id);
  EXPECT_EQ(to_ns(*id->time()), 1'000'000'000);
  EXPECT_EQ(id->index(), 2);
  EXPECT_FAILS(target->entity("id"), StatusCode::kInvalidArgument, "an entity");
  EXPECT_FAILS(target->moment("entity"), StatusCode::kInvalidArgument, "a snapshot");
}

TEST(RequestTarget, ReadsListsOfNumbers) {
  const auto numbers = [](const std::string& list) {
    const auto target = RequestTarget::parse("/?n=" + list);
    return target->integers("n", 1, 9, 3);
  };
  EXPECT_EQ(*numbers("4"), std::vector<int64_t>{4});
  EXPECT_EQ(*numbers("4,1,9"), (std::vector<int64_t>{4, 1, 9}));
  for (const char* wrong : {"4,", ",4", "4,,5", "0", "4,10", "4%26n=5", "4%2C%2C5", "a"})
    EXPECT_FAILS(numbers(wrong), StatusCode::kInvalidArgument, "an integer from 1 to 9");
  EXPECT_FAILS(numbers("1,2,3,4"), StatusCode::kInvalidArgument, "at most 3 numbers");
  EXPECT_FAILS(numbers(""), StatusCode::kInvalidArgument, "missing");
}

TEST(RequestTarget, ChoosesAmongWords) {
  const auto target = RequestTarget::parse("/?as=webp");
  EXPECT_FAILS(target->choice("as", {"png", "jpeg"}, "png"), StatusCode::kInvalidArgument,
               "one of png, jpeg");
  EXPECT_EQ(*target->choice("form", {"any", "latent"}, "any"), "any");
}

}  // namespace
}  // namespace engram::viewer
