// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ltm/core/status.h"

namespace engram::viewer {

/// What the gateway tells of one request. All of it came from outside.
struct HttpRequest {
  std::string method = "GET";
  std::string target = "/";  ///< As it came: path, '?' and query.
  // Headers; empty where there is none.
  std::string host{};
  std::string origin{};
  std::string cookie{};
  std::string accept_encoding{};
  std::string if_none_match{};
  std::string fetch_site{};  ///< Sec-Fetch-Site.
};

struct HttpResponse {
  int status = 200;
  std::string type = "application/json";
  std::string body{};
  std::vector<std::pair<std::string, std::string>> headers{};
};

/// The text of a JSON value. Bytes in it that are no UTF-8 are replaced: a message may quote them.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json);

[[nodiscard]] HttpResponse json_response(const nlohmann::ordered_json& json);

/// A text as the value of a header: what is no printable ASCII is percent-encoded.
[[nodiscard]] std::string header_text(std::string_view text);

/// {"error": {"code": "not found", "message": "..."}} with the HTTP status of the code.
[[nodiscard]] HttpResponse error_response(const Status& status);
/// The same with another HTTP status.
[[nodiscard]] HttpResponse error_response(int http_status, const Status& status);

}  // namespace engram::viewer
