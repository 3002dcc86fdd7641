// SPDX-License-Identifier: Apache-2.0
#include "speech/language/time_words.h"

#include <algorithm>
#include <array>

#include "speech/language/word_pattern.h"

namespace engram::speech {

namespace {

using Words = std::vector<QuestionWord>;

constexpr std::array<std::string_view, 12> kMonths{"january",   "february", "march",    "april",
                                                   "may",       "june",     "july",     "august",
                                                   "september", "october",  "november", "december"};
constexpr std::array<std::string_view, 7> kDaysOfWeek{"monday", "tuesday",  "wednesday", "thursday",
                                                      "friday", "saturday", "sunday"};
/// Stands before a clock time that a day may still precede.
constexpr char kOpenDay = '@';

/// A time that begins at a word, and of how many words it is.
struct ReadTime {
  std::string text;
  size_t count = 0;
};

class TimeWordReader {
 public:
  TimeWordReader(Words& words, Time now, DayZone zone) : words_(words), now_(now), zone_(zone) {}

  AskedTimes take_all() {
    for (size_t at = 0; at < words_.size();) {
      if (const size_t count = take(at); count > 0)
        erase_words(words_, at, count);
      else
        ++at;
    }
    finish();
    return std::move(times_);
  }

 private:
  [[nodiscard]] const std::string& word(size_t at) const {
    static const std::string kNone;
    return at < words_.size() ? words_[at].text : kNone;
  }
  [[nodiscard]] bool is(size_t at, std::initializer_list<std::string_view> choices) const {
    return is_any(word(at), choices);
  }

  /// Takes what begins at a word; returns of how many words it was, 0 for nothing. A second time of
  /// one kind is left: no program has two of them.
  size_t take(size_t at) {
    for (const auto taker :
         {&TimeWordReader::take_present, &TimeWordReader::take_range,
          &TimeWordReader::take_last_span, &TimeWordReader::take_ago, &TimeWordReader::take_bound,
          &TimeWordReader::take_day, &TimeWordReader::take_moment})
      if (const size_t count = (this->*taker)(at); count > 0) return count;
    return 0;
  }

  size_t take_present(size_t at) {
    const auto now = [this](size_t count) {
      times_.is_now = true;
      return count;
    };
    if (is(at, {"right", "just"}) && is(at + 1, {"now"})) return now(2);
    if (is(at, {"at"}) && is(at + 1, {"the", "this", "present"}) && is(at + 2, {"moment"}))
      return now(3);
    if (is(at, {"at"}) && is(at + 1, {"present"})) return now(2);
    if (is(at, {"until", "till"}) && is(at + 1, {"now"})) return 2;
    if (is(at, {"up"}) && is(at + 1, {"to"}) && is(at + 2, {"now"})) return 3;
    if (is(at, {"so"}) && is(at + 1, {"far"})) return 2;
    if (is(at, {"by"}) && is(at + 1, {"now"})) return now(2);
    if (is(at, {"now", "currently", "presently"})) return now(1);
    if (is(at, {"tomorrow"}) ||
        (is(at, {"next"}) && is(at + 1, {"week", "month", "year", "hour", "day"}))) {
      times_.is_future = true;
      return is(at, {"next"}) ? 2 : 1;
    }
    return 0;
  }

  size_t take_range(size_t at) {
    const bool is_between = is(at, {"between"});
    if (!is_between && !is(at, {"from"})) return 0;
    const auto from = moment(at + 1, true);
    if (!from) return 0;
    const size_t middle = at + 1 + from->count;
    if (!is(middle, {"and", "to", "until", "till"})) return 0;
    const auto to = moment(middle + 1, true);
    if (!to || times_.during) return 0;
    times_.during = from->text + ".." + to->text;
    return 2 + from->count + to->count;
  }

  /// "in the last ten seconds", "within the past hour".
  size_t take_last_span(size_t at) {
    size_t begin = at;
    if (is(begin, {"in", "within", "during", "over", "for"})) ++begin;
    if (is(begin, {"the", "these", "your"})) ++begin;
    if (!is(begin, {"last", "past", "previous"})) return 0;
    // "Last week" is the one before this; "in the last week" are seven days.
    if (begin == at && is(begin + 1, {"week", "day"})) return 0;
    const auto length = duration(begin + 1, true);
    if (!length || times_.during) return 0;
    times_.during = "last:" + length->text;
    return begin + 1 + length->count - at;
  }

