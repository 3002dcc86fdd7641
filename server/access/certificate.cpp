// SPDX-License-Identifier: Apache-2.0
#include "server/access/certificate.h"

#include <openssl/pem.h>
#include <openssl/x509.h>

#include <memory>

#include "ltm/core/file.h"

namespace engram::server {

namespace {

using std::filesystem::path;

struct Free {
  void operator()(BIO* bio) const { BIO_free(bio); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
using Bio = std::unique_ptr<BIO, Free>;
using Certificate = std::unique_ptr<X509, Free>;
using Key = std::unique_ptr<EVP_PKEY, Free>;

/// A server that starts by itself has nobody to ask.
int no_password(char*, int, int, void*) {
  return 0;
}

/// Reads from `content`, which must outlive it.
Bio bio_of(const Buffer& content) {
  return Bio(BIO_new_mem_buf(content.data(), static_cast<int>(content.size())));
}

Result<Certificate> first_certificate(const path& file) {
  ENGRAM_ASSIGN_OR_RETURN(const Buffer content, read_file(file));
  const Bio bio = bio_of(content);
  Certificate first;
  while (Certificate next{PEM_read_bio_X509(bio.get(), nullptr, no_password, nullptr)})
    if (!first) first = std::move(next);
  if (!first) return invalid_argument("'{}': has no certificate, needs one in PEM", file.string());
  return first;
}

}  // namespace

Status check_certificates(const path& file) {
  return first_certificate(file).status();
}

Status check_key_of(const path& certificate, const path& key) {
  ENGRAM_ASSIGN_OR_RETURN(const Certificate found, first_certificate(certificate));
  ENGRAM_ASSIGN_OR_RETURN(const Buffer content, read_file(key));
  const Bio bio = bio_of(content);
  const Key read{PEM_read_bio_PrivateKey(bio.get(), nullptr, no_password, nullptr)};
  if (!read)
    return invalid_argument("'{}': has no key, needs one in PEM without a password", key.string());
  if (X509_check_private_key(found.get(), read.get()) != 1)
    return invalid_argument("'{}': is not the key of the certificate '{}'", key.string(),
                            certificate.string());
  return {};
}

}  // namespace engram::server
