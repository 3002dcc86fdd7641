// SPDX-License-Identifier: Apache-2.0
#include "store/scale_reader.h"

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "ltm/recall/recall.h"
#include "store/report.h"
#include "store/store_measure.h"

namespace engram::experiments {

namespace {

/// A query of one entity, and the steps whose snapshots answer it.
struct Question {
  int entity = 0;
  ltm::Query query;
  uint64_t first_step = 0;
  uint64_t count = 0;
};

/// One kind of question.
struct Kind {
  std::string name;
  std::function<Question(std::mt19937_64&)> draw;
};

uint64_t below(std::mt19937_64& random, uint64_t bound) {
  return std::uniform_int_distribution<uint64_t>(0, bound - 1)(random);
}

class Questions {
 public:
  explicit Questions(const ScaleWorld& world) : world_(world) {}

  /// The result is valid as long as this.
  [[nodiscard]] std::vector<Kind> kinds() const& {
    return {
        {"nearest", [this](auto& random) { return nearest(random); }},
        {"range of 100", [this](auto& random) { return range(random); }},
        {"latest:10", [this](auto& random) { return last(random, ltm::select::Latest{10}, 10); }},
        {"index -3..-1",
         [this](auto& random) {
           return last(random, ltm::select::IndexRange{-3, -1}, 3);
         }},
        {"existence", [this](auto& random) { return existence(random); }}};
  }

  void kinds() && = delete;

 private:
  Question ask(int entity, const ltm::Selector& selector, uint64_t first, uint64_t count) const {
    return {entity, ltm::Query::of_entity(world_.entity(entity), selector), first, count};
  }
  int any_entity(std::mt19937_64& random) const {
    return static_cast<int>(below(random, static_cast<uint64_t>(world_.entities)));
  }
  /// Asks for a time that is up to four tenths of a step away from a snapshot.
  Question nearest(std::mt19937_64& random) const {
    const uint64_t step = below(random, world_.steps);
    const auto beside = Duration(static_cast<int64_t>(below(random, 8000001)) - 4000000);
    return ask(any_entity(random), ltm::select::Nearest{ScaleWorld::time_of(step) + beside}, step,
               1);
  }
  Question range(std::mt19937_64& random) const {
    const uint64_t count = std::min<uint64_t>(100, world_.steps);
    const uint64_t first = below(random, world_.steps - count + 1);
    return ask(
        any_entity(random),
        ltm::select::TimeRange{ScaleWorld::time_of(first), ScaleWorld::time_of(first + count - 1)},
        first, count);
  }
  Question last(std::mt19937_64& random, const ltm::Selector& selector, uint64_t count) const {
    return ask(any_entity(random), selector, world_.steps - count, count);
  }
  /// Half of the questions are about a moment without a snapshot.
  Question existence(std::mt19937_64& random) const {
    const uint64_t step = below(random, world_.steps);
    const bool is_there = below(random, 2) == 0;
    const Time time = ScaleWorld::time_of(step) + (is_there ? Duration{} : Duration(-1));
    Question made = ask(any_entity(random), ltm::select::At{time}, step, is_there ? 1 : 0);
    made.query = ltm::Query::parse("?ids " + made.query.to_string()).value();
    return made;
  }

  const ScaleWorld& world_;
};

bool is_right(const Question& question, const ltm::QueryResult& answer) {
  const auto entities = answer.entities();
  if (entities.size() != 1 || entities[0]->snapshots.size() != question.count) return false;
  for (uint64_t i = 0; i < question.count; ++i) {
    const ltm::SnapshotResult& found = entities[0]->snapshots[i];
    const uint64_t step = question.first_step + i;
    if (found.time != ScaleWorld::time_of(step) || found.instances.size() != 1) return false;
    const bool has_data = !answer.is_ids_only();
    if (has_data && found.instances[0].data != ScaleWorld::value(question.entity, step))
      return false;
  }
  return true;
}

Result<Latency> ask_all(ltm::Recall& recall, const Kind& kind, int queries) {
  std::mt19937_64 random(1);
  std::vector<double> latencies;
  for (int i = 0; i < queries; ++i) {
    const Question question = kind.draw(random);
    const Stopwatch clock;
    const auto answer = recall.query(question.query);
    latencies.push_back(clock.seconds());
    if (!answer.ok()) return answer.status();
    if (!is_right(question, *answer))
      return data_loss("query '{}': was answered wrong", question.query.to_string());
  }
  return summarize(latencies);
}

/// Measures each kind cold, in a store that was just opened, and then the same questions again.
Status measure_kind(const Kind& kind, const std::filesystem::path& store, int queries,
                    nlohmann::json& found) {
  ENGRAM_RETURN_IF_ERROR(drop_cached(store));
  const Stopwatch clock;
  ENGRAM_ASSIGN_OR_RETURN(auto reader, ltm::StoreReader::open(store));
  const double open_seconds = clock.seconds();
  found["open_seconds"] = std::max(open_seconds, found.value("open_seconds", 0.0));
  ltm::Recall recall(std::move(reader), {});
  ENGRAM_ASSIGN_OR_RETURN(const Latency cold, ask_all(recall, kind, queries));
  ENGRAM_ASSIGN_OR_RETURN(const Latency warm, ask_all(recall, kind, queries));
  found["questions"].push_back(
      {{"name", kind.name}, {"cold", to_json(cold)}, {"warm", to_json(warm)}});
  return {};
}

}  // namespace

Result<nlohmann::json> read_scale(const ScaleWorld& world, const std::filesystem::path& store,
                                  int queries) {
  nlohmann::json found = nlohmann::json::object();
  const Questions questions(world);
  for (const Kind& kind : questions.kinds())
    ENGRAM_RETURN_IF_ERROR(measure_kind(kind, store, queries, found));
  ENGRAM_ASSIGN_OR_RETURN(const Memory peak, memory());
  found["memory_bytes"] = peak.peak_bytes;
  return found;
}

}  // namespace engram::experiments
