// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/secret_bytes.h"

#include <openssl/rand.h>

namespace engram::datasets::vault {

Result<SecretKey> SecretKey::random() {
  SecretKey key;
  if (RAND_priv_bytes(reinterpret_cast<unsigned char*>(key.bytes_.data()),
                      static_cast<int>(kBytes)) != 1)
    return unavailable("OpenSSL gives no random bytes for a key");
  return key;
}

Status fill_random(std::span<std::byte> bytes) {
  if (RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), static_cast<int>(bytes.size())) !=
      1)
    return unavailable("OpenSSL gives no random bytes");
  return {};
}

}  // namespace engram::datasets::vault
