// SPDX-License-Identifier: Apache-2.0
#include "viewer/visitor_gate.h"

#include <algorithm>

namespace engram::viewer {

namespace {

HttpResponse refusal(int status, const Status& reason) {
  return error_response(status, reason);
}

/// What a person sees who opens the address without its token.
HttpResponse closed_page() {
  return {.status = 403,
          .type = "text/html; charset=utf-8",
          .body =
              "<!doctype html><html lang=\"en\"><title>Engram</title><h1>Engram</h1><p>This "
              "page needs the whole URL that <code>engram view</code> printed, with its "
              "token.</p></html>\n"};
}

std::string authority(const std::string& host, uint16_t port) {
  return fmt::format("{}:{}", host.find(':') == std::string::npos ? host : "[" + host + "]", port);
}

}  // namespace

VisitorGate::VisitorGate(Options options)
    : options_(std::move(options)), token_(server::hash_token(options_.token)) {
  hosts_ = {authority(options_.host, options_.port), authority("localhost", options_.port)};
  std::string sockets;
  for (const std::string& host : hosts_) sockets += " ws://" + host;
  // Components have attributes `style`, but no elements of that name.
  headers_ = {
      {"Content-Security-Policy",
       fmt::format("default-src 'none'; script-src 'self'; style-src 'self'; style-src-attr "
                   "'unsafe-inline'; img-src 'self' data: blob:; font-src 'self'; connect-src "
                   "'self'{}; worker-src "
                   "'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors {}",
                   sockets,
                   options_.embedding_origin.empty() ? "'none'" : options_.embedding_origin)},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
  };
}

bool VisitorGate::is_origin(std::string_view text) {
  const size_t scheme = text.starts_with("http://")    ? 7
                        : text.starts_with("https://") ? 8
                                                       : std::string_view::npos;
  if (scheme == std::string_view::npos || scheme == text.size()) return false;
  return std::ranges::all_of(text.substr(scheme), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view(".:-[]").find(c) != std::string_view::npos;
  });
}

std::string VisitorGate::url() const {
  return fmt::format("http://{}/?token={}", hosts_.front(), options_.token);
}

std::string VisitorGate::cookie_name() const {
  // Browsers send cookies to all ports of a host, so two viewers need two names.
  return fmt::format("engram_viewer_{}", options_.port);
}

bool VisitorGate::is_ours(std::string_view host) const {
  return std::ranges::find(hosts_, host) != hosts_.end();
}

bool VisitorGate::is_token(std::string_view text) const {
  return server::equal_in_constant_time(server::hash_token(text), token_);
}

bool VisitorGate::has_cookie(std::string_view cookies) const {
  const std::string name = cookie_name() + "=";
  while (!cookies.empty()) {
    std::string_view one = cookies.substr(0, cookies.find(';'));
    cookies.remove_prefix(std::min(cookies.size(), one.size() + 1));
    while (one.starts_with(' ')) one.remove_prefix(1);
    if (one.starts_with(name) && is_token(one.substr(name.size()))) return true;
  }
  return false;
}

std::optional<HttpResponse> VisitorGate::stop(const HttpRequest& request,
                                              const RequestTarget& target) const {
  if (!is_ours(request.host))
    return refusal(421, invalid_argument("header 'Host': is none of this viewer, which is at {}",
                                         hosts_.front()));
  if (request.method != "GET" && request.method != "HEAD") {
    HttpResponse response =
        refusal(405, invalid_argument("the viewer only shows: needs GET or HEAD"));
    response.headers.emplace_back("Allow", "GET, HEAD");
    return response;
  }
  const bool is_page = target.path() == "/";
  if (const auto token = target.find("token"); token && is_page) {
    if (!is_token(*token)) return closed_page();
    return HttpResponse{
        .status = 303,
        .type = "text/plain",
        .headers = {{"Location", "/" + target.query_without("token")},
                    {"Set-Cookie", fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/",
                                               cookie_name(), options_.token)},
                    {"Cache-Control", "no-store"}}};
  }
  if (!has_cookie(request.cookie))
    return is_page ? closed_page()
                   : refusal(401, failed_precondition(
                                      "the viewer shows this to whoever has its token alone"));
  // Other ports of this host are the same site, whose requests carry the cookie.
  if (!is_page && !request.fetch_site.empty() && request.fetch_site != "same-origin" &&
      request.fetch_site != "none")
    return refusal(403, failed_precondition("a page of another origin asked for this"));
  return std::nullopt;
}

std::optional<HttpResponse> VisitorGate::stop_socket(const HttpRequest& request) const {
  const auto is_page_of = [&](const std::string& host) {
    return request.origin == "http://" + host;
  };
  if (std::ranges::none_of(hosts_, is_page_of))
    return refusal(403, failed_precondition("a page of another origin asked for a connection"));
  return std::nullopt;
}

}  // namespace engram::viewer
