// SPDX-License-Identifier: Apache-2.0
#include "speech/assistants/mcp_session.h"

#include <gmock/gmock.h>

#include "speech/assistants/tool_arguments.h"
#include "tests/ltm/expect_status.h"

namespace engram::speech {
namespace {

using ::testing::HasSubstr;

McpSession session() {
  MemoryTool echo{
      "echo", "Echo", "Says it again.", {{"type", "object"}}, [](const ToolJson& given) {
        ToolArguments arguments(given);
        const auto text = arguments.text("text");
        if (!text.ok()) return Result<ToolAnswer>(text.status());
        if (const Status status = arguments.finish(); !status.ok())
          return Result<ToolAnswer>(status);
        return Result<ToolAnswer>(ToolAnswer{{{"said", *text}}, ToolImage{"image/png", "AAAA"}});
      }};
  return McpSession({std::move(echo)}, {.version = "7", .instructions = "Ask."});
}

ToolJson asked(McpSession& session, const std::string& message) {
  const std::string answer = session.answer(message);
  EXPECT_EQ(answer.find('\n'), std::string::npos);
  return answer.empty() ? ToolJson() : ToolJson::parse(answer);
}

std::string request(const std::string& method, const std::string& parameters = "{}") {
  return R"({"jsonrpc":"2.0","id":5,"method":")" + method + R"(","params":)" + parameters + "}";
}

TEST(McpSession, AgreesOnARevision) {
  for (const char* known : {"2025-06-18", "2025-03-26", "2024-11-05"}) {
    McpSession one = session();
    const ToolJson reply =
        asked(one, request("initialize", fmt::format(R"({{"protocolVersion":"{}"}})", known)));
    EXPECT_EQ(reply["result"]["protocolVersion"], known);
    EXPECT_EQ(reply["id"], 5);
  }
  McpSession one = session();
  const ToolJson reply = asked(one, request("initialize", R"({"protocolVersion":"1999-01-01"})"));
  EXPECT_EQ(reply["result"]["protocolVersion"], "2025-06-18");
  EXPECT_EQ(reply["result"]["serverInfo"]["version"], "7");
  EXPECT_EQ(reply["result"]["instructions"], "Ask.");
}

TEST(McpSession, TellsValuesAsTextAndAsTheyAreWithTheirImage) {
  McpSession one = session();
  asked(one, request("initialize"));
  const ToolJson result = asked(
      one, request("tools/call", R"({"name":"echo","arguments":{"text":"a \"b\"\nc"}})"))["result"];
  EXPECT_EQ(result["isError"], false);
  EXPECT_EQ(result["structuredContent"]["said"], "a \"b\"\nc");
  EXPECT_EQ(ToolJson::parse(result["content"][0]["text"].get<std::string>()),
            result["structuredContent"]);
  EXPECT_EQ(result["content"][1]["type"], "image");
  EXPECT_EQ(result["content"][1]["data"], "AAAA");
}

TEST(McpSession, ErrorsOfToolsAreResults) {
  McpSession one = session();
  asked(one, request("initialize"));
  for (const auto& [given, expected] :
       {std::pair{R"({"text":1})", "argument 'text': found 1, needs a text"},
        std::pair{"{}", "argument 'text' is missing"}, std::pair{"7", "is missing"},
        std::pair{R"({"text":"x","volume":3})", "argument 'volume' is unknown; there are text"}}) {
    const ToolJson result = asked(
        one,
        request("tools/call", fmt::format(R"({{"name":"echo","arguments":{}}})", given)))["result"];
    EXPECT_EQ(result["isError"], true);
    EXPECT_THAT(result["content"][0]["text"].get<std::string>(), HasSubstr(expected));
  }
}

TEST(McpSession, AnswersBatchesAndNoNotifications) {
  McpSession one = session();
  asked(one, request("initialize"));
  EXPECT_EQ(one.answer(R"({"jsonrpc":"2.0","method":"notifications/cancelled"})"), "");
  EXPECT_EQ(one.answer(R"([{"jsonrpc":"2.0","method":"a"},{"jsonrpc":"2.0","id":1,"result":{}}])"),
            "");
  const ToolJson replies = asked(
      one, R"([{"jsonrpc":"2.0","id":"x","method":"ping"},{"jsonrpc":"2.0","method":"b"},3])");
  ASSERT_EQ(replies.size(), 2u);
  EXPECT_EQ(replies[0]["id"], "x");
  EXPECT_EQ(replies[1]["error"]["code"], -32600);
  std::string many = "[1";
  for (int i = 0; i < 200; ++i) many += ",1";
  EXPECT_EQ(asked(one, many + "]")["error"]["code"], -32600);
}

TEST(ToolArguments, SayWhatWasFoundAndWhatIsNeeded) {
  const ToolJson given{{"count", 5000},       {"x", "1"},       {"radius", -1},
                       {"when", "yesterday"}, {"id", "Vision"}, {"nothing", nullptr}};
  ToolArguments arguments(given);
  EXPECT_FAILS(arguments.count_or("count", 1, 100), StatusCode::kInvalidArgument,
               "found 5000, needs an integer from 1 to 100");
  EXPECT_FAILS(arguments.number("x"), StatusCode::kInvalidArgument, "needs a finite number");
  EXPECT_FAILS(arguments.number_or("radius", 1, 0, 10), StatusCode::kInvalidArgument,
               "a number from 0 to 10");
  EXPECT_FAILS(arguments.time("when"), StatusCode::kInvalidArgument, "argument 'when'");
  EXPECT_FAILS(arguments.id("id"), StatusCode::kInvalidArgument, "the ID of an entity");
  EXPECT_EQ(*arguments.text_or("nothing", "else"), "else");
  EXPECT_OK(arguments.finish());
  EXPECT_FAILS(ToolArguments(ToolJson::array()).finish(), StatusCode::kInvalidArgument,
               "needs an object");
}

}  // namespace
}  // namespace engram::speech
