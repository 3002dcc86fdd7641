// SPDX-License-Identifier: Apache-2.0
#include "viewer/forget_form.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "ltm/core/config.h"
#include "ltm/core/printable.h"
#include "ltm/forgetting/forget_config.h"

namespace engram::viewer {

namespace {

constexpr std::array<const char*, 8> kFields{"match",      "older_than", "unread_for", "keep",
                                             "fade_after", "fade_psnr",  "max_bytes",  "newest"};

std::string named(std::string_view name) {
  return fmt::format("parameter '{}'", name);
}

/// Quotes a text for YAML.
std::string yaml_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

/// The fields of the form. An empty one counts as missing, because a form sends it so.
class PolicyFields {
 public:
  explicit PolicyFields(const RequestTarget& target) : target_(target) {}

  [[nodiscard]] std::optional<std::string> find(std::string_view name) const {
    auto found = target_.find(name);
    return found && found->empty() ? std::nullopt : std::move(found);
  }

  /// "older_than: 7d", or an empty text; `as` is the key of the configuration.
  Result<std::string> duration(std::string_view name, std::string_view as) const {
    const auto found = find(name);
    if (!found) return std::string();
    const auto value = parse_duration(*found);
    if (!value.ok() || *value < Duration(0)) return wrong(name, "a duration such as 12h or 7d");
    return fmt::format("{}: {}", as, *found);
  }

  Result<std::string> bytes(std::string_view name) const {
    const auto found = find(name);
    if (!found) return std::string();
    const auto value = ConfigValue::parse(yaml_quoted(*found), named(name));
    if (!value.ok() || !value->bytes().ok()) return wrong(name, "a size such as 500MB or 20GiB");
    return fmt::format("{}: {}", name, *found);
  }

  /// A decimal number within bounds, as it was written.
  Result<std::string> number(std::string_view name, double min, double max) const {
    const auto found = find(name);
    if (!found) return std::string();
    double value = 0;
    const auto [end, error] = std::from_chars(found->data(), found->data() + found->size(), value,
                                              std::chars_format::fixed);
    if (error != std::errc() || end != found->data() + found->size() || !(value >= min) ||
        !(value <= max))
      return wrong(name, fmt::format("a number from {} to {}", min, max));
    return *found;
  }

  /// "match: 'Vision/.*'", or an empty text.
  Result<std::string> pattern(std::string_view name) const {
    const auto found = find(name);
    if (!found) return std::string();
    // What cannot be printed could not be copied into a configuration either.
    if (printable(*found) != *found) return wrong(name, "names without control characters");
    const auto parsed = ltm::EntityPattern::parse(*found);
    if (!parsed.ok()) return parsed.status().with_context(named(name));
    return fmt::format("{}: {}", name, yaml_quoted(*found));
  }

  [[nodiscard]] Status wrong(std::string_view name, std::string_view needed) const {
    constexpr size_t kShownText = 100;
    return invalid_argument("{}: found '{}', needs {}", named(name),
                            printable(find(name).value_or("").substr(0, kShownText)), needed);
  }

 private:
  const RequestTarget& target_;
};

/// Keys and values that are not empty, between braces.
std::string map_text(std::initializer_list<std::string> parts) {
  std::string text;
  for (const std::string& part : parts)
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  return "{" + text + "}";
}

Result<std::string> fade_text(const PolicyFields& fields, const std::string& match) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string after, fields.duration("fade_after", "after"));
  const auto target = fields.find("fade_psnr");
  if (after.empty()) {
    if (!target) return std::string();
    return fields.wrong("fade_psnr", "'fade_after' beside it");
  }
  std::string form = "form: gist";
  if (target.value_or("gist") != "gist") {
    ENGRAM_ASSIGN_OR_RETURN(
        const std::string psnr,
        fields.number("fade_psnr", ltm::FadeStep::kMinPsnrDb, ltm::FadeStep::kMaxPsnrDb));
    form = "psnr: " + psnr;
  }
  return fmt::format("  fade:\n    - {}\n", map_text({match, after, form}));
}

/// The configuration that a form means.
Result<std::string> config_of(const PolicyFields& fields) {
  ENGRAM_ASSIGN_OR_RETURN(const std::string match, fields.pattern("match"));
  ENGRAM_ASSIGN_OR_RETURN(const std::string age, fields.duration("older_than", "older_than"));
  ENGRAM_ASSIGN_OR_RETURN(const std::string unread, fields.duration("unread_for", "unread_for"));
  ENGRAM_ASSIGN_OR_RETURN(const std::string keep, fields.number("keep", 0, 1));
  ENGRAM_ASSIGN_OR_RETURN(const std::string fade, fade_text(fields, match));
  ENGRAM_ASSIGN_OR_RETURN(const std::string bytes, fields.bytes("max_bytes"));
  ENGRAM_ASSIGN_OR_RETURN(const std::string newest, fields.number("newest", 0, 1e6));
  if (newest.find('.') != std::string::npos) return fields.wrong("newest", "an integer");
  const std::string saliency = keep.empty() ? "" : fmt::format("saliency: {{keep: {}}}", keep);
  std::string config = "forget:\n";
  if (!age.empty() || !unread.empty() || !saliency.empty())
    config += fmt::format("  rules:\n    - {}\n", map_text({match, age, unread, saliency}));
  config += fade;
  if (!bytes.empty()) {
    config += fmt::format("  quota:\n    {}\n", bytes);
    // A quota is one of the whole store; what it takes first are the oldest of these.
    if (!match.empty())
      config += fmt::format("    first:\n      - {}\n", map_text({match, "older_than: 0s"}));
  }
  if (config == "forget:\n")
    return invalid_argument(
        "nothing says what is to go: needs 'older_than', 'unread_for', 'keep', 'fade_after' or "
        "'max_bytes'");
  if (!newest.empty()) config += fmt::format("  protect:\n    newest: {}\n", newest);
  return config;
}

}  // namespace

Result<ForgetPolicyText> read_forget_policy(const RequestTarget& target) {
  const PolicyFields fields(target);
  ForgetPolicyText policy;
  if (const auto config = fields.find("config")) {
    for (const char* field : kFields)
      if (fields.find(field))
        return invalid_argument("{}: found it beside 'config', needs one of both", named(field));
    policy.config = *config;
  } else {
    ENGRAM_ASSIGN_OR_RETURN(policy.config, config_of(fields));
  }
  ENGRAM_ASSIGN_OR_RETURN(policy.options, ltm::parse_forget_config(policy.config, "policy"));
  return policy;
}

}  // namespace engram::viewer
