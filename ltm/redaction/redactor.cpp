// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/redactor.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "ltm/core/mutex.h"
#include "ltm/redaction/held_boxes.h"
#include "ltm/redaction/image_members.h"

namespace engram::ltm {

namespace {

constexpr double kMaxGrow = 10;
/// Beyond so many entities with held boxes, further ones join theirs early, which bounds the RAM of
/// a memory of a million cameras.
constexpr size_t kManyHeldEntities = 20'000;
constexpr size_t kFewBoxes = 4;
/// More than any camera gives at once. A detector is asked for each, while a commit waits.
constexpr int64_t kMaxLooks = 256;

/// An image of a snapshot, and what is to be redacted in it.
struct LookedImage {
  ImagePlace place;
  const ImageMember* member = nullptr;
  std::vector<RelativeBox> boxes;
};

/// A box with its margins, cut to the image. Nothing where it lies outside.
std::optional<RelativeBox> grown(const Box& box, double grow, const ImageLayout& layout) {
  const auto width = static_cast<double>(layout.width);
  const auto height = static_cast<double>(layout.height);
  const auto part = [](double pixels, double side) { return std::clamp(pixels / side, 0.0, 1.0); };
  const RelativeBox relative{
      part(box.x - grow * box.width, width), part(box.y - grow * box.height, height),
      part(box.x + (1 + grow) * box.width, width), part(box.y + (1 + grow) * box.height, height)};
  if (relative.left >= relative.right || relative.top >= relative.bottom) return std::nullopt;
  return relative;
}

/// The pixels that a box touches.
ImagePart part_of(const RelativeBox& box, const ImageLayout& layout, int64_t image) {
  const auto low = [](double share, int64_t side) {
    return std::clamp(static_cast<int64_t>(std::floor(share * static_cast<double>(side))),
                      int64_t{0}, side - 1);
  };
  const auto high = [](double share, int64_t side, int64_t begin) {
    return std::clamp(static_cast<int64_t>(std::ceil(share * static_cast<double>(side))), begin + 1,
                      side);
  };
  ImagePart part{image, low(box.left, layout.width), low(box.top, layout.height), 0, 0};
  part.right = high(box.right, layout.width, part.left);
  part.bottom = high(box.bottom, layout.height, part.top);
  return part;
}

/// Puts what was found in one image of an instance into all its images of the same size.
void share_boxes(std::vector<LookedImage>& images) {
  using Size = std::tuple<size_t, int64_t, int64_t>;
  const auto size_of = [](const LookedImage& image) {
    return Size{image.place.instance, image.member->layout.width, image.member->layout.height};
  };
  std::map<Size, std::vector<RelativeBox>> found;
  for (const LookedImage& image : images) {
    std::vector<RelativeBox>& all = found[size_of(image)];
    all.insert(all.end(), image.boxes.begin(), image.boxes.end());
  }
  for (LookedImage& image : images) image.boxes = found[size_of(image)];
}

/// Finds the images of all instances. Returns why no detector can look at them; empty: it can.
std::string find_in_all(std::span<idf::Data* const> values, std::vector<FoundImages>& found) {
  int64_t looks = 0;
  for (idf::Data* const value : values) {
    found.push_back(find_images(*value));
    looks += found.back().looks();
    if (!found.back().unreadable.empty()) return found.back().unreadable;
    if (looks > kMaxLooks)
      return fmt::format("found more than {} images in one snapshot", kMaxLooks);
  }
  return "";
}

/// `found` must outlive them.
std::vector<LookedImage> images_of(const std::vector<FoundImages>& found) {
  std::vector<LookedImage> images;
  for (size_t i = 0; i < found.size(); ++i)
    for (const ImageMember& member : found[i].members)
      for (int64_t n = 0; n < member.layout.images; ++n)
        images.push_back({{i, member.path, n}, &member, {}});
  return images;
}

/// Whether all pixels are the same, as those of a channel that nobody uses.
bool is_plain(const GreyOrRgb& pixels) {
  return std::ranges::adjacent_find(pixels.pixels, std::not_equal_to<>()) == pixels.pixels.end();
}

}  // namespace

Status RedactionOptions::validate() const {
  ENGRAM_RETURN_IF_ERROR(ltm::validate(detector));
  if (!(grow >= 0 && grow <= kMaxGrow))
    return invalid_argument("grow: found {}, needs 0 to {}", grow, kMaxGrow);
  if (hold < Duration(0) || hold > std::chrono::hours(24))
    return invalid_argument("hold: found {}, needs 0s to 1d", to_string(hold));
  return {};
}

void RedactionCounters::add(const RedactionCounters& more) {
  images += more.images;
  redacted += more.redacted;
  boxes += more.boxes;
  dropped += more.dropped;
  unanswered += more.unanswered;
  unreadable += more.unreadable;
}

struct Redactor::State {
  struct Rule {
    EntityPattern match;
    std::optional<RedactionOptions> options;
    std::unique_ptr<Detector> detector;  ///< Null where nothing is redacted.
    Mutex mutex;
    std::map<MemoryId, HeldBoxes> held ENGRAM_GUARDED_BY(mutex);
  };

