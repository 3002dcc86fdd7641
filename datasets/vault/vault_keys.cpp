// SPDX-License-Identifier: Apache-2.0
#include "datasets/vault/vault_keys.h"

#include <openssl/evp.h>

#include <charconv>
#include <chrono>

#include "ltm/core/byte_fields.h"
#include "ltm/core/printable.h"
#include "ltm/idf/binary.h"

namespace engram::datasets::vault {

namespace {

constexpr std::string_view kKeysMagic = "ENGRAMVK";
constexpr uint32_t kKeysVersion = 1;
constexpr size_t kDigestBytes = 32;

/// A key file has about so many bytes for each day and for each entity.
constexpr size_t kDayBytes = 168;
constexpr size_t kEntityBytes = 300;

Result<std::array<std::byte, kDigestBytes>> sha256(std::span<const std::byte> bytes) {
  std::array<std::byte, kDigestBytes> sum{};
  unsigned int size = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), reinterpret_cast<unsigned char*>(sum.data()), &size,
                 EVP_sha256(), nullptr) != 1 ||
      size != kDigestBytes)
    return unavailable("OpenSSL cannot compute a SHA-256");
  return sum;
}

Time time_of(FieldReader& in) {
  return time_from_ns(in.number<int64_t>());
}

void write_day(FieldWriter<SecretBytes>& out, Day day, const VaultDay& kept) {
  out.number(day);
  out.bytes(kept.file);
  out.bytes(kept.key.bytes());
  for (const uint64_t number : {kept.snapshots, kept.instances, kept.raw_bytes, kept.file_bytes,
                                kept.reconstructed, kept.source, kept.times, kept.digest})
    out.number(number);
  out.number(to_ns(kept.first));
  out.number(to_ns(kept.last));
}

VaultDay read_day(FieldReader& in) {
  VaultDay kept;
  in.fill(kept.file);
  const auto key = in.bytes(SecretKey::kBytes);
  if (key.size() == SecretKey::kBytes) kept.key = SecretKey(key.first<SecretKey::kBytes>());
  for (uint64_t* number : {&kept.snapshots, &kept.instances, &kept.raw_bytes, &kept.file_bytes,
                           &kept.reconstructed, &kept.source, &kept.times, &kept.digest})
    *number = in.number<uint64_t>();
  kept.first = time_of(in);
  kept.last = time_of(in);
  return kept;
}

void write_destroyed(FieldWriter<SecretBytes>& out, Day day, const DestroyedDay& gone) {
  out.number(day);
  out.bytes(gone.file);
  out.number(to_ns(gone.when));
}

DestroyedDay read_destroyed(FieldReader& in) {
  DestroyedDay gone;
  in.fill(gone.file);
  gone.when = time_of(in);
  return gone;
}

template <typename OfDay>
using ByEntity = std::map<ltm::MemoryId, std::map<Day, OfDay>>;

template <typename OfDay, typename Write>
void write_all(FieldWriter<SecretBytes>& out, const ByEntity<OfDay>& all, const Write& write) {
  out.number(static_cast<uint64_t>(all.size()));
  for (const auto& [entity, days] : all) {
    out.text(entity.to_string());
    out.number(static_cast<uint64_t>(days.size()));
    for (const auto& [day, of_day] : days) write(out, day, of_day);
  }
}

/// Counts come from a file: the loops end where its bytes do.
template <typename OfDay, typename Read>
Status read_all(FieldReader& in, ByEntity<OfDay>& all, const Read& read) {
  const auto entities = in.number<uint64_t>();
  for (uint64_t i = 0; i < entities && in.is_whole(); ++i) {
    const std::string_view name = in.text();
    const auto entity = ltm::MemoryId::parse(name);
    if (!entity.ok() || !entity->is_entity())
      return data_loss("'{}' is no entity", printable(name));
    const auto [place, is_new] = all.try_emplace(*entity);
    if (!is_new) return data_loss("'{}' is there twice", entity->printable());
    const auto days = in.number<uint64_t>();
    for (uint64_t j = 0; j < days && in.is_whole(); ++j) {
      const auto day = in.number<Day>();
      if (!place->second.try_emplace(day, read(in)).second)
        return data_loss("'{}' has one day twice", entity->printable());
    }
  }
  return {};
}

Status check_files_differ(const VaultKeys& keys) {
  std::set<RandomId> files = keys.obsolete;
  const auto is_new = [&files](const auto& of_day) { return files.insert(of_day.file).second; };
  for (const auto& [entity, days] : keys.days)
    for (const auto& [day, kept] : days)
      if (!is_new(kept) || keys.is_destroyed(entity, day))
        return data_loss("'{}': two entries are of one file or day", entity.printable());
  for (const auto& [entity, days] : keys.destroyed)
    for (const auto& [day, gone] : days)
      if (!is_new(gone)) return data_loss("'{}': two entries are of one file", entity.printable());
  return {};
}

