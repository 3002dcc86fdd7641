// SPDX-License-Identifier: Apache-2.0
#include "server/access/audit_chain.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <charconv>
#include <vector>

#include "ltm/core/private_file.h"

namespace engram::server {

namespace {

constexpr std::string_view kRecord = "{\"record\":", kBefore = ",\"before\":\"",
                           kSeal = "\",\"seal\":\"", kEnd = "\"}";
constexpr std::string_view kStateHeader = "engram-audit-state 1";
constexpr size_t kHexBytes = 64;

TokenHash sealed(const TokenHash& key, std::string_view text) {
  TokenHash seal{};
  const auto* done = HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
                          reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                          reinterpret_cast<unsigned char*>(seal.data()), nullptr);
  ENGRAM_CHECK(done != nullptr, "HMAC of {} bytes", text.size());
  return seal;
}

std::optional<uint64_t> number_from(std::string_view text) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

AuditLink AuditLink::first(std::string_view secret) {
  AuditLink link;
  link.key = hash_token(secret);
  return link;
}

std::string AuditLink::line_of(std::string_view fields) const {
  std::string text =
      fmt::format("{}{},{}{}{}", kRecord, record, fields, kBefore, to_hex(this->seal));
  const TokenHash own = sealed(key, text);
  return fmt::format("{}{}{}{}\n", text, kSeal, to_hex(own), kEnd);
}

bool AuditLink::fits(std::string_view line) const {
  const auto told = parse_audit_line(line);
  if (!told) return false;
  const size_t text = line.size() - kSeal.size() - kHexBytes - kEnd.size();
  return equal_in_constant_time(told->seal, sealed(key, line.substr(0, text)));
}

bool AuditLink::is_next(std::string_view line) const {
  const auto told = parse_audit_line(line);
  return told && told->record == record && told->before == seal && fits(line);
}

void AuditLink::advance(std::string_view line) {
  const auto told = parse_audit_line(line.substr(0, line.size() - 1));
  ENGRAM_CHECK(told.has_value(), "audit log: record {} is no record", record);
  skip();
  seal = told->seal;
  bytes += line.size();
}

void AuditLink::skip() {
  TokenHash next = sealed(key, "next");
  OPENSSL_cleanse(key.data(), key.size());
  key = next;
  ++record;
}

std::optional<AuditLine> parse_audit_line(std::string_view line) {
  const size_t tail = kBefore.size() + kHexBytes + kSeal.size() + kHexBytes + kEnd.size();
  if (line.size() > kMaxAuditLine || line.size() < kRecord.size() + tail) return std::nullopt;
  if (!line.starts_with(kRecord) || !line.ends_with(kEnd)) return std::nullopt;
  const std::string_view end = line.substr(line.size() - tail);
  if (!end.starts_with(kBefore)) return std::nullopt;
  if (end.substr(kBefore.size() + kHexBytes, kSeal.size()) != kSeal) return std::nullopt;
  const auto before = token_hash_from_hex(end.substr(kBefore.size(), kHexBytes));
  const auto seal =
      token_hash_from_hex(end.substr(kBefore.size() + kHexBytes + kSeal.size(), kHexBytes));
  const size_t comma = line.find(',');
  const auto record = number_from(line.substr(kRecord.size(), comma - kRecord.size()));
  if (!before || !seal || !record) return std::nullopt;
  // Servers write small digits. The seal covers all of the line but itself.
  if (!end.ends_with(fmt::format("{}{}", to_hex(*seal), kEnd))) return std::nullopt;
  return AuditLine{*record, *before, *seal};
}

std::string to_text(const AuditLink& link) {
  const std::string text = fmt::format("{}\n{:020}\n{:020}\n{}\n{}\n", kStateHeader, link.record,
                                       link.bytes, to_hex(link.key), to_hex(link.seal));
  return fmt::format("{}{}\n", text, to_hex(hash_token(text)));
}

Result<AuditLink> read_audit_state(const std::filesystem::path& path) {
  const size_t size = to_text({}).size();
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, read_private_file(path, size));
  const auto none = [&path] {
    return data_loss("'{}': is no state of an audit log", path.string());
  };
  std::vector<std::string_view> lines;
  for (size_t at = 0; at < text.size();) {
    const size_t end = text.find('\n', at);
    if (end == std::string::npos) return none();
    lines.push_back(std::string_view(text).substr(at, end - at));
    at = end + 1;
  }
  constexpr size_t kLines = 6;
  if (lines.size() != kLines || lines[0] != kStateHeader) return none();
  const auto record = number_from(lines[1]), bytes = number_from(lines[2]);
  const auto key = token_hash_from_hex(lines[3]), seal = token_hash_from_hex(lines[4]);
  if (!record || !bytes || !key || !seal) return none();
  const AuditLink link{*record, *key, *seal, *bytes};
  // A part of it may be older where it is read while it is written.
  if (to_text(link) != text) return none();
  return link;
}

}  // namespace engram::server
