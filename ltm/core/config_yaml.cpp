// SPDX-License-Identifier: Apache-2.0
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <exception>
#include <sstream>

#include "ltm/core/config_tree.h"
#include "ltm/core/file.h"

namespace engram {

namespace {

/// Leaves the parser of yaml-cpp, whose handlers can only stop it by throwing. It never leaves this
/// file.
class ConfigError : public std::exception {
 public:
  ConfigError(int line, std::string message) : line_(line), message_(std::move(message)) {}
  [[nodiscard]] const char* what() const noexcept override { return message_.c_str(); }
  [[nodiscard]] int line() const { return line_; }

 private:
  int line_;
  std::string message_;
};

}  // namespace

/// Builds a tree from the events of the parser. Throws ConfigError. YAML::Load would resolve
/// aliases and accept keys twice before anything could be checked.
class ConfigParser : public YAML::EventHandler {
 public:
  using Node = ConfigValue::Node;

  static Result<ConfigValue> parse(std::string_view text, std::string name) {
    auto root = std::make_shared<ConfigValue::Root>();
    root->name = std::move(name);
    ConfigParser handler(root->node);
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(handler)) root->node.kind = Node::Kind::kMap;
    if (parser.HandleNextDocument(handler))
      throw ConfigError(handler.last_line_, "holds a second document, needs one");
    if (root->node.kind == Node::Kind::kNull) root->node.kind = Node::Kind::kMap;
    const Node* node = &root->node;
    return ConfigValue(std::move(root), node, "");
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) throw ConfigError(line_of(mark), "holds a second document, needs one");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    place(mark, Node::Kind::kNull, "", false);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw ConfigError(line_of(mark), "found an alias (*name), needs the value itself");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    place(mark, Node::Kind::kText, value, tag == "!");
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, Node::Kind::kList);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, tag, anchor, Node::Kind::kMap);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  /// A list or map that is being read.
  struct Open {
    Node* node;
    bool has_key = false;
    std::string key;
  };

  explicit ConfigParser(Node& root) : root_(root) {}

  static int line_of(const YAML::Mark& mark) { return mark.line + 1; }
  static void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != YAML::NullAnchor)
      throw ConfigError(line_of(mark), "found an anchor (&name), needs a plain value");
  }
  static void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!")
      throw ConfigError(line_of(mark), fmt::format("found the tag '{}', needs a plain value", tag));
  }

  void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
            Node::Kind kind) {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    if (open_.size() == ConfigValue::kMaxDepth)
      throw ConfigError(line_of(mark),
                        fmt::format("nests deeper than {} levels", ConfigValue::kMaxDepth));
    if (Node* node = place(mark, kind, "", false)) open_.push_back({node, false, ""});
  }

  /// Adds a node; returns null where it was a key.
  Node* place(const YAML::Mark& mark, Node::Kind kind, const std::string& text, bool is_quoted) {
    last_line_ = line_of(mark);
    if (++values_ > ConfigValue::kMaxValues)
      throw ConfigError(last_line_,
                        fmt::format("holds more than {} values", ConfigValue::kMaxValues));
    Node made{kind, last_line_, is_quoted, text, {}};
    if (open_.empty()) {
      root_ = std::move(made);
      return &root_;
    }
    Open& above = open_.back();
    if (above.node->kind == Node::Kind::kMap && !above.has_key) {
      take_key(above, made);
      return nullptr;
    }
    above.has_key = false;
    above.node->entries.push_back({std::move(above.key), std::move(made)});
    above.key.clear();
    return &above.node->entries.back().value;
  }

  static void take_key(Open& above, const Node& key) {
    if (key.kind != Node::Kind::kText) throw ConfigError(key.line, "found a key that is no text");
    const auto same = std::ranges::find(above.node->entries, key.text, &Node::Entry::key);
    if (same != above.node->entries.end())
      throw ConfigError(key.line, fmt::format("found the key '{}' again, it is already in line {}",
                                              key.text, same->value.line));
    above.has_key = true;
    above.key = key.text;
  }

  Node& root_;
  std::vector<Open> open_;
  int documents_ = 0;
  size_t values_ = 0;
  int last_line_ = 1;
};

Result<ConfigValue> ConfigValue::parse(std::string_view text, std::string name) {
  if (text.size() > kMaxBytes)
    return invalid_argument("{}: has {} bytes, at most {} are read", name, text.size(), kMaxBytes);
  try {
    return ConfigParser::parse(text, name);
  } catch (const ConfigError& error) {
    return invalid_argument("{}:{}: {}", name, error.line(), error.what());
  } catch (const YAML::Exception& error) {
    return invalid_argument("{}:{}: is no YAML: {}", name, std::max(error.mark.line, 0) + 1,
                            error.msg);
  } catch (const std::exception& error) {
    return invalid_argument("{}: is no YAML: {}", name, error.what());
  }
}

Result<std::string> read_config_text(const std::filesystem::path& path) {
  ENGRAM_ASSIGN_OR_RETURN(const File file, File::open(path, File::Mode::kRead));
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t size, file.size());
  if (size > ConfigValue::kMaxBytes)
    return invalid_argument("{}: has {} bytes, at most {} are read", path.string(), size,
                            ConfigValue::kMaxBytes);
  std::string text(size, '\0');
  ENGRAM_RETURN_IF_ERROR(file.read_at(0, std::as_writable_bytes(std::span(text.data(), size))));
  return text;
}

}  // namespace engram
