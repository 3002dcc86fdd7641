// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/similarity_filter.h"

#include <algorithm>

#include "ltm/filter/reduced_image.h"
#include "ltm/filter/saturated_time.h"
#include "ltm/idf/layout.h"

namespace engram::ltm {

namespace {

/// A value split into members, with the reduced images that were computed so far.
struct TakenApart {
  idf::SplitValue parts;
  std::vector<std::optional<ReducedImage>> reduced;  ///< Per tensor; set when first needed.

  explicit TakenApart(idf::SplitValue split) : parts(std::move(split)) {
    reduced.resize(parts.tensors.size());
  }

  /// The reduced image of a tensor; null if it is not an image.
  const ReducedImage* image(size_t tensor) {
    if (!reduced[tensor]) reduced[tensor] = ReducedImage::of(parts.tensors[tensor]);
    return reduced[tensor] ? &*reduced[tensor] : nullptr;
  }
};

/// The members of a layout with the rules that compare them.
struct Plan {
  idf::Layout layout;
  std::vector<size_t> rule_of;  ///< Per member, an index into the rules.
};

}  // namespace

struct SimilarityFilter::State {
  Options options;
  std::vector<Similarity> rules;  ///< The rules of the options, then one per kind of member.

  std::optional<Time> last_time;
  std::optional<idf::Type> type;  ///< The type that the plans were made with.
  std::vector<Plan> plans;        ///< Per instance of the last snapshot that was kept.
  std::vector<TakenApart> last;   ///< Its values.

  explicit State(const Options& chosen) : options(chosen) {
    for (const MemberRule& rule : options.members) rules.push_back(rule.similarity);
    for (const Similarity& each :
         {options.images, options.numbers, options.orientations, Similarity{Measure::kEqual, 0}})
      rules.push_back(each);
  }

  [[nodiscard]] size_t rule_of(const idf::TensorMember& member) const {
    const size_t first_default = options.members.size();
    for (size_t i = 0; i < first_default; ++i)
      if (options.members[i].path.matches(member.path)) return i;
    switch (member.kind) {
      case idf::MemberKind::kImage:
      case idf::MemberKind::kDepth:
        return first_default;
      case idf::MemberKind::kOrientation:
        return first_default + 2;
      case idf::MemberKind::kBool:
        return first_default + 3;
      default:
        return first_default + 1;
    }
  }

  [[nodiscard]] Plan plan_of(const idf::Data& value) const {
    Plan plan;
    // The plan takes free sizes of the type from the value, as a camera's images have one size.
    plan.layout =
        type ? idf::Layout::of(value, *type, idf::FreeSizes::kOfValue) : idf::Layout::of(value);
    for (const idf::TensorMember& member : plan.layout.members())
      plan.rule_of.push_back(rule_of(member));
    return plan;
  }

  /// Splits the values by the layouts of the last snapshot; nothing if they have other layouts.
  [[nodiscard]] std::optional<std::vector<TakenApart>> take_apart(
      const Candidate& candidate) const {
    const auto& instances = candidate.snapshot.instances;
    if (!last_time || instances.size() != plans.size() || candidate.type != type)
      return std::nullopt;
    std::vector<TakenApart> values;
    values.reserve(instances.size());
    for (size_t i = 0; i < instances.size(); ++i) {
      auto parts = plans[i].layout.split(instances[i].data);
      if (!parts.ok()) return std::nullopt;
      values.emplace_back(*std::move(parts));
    }
    return values;
  }

  void make_plans(const Candidate& candidate) {
    type = candidate.type;
    plans.clear();
    last.clear();
    for (const Instance& instance : candidate.snapshot.instances) {
      plans.push_back(plan_of(instance.data));
      auto parts = plans.back().layout.split(instance.data);
      ENGRAM_CHECK(parts.ok(), "a layout of its own value: {}", parts.status().message());
      last.emplace_back(*std::move(parts));
    }
  }

