// SPDX-License-Identifier: Apache-2.0
// A language model that says what the test wants, with the tools of a memory.
#include "speech/assistants/chat_route.h"

#include <gmock/gmock.h>

#include <deque>

#include "tests/ltm/expect_status.h"

namespace engram::speech {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const char* const kCup = "Objects/Instances/kitchen/cup_1/2026-01-01 08:00:00.500000";

MemoryTool query_tool() {
  return {
      "query", "Ask", "Asks.", {{"type", "object"}}, [](const ToolJson& arguments) {
        if (!arguments.contains("query"))
          return Result<ToolAnswer>(invalid_argument("argument 'query' is missing"));
        if (arguments["query"] == "@ all")
          return Result<ToolAnswer>(ToolAnswer{{{"text", std::string(30'000, 'x')}, {"id", kCup}}});
        return Result<ToolAnswer>(ToolAnswer{
            {{"entities", ToolJson::array({{{"snapshots", ToolJson::array({kCup})}}})}}});
      }};
}

std::string says(const std::string& content) {
  return ToolJson{{"choices", ToolJson::array({{{"message", {{"content", content}}}}})}}.dump();
}

std::string calls(const std::string& name, const std::string& arguments) {
  const ToolJson call{
      {"id", "c1"}, {"type", "function"}, {"function", {{"name", name}, {"arguments", arguments}}}};
  const ToolJson message{{"content", nullptr}, {"tool_calls", ToolJson::array({call})}};
  return ToolJson{{"choices", ToolJson::array({{{"message", message}}})}}.dump();
}

std::string answers(const std::string& text, const std::string& evidence) {
  return says(ToolJson{{"answer", text}, {"evidence", ToolJson::array({evidence})}}.dump());
}

class ChatRouteTest : public ::testing::Test {
 protected:
  Result<ChatAnswer> ask(std::deque<std::string> replies, ChatRoute::Options options = {}) {
    replies_ = std::move(replies);
    auto route = ChatRoute::create(
        std::move(options), {query_tool()},
        [this](const HttpPost& post, const std::stop_token&) -> Result<HttpReply> {
          asked_.push_back(ToolJson::parse(post.json));
          url_ = post.url;
          if (replies_.empty()) return unavailable("the server is gone");
          HttpReply reply{200, replies_.front()};
          replies_.pop_front();
          return reply;
        });
    EXPECT_OK(route);
    return route->ask("Where is the cup?", time_from_ns(0));
  }

  std::deque<std::string> replies_;
  std::vector<ToolJson> asked_;
  std::string url_;
};

TEST_F(ChatRouteTest, TellsWhatTheMemoryShowed) {
  const auto answer = ask({calls("query", R"({"query":"Objects"})"),
                           says("Here:\n```json\n" +
                                ToolJson{{"answer", "On the table."},
                                         {"evidence", ToolJson::array({std::string(kCup) + "/0"})}}
                                    .dump() +
                                "\n```")},
                          {.url = "http://there/v1/", .model = "small"});
  ASSERT_OK(answer);
  EXPECT_TRUE(answer->is_known) << answer->withheld;
  EXPECT_EQ(answer->text, "On the table.");
  EXPECT_THAT(answer->evidence, ElementsAre(*ltm::MemoryId::parse(kCup)));
  EXPECT_THAT(answer->looked_for, ElementsAre(R"(query {"query":"Objects"})"));
  EXPECT_EQ(url_, "http://there/v1/chat/completions");
  EXPECT_EQ(asked_[0]["model"], "small");
  EXPECT_EQ(asked_[0]["tools"][0]["function"]["name"], "query");
  EXPECT_EQ(asked_[0]["messages"][1]["content"], "Where is the cup?");
  EXPECT_EQ(asked_[1]["messages"][3]["role"], "tool");
  EXPECT_THAT(asked_[1]["messages"][3]["content"].get<std::string>(), HasSubstr("cup_1"));
}

TEST_F(ChatRouteTest, WithholdsWhatTheMemoryDidNotShow) {
  for (const auto& [replies, why] : {
           std::pair{std::deque<std::string>{says("The cup is in the sea.")}, "did not say"},
           std::pair{std::deque<std::string>{answers("In the sea.", kCup)}, "had not shown"},
           std::pair{std::deque<std::string>{calls("query", R"({"query":"Objects"})"),
                                             answers("In the sea.", "Objects/a/b/c/2026-01-01")},
                     "had not shown"},
           std::pair{std::deque<std::string>{calls("query", R"({"query":"Objects"})"),
                                             says(R"({"answer":"I do not know","evidence":[]})")},
                     "did not say"},
           // The answer was too long to be read, so nothing in it was shown.
           std::pair{std::deque<std::string>{calls("query", R"({"query":"@ all"})"),
                                             answers("On the table.", kCup)},
                     "had not shown"},
       }) {
    const auto answer = ask(replies);
    ASSERT_OK(answer);
    EXPECT_FALSE(answer->is_known);
    EXPECT_EQ(answer->text, "");
    EXPECT_THAT(answer->withheld, HasSubstr(why));
  }
}

TEST_F(ChatRouteTest, LetsTheModelTryAgainAfterItsErrors) {
  const auto answer =
      ask({calls("erase", "{}"), calls("query", "no JSON"), calls("query", "{}"),
           calls("query", R"({"query":"Objects"})"), answers("On the table.", kCup)});
  ASSERT_OK(answer);
  EXPECT_TRUE(answer->is_known);
  const ToolJson& told = asked_.back()["messages"];
  EXPECT_THAT(told[3]["content"].get<std::string>(), HasSubstr("no tool 'erase'"));
  EXPECT_THAT(told[5]["content"].get<std::string>(), HasSubstr("no JSON"));
  EXPECT_THAT(told[7]["content"].get<std::string>(), HasSubstr("'query' is missing"));
}

TEST_F(ChatRouteTest, EndsWithAModelThatOnlyAsks) {
  std::deque<std::string> replies(20, calls("query", R"({"query":"Objects"})"));
  const auto answer = ask(replies, {.max_turns = 3});
  ASSERT_OK(answer);
  EXPECT_FALSE(answer->is_known);
  EXPECT_THAT(answer->withheld, HasSubstr("3 turns"));
  EXPECT_EQ(asked_.size(), 4u);
  EXPECT_FALSE(asked_.back().contains("tools"));
}

TEST_F(ChatRouteTest, SaysWhatIsWrongWithTheServer) {
  EXPECT_FAILS(ask({}), StatusCode::kUnavailable, "gone");
  EXPECT_FAILS(ask({"<html>"}), StatusCode::kUnavailable, "chat/completions");
  EXPECT_FAILS(ask({R"({"choices":[]})"}), StatusCode::kUnavailable, "without a message");
  EXPECT_FAILS(ask({R"({"choices":[7]})"}), StatusCode::kUnavailable, "without a message");
  EXPECT_FAILS(ChatRoute::create({.url = "file:///etc/passwd"}, {}), StatusCode::kInvalidArgument,
               "http");
}

TEST(HttpPostTest, SaysThatNobodyAnswers) {
  EXPECT_FAILS(post({.url = "http://127.0.0.1:9/v1", .json = "{}"}, {}), StatusCode::kUnavailable,
               "127.0.0.1:9");
  EXPECT_FAILS(post({.url = "ftp://127.0.0.1/v1", .json = "{}"}, {}), StatusCode::kInvalidArgument,
               "http");
}

}  // namespace
}  // namespace engram::speech