  size_t take_ago(size_t at) {
    size_t begin = at;
    if (is(begin, {"about", "around", "roughly", "some", "exactly"})) ++begin;
    const auto length = duration(begin, false);
    if (!length || !is(begin + length->count, {"ago", "earlier", "back"})) return 0;
    const std::string& text = length->text;
    if (text.back() == 'd' ? times_.during : times_.at) return 0;
    if (text.back() == 'd')
      times_.during = text.substr(0, text.size() - 1) + "_days_ago";
    else
      times_.at = "now-" + text;
    return begin + length->count + 1 - at;
  }

  /// "since 8:05", "before noon".
  size_t take_bound(size_t at) {
    if (!is(at, {"since", "after", "before", "until", "till", "by"})) return 0;
    const auto time = moment(at + 1, true);
    if (time) {
      (is(at, {"since", "after"}) ? times_.after : times_.before) = time->text;
      return 1 + time->count;
    }
    const auto day = day_at(at + 1);
    if (!day) return 0;
    // "Since yesterday" counts from its begin.
    if (is(at, {"since"}))
      times_.during = day->text + "..now";
    else
      (is(at, {"after"}) ? times_.after : times_.before) = day->text;
    return 1 + day->count;
  }

  size_t take_day(size_t at) {
    size_t begin = at;
    if (is(begin, {"on", "during", "in", "of", "from", "for"})) ++begin;
    if (const auto day = day_at(begin)) {
      day_ = day->text;
      return begin + day->count - at;
    }
    const size_t the = is(begin, {"the", "this"}) ? 1 : 0;
    if (begin > at || the > 0 || is(begin, {"tonight"}))
      if (const auto part = part_at(begin + the)) {
        part_ = *part;
        return begin + the + 1 - at;
      }
    return 0;
  }

  size_t take_moment(size_t at) {
    const bool is_at = is(at, {"at", "around", "about", "near"});
    const size_t begin = is_at ? at + 1 : at;
    const auto time = moment(begin, is_at);
    if (!time || times_.at) return 0;
    times_.at = time->text;
    return begin + time->count - at;
  }

  /// A clock time, or a day with one. A bare hour counts only behind a word that makes it one.
  [[nodiscard]] std::optional<ReadTime> moment(size_t at, bool may_be_hour) const {
    const auto day = day_at(at);
    if (day && day->text.find("week") == std::string::npos) {
      const size_t next = at + day->count + (is(at + day->count, {"at"}) ? 1 : 0);
      const auto clock = clock_at(next, next > at + day->count);
      // "Yesterday morning at 8:05" is told by the clock alone.
      const std::string date = day->text.substr(0, day->text.find('/'));
      if (clock) return ReadTime{date + "/" + clock->text, next + clock->count - at};
    }
    if (is(at, {"now"})) return ReadTime{"now", 1};
    auto clock = clock_at(at, may_be_hour);
    if (!clock) return {};
    return ReadTime{kOpenDay + clock->text, clock->count};
  }

