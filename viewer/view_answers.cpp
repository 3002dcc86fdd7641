// SPDX-License-Identifier: Apache-2.0
#include "viewer/view_answers.h"

#include <array>
#include <cmath>

#include "ltm/core/buffer.h"
#include "ltm/core/printable.h"

namespace engram::viewer {

namespace {

using AnswerFunction = ViewAnswer (*)(ViewedMemory&, const RequestTarget&);

struct Question {
  std::string_view path;
  AnswerFunction answer;
};

constexpr std::array<Question, 20> kQuestions{{
    {"/api/info", answer_info},
    {"/api/tree", answer_tree},
    {"/api/find", answer_find},
    {"/api/nights", answer_nights},
    {"/api/density", answer_density},
    {"/api/members", answer_members},
    {"/api/series", answer_series},
    {"/api/moment", answer_moment},
    {"/api/step", answer_step},
    {"/api/predict", answer_predict},
    {"/api/query", answer_query},
    {"/api/similar", answer_similar},
    {"/api/links", answer_links},
    {"/api/map", answer_map},
    {"/api/quality", answer_quality},
    {"/api/reflection", answer_reflection},
    {"/api/forgetting", answer_forgetting},
    {"/api/cloud", answer_cloud},
    {"/api/ask", answer_ask},
    {"/api/tell", answer_tell},
}};

}  // namespace

Result<HttpResponse> answer(ViewedMemory& viewed, const HttpRequest& request,
                            const RequestTarget& target) {
  if (target.path() == "/api/image") return answer_image(viewed, request, target);
  for (const Question& question : kQuestions) {
    if (question.path != target.path()) continue;
    auto response = question.answer(viewed, target);
    // What was forgotten must not stay in a browser.
    if (response.ok()) response->headers.emplace_back("Cache-Control", "no-store");
    return response;
  }
  return not_found("'{}': the viewer has no such page", printable(target.path().substr(0, 200)));
}

ViewAnswer bounded_json(const nlohmann::ordered_json& json) {
  HttpResponse response = json_response(json);
  if (response.body.size() > kMaxAnswerBytes)
    return resource_exhausted("the answer has {} bytes, needs at most {}: ask for less",
                              response.body.size(), kMaxAnswerBytes);
  return response;
}

Result<LongQuestion> long_question(const RequestTarget& target) {
  constexpr size_t kMaxPageName = 64;
  LongQuestion question;
  question.page = target.find("page").value_or("");
  if (question.page.size() > kMaxPageName)
    return invalid_argument("parameter 'page': has {} bytes, needs at most {}",
                            question.page.size(), kMaxPageName);
  ENGRAM_ASSIGN_OR_RETURN(const int64_t budget, target.integer("budget", 1, 60'000, 20'000));
  question.budget = std::chrono::milliseconds(budget);
  ENGRAM_ASSIGN_OR_RETURN(const int64_t stop, target.integer("stop", 0, 1, 0));
  question.is_called_off = stop == 1;
  return question;
}

HttpResponse binary_response(std::span<const std::byte> bytes) {
  return {.type = "application/octet-stream", .body = std::string(as_text(bytes))};
}

double error_number(const ltm::MeasuredError& error) {
  constexpr double kLargestGrey = 255;
  if (!std::isnan(error.number_mse)) return std::sqrt(error.number_mse);
  return std::sqrt(error.image_mse) / kLargestGrey;
}

Result<std::optional<ltm::SnapshotResult>> find_one(Memory& memory, const ltm::MemoryId& entity,
                                                    const ltm::Selector& selector,
                                                    bool is_ids_only) {
  const ltm::Query query = ltm::Query::of_entity(entity, selector);
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Query asked,
                          ltm::Query::create(query.memories(), is_ids_only));
  ENGRAM_ASSIGN_OR_RETURN(ltm::QueryResult found, memory.query(asked));
  const ltm::EntityResult* const result = found.find_entity(entity);
  if (result == nullptr || result->snapshots.empty()) return std::optional<ltm::SnapshotResult>();
  return std::optional(result->snapshots.back());
}

}  // namespace engram::viewer
