// SPDX-License-Identifier: Apache-2.0
#include "server/access/endpoint.h"

#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

TEST(Endpoint, ReadsASocketInTheFileSystem) {
  const auto endpoint = Endpoint::parse("unix:/run/engram/a b.sock");
  ASSERT_OK(endpoint);
  EXPECT_EQ(endpoint->kind(), Endpoint::Kind::kUnix);
  EXPECT_EQ(endpoint->path(), "/run/engram/a b.sock");
  EXPECT_TRUE(endpoint->is_local());
}

TEST(Endpoint, ReadsAHostAndAPort) {
  const auto named = Endpoint::parse("head-2.local:50051");
  ASSERT_OK(named);
  EXPECT_EQ(named->kind(), Endpoint::Kind::kTcp);
  EXPECT_EQ(named->host(), "head-2.local");
  EXPECT_EQ(named->port(), 50051);
  const auto v6 = Endpoint::parse("[fe80::1]:65535");
  ASSERT_OK(v6);
  EXPECT_EQ(v6->host(), "fe80::1");
  EXPECT_EQ(v6->port(), 65535);
}

TEST(Endpoint, PrintsAsItReads) {
  for (const char* text :
       {"unix:/a.sock", "10.0.0.7:1", "head.local:50051", "[::1]:0", "my_host:9"})
    EXPECT_EQ(Endpoint::parse(text)->to_string(), text);
}

TEST(Endpoint, KnowsWhatOnlyThisMachineReaches) {
  const auto is_local = [](std::string_view text) { return Endpoint::parse(text)->is_local(); };
  for (const char* text : {"127.0.0.1:1", "127.200.3.4:1", "[::1]:1", "[0:0:0:0:0:0:0:1]:1",
                           "localhost:1", "LocalHost:1"})
    EXPECT_TRUE(is_local(text)) << text;
  for (const char* text :
       {"0.0.0.0:1", "[::]:1", "128.0.0.1:1", "10.0.0.7:1", "head:1", "localhost.example:1",
        "mylocalhost:1", "[::ffff:10.0.0.7]:1", "[::ffff:127.0.0.1]:1"})
    EXPECT_FALSE(is_local(text)) << text;
}

TEST(Endpoint, RefusesSocketsThatAreNone) {
  const auto refuses = [](std::string_view text, std::string_view why) {
    EXPECT_FAILS(Endpoint::parse(text), StatusCode::kInvalidArgument, std::string(why));
  };
  refuses("unix:", "absolute path");
  refuses("unix:a.sock", "absolute path");
  refuses("unix:/", "empty names");
  refuses("unix:/run//a", "empty names");
  refuses("unix:///run/a", "empty names");
  refuses("unix:/run/", "empty names");
  refuses("unix:/" + std::string(107, 'a'), "108 bytes, at most 107");
  EXPECT_OK(Endpoint::parse("unix:/" + std::string(106, 'a')));
  refuses(std::string_view("unix:/a\0b", 9), "control characters");
  refuses("unix:/a\nb", "control characters");
}

TEST(Endpoint, RefusesHostsAndPortsThatAreNone) {
  const std::string long_label(64, 'a');
  std::string long_host;
  for (int i = 0; i < 64; ++i) long_host += "abc.";
  for (const std::string& text : std::vector<std::string>{"",
                                                          ":",
                                                          "host",
                                                          "host:",
                                                          "host:x",
                                                          "host:-1",
                                                          "host:+1",
                                                          "host: 1",
                                                          "host:1 ",
                                                          "host:65536",
                                                          "host:080",
                                                          "host:00",
                                                          ":80",
                                                          " host:80",
                                                          "a b:80",
                                                          "host/:80",
                                                          "http://host:80",
                                                          "-a:80",
                                                          "a-:80",
                                                          "a..b:80",
                                                          ".a:80",
                                                          "a.:80",
                                                          "1.2.3:80",
                                                          "1.2.3.4.5:80",
                                                          "256.1.1.1:80",
                                                          "01.2.3.4:80",
                                                          "127.1:80",
                                                          "2130706433:80",
                                                          "0x7f.0.0.1x.1:80",
                                                          "::1:80",
                                                          "fe80::1:80",
                                                          "[]:80",
                                                          "[::1:80",
                                                          "::1]:80",
                                                          "[host]:80",
                                                          "[127.0.0.1]:80",
                                                          "[::1]",
                                                          "[::1]80",
                                                          "[fe80::1%eth0]:80",
                                                          "höst:80",
                                                          long_label + ":80",
                                                          long_host + "a:80",
                                                          std::string("127.0.0.1\0:80", 13),
                                                          std::string("[::1\0]:80", 9)})
    EXPECT_FAILS(Endpoint::parse(text), StatusCode::kInvalidArgument, "endpoint '");
}

TEST(Endpoint, RepeatsNoEndlessText) {
  EXPECT_LT(Endpoint::parse(std::string(1'000'000, 'x')).status().message().size(), 300u);
}

}  // namespace
}  // namespace engram::server