  [[nodiscard]] std::optional<ReadTime> clock_at(size_t at, bool may_be_hour) const {
    std::string text = word(at);
    size_t count = 1;
    if (text == "noon") return ReadTime{"12:00", 1};
    if (text == "midnight") return ReadTime{"00:00", 1};
    std::string half = text.size() > 2 ? text.substr(text.size() - 2) : "";
    if (half == "am" || half == "pm") {
      text.resize(text.size() - 2);
    } else {
      half = is(at + 1, {"am", "pm"}) ? word(at + 1) : "";
      // "8 a.m." is two words.
      if (half.empty() && is(at + 1, {"a", "p"}) && is(at + 2, {"m"})) half = word(at + 1) + "m";
      if (!half.empty()) count += is(at + 1, {"am", "pm"}) ? 1 : 2;
    }
    const size_t colon = text.find(':');
    const int hour = number_named(text.substr(0, colon));
    if (hour < 0 || hour > 23 || text.front() == 'a') return {};
    const bool is_oclock = is(at + count, {"o'clock", "oclock"});
    if (is_oclock) ++count;
    if (colon == std::string::npos) {
      const bool is_hour =
          is_oclock || !half.empty() || (may_be_hour && is_end_of_hour(at + count));
      if (!is_hour) return {};
    }
    int shown = hour;
    if (half == "pm" && hour < 12) shown += 12;
    if (half == "am" && hour == 12) shown = 0;
    const std::string rest = colon == std::string::npos ? ":00" : text.substr(colon);
    std::string clock = fmt::format("{:02}{}", shown, rest);
    if (!resolve_period(clock, now_, zone_).ok()) return {};
    return ReadTime{std::move(clock), count};
  }

  /// Whether a bare number before this word may be an hour: "at 8", not "at 8 places".
  [[nodiscard]] bool is_end_of_hour(size_t at) const {
    return at >= words_.size() || words_[at - 1].ends_clause ||
           is(at, {"and", "to", "until", "till", "today", "yesterday", "on", "in", "this"});
  }

  [[nodiscard]] std::optional<ReadTime> day_at(size_t at) const {
    if (is(at, {"today", "yesterday"})) return with_part({word(at), 1}, at);
    if (is(at, {"last"}) && is(at + 1, {"night"})) return ReadTime{"yesterday/night", 2};
    if (is(at, {"this", "last"}) && is(at + 1, {"week"})) return ReadTime{word(at) + "_week", 2};
    const size_t the = is(at, {"the"}) ? 1 : 0;
    if (is(at + the, {"day"}) && is(at + the + 1, {"before"}) && is(at + the + 2, {"yesterday"}))
      return ReadTime{"2_days_ago", the + 3};
    const size_t last = is(at, {"last"}) ? 1 : 0;
    if (std::find(kDaysOfWeek.begin(), kDaysOfWeek.end(), word(at + last)) != kDaysOfWeek.end())
      return with_part({word(at + last), last + 1}, at + last);
    if (word(at).size() == 10 && resolve_period(word(at), now_, zone_).ok())
      return with_part({word(at), 1}, at);
    return date_at(at);
  }

  /// "yesterday morning".
  [[nodiscard]] ReadTime with_part(ReadTime day, size_t last) const {
    if (const auto part = part_at(last + 1)) {
      day.text += "/" + *part;
      ++day.count;
    }
    return day;
  }

  [[nodiscard]] std::optional<std::string> part_at(size_t at) const {
    if (is(at, {"morning", "afternoon", "evening", "night"})) return word(at);
    if (is(at, {"tonight"})) return "evening";
    return {};
  }

  /// "January 2", "January 2nd, 2026", "the 2nd of January".
  [[nodiscard]] std::optional<ReadTime> date_at(size_t at) const {
    const auto month_at = [this](size_t index) {
      const auto found = std::find(kMonths.begin(), kMonths.end(), word(index));
      return found == kMonths.end() ? 0 : static_cast<int>(found - kMonths.begin()) + 1;
    };
    const auto day_number = [this](size_t index) {
      std::string text = word(index);
      if (text.size() > 2 && is_any(text.substr(text.size() - 2), {"st", "nd", "rd", "th"}))
        text.resize(text.size() - 2);
      const bool is_digits =
          !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
      return is_digits && text.size() <= 2 ? number_named(text) : -1;
    };
    int month = month_at(at);
    int day = 0;
    size_t count = 0;
    if (month > 0) {
      const size_t the = is(at + 1, {"the"}) ? 1 : 0;
      day = day_number(at + 1 + the);
      count = 2 + the;
    } else {
      const size_t the = is(at, {"the"}) ? 1 : 0;
      day = day_number(at + the);
      const size_t of = is(at + the + 1, {"of"}) ? 1 : 0;
      month = month_at(at + the + 1 + of);
      count = the + 2 + of;
    }
    if (month == 0 || day < 1 || day > 31) return {};
    int year = number_named(to_string(now_).substr(0, 4));
    if (word(at + count).size() == 4 && number_named(word(at + count)) >= 1678)
      year = number_named(word(at + count++));
    const auto text = [&](int of_year) {
      return fmt::format("{:04}-{:02}-{:02}", of_year, month, day);
    };
    const auto period = resolve_period(text(year), now_, zone_);
    if (!period.ok()) return {};
    if (period->from > now_) --year;
    return ReadTime{text(year), count};
  }

