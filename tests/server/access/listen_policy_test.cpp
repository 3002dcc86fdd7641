// SPDX-License-Identifier: Apache-2.0
#include "server/access/listen_policy.h"

#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"

namespace engram::server {
namespace {

using engram::testing::write_secret;

Endpoint endpoint(std::string_view text) {
  return *Endpoint::parse(text);
}

class ListenPolicyTest : public ::testing::Test {
 protected:
  ListenPolicy::Options complete() const {
    return {.certificate = write_secret(scratch_ / "cert.pem", "x", 0644),
            .key = write_secret(scratch_ / "key.pem", "x"),
            .client_ca = {},
            .tokens = write_secret(scratch_ / "tokens.yaml", "x")};
  }

  ScratchDirectory scratch_;
};

TEST_F(ListenPolicyTest, AsksNothingOfWhatOnlyThisMachineReaches) {
  const ListenPolicy policy({});
  for (const char* text : {"unix:/run/a.sock", "127.0.0.1:50051", "[::1]:50051", "localhost:1"}) {
    EXPECT_OK(policy.check(endpoint(text)));
    EXPECT_FALSE(ListenPolicy::needs_tls(endpoint(text)));
  }
}

TEST_F(ListenPolicyTest, RefusesTheNetworkAndSaysAllThatIsMissing) {
  const ListenPolicy policy({});
  for (const char* text : {"0.0.0.0:50051", "[::]:50051", "head.local:50051"}) {
    const Status status = policy.check(endpoint(text));
    EXPECT_EQ(status.code(), StatusCode::kFailedPrecondition);
    for (const char* part :
         {text, "TLS certificate: not named", "TLS key: not named", "tokens file: not named"})
      EXPECT_THAT(status.message(), ::testing::HasSubstr(part));
    EXPECT_THAT(status.message(), ::testing::Not(::testing::HasSubstr("CA of clients")));
    EXPECT_TRUE(ListenPolicy::needs_tls(endpoint(text)));
  }
}

TEST_F(ListenPolicyTest, AllowsTheNetworkWithCertificateKeyAndTokens) {
  EXPECT_OK(ListenPolicy(complete()).check(endpoint("0.0.0.0:50051")));
}

TEST_F(ListenPolicyTest, RefusesEachFileThatIsNotAsItMustBe) {
  const auto refuses = [](const ListenPolicy::Options& options, const std::string& part) {
    const Status status = ListenPolicy(options).check(endpoint("0.0.0.0:1"));
    EXPECT_FAILS(status, StatusCode::kFailedPrecondition, part);
    EXPECT_THAT(status.message(), ::testing::Not(::testing::HasSubstr(";  ")));
  };
  auto options = complete();
  options.certificate = scratch_ / "none.pem";
  refuses(options, "none.pem': there is no such file");
  options = complete();
  options.certificate = scratch_.path();
  refuses(options, "no such file");
  options = complete();
  options.client_ca = scratch_ / "ca.pem";
  refuses(options, "CA of clients: '");
  options = complete();
  write_secret(options.key, "x", 0644);
  refuses(options, "TLS key: '");
  options = complete();
  write_secret(options.tokens, "x", 0660);
  refuses(options, "0660");
  options = complete();
  options.tokens.clear();
  refuses(options, "missing are: tokens file: not named");
}

TEST_F(ListenPolicyTest, ChecksAllEndpointsAtOnce) {
  const std::vector<Endpoint> endpoints{endpoint("unix:/run/a.sock"), endpoint("one:1"),
                                        endpoint("two:2")};
  const Status status = ListenPolicy({}).check(endpoints);
  EXPECT_FAILS(status, StatusCode::kFailedPrecondition, "'one:1'");
  EXPECT_THAT(status.message(), ::testing::HasSubstr("'two:2'"));
  EXPECT_OK(ListenPolicy(complete()).check(endpoints));
}

}  // namespace
}  // namespace engram::server
