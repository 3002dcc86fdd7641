// SPDX-License-Identifier: Apache-2.0
#include "server/access/access_policy.h"

#include <algorithm>

#include "server/access/private_file.h"

namespace engram::server {

using ltm::MemoryId;

struct Identity::Grant {
  std::string name;
  TokenHash hash{};
  Role role = Role::kRead;
  std::vector<MemoryId> memories;  ///< The empty ID covers all memories.
  mutable std::optional<RateLimit> rate;
  std::optional<Time> expires;

  [[nodiscard]] bool covers(const MemoryId& id) const {
    return std::ranges::any_of(memories,
                               [&](const MemoryId& prefix) { return prefix.is_prefix_of(id); });
  }

  [[nodiscard]] bool is_expired() const { return expires && system_now() >= *expires; }

  [[nodiscard]] Status check_time() const {
    if (!is_expired()) return {};
    return failed_precondition("access: the token of '{}' expired at {}", name,
                               engram::to_string(*expires));
  }
};

namespace {

constexpr std::string_view kAllMemories = "all";

Result<Role> read_role(const ConfigValue& config) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
  for (const Role role : {Role::kRead, Role::kWrite, Role::kAdmin})
    if (text == to_string(role)) return role;
  return config.error(fmt::format("found '{}', needs read, write or admin", text));
}

Result<TokenHash> read_token_file(const ConfigValue& config, std::filesystem::path path) {
  auto text = read_private_file(path, AccessPolicy::kMaxTokenBytes);
  if (!text.ok()) return Status(text.status().code(), config.error(text.status()).message());
  const size_t end = text->find_last_not_of("\r\n");
  const std::string_view token = std::string_view(*text).substr(0, end + 1);
  if (token.size() < AccessPolicy::kFewestTokenBytes)
    return config.error(fmt::format("'{}' has a token of {} bytes, needs at least {}",
                                    path.string(), token.size(), AccessPolicy::kFewestTokenBytes));
  return hash_token(token);
}

Result<TokenHash> read_hash(ConfigMap& map, const std::filesystem::path& directory) {
  const auto hash = map.find("token_sha256");
  const auto file = map.find("token_file");
  if (hash.has_value() == file.has_value())
    return map.value().error("needs either 'token_sha256' or 'token_file'");
  if (file) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string path, file->text());
    return read_token_file(*file, directory / path);
  }
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, hash->text());
  if (const auto value = token_hash_from_hex(text)) return *value;
  // The text may be the token itself, put there by mistake, so the message does not repeat it.
  return hash->error(
      fmt::format("found a text of {} bytes, needs 64 hexadecimal digits", text.size()));
}

Result<Time> read_time(const ConfigValue& config) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
  auto time = parse_time(text);
  if (!time.ok()) return config.error(time.status());
  return time;
}

Result<MemoryId> read_prefix(const ConfigValue& config) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
  auto id = MemoryId::parse(text);
  if (!id.ok()) return config.error(id.status());
  if (id->names().empty() || id->time())
    return config.error(fmt::format("found '{}', needs a memory, segment or entity", text));
  return id;
}

Result<std::vector<MemoryId>> read_memories(const ConfigValue& config) {
  if (config.is_text()) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string text, config.text());
    if (text == kAllMemories) return std::vector{MemoryId()};
    return config.error(fmt::format("found '{}', needs a list of IDs, or 'all'", text));
  }
  std::vector<MemoryId> memories;
  ENGRAM_ASSIGN_OR_RETURN(const auto list, config.list());
  for (const ConfigValue& value : list) {
    ENGRAM_ASSIGN_OR_RETURN(MemoryId prefix, read_prefix(value));
    memories.push_back(std::move(prefix));
  }
  if (memories.empty()) return config.error("found an empty list, needs IDs, or 'all'");
  return memories;
}

}  // namespace

std::string_view to_string(Role role) {
  switch (role) {
    case Role::kRead:
      return "read";
    case Role::kWrite:
      return "write";
    case Role::kAdmin:
      break;
  }
  return "admin";
}

const std::string& Identity::name() const {
  return grant_->name;
}

Role Identity::role() const {
  return grant_->role;
}

Status Identity::check(Role needed, const MemoryId& id) const {
  ENGRAM_RETURN_IF_ERROR(grant_->check_time());
  const std::string what =
      id.names().empty() ? "all memories" : fmt::format("'{}'", id.to_string());
  if (grant_->role < needed)
    return failed_precondition("'{}' has the role {}, {} needs {}", name(), to_string(role()), what,
                               to_string(needed));
  if (!grant_->covers(id)) return failed_precondition("'{}' has no access to {}", name(), what);
  return {};
}

