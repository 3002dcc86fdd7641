// SPDX-License-Identifier: Apache-2.0
#include <openssl/evp.h>

#include "datasets/vault/vault_keys.h"
#include "ltm/core/byte_fields.h"
#include "tests/fuzz/fuzz_check.h"

/// A key file that reads is written as it was. The checksum is made to fit, or nothing would read.
int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace engram::datasets::vault;
  const auto text = engram::as_bytes(engram::fuzzed_text(data, size));
  static_cast<void>(decode_keys(text).ok());
  std::vector<std::byte> bytes(text.begin(), text.end());
  std::array<std::byte, 32> sum{};
  ENGRAM_CHECK(EVP_Digest(bytes.data(), bytes.size(), reinterpret_cast<unsigned char*>(sum.data()),
                          nullptr, EVP_sha256(), nullptr) == 1,
               "no SHA-256");
  bytes.insert(bytes.end(), sum.begin(), sum.end());
  const auto keys = decode_keys(bytes);
  if (!keys.ok()) return 0;
  const auto again = encode_keys(*keys);
  ENGRAM_CHECK(again.ok(), "{}", again.status().message());
  const auto back = decode_keys(*again);
  ENGRAM_CHECK(back.ok(), "{}", back.status().message());
  ENGRAM_CHECK(back->day_count() == keys->day_count() &&
                   back->destroyed_count() == keys->destroyed_count() && back->vault == keys->vault,
               "other keys came back");
  return 0;
}
