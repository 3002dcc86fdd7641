// SPDX-License-Identifier: Apache-2.0
#include "speech/assistants/mcp_session.h"

#include <algorithm>
#include <array>
#include <utility>

#include "ltm/idf/strict_json.h"

namespace engram::speech {

namespace {

/// The newest first, which is offered to whoever asks for one that is not known.
constexpr std::array<std::string_view, 3> kRevisions{"2025-06-18", "2025-03-26", "2024-11-05"};
constexpr size_t kMaxBatch = 64;
constexpr int kMaxMessageLevels = 64;

// Codes of JSON-RPC 2.0.
constexpr int kParseError = -32700;
constexpr int kInvalidRequest = -32600;
constexpr int kMethodNotFound = -32601;
constexpr int kInvalidParameters = -32602;

ToolJson reply_to(const ToolJson& id) {
  return {{"jsonrpc", "2.0"}, {"id", id}};
}

ToolJson result_of(const ToolJson& request, ToolJson result) {
  ToolJson reply = reply_to(request.at("id"));
  reply["result"] = std::move(result);
  return reply;
}

ToolJson error_of(const ToolJson& id, int code, std::string message) {
  ToolJson reply = reply_to(id);
  reply["error"] = {{"code", code}, {"message", std::move(message)}};
  return reply;
}

ToolJson parameters_of(const ToolJson& request) {
  const auto found = request.find("params");
  return found != request.end() && found->is_object() ? *found : ToolJson::object();
}

std::string text_in(const ToolJson& object, const std::string& name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string line_of(const ToolJson& json) {
  // Names in a memory may be any bytes, and a line has to be UTF-8.
  return json.dump(-1, ' ', false, ToolJson::error_handler_t::replace);
}

}  // namespace

McpSession::McpSession(std::vector<MemoryTool> tools, Options options)
    : tools_(std::move(tools)),
      options_(std::move(options)),
      methods_{{"initialize", &McpSession::initialize},
               {"ping", &McpSession::ping},
               {"tools/list", &McpSession::list_tools},
               {"tools/call", &McpSession::call_tool}} {}

std::string McpSession::answer(std::string_view message) {
  if (message.size() > kMaxMessage)
    return line_of(error_of(
        nullptr, kInvalidRequest,
        fmt::format("a message of {} bytes, needs at most {}", message.size(), kMaxMessage)));
  const auto parsed = idf::parse_json(message, kMaxMessageLevels);
  if (!parsed.ok()) return line_of(error_of(nullptr, kParseError, parsed.status().message()));
  if (!parsed->is_array()) {
    const ToolJson reply = answer_one(*parsed);
    return reply.is_null() ? std::string() : line_of(reply);
  }
  if (parsed->empty() || parsed->size() > kMaxBatch)
    return line_of(
        error_of(nullptr, kInvalidRequest,
                 fmt::format("a batch of {} messages, needs 1 to {}", parsed->size(), kMaxBatch)));
  ToolJson replies = ToolJson::array();
  for (const ToolJson& one : *parsed)
    if (ToolJson reply = answer_one(one); !reply.is_null()) replies.push_back(std::move(reply));
  return replies.empty() ? std::string() : line_of(replies);
}

ToolJson McpSession::answer_one(const ToolJson& message) {
  const bool is_object = message.is_object();
  const auto given = is_object ? message.find("id") : message.end();
  const bool has_id =
      is_object && given != message.end() && (given->is_string() || given->is_number_integer());
  const ToolJson id = has_id ? *given : ToolJson(nullptr);
  if (!is_object || text_in(message, "jsonrpc") != "2.0")
    return error_of(id, kInvalidRequest, "no message of JSON-RPC 2.0");
  // An answer to something that was never asked.
  if (message.contains("result") || message.contains("error")) return nullptr;
  const std::string name = text_in(message, "method");
  if (name.empty()) return error_of(id, kInvalidRequest, "a message without a method");
  if (is_object && given == message.end()) return nullptr;  // A notification.
  if (!has_id) return error_of(id, kInvalidRequest, "the id needs to be a text or an integer");
  const auto method = methods_.find(name);
  if (method == methods_.end())
    return error_of(id, kMethodNotFound, fmt::format("there is no method '{}'", name));
  if (!is_initialized_ && name != "initialize" && name != "ping")
    return error_of(id, kInvalidRequest, fmt::format("'{}' before 'initialize'", name));
  return (this->*method->second)(message);
}

ToolJson McpSession::initialize(const ToolJson& request) {
  const std::string wanted = text_in(parameters_of(request), "protocolVersion");
  const auto known = std::ranges::find(kRevisions, wanted);
  is_initialized_ = true;
  return result_of(request,
                   {{"protocolVersion", known == kRevisions.end() ? kRevisions.front() : *known},
                    {"capabilities", {{"tools", {{"listChanged", false}}}}},
                    {"serverInfo", {{"name", options_.name}, {"version", options_.version}}},
                    {"instructions", options_.instructions}});
}

ToolJson McpSession::ping(const ToolJson& request) {
  return result_of(request, ToolJson::object());
}

ToolJson McpSession::list_tools(const ToolJson& request) {
  ToolJson list = ToolJson::array();
  for (const MemoryTool& tool : tools_)
    list.push_back({{"name", tool.name},
                    {"title", tool.title},
                    {"description", tool.description},
                    {"inputSchema", tool.input_schema},
                    {"annotations", {{"readOnlyHint", true}, {"openWorldHint", false}}}});
  return result_of(request, {{"tools", std::move(list)}});
}

ToolJson McpSession::call_tool(const ToolJson& request) {
  const ToolJson parameters = parameters_of(request);
  const std::string name = text_in(parameters, "name");
  const auto tool = std::ranges::find(tools_, name, &MemoryTool::name);
  if (tool == tools_.end())
    return error_of(request.at("id"), kInvalidParameters,
                    fmt::format("there is no tool '{}'", name));
  const auto arguments = parameters.find("arguments");
  auto answer = tool->call(arguments == parameters.end() ? ToolJson::object() : *arguments);
  if (!answer.ok())
    return result_of(
        request,
        {{"content", ToolJson::array({{{"type", "text"}, {"text", answer.status().to_string()}}})},
         {"isError", true}});
  // Older assistants read the text, newer ones the value.
  ToolJson content = ToolJson::array({{{"type", "text"}, {"text", line_of(answer->value)}}});
  if (answer->image)
    content.push_back({{"type", "image"},
                       {"data", std::move(answer->image->base64)},
                       {"mimeType", std::move(answer->image->media_type)}});
  return result_of(request, {{"content", std::move(content)},
                             {"structuredContent", std::move(answer->value)},
                             {"isError", false}});
}

}  // namespace engram::speech
