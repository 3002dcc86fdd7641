// SPDX-License-Identifier: Apache-2.0
#include "memory/replay/replay_state.h"

namespace engram {

namespace {

/// Reads members of a value; the first that is missing or of another kind is the error.
class StateReader {
 public:
  explicit StateReader(const idf::Data& data) : data_(data) {}

  template <typename T>
  T get(std::string_view key) {
    const idf::Data* found = data_.is<idf::Dict>() ? data_.at(key) : nullptr;
    const T* value = found == nullptr ? nullptr : found->get_if<T>();
    if (value == nullptr && status_.ok())
      status_ = invalid_argument("replay state: '{}' is {}, needs another kind of value", key,
                                 found == nullptr ? "missing" : std::string(found->kind_name()));
    return value == nullptr ? T{} : *value;
  }
  Time time(std::string_view key) { return time_from_ns(get<int64_t>(key)); }
  uint64_t count(std::string_view key) { return static_cast<uint64_t>(get<int64_t>(key)); }
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  const idf::Data& data_;
  Status status_;
};

}  // namespace

idf::Data ReplayState::to_data() const {
  const auto count = [](uint64_t number) { return static_cast<int64_t>(number); };
  idf::List names(stores.begin(), stores.end());
  idf::Data loops;
  if (loop) loops = idf::Dict{{"first", to_ns(loop->first)}, {"last", to_ns(loop->last)}};
  return idf::Dict{{"stores", std::move(names)},
                   {"now", to_ns(now)},
                   {"speed", speed},
                   {"is_playing", is_playing},
                   {"loop", std::move(loops)},
                   {"first", to_ns(first)},
                   {"last", to_ns(last)},
                   {"jumps", count(jumps)},
                   {"told", count(told)},
                   {"unreadable", count(unreadable)},
                   {"scored", count(scored)},
                   {"bounded", count(bounded)},
                   {"within_bound", count(within_bound)},
                   {"unscored", count(unscored)}};
}

Result<ReplayState> ReplayState::from_data(const idf::Data& data) {
  StateReader reader(data);
  ReplayState state;
  for (const idf::Data& store : reader.get<idf::List>("stores")) {
    const auto* name = store.get_if<std::string>();
    if (name == nullptr) return invalid_argument("replay state: 'stores' has one without a name");
    state.stores.push_back(*name);
  }
  state.now = reader.time("now");
  state.speed = reader.get<double>("speed");
  state.is_playing = reader.get<bool>("is_playing");
  state.first = reader.time("first");
  state.last = reader.time("last");
  state.jumps = reader.count("jumps");
  state.told = reader.count("told");
  state.unreadable = reader.count("unreadable");
  state.scored = reader.count("scored");
  state.bounded = reader.count("bounded");
  state.within_bound = reader.count("within_bound");
  state.unscored = reader.count("unscored");
  ENGRAM_RETURN_IF_ERROR(reader.status());
  if (const idf::Data* loop = data.at("loop"); loop != nullptr && loop->is<idf::Dict>()) {
    StateReader ends(*loop);
    state.loop = ReplayLoop{ends.time("first"), ends.time("last")};
    ENGRAM_RETURN_IF_ERROR(ends.status());
  }
  return state;
}

const ltm::MemoryId& replay_clock_entity() {
  static const ltm::MemoryId id =
      *ltm::MemoryId::from_names({"SystemState", "Replay", "engram", "clock"});
  return id;
}

}  // namespace engram