  /// Compares one member. Numbers are only added to `sums`, which the caller compares.
  [[nodiscard]] bool is_similar(const Similarity& rule, TakenApart& now, TakenApart& then,
                                size_t tensor, NumberDifference& sums) const {
    const idf::NdArray& a = now.parts.tensors[tensor];
    const idf::NdArray& b = then.parts.tensors[tensor];
    if (rule.measure == Measure::kIgnore || a == b) {
      // Equal tensors belong to the vector too, or its mean would be over fewer elements.
      if (!is_image_measure(rule.measure) && is_gathered(rule.measure)) sums.add(a, b);
      return true;
    }
    if (rule.measure == Measure::kEqual) return false;
    if (rule.measure == Measure::kAngle) return rule.admits(rotation_angle_rad(a, b));
    if (is_image_measure(rule.measure)) {
      const ReducedImage* image = now.image(tensor);
      const ReducedImage* before = then.image(tensor);
      if (image != nullptr && before != nullptr)
        return rule.admits(image->measured(rule.measure, *before));
      if (rule.measure == Measure::kSsim) return false;
      NumberDifference own;
      own.add(a, b);
      return rule.admits(own.measured(rule.measure));
    }
    sums.add(a, b);
    return true;
  }

  static bool is_gathered(Measure measure) {
    return measure == Measure::kMaxAbs || measure == Measure::kRms || measure == Measure::kCosine;
  }

  [[nodiscard]] bool is_similar(const Plan& plan, TakenApart& now, TakenApart& then) const {
    if (options.compares_remainder && now.parts.remainder != then.parts.remainder) return false;
    std::vector<NumberDifference> sums(rules.size());
    for (size_t i = 0; i < plan.rule_of.size(); ++i) {
      const size_t rule = plan.rule_of[i];
      if (!is_similar(rules[rule], now, then, i, sums[rule])) return false;
    }
    for (size_t i = 0; i < rules.size(); ++i)
      if (is_gathered(rules[i].measure) && !rules[i].admits(sums[i].measured(rules[i].measure)))
        return false;
    return true;
  }

  [[nodiscard]] bool is_similar(std::vector<TakenApart>& now) {
    for (size_t i = 0; i < now.size(); ++i)
      if (!is_similar(plans[i], now[i], last[i])) return false;
    return true;
  }
};

Status SimilarityFilter::Options::validate() const {
  if (max_gap && *max_gap <= Duration(0))
    return invalid_argument("similarity filter: max_gap is {}, needs more than 0s",
                            to_string(*max_gap));
  for (const Similarity* each : {&images, &numbers, &orientations})
    if (Status status = each->validate(); !status.ok())
      return status.with_context("similarity filter");
  for (const MemberRule& rule : members)
    if (Status status = rule.similarity.validate(); !status.ok())
      return status.with_context(
          fmt::format("similarity filter: member '{}'", rule.path.to_string()));
  return {};
}

Result<SimilarityFilter> SimilarityFilter::create(const Options& options) {
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return SimilarityFilter(std::make_unique<State>(options));
}

SimilarityFilter::SimilarityFilter(std::unique_ptr<State> state) : state_(std::move(state)) {}
SimilarityFilter::SimilarityFilter(SimilarityFilter&&) noexcept = default;
SimilarityFilter::~SimilarityFilter() = default;

void SimilarityFilter::offer(Candidate candidate, FilterDecisions& decisions) {
  State& state = *state_;
  const Time time = candidate.snapshot.time;
  const bool is_gap = state.last_time && state.options.max_gap &&
                      time >= saturated_add(*state.last_time, *state.options.max_gap);
  auto values = state.take_apart(candidate);
  if (values && !is_gap && state.is_similar(*values)) return decisions.drop("similar", candidate);
  if (values)
    state.last = *std::move(values);
  else
    state.make_plans(candidate);
  state.last_time = time;
  decisions.keep(std::move(candidate));
}

}  // namespace engram::ltm
