// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/access/token.h"
#include "viewer/http_message.h"
#include "viewer/request_target.h"

namespace engram::viewer {

/// Decides who may see the memory: who knows the token, at our own address, from our own page.
///
/// The token comes once, in the URL that was printed, and becomes a cookie that scripts cannot read
/// and other sites cannot send. Names other than ours in `Host` are refused, so that a page of
/// somebody else cannot reach the gateway by a name of its own that leads here (DNS rebinding).
/// Threading: const-parallel.
/// Source: docs/viewer.md, section "Who may look".
class VisitorGate {
 public:
  struct Options {
    std::string host = "127.0.0.1";  ///< Where the gateway listens; without brackets.
    uint16_t port = 0;
    std::string token{};
    std::string embedding_origin{};  ///< May show the page in a frame; empty: nobody may.
  };

  explicit VisitorGate(Options options);

  /// Whether `text` is an origin that may be named in a header: "http://localhost:8888".
  [[nodiscard]] static bool is_origin(std::string_view text);

  /// The URL that a person opens.
  [[nodiscard]] std::string url() const;

  /// The answer for a request that is let in no further: an error, or the step from the token in
  /// the URL to the cookie. Nothing where it may pass.
  [[nodiscard]] std::optional<HttpResponse> stop(const HttpRequest& request,
                                                 const RequestTarget& target) const;

  /// Whether a WebSocket may be opened: as stop(), and the page must be ours.
  [[nodiscard]] std::optional<HttpResponse> stop_socket(const HttpRequest& request) const;

  /// Headers that every answer has.
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& headers() const {
    return headers_;
  }

 private:
  [[nodiscard]] bool is_ours(std::string_view host) const;
  [[nodiscard]] bool has_cookie(std::string_view cookies) const;
  [[nodiscard]] bool is_token(std::string_view text) const;
  [[nodiscard]] std::string cookie_name() const;

  const Options options_;
  const server::TokenHash token_;
  std::vector<std::string> hosts_;  ///< Values of `Host` that are ours.
  std::vector<std::pair<std::string, std::string>> headers_;
};

}  // namespace engram::viewer