  struct ReadNumber {
    int value = -1;  ///< -1: it is no number.
    size_t count = 1;
  };

  /// "ten", "twenty-five", "a hundred".
  [[nodiscard]] ReadNumber number_at(size_t at) const {
    if (is(at, {"a", "one"}) && is(at + 1, {"hundred"})) return {100, 2};
    const int tens = number_named(word(at));
    const int units = is(at + 1, {"a", "an"}) ? -1 : number_named(word(at + 1));
    const bool is_both = tens >= 20 && tens < 100 && tens % 10 == 0 && units > 0 && units < 10;
    return is_both ? ReadNumber{tens + units, 2} : ReadNumber{tens, 1};
  }

  /// "ten seconds", "an hour", "half a minute", "minute" where `may_be_bare`.
  [[nodiscard]] std::optional<ReadTime> duration(size_t at, bool may_be_bare) const {
    const bool is_half = is(at, {"half"});
    size_t next = at + (is_half ? 1 : 0);
    auto [number, count] = number_at(next);
    if (is(next, {"couple"}) || (is(next, {"a"}) && is(next + 1, {"couple", "few"}))) {
      next += is(next, {"couple"}) ? 0 : 1;
      number = is(next, {"few"}) ? 5 : 2;
      if (is(next + 1, {"of"})) ++next;
    }
    if (number >= 0)
      next += count;
    else if (may_be_bare || is_half)
      number = 1;
    else
      return {};
    std::string unit = word(next);
    if (unit.size() > 3 && unit.back() == 's') unit.pop_back();
    constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kUnits{
        {{"second", "s"},
         {"s", "s"},
         {"sec", "s"},
         {"minute", "m"},
         {"min", "m"},
         {"hour", "h"},
         {"day", "d"},
         {"week", "w"},
         {"moment", "s"}}};
    for (const auto& [name, sign] : kUnits) {
      if (unit != name) continue;
      if (unit == "moment") number *= 5;
      if (sign == "w") return ReadTime{fmt::format("{}d", number * 7), next + 1 - at};
      if (is_half && sign == "m") return ReadTime{fmt::format("{}s", number * 30), next + 1 - at};
      if (is_half && sign == "h") return ReadTime{fmt::format("{}m", number * 30), next + 1 - at};
      return ReadTime{fmt::format("{}{}", number, sign), next + 1 - at};
    }
    return {};
  }

  /// Puts the day before the clock times that have none.
  void finish() {
    // A week has no morning, and a morning no second one.
    const bool has_part = day_.find('/') != std::string::npos || day_.ends_with("_week");
    if (!part_.empty() && !has_part) day_ = (day_.empty() ? "today" : day_) + "/" + part_;
    bool has_used_day = false;
    const std::string date = day_.substr(0, day_.find('/'));
    const bool is_date = !date.empty() && date.find("week") == std::string::npos;
    for (auto* time : {&times_.during, &times_.at, &times_.after, &times_.before}) {
      if (!*time) continue;
      std::string closed;
      for (const char c : **time) {
        if (c != kOpenDay) {
          closed += c;
        } else if (is_date) {
          closed += date + "/";
          has_used_day = true;
        }
      }
      *time = closed;
    }
    if (!day_.empty() && !has_used_day && !times_.during) times_.during = day_;
  }

  Words& words_;
  const Time now_;
  const DayZone zone_;
  AskedTimes times_;
  std::string day_;
  std::string part_;
};

}  // namespace

AskedTimes take_times(Words& words, Time now, DayZone zone) {
  return TimeWordReader(words, now, zone).take_all();
}

}  // namespace engram::speech
