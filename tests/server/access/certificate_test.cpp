// SPDX-License-Identifier: Apache-2.0
#include "server/access/certificate.h"

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "server/access/listen_policy.h"
#include "tests/ltm/expect_status.h"
#include "tests/server/access/secret_file.h"

namespace engram::server {
namespace {

using engram::testing::write_secret;

std::string text_of(BIO* bio) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(bio, &bytes);
  std::string text(bytes, static_cast<size_t>(size));
  BIO_free(bio);
  return text;
}

/// A key, and a certificate that it signed itself.
struct Pair {
  std::string certificate, key, locked_key;

  Pair() {
    EVP_PKEY* made = EVP_EC_gen("P-256");
    X509* signed_by_itself = X509_new();
    X509_set_version(signed_by_itself, X509_VERSION_3);
    ASN1_INTEGER_set(X509_get_serialNumber(signed_by_itself), 1);
    X509_gmtime_adj(X509_getm_notBefore(signed_by_itself), 0);
    X509_gmtime_adj(X509_getm_notAfter(signed_by_itself), 3600);
    X509_set_pubkey(signed_by_itself, made);
    X509_sign(signed_by_itself, made, EVP_sha256());
    BIO* out = BIO_new(BIO_s_mem());
    PEM_write_bio_X509(out, signed_by_itself);
    certificate = text_of(out);
    out = BIO_new(BIO_s_mem());
    PEM_write_bio_PrivateKey(out, made, nullptr, nullptr, 0, nullptr, nullptr);
    key = text_of(out);
    out = BIO_new(BIO_s_mem());
    const std::string password = "secret";
    PEM_write_bio_PKCS8PrivateKey(out, made, EVP_aes_256_cbc(), password.data(),
                                  static_cast<int>(password.size()), nullptr, nullptr);
    locked_key = text_of(out);
    X509_free(signed_by_itself);
    EVP_PKEY_free(made);
  }
};

class CertificateTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& text) const {
    return write_secret(scratch_ / name, text);
  }

  ScratchDirectory scratch_;
  Pair one_, other_;
};

TEST_F(CertificateTest, FitsItsKeyAlone) {
  const auto certificate = file("cert.pem", one_.certificate + other_.certificate);
  EXPECT_OK(check_certificates(certificate));
  EXPECT_OK(check_key_of(certificate, file("key.pem", one_.key)));
  EXPECT_FAILS(check_key_of(certificate, file("other.pem", other_.key)),
               StatusCode::kInvalidArgument, "is not the key of the certificate");
  EXPECT_FAILS(check_key_of(certificate, file("locked.pem", one_.locked_key)),
               StatusCode::kInvalidArgument, "without a password");
  EXPECT_FAILS(check_certificates(file("x.pem", "x")), StatusCode::kInvalidArgument,
               "has no certificate");
  EXPECT_FAILS(check_certificates(scratch_ / "none.pem"), StatusCode::kNotFound, "none.pem");
}

TEST_F(CertificateTest, CountsOnLoopbackToo) {
  ListenPolicy::Options options;
  EXPECT_OK(ListenPolicy(options).check_files());
  options.certificate = file("cert.pem", one_.certificate);
  EXPECT_OK(ListenPolicy(options).check_files());
  options.key = file("other.pem", other_.key);
  EXPECT_FAILS(ListenPolicy(options).check_files(), StatusCode::kInvalidArgument, "is not the key");
  options.key = file("key.pem", one_.key);
  EXPECT_OK(ListenPolicy(options).check_files());
  options.client_ca = scratch_ / "none.pem";
  EXPECT_FAILS(ListenPolicy(options).check_files(), StatusCode::kNotFound, "none.pem");
  options.client_ca.clear();
  options.certificate.clear();
  EXPECT_FAILS(ListenPolicy(options).check_files(), StatusCode::kInvalidArgument,
               "without its certificate");
}

}  // namespace
}  // namespace engram::server
