// SPDX-License-Identifier: Apache-2.0
// Reads the words of others from lines of JSON.
#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "ltm/core/printable.h"
#include "speech/dialogues/foreign_phrasings.h"
#include "speech/dialogues/lasting_hash.h"

namespace engram::speech::dialogues {

namespace {

using Json = nlohmann::ordered_json;

/// Reads one line. `index` counts the lines that are not empty.
class PhrasingReader {
 public:
  PhrasingReader(const std::string& line, size_t number) : line_(line), number_(number) {}

  Result<ForeignPhrasing> read(size_t index) const {
    const Json json = Json::parse(line_, nullptr, false);
    if (!json.is_object()) return wrong("an object");
    const auto question = json.find("question");
    if (question == json.end() || !question->is_string()) return wrong("a text 'question'");
    ForeignPhrasing phrasing{.question = question->get<std::string>(),
                             .phrasing = fmt::format("foreign#{}", index),
                             .form = {},
                             .skill = {},
                             .asks = {}};
    ENGRAM_RETURN_IF_ERROR(json.contains("form") ? read_form(json, phrasing)
                                                 : read_asks(json, phrasing));
    return phrasing;
  }

 private:
  [[nodiscard]] Status read_form(const Json& json, ForeignPhrasing& phrasing) const {
    constexpr std::array kSkills{"pick", "place", "navigate", "look"};
    const Json& form = json["form"];
    if (!form.is_string() || !is_form(form.get<std::string>())) return wrong("a known 'form'");
    phrasing.form = form.get<std::string>();
    if (const auto skill = json.find("skill"); skill != json.end()) {
      if (!skill->is_string() ||
          std::find(kSkills.begin(), kSkills.end(), skill->get<std::string>()) == kSkills.end())
        return wrong("a 'skill' of pick, place, navigate or look");
      phrasing.skill = skill->get<std::string>();
    }
    // Its name stays when lines come before it, so that it stays held out or not.
    phrasing.phrasing = fmt::format("{}#w{:08x}", phrasing.form,
                                    static_cast<uint32_t>(lasting_hash(phrasing.question)));
    return {};
  }

  [[nodiscard]] Status read_asks(const Json& json, ForeignPhrasing& phrasing) const {
    const auto asks = json.find("asks");
    if (asks == json.end() || !asks->is_object()) return wrong("a 'form' or an object 'asks'");
    for (const auto& [name, value] : asks->items())
      phrasing.asks[name] = value.is_string() ? value.get<std::string>() : value.dump();
    return phrasing.ask("what").empty() ? wrong("'what' within 'asks'") : Status();
  }

  [[nodiscard]] Status wrong(const char* needed) const {
    return invalid_argument("phrasings: line {} needs {}, found '{}'", number_, needed,
                            printable(line_.substr(0, 80)));
  }

  const std::string& line_;
  size_t number_;
};

}  // namespace

Result<std::vector<ForeignPhrasing>> read_phrasings(std::istream& lines) {
  std::vector<ForeignPhrasing> all;
  size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    ENGRAM_ASSIGN_OR_RETURN(ForeignPhrasing one, PhrasingReader(line, number).read(all.size()));
    all.push_back(std::move(one));
  }
  return all;
}

Result<std::vector<ForeignPhrasing>> read_phrasings(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return unavailable("phrasings '{}': cannot be read", path.string());
  return read_phrasings(file);
}

const Result<std::vector<ForeignPhrasing>>& written_phrasings() {
  static const Result<std::vector<ForeignPhrasing>> kRead = [] {
    std::istringstream lines{std::string(written_wordings())};
    return read_phrasings(lines);
  }();
  return kRead;
}

}  // namespace engram::speech::dialogues
