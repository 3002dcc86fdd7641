// SPDX-License-Identifier: Apache-2.0
#include "server/access/access_policy.h"

#include <algorithm>

#include "ltm/core/private_file.h"
#include "ltm/redaction/redaction_config.h"
#include "server/access/grants.h"

namespace engram::server {

using ltm::MemoryId;

class Identity::Holder final : public ltm::View {
 public:
  std::string name;
  TokenHash hash{};
  Grants grants;
  mutable std::optional<RateLimit> rate;
  std::optional<Time> expires;

  [[nodiscard]] ltm::Sight of(const MemoryId& entity) const override {
    const Time now = system_now();
    return is_expired(now) ? ltm::Sight{} : grants.sight_of(entity, now);
  }

  [[nodiscard]] bool is_expired(Time now) const { return expires && now >= *expires; }

  [[nodiscard]] Status check_time() const {
    if (!is_expired(system_now())) return {};
    return failed_precondition("access: the token of '{}' expired at {}", name,
                               engram::to_string(*expires));
  }

  [[nodiscard]] Status refused(Right right, const MemoryId& id, std::string_view when) const {
    const std::string what =
        id.names().empty() ? "all memories" : fmt::format("'{}'", id.to_string());
    return failed_precondition("'{}' may not {} {}{}", name, verb_of(right), what, when);
  }

  [[nodiscard]] Status refused_all(Right right) const {
    return failed_precondition("'{}' may {} nothing", name, verb_of(right));
  }

 private:
  static std::string_view verb_of(Right right) {
    return right == Right::kRead     ? "read"
           : right == Right::kModels ? "ask for predictions of"
           : right == Right::kWrite  ? "write"
                                     : "erase";
  }
};

/// What the holder of a token may erase.
class Identity::Erasable final : public ltm::View {
 public:
  explicit Erasable(std::shared_ptr<const Holder> holder) : holder_(std::move(holder)) {}

  [[nodiscard]] ltm::Sight of(const MemoryId& entity) const override {
    const Time now = system_now();
    if (holder_->is_expired(now)) return {};
    ltm::Sight sight;
    sight.times = holder_->grants.times(Right::kErase, entity, now);
    return sight;
  }

 private:
  const std::shared_ptr<const Holder> holder_;
};

namespace {

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

}  // namespace

const std::string& Identity::name() const {
  return holder_->name;
}

Status Identity::check(Right needed, const MemoryId& id) const {
  ENGRAM_RETURN_IF_ERROR(holder_->check_time());
  return holder_->grants.give(needed, id) ? Status() : holder_->refused(needed, id, "");
}

Status Identity::check(Right needed, const MemoryId& id, Time time) const {
  ENGRAM_RETURN_IF_ERROR(check(needed, id));
  if (holder_->grants.times(needed, id, system_now()).contains(time)) return {};
  return holder_->refused(needed, id, " at " + engram::to_string(time));
}

Status Identity::check_below(Right needed, const MemoryId& id) const {
  ENGRAM_RETURN_IF_ERROR(holder_->check_time());
  if (holder_->grants.give_below(needed, id)) return {};
  return id.names().empty() ? holder_->refused_all(needed) : holder_->refused(needed, id, "");
}

bool Identity::may_read_all(const MemoryId& id) const {
  return holder_->of(id).is_whole();
}

ltm::SharedView Identity::view() const {
  const bool sees_all = !holder_->expires && holder_->of(MemoryId()).is_all();
  return sees_all ? nullptr : ltm::SharedView(holder_);
}

ltm::SharedView Identity::erasable() const {
  auto erasable = std::make_shared<const Erasable>(holder_);
  if (!holder_->expires && erasable->of(MemoryId()).times.is_all()) return nullptr;
  return erasable;
}

Status Identity::take_request(SteadyTime now) const {
  ENGRAM_RETURN_IF_ERROR(holder_->check_time());
  if (!holder_->rate || holder_->rate->take(now)) return {};
  return resource_exhausted("'{}' makes more requests per second than its token may", name());
}

AccessPolicy AccessPolicy::everyone() {
  AccessPolicy policy{std::vector<SharedHolder>{}};
  auto holder = std::make_shared<Identity::Holder>();
  holder->name = "everyone";
  holder->grants = Grants::all();
  policy.everyone_ = std::move(holder);
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
  std::optional<ltm::RedactionOptions> redaction;
  if (const auto redact = map.find("redact")) {
    ENGRAM_ASSIGN_OR_RETURN(redaction, ltm::read_redaction(*redact));
  }
  ENGRAM_RETURN_IF_ERROR(map.finish());
  ENGRAM_ASSIGN_OR_RETURN(const auto list, tokens.list());
  if (list.empty() || list.size() > kMaxTokens)
    return tokens.error(fmt::format("found {} tokens, needs 1 to {}", list.size(), kMaxTokens));
  std::vector<SharedHolder> holders;
  for (const ConfigValue& value : list) {
    ENGRAM_ASSIGN_OR_RETURN(auto holder, read_holder(value, directory, now));
    for (const auto& other : holders) {
      if (other->name == holder->name)
        return value.error(fmt::format("the name '{}' is there twice", holder->name));
      if (other->hash == holder->hash)
        return value.error(fmt::format("has the token of '{}'", other->name));
    }
    if (holder->grants.redact() && !redaction)
      return value.error("has a grant with the form redacted, needs 'redact' in this file");
    holders.push_back(std::move(holder));
  }
  AccessPolicy policy(std::move(holders));
  policy.redaction_ = std::move(redaction);
  return policy;
}

Result<AccessPolicy::SharedHolder> AccessPolicy::read_holder(const ConfigValue& config,
                                                             const std::filesystem::path& directory,
                                                             SteadyTime now) {
  auto holder = std::make_shared<Identity::Holder>();
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, config.map());
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue name, map.require("name"));
  ENGRAM_ASSIGN_OR_RETURN(holder->name, name.text());
  if (holder->name.empty()) return name.error("is empty");
  ENGRAM_ASSIGN_OR_RETURN(holder->hash, read_hash(map, directory));
  ENGRAM_ASSIGN_OR_RETURN(holder->grants, Grants::read(map));
  std::optional<double> rate_hz;
  ENGRAM_RETURN_IF_ERROR(map.read("rate", rate_hz, &ConfigValue::rate_hz));
  if (rate_hz) holder->rate.emplace(*rate_hz, now);
  if (const auto expires = map.find("expires")) {
    ENGRAM_ASSIGN_OR_RETURN(holder->expires, read_time(*expires));
  }
  ENGRAM_RETURN_IF_ERROR(map.finish());
  return SharedHolder(std::move(holder));
}

Result<Identity> AccessPolicy::authenticate(std::string_view token) const {
  if (everyone_ != nullptr) return Identity(everyone_);
  if (token.empty()) return failed_precondition("access: found no token, needs one");
  if (token.size() > kMaxTokenBytes)
    return failed_precondition("access: found a token of {} bytes, there is none above {}",
                               token.size(), kMaxTokenBytes);
  const TokenHash hash = hash_token(token);
  SharedHolder found;
  // No early exit: the time must not tell at which entry a token matched.
  for (const auto& holder : holders_)
    if (equal_in_constant_time(holder->hash, hash)) found = holder;
  if (found == nullptr) return failed_precondition("access: the token is not known");
  ENGRAM_RETURN_IF_ERROR(found->check_time());
  return Identity(std::move(found));
}

}  // namespace engram::server
