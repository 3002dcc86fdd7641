// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>

#include "ltm/core/status.h"
#include "ltm/core/time.h"

namespace engram::speech {

struct HttpPost {
  std::string url;  ///< http or https.
  std::string json;
  std::string bearer_token{};  ///< Empty: none is sent.
  Duration timeout = std::chrono::minutes(2);
  size_t max_reply_bytes = size_t{8} << 20;
};

struct HttpReply {
  int status = 0;
  std::string body;
};

/// Sends JSON and waits for the reply. No redirection is followed, so that a token goes nowhere
/// else.
/// Errors: kInvalidArgument for another kind of URL; kUnavailable if nobody answers in time;
/// kResourceExhausted for a reply that is too long; kCancelled if `stop` is requested.
/// Threading: thread-safe.
Result<HttpReply> post(const HttpPost& request, const std::stop_token& stop);

}  // namespace engram::speech
