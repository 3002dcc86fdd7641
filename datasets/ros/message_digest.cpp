// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/message_digest.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "datasets/ros/definition_text.h"

namespace engram::datasets::ros {

namespace {

constexpr std::array<std::string_view, 16> kPlainTypes{
    "bool",   "int8",  "uint8",  "byte",    "char",    "int16",  "uint16", "int32",
    "uint32", "int64", "uint64", "float32", "float64", "string", "time",   "duration"};

struct NamedType {
  std::string_view type;
  std::string_view name;
};
struct Section {
  std::string constants;  ///< In the form in which they are summed.
  std::vector<NamedType> fields;
};
using Sections = std::map<std::string, Section, std::less<>>;

Status read_line(std::string_view line, Section& section) {
  const std::string_view code = trimmed(line.substr(0, line.find('#')));
  if (code.empty()) return {};
  const size_t type_end = code.find_first_of(kSpace);
  if (type_end == std::string_view::npos)
    return invalid_argument("'{}' is no field, needs a type and a name", code);
  const std::string_view type = code.substr(0, type_end);
  const size_t equals = code.find('=');
  if (equals == std::string_view::npos) {
    section.fields.push_back({type, trimmed(code.substr(type_end))});
    return {};
  }
  // Everything after '=' belongs to a text constant, including '#'.
  const std::string_view whole = type == "string" ? trimmed(line) : code;
  section.constants +=
      fmt::format("{} {}={}\n", type, trimmed(code.substr(type_end, equals - type_end)),
                  trimmed(whole.substr(whole.find('=') + 1)));
  return {};
}

Result<Sections> read_sections(std::string_view type, std::string_view text) {
  Sections sections;
  Section* section = &sections[std::string(type)];
  while (!text.empty()) {
    const size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    if (trimmed(line).starts_with("========")) continue;
    if (trimmed(line).starts_with("MSG:"))
      section = &sections[std::string(trimmed(trimmed(line).substr(4)))];
    else
      ENGRAM_RETURN_IF_ERROR(read_line(line, *section));
  }
  return sections;
}

Result<std::string> md5_of(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> sum{};
  unsigned int size = 0;
  if (EVP_Digest(text.data(), text.size(), sum.data(), &size, EVP_md5(), nullptr) != 1)
    return failed_precondition("OpenSSL has no MD5 here, which bags need");
  std::string digits;
  for (unsigned int i = 0; i < size; ++i) digits += fmt::format("{:02x}", sum[i]);
  return digits;
}

/// Computes the sum of a message after those of its nested messages.
class Digest {
 public:
  explicit Digest(const Sections& sections) : sections_(sections) {}

  Result<std::string> of(const std::string& type, int depth = 0) {
    if (const auto known = sums_.find(type); known != sums_.end()) return known->second;
    if (depth > kMaxDepth) return invalid_argument("'{}' nests deeper than {}", type, kMaxDepth);
    const Section& section = sections_.find(type)->second;
    std::string text = section.constants;
    for (const auto& [field_type, name] : section.fields) {
      // Arrays of messages are summed without their brackets, as genmsg does it.
      const std::string_view bare = field_type.substr(0, field_type.find('['));
      if (std::ranges::find(kPlainTypes, bare) != kPlainTypes.end()) {
        text += fmt::format("{} {}\n", field_type, name);
        continue;
      }
      ENGRAM_ASSIGN_OR_RETURN(const std::string inner, resolved(bare, type));
      ENGRAM_ASSIGN_OR_RETURN(const std::string sum, of(inner, depth + 1));
      text += fmt::format("{} {}\n", sum, name);
    }
    // genmsg sums the text without the last line break; another byte would be another type.
    if (text.ends_with('\n')) text.pop_back();
    ENGRAM_ASSIGN_OR_RETURN(const std::string sum, md5_of(text));
    return sums_[type] = sum;
  }

 private:
  Result<std::string> resolved(std::string_view type, std::string_view inside) const {
    const std::string name(type == "Header" ? "std_msgs/Header" : type);
    if (sections_.contains(name)) return name;
    const std::string sibling = fmt::format("{}/{}", inside.substr(0, inside.find('/')), name);
    if (sections_.contains(sibling)) return sibling;
    return invalid_argument("'{}' of '{}' is defined nowhere", type, inside);
  }

  const Sections& sections_;
  std::map<std::string, std::string, std::less<>> sums_;
};

}  // namespace

Result<std::string> message_md5(std::string_view type, std::string_view text) {
  const auto fail = [&](const Status& status) {
    return status.with_context(fmt::format("definition of '{}'", type));
  };
  const auto sections = read_sections(type, text);
  if (!sections.ok()) return fail(sections.status());
  auto sum = Digest(*sections).of(std::string(type));
  return sum.ok() ? std::move(sum) : fail(sum.status());
}

}  // namespace engram::datasets::ros