  std::vector<std::unique_ptr<Rule>> rules;
  mutable Mutex mutex;
  RedactionCounters counters ENGRAM_GUARDED_BY(mutex);

  [[nodiscard]] Rule* rule_of(const MemoryId& entity) const {
    const auto found =
        std::ranges::find_if(rules, [&](const auto& rule) { return rule->match.matches(entity); });
    return found == rules.end() || !(*found)->detector ? nullptr : found->get();
  }

  /// Looks at one image, as often as its channels need. Errors: those of the detector.
  static Status look(Rule& rule, const MemoryId& entity, Time time, LookedImage& image,
                     size_t& found) {
    const ImageLayout& layout = image.member->layout;
    for (int64_t look = 0; look < layout.looks(); ++look) {
      const GreyOrRgb pixels = pixels_of(*image.member->array, layout, image.place.image, look);
      if (look > 0 && is_plain(pixels)) continue;
      ENGRAM_ASSIGN_OR_RETURN(
          const std::vector<Box> boxes,
          rule.detector->find({static_cast<int>(layout.width), static_cast<int>(layout.height),
                               pixels.channels, pixels.pixels, entity.to_string(),
                               image.place.member, time}));
      found += boxes.size();
      for (const Box& box : boxes)
        if (const auto one = grown(box, rule.options->grow, layout)) image.boxes.push_back(*one);
    }
    if (found <= kMaxBoxes) return {};
    return unavailable("detector '{}' found more than {} boxes in one snapshot",
                       rule.detector->name(), kMaxBoxes);
  }

  static HeldBoxes& boxes_of(Rule& rule, const MemoryId& entity) ENGRAM_REQUIRES(rule.mutex) {
    const size_t max = rule.held.size() < kManyHeldEntities ? HeldBoxes::kMax : kFewBoxes;
    return rule.held.try_emplace(entity, max).first->second;
  }

  /// Adds to the boxes of images those that hold of earlier times, and remembers the new ones.
  static void hold(Rule& rule, const MemoryId& entity, Time time,
                   std::vector<LookedImage>& images) {
    const Duration length = rule.options->hold;
    const MutexLock lock(rule.mutex);
    const bool is_found =
        std::ranges::any_of(images, [](const auto& i) { return !i.boxes.empty(); });
    const auto known = rule.held.find(entity);
    if (known == rule.held.end() && !is_found) return;
    HeldBoxes& held = boxes_of(rule, entity);
    held.begin(time, length);
    for (LookedImage& image : images) {
      const auto holding = held.hold(image.place, time, length, image.boxes);
      image.boxes.insert(image.boxes.end(), holding.begin(), holding.end());
    }
    if (held.empty()) rule.held.erase(entity);
  }

  /// Redacts the images of one array.
  static uint64_t change(const Rule& rule, std::span<const LookedImage> images,
                         RedactionOutcome& outcome) {
    uint64_t changed = 0;
    std::vector<ImagePart> parts;
    for (const LookedImage& image : images) {
      changed += image.boxes.empty() ? 0 : 1;
      for (const RelativeBox& box : image.boxes)
        parts.push_back(part_of(box, image.member->layout, image.place.image));
    }
    if (parts.empty()) return 0;
    const ImageMember& member = *images.front().member;
    outcome.originals.push_back(member.array->buffer());
    if (rule.options->action == RedactAction::kFill)
      fill(*member.array, member.layout, parts);
    else
      pixelate(*member.array, member.layout, parts);
    return changed;
  }

