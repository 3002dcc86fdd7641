// SPDX-License-Identifier: Apache-2.0
#include "viewer/visitor_gate.h"

#include "tests/ltm/expect_status.h"

namespace engram::viewer {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kToken = "q7mA1d-example";

VisitorGate gate_of(const std::string& embedding_origin = "") {
  return VisitorGate({.port = 8200, .token = kToken, .embedding_origin = embedding_origin});
}

HttpRequest request_of(const std::string& target) {
  return {.target = target, .host = "127.0.0.1:8200", .cookie = "engram_viewer_8200=" + kToken};
}

/// The HTTP status that a request gets at the gate; 200 where it may pass.
int status_at(const VisitorGate& gate, const HttpRequest& request) {
  const auto stopped = gate.stop(request, *RequestTarget::parse(request.target));
  return stopped ? stopped->status : 200;
}

std::string header_of(const HttpResponse& response, const std::string& name) {
  for (const auto& [key, value] : response.headers)
    if (key == name) return value;
  return "";
}

TEST(VisitorGate, LetsInWhoHasTheCookie) {
  const VisitorGate gate = gate_of();
  EXPECT_EQ(status_at(gate, request_of("/")), 200);
  EXPECT_EQ(status_at(gate, request_of("/api/info")), 200);
  HttpRequest other = request_of("/api/info");
  other.host = "localhost:8200";
  other.cookie = "a=b; engram_viewer_8200=" + kToken + "; c=d";
  EXPECT_EQ(status_at(gate, other), 200);
}

TEST(VisitorGate, TurnsTheTokenIntoACookie) {
  HttpRequest first = request_of("/?token=" + kToken + "&view=1%2F2");
  first.cookie = "";
  const auto stopped = gate_of().stop(first, *RequestTarget::parse(first.target));
  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->status, 303);
  EXPECT_EQ(header_of(*stopped, "Location"), "/?view=1%2F2");
  EXPECT_EQ(header_of(*stopped, "Set-Cookie"),
            "engram_viewer_8200=" + kToken + "; HttpOnly; SameSite=Strict; Path=/");
  EXPECT_EQ(gate_of().url(), "http://127.0.0.1:8200/?token=" + kToken);
}

TEST(VisitorGate, RefusesAWrongTokenAndNone) {
  const VisitorGate gate = gate_of();
  HttpRequest request = request_of("/?token=wrong");
  EXPECT_EQ(status_at(gate, request), 403);
  for (const std::string& cookie :
       {std::string(), std::string("engram_viewer_8200="), "engram_viewer_8200=" + kToken + "x",
        "engram_viewer_8201=" + kToken, "xengram_viewer_8200=" + kToken}) {
    request = request_of("/api/info");
    request.cookie = cookie;
    EXPECT_EQ(status_at(gate, request), 401) << cookie;
    request.target = "/";
    EXPECT_EQ(status_at(gate, request), 403) << cookie;
    request.target = "/assets/index.js?token=" + kToken;
    EXPECT_EQ(status_at(gate, request), 401) << cookie;
  }
}

TEST(VisitorGate, RefusesNamesThatAreNotOurs) {
  const VisitorGate gate = gate_of();
  for (const char* host : {"", "evil.example", "evil.example:8200", "127.0.0.1", "127.0.0.1:8201",
                           "localhost", "127.0.0.1:8200.evil.example", "[::1]:8200"}) {
    HttpRequest request = request_of("/?token=" + kToken);
    request.host = host;
    EXPECT_EQ(status_at(gate, request), 421) << host;
  }
}

TEST(VisitorGate, ShowsAndChangesNothing) {
  const VisitorGate gate = gate_of();
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE", "BREW", "get"}) {
    HttpRequest request = request_of("/api/info");
    request.method = method;
    EXPECT_EQ(status_at(gate, request), 405) << method;
  }
}

TEST(VisitorGate, AnswersOurPageAlone) {
  const VisitorGate gate = gate_of();
  HttpRequest request = request_of("/api/info");
  for (const auto& [site, status] : {std::pair("cross-site", 403), std::pair("same-site", 403),
                                     std::pair("same-origin", 200), std::pair("none", 200)}) {
    request.fetch_site = site;
    EXPECT_EQ(status_at(gate, request), status) << site;
  }
  HttpRequest socket = request_of("/api/live");
  for (const char* origin :
       {"", "null", "http://evil.example", "https://127.0.0.1:8200", "http://127.0.0.1:8201"}) {
    socket.origin = origin;
    EXPECT_TRUE(gate.stop_socket(socket)) << origin;
  }
  socket.origin = "http://127.0.0.1:8200";
  EXPECT_FALSE(gate.stop_socket(socket));
}

TEST(VisitorGate, LetsNobodyFrameThePageUnlessOneMay) {
  const auto policy_of = [](const VisitorGate& gate) {
    return header_of({.headers = gate.headers()}, "Content-Security-Policy");
  };
  EXPECT_THAT(policy_of(gate_of()), HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(policy_of(gate_of()), HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy_of(gate_of()), Not(HasSubstr("unsafe-eval")));
  EXPECT_THAT(policy_of(gate_of("http://localhost:8888")),
              HasSubstr("frame-ancestors http://localhost:8888"));
  EXPECT_TRUE(VisitorGate::is_origin("https://[::1]:8888"));
  for (const char* text : {"", "localhost:8888", "http://", "http://a b", "http://a;script-src *",
                           "http://a/b", "http://a\r\nX: y", "*"})
    EXPECT_FALSE(VisitorGate::is_origin(text)) << text;
}

}  // namespace
}  // namespace engram::viewer
