// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "viewer/http_message.h"
#include "viewer/request_target.h"
#include "viewer/viewed_memory.h"

namespace engram::viewer {

/// Answers what the page asks; docs/viewer_protocol.md describes each question and its answer.
///
/// Errors: kNotFound if there is no such question; kInvalidArgument naming the parameter;
/// kResourceExhausted if the answer would be too large; those of the memory.
/// Threading: thread-safe.
[[nodiscard]] Result<HttpResponse> answer(ViewedMemory& viewed, const HttpRequest& request,
                                          const RequestTarget& target);

// What answer() is made of, one function for each question.
using ViewAnswer = Result<HttpResponse>;
ViewAnswer answer_info(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_tree(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_find(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_nights(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_density(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_members(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_series(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_moment(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_step(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_predict(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_query(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_similar(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_links(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_map(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_quality(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_reflection(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_forgetting(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_cloud(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_ask(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_tell(ViewedMemory& viewed, const RequestTarget& target);
ViewAnswer answer_image(ViewedMemory& viewed, const HttpRequest& request,
                        const RequestTarget& target);

/// Max bytes of an answer in JSON.
inline constexpr size_t kMaxAnswerBytes = size_t{16} << 20;

/// JSON in an answer, unless it is too large.
/// Errors: kResourceExhausted.
ViewAnswer bounded_json(const nlohmann::ordered_json& json);

/// A question that may take long.
struct LongQuestion {
  std::string page;            ///< Who asks: a new question takes the place of the one before.
  Duration budget{};           ///< How long it may take.
  bool is_called_off = false;  ///< Whether the one before is to end instead.
};
/// Reads `page`, `budget` in milliseconds, and `stop`. Errors: kInvalidArgument.
Result<LongQuestion> long_question(const RequestTarget& target);

/// Numbers as bytes, little endian.
[[nodiscard]] HttpResponse binary_response(std::span<const std::byte> bytes);

/// A time as decimal nanoseconds: JavaScript has no integers of 64 bits.
[[nodiscard]] inline std::string time_text(Time time) {
  return std::to_string(to_ns(time));
}

/// The root of a mean squared error: of numbers in their unit; of images, if there are no numbers,
/// as a share of the largest grey level. NaN where neither is known.
[[nodiscard]] double error_number(const ltm::MeasuredError& error);

/// The one snapshot that a selector finds; nothing if it finds none.
/// Errors: those of Memory::query.
Result<std::optional<ltm::SnapshotResult>> find_one(Memory& memory, const ltm::MemoryId& entity,
                                                    const ltm::Selector& selector,
                                                    bool is_ids_only = false);

}  // namespace engram::viewer