Status read_body(FieldReader& in, VaultKeys& keys) {
  in.fill(keys.vault);
  keys.store_id = in.text();
  const auto types = in.sized();
  if (!in.is_whole()) return data_loss("is cut off");
  ENGRAM_ASSIGN_OR_RETURN(const idf::Data data, idf::decode(Buffer::copy(types)));
  ENGRAM_ASSIGN_OR_RETURN(keys.types, ltm::SegmentTypes::from_data(data));
  ENGRAM_RETURN_IF_ERROR(read_all(in, keys.days, read_day));
  ENGRAM_RETURN_IF_ERROR(read_all(in, keys.destroyed, read_destroyed));
  const auto obsolete = in.number<uint64_t>();
  for (uint64_t i = 0; i < obsolete && in.is_whole(); ++i) {
    RandomId file{};
    in.fill(file);
    keys.obsolete.insert(file);
  }
  if (!in.is_whole()) return data_loss("is cut off");
  if (in.rest() > 0) return data_loss("has {} bytes too many", in.rest());
  return check_files_differ(keys);
}

/// True if the bytes end with the SHA-256 of those before.
Result<bool> has_its_sum(std::span<const std::byte> bytes) {
  if (bytes.size() < kDigestBytes) return false;
  ENGRAM_ASSIGN_OR_RETURN(const auto sum, sha256(bytes.first(bytes.size() - kDigestBytes)));
  return std::ranges::equal(sum, bytes.last(kDigestBytes));
}

}  // namespace

Day day_of(Time time) {
  return static_cast<Day>(std::chrono::floor<std::chrono::days>(time).time_since_epoch().count());
}

// The range of Time begins and ends within a day.
Time day_begin(Day day) {
  return day <= day_of(Time::min()) ? Time::min() : Time(std::chrono::days(day));
}

Time day_end(Day day) {
  return day >= day_of(Time::max()) ? Time::max() : Time(std::chrono::days(day + 1)) - Duration(1);
}

std::string day_text(Day day) {
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::days(day))};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

std::string printable_day(const ltm::MemoryId& entity, Day day) {
  return day_text(day) + " " + entity.printable();
}

Result<Day> parse_day(std::string_view text) {
  const auto wrong = [text] {
    return invalid_argument("'{}' is no day, needs one as in 2022-02-18", printable(text));
  };
  constexpr std::string_view kLike = "2022-02-18";
  if (text.size() != kLike.size()) return wrong();
  for (size_t i = 0; i < text.size(); ++i)
    if ((kLike[i] == '-') != (text[i] == '-')) return wrong();
  int year = 0;
  unsigned month = 0, day = 0;
  const auto read = [&text](size_t at, size_t count, auto& number) {
    const char* const end = text.data() + at + count;
    return std::from_chars(text.data() + at, end, number).ptr == end;
  };
  if (!read(0, 4, year) || !read(5, 2, month) || !read(8, 2, day)) return wrong();
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
  if (!date.ok()) return wrong();
  return static_cast<Day>(std::chrono::sys_days(date).time_since_epoch().count());
}

const VaultDay* VaultKeys::find(const ltm::MemoryId& entity, Day day) const {
  const auto of_entity = days.find(entity);
  if (of_entity == days.end()) return nullptr;
  const auto kept = of_entity->second.find(day);
  return kept == of_entity->second.end() ? nullptr : &kept->second;
}

bool VaultKeys::is_destroyed(const ltm::MemoryId& entity, Day day) const {
  const auto of_entity = destroyed.find(entity);
  return of_entity != destroyed.end() && of_entity->second.contains(day);
}

uint64_t VaultKeys::day_count() const {
  uint64_t count = 0;
  for (const auto& [entity, of_entity] : days) count += of_entity.size();
  return count;
}

uint64_t VaultKeys::destroyed_count() const {
  uint64_t count = 0;
  for (const auto& [entity, of_entity] : destroyed) count += of_entity.size();
  return count;
}

Result<SecretBytes> encode_keys(const VaultKeys& keys) {
  ENGRAM_ASSIGN_OR_RETURN(const auto types, idf::encode(keys.types.to_data()));
  SecretBytes bytes;
  bytes.reserve(types.size() + kDayBytes * (keys.day_count() + keys.destroyed_count() + 8) +
                kEntityBytes * keys.days.size());
  FieldWriter out(bytes);
  out.bytes(as_bytes(kKeysMagic));
  out.number(kKeysVersion);
  out.bytes(keys.vault);
  out.text(keys.store_id);
  out.sized(types);
  write_all(out, keys.days, write_day);
  write_all(out, keys.destroyed, write_destroyed);
  out.number(static_cast<uint64_t>(keys.obsolete.size()));
  for (const RandomId& file : keys.obsolete) out.bytes(file);
  ENGRAM_ASSIGN_OR_RETURN(const auto sum, sha256(bytes));
  out.bytes(sum);
  return bytes;
}

Result<VaultKeys> decode_keys(std::span<const std::byte> bytes) {
  FieldReader in(bytes);
  if (as_text(in.bytes(kKeysMagic.size())) != kKeysMagic)
    return data_loss("is no key file of a vault");
  const auto version = in.number<uint32_t>();
  if (in.is_whole() && version > kKeysVersion)
    return failed_precondition("has version {} of the format, this program reads up to {}", version,
                               kKeysVersion);
  ENGRAM_ASSIGN_OR_RETURN(const bool is_whole, has_its_sum(bytes));
  if (!is_whole || version == 0) return data_loss("is damaged: its checksum does not fit");
  FieldReader body(bytes.first(bytes.size() - kDigestBytes));
  body.bytes(kKeysMagic.size() + sizeof(version));
  VaultKeys keys;
  ENGRAM_RETURN_IF_ERROR(read_body(body, keys));
  return keys;
}

}  // namespace engram::datasets::vault