bool Identity::may_read(const MemoryId& id) const {
  return !grant_->is_expired() && grant_->covers(id);
}

Status Identity::take_request(SteadyTime now) const {
  ENGRAM_RETURN_IF_ERROR(grant_->check_time());
  if (!grant_->rate || grant_->rate->take(now)) return {};
  return resource_exhausted("'{}' makes more requests per second than its token may", name());
}

AccessPolicy AccessPolicy::everyone() {
  AccessPolicy policy{Grants{}};
  auto grant = std::make_shared<Identity::Grant>();
  grant->name = "everyone";
  grant->role = Role::kAdmin;
  grant->memories = {MemoryId()};
  policy.everyone_ = std::move(grant);
  return policy;
}

Result<AccessPolicy> AccessPolicy::read_file(const std::filesystem::path& path, SteadyTime now) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string text, read_private_file(path, ConfigValue::kMaxBytes));
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue config, ConfigValue::parse(text, path.string()));
  return parse(config, path.parent_path(), now);
}

Result<AccessPolicy> AccessPolicy::parse(const ConfigValue& config,
                                         const std::filesystem::path& directory, SteadyTime now) {
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, config.map());
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue tokens, map.require("tokens"));
  ENGRAM_RETURN_IF_ERROR(map.finish());
  ENGRAM_ASSIGN_OR_RETURN(const auto list, tokens.list());
  if (list.empty() || list.size() > kMaxTokens)
    return tokens.error(fmt::format("found {} tokens, needs 1 to {}", list.size(), kMaxTokens));
  Grants grants;
  for (const ConfigValue& value : list) {
    ENGRAM_ASSIGN_OR_RETURN(auto grant, read_grant(value, directory, now));
    for (const auto& other : grants) {
      if (other->name == grant->name)
        return value.error(fmt::format("the name '{}' is there twice", grant->name));
      if (other->hash == grant->hash)
        return value.error(fmt::format("has the token of '{}'", other->name));
    }
    grants.push_back(std::move(grant));
  }
  return AccessPolicy(std::move(grants));
}

Result<std::shared_ptr<const Identity::Grant>> AccessPolicy::read_grant(
    const ConfigValue& config, const std::filesystem::path& directory, SteadyTime now) {
  auto grant = std::make_shared<Identity::Grant>();
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, config.map());
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue name, map.require("name"));
  ENGRAM_ASSIGN_OR_RETURN(grant->name, name.text());
  if (grant->name.empty()) return name.error("is empty");
  ENGRAM_ASSIGN_OR_RETURN(grant->hash, read_hash(map, directory));
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue role, map.require("role"));
  ENGRAM_ASSIGN_OR_RETURN(grant->role, read_role(role));
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue memories, map.require("memories"));
  ENGRAM_ASSIGN_OR_RETURN(grant->memories, read_memories(memories));
  std::optional<double> rate_hz;
  ENGRAM_RETURN_IF_ERROR(map.read("rate", rate_hz, &ConfigValue::rate_hz));
  if (rate_hz) grant->rate.emplace(*rate_hz, now);
  if (const auto expires = map.find("expires")) {
    ENGRAM_ASSIGN_OR_RETURN(grant->expires, read_time(*expires));
  }
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return std::shared_ptr<const Identity::Grant>(std::move(grant));
}

Result<Identity> AccessPolicy::authenticate(std::string_view token) const {
  if (everyone_ != nullptr) return Identity(everyone_);
  if (token.empty()) return failed_precondition("access: found no token, needs one");
  if (token.size() > kMaxTokenBytes)
    return failed_precondition("access: found a token of {} bytes, there is none above {}",
                               token.size(), kMaxTokenBytes);
  const TokenHash hash = hash_token(token);
  std::shared_ptr<const Identity::Grant> found;
  // No early exit: the time must not tell at which entry a token matched.
  for (const auto& grant : grants_)
    if (equal_in_constant_time(grant->hash, hash)) found = grant;
  if (found == nullptr) return failed_precondition("access: the token is not known");
  ENGRAM_RETURN_IF_ERROR(found->check_time());
  return Identity(std::move(found));
}

}  // namespace engram::server
