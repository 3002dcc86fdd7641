// SPDX-License-Identifier: Apache-2.0
// What encrypting a file of a vault costs, beside AES-256-GCM alone, and what a key file costs.
#include <benchmark/benchmark.h>
#include <openssl/evp.h>

#include "datasets/vault/vault_keys.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets::vault {
namespace {

constexpr size_t kVaultBytes = 64 << 20;

/// The limit: the same chunks in memory, without files.
void VaultAesAlone(benchmark::State& state) {
  std::vector<unsigned char> chunk(kPlainChunkBytes), key(SecretKey::kBytes), nonce(12), seal(16);
  EVP_CIPHER_CTX* context = EVP_CIPHER_CTX_new();
  EVP_EncryptInit_ex(context, EVP_aes_256_gcm(), nullptr, key.data(), nullptr);
  int count = 0;
  for (auto _ : state)
    for (size_t at = 0; at < kVaultBytes; at += chunk.size()) {
      ++nonce[0];
      EVP_EncryptInit_ex(context, nullptr, nullptr, nullptr, nonce.data());
      EVP_EncryptUpdate(context, chunk.data(), &count, chunk.data(),
                        static_cast<int>(chunk.size()));
      EVP_EncryptFinal_ex(context, chunk.data(), &count);
      EVP_CIPHER_CTX_ctrl(context, EVP_CTRL_GCM_GET_TAG, 16, seal.data());
    }
  EVP_CIPHER_CTX_free(context);
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(kVaultBytes));
}
BENCHMARK(VaultAesAlone)->Unit(benchmark::kMillisecond);

void VaultSeal(benchmark::State& state) {
  const ScratchDirectory scratch;
  const std::vector<std::byte> bytes(kVaultBytes);
  for (auto _ : state) {
    RandomId id{};
    if (!fill_random(id).ok()) std::abort();
    auto file = SealedFileWriter::create(scratch / to_text(id), id, *SecretKey::random());
    if (!file.ok() || !file->append(bytes).ok() || !file->finish().ok()) std::abort();
    state.PauseTiming();
    std::filesystem::remove(scratch / to_text(id));
    state.ResumeTiming();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(kVaultBytes));
}
BENCHMARK(VaultSeal)->Unit(benchmark::kMillisecond);

void VaultOpen(benchmark::State& state) {
  const ScratchDirectory scratch;
  RandomId id{};
  const SecretKey key = *SecretKey::random();
  std::vector<std::byte> bytes(kVaultBytes);
  {
    auto file = SealedFileWriter::create(scratch / to_text(id), id, key);
    if (!file.ok() || !file->append(bytes).ok() || !file->finish().ok()) std::abort();
  }
  for (auto _ : state) {
    auto file = SealedFileReader::open(scratch / to_text(id), id, key);
    if (!file.ok() || !file->read(bytes).ok()) std::abort();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(kVaultBytes));
}
BENCHMARK(VaultOpen)->Unit(benchmark::kMillisecond);

/// Argument: days of 100 entities.
void VaultKeyFile(benchmark::State& state) {
  VaultKeys keys;
  for (int entity = 0; entity < 100; ++entity)
    for (Day day = 0; day < state.range(0); ++day) {
      VaultDay& kept =
          keys.days[*ltm::MemoryId::from_names({"Vision", "RGB", "head", std::to_string(entity)})]
                   [day];
      if (!fill_random(kept.file).ok()) std::abort();
      kept.key = *SecretKey::random();
    }
  for (auto _ : state) {
    const auto bytes = encode_keys(keys);
    if (!bytes.ok() || !decode_keys(*bytes).ok()) std::abort();
    state.counters["bytes"] = static_cast<double>(bytes->size());
  }
}
BENCHMARK(VaultKeyFile)->Arg(10)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace engram::datasets::vault