  RedactionOutcome redact(Rule& rule, const MemoryId& entity, Time time,
                          std::span<idf::Data* const> values, RedactionMemory memory,
                          RedactionCounters& counts) {
    RedactionOutcome outcome;
    std::vector<FoundImages> found;
    outcome.dropped = find_in_all(values, found);
    if (outcome.is_dropped()) {
      ++counts.unreadable;
      outcome.is_unreadable = true;
      return outcome;
    }
    std::vector<LookedImage> images = images_of(found);
    if (images.empty()) return outcome;
    size_t boxes = 0;
    for (LookedImage& image : images) {
      const Status looked = look(rule, entity, time, image, boxes);
      ++counts.images;
      if (looked.ok()) continue;
      ++counts.unanswered;
      outcome.is_unanswered = true;
      outcome.dropped = looked.message();
      return outcome;
    }
    outcome.boxes = boxes;
    for (const LookedImage& image : images)
      for (const RelativeBox& box : image.boxes) outcome.seen.push_back({image.place, box});
    if (memory == RedactionMemory::kHold) hold(rule, entity, time, images);
    share_boxes(images);
    const bool has_any =
        std::ranges::any_of(images, [](const auto& i) { return !i.boxes.empty(); });
    if (has_any && rule.options->action == RedactAction::kDrop) {
      outcome.dropped = fmt::format("detector '{}' found something", rule.detector->name());
      return outcome;
    }
    for (size_t begin = 0, end = 0; has_any && begin < images.size(); begin = end) {
      while (end < images.size() && images[end].member == images[begin].member) ++end;
      outcome.redacted += change(rule, std::span(images).subspan(begin, end - begin), outcome);
    }
    return outcome;
  }
};

Redactor::Redactor(std::unique_ptr<State> state) : state_(std::move(state)) {}
Redactor::~Redactor() = default;

Result<std::unique_ptr<Redactor>> Redactor::create(std::vector<RedactionRule> rules) {
  auto state = std::make_unique<State>();
  for (RedactionRule& rule : rules) {
    auto made = std::make_unique<State::Rule>();
    made->match = std::move(rule.match);
    made->options = std::move(rule.redact);
    if (made->options) {
      const std::string context = fmt::format("redact '{}'", made->match.to_string());
      if (const Status status = made->options->validate(); !status.ok())
        return status.with_context(context);
      auto detector = make_detector(made->options->detector);
      if (!detector.ok()) return detector.status().with_context(context);
      made->detector = *std::move(detector);
    }
    state->rules.push_back(std::move(made));
  }
  return std::unique_ptr<Redactor>(new Redactor(std::move(state)));
}

bool Redactor::applies_to(const MemoryId& entity) const {
  return state_->rule_of(entity) != nullptr;
}

bool Redactor::may_apply_in(std::string_view memory) const {
  return std::ranges::any_of(state_->rules, [&](const auto& rule) {
    return rule->detector && rule->match.may_match_in(memory);
  });
}

RedactionOutcome Redactor::redact(Snapshot& snapshot, RedactionMemory memory) {
  if (!applies_to(snapshot.entity)) return {};
  std::vector<idf::Data*> values;
  for (Instance& instance : snapshot.instances) values.push_back(&instance.data);
  return redact(snapshot.entity, snapshot.time, values, memory);
}

RedactionOutcome Redactor::redact(const MemoryId& entity, Time time,
                                  std::span<idf::Data* const> values, RedactionMemory memory) {
  State::Rule* const rule = state_->rule_of(entity);
  if (rule == nullptr) return {};
  RedactionCounters counts;
  RedactionOutcome outcome = state_->redact(*rule, entity, time, values, memory, counts);
  counts.redacted = outcome.redacted;
  counts.boxes = outcome.boxes;
  counts.dropped = outcome.is_dropped() ? 1 : 0;
  const MutexLock lock(state_->mutex);
  state_->counters.add(counts);
  return outcome;
}

void Redactor::hold(const MemoryId& entity, Time time, std::span<const SeenBox> boxes) {
  State::Rule* const rule = state_->rule_of(entity);
  if (rule == nullptr || rule->options->hold <= Duration(0) || boxes.empty()) return;
  const MutexLock lock(rule->mutex);
  HeldBoxes& held = State::boxes_of(*rule, entity);
  for (const SeenBox& seen : boxes) held.add(seen.place, time, rule->options->hold, seen.box);
}

Status Redactor::wait_ready(const std::stop_token& stop) {
  for (const auto& rule : state_->rules)
    if (rule->detector) ENGRAM_RETURN_IF_ERROR(rule->detector->wait_ready(stop));
  return {};
}

RedactionCounters Redactor::counters() const {
  const MutexLock lock(state_->mutex);
  return state_->counters;
}

}  // namespace engram::ltm
