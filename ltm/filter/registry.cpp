// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/registry.h"

#include <array>

namespace engram::ltm {

namespace {

template <typename F>
Result<std::unique_ptr<Filter>> make(const typename F::Options& options) {
  ENGRAM_ASSIGN_OR_RETURN(F filter, F::create(options));
  return std::unique_ptr<Filter>(std::make_unique<F>(std::move(filter)));
}

struct Maker {
  using Made = Result<std::unique_ptr<Filter>>;
  Made operator()(const FrequencyFilter::Options& options) {
    return make<FrequencyFilter>(options);
  }
  Made operator()(const EqualityFilter::Options& options) { return make<EqualityFilter>(options); }
  Made operator()(const SimilarityFilter::Options& options) {
    return make<SimilarityFilter>(options);
  }
  Made operator()(const ImportanceFilter::Options& options) {
    return make<ImportanceFilter>(options);
  }
  Made operator()(const TriggerFilter::Options& options) { return make<TriggerFilter>(options); }
};

}  // namespace

std::span<const std::string_view> all_filters() {
  static constexpr std::array<std::string_view, std::variant_size_v<FilterOptions>> kNames{
      "frequency", "equality", "similarity", "importance", "trigger"};
  return kNames;
}

Result<std::unique_ptr<Filter>> make_filter(const FilterOptions& options) {
  return std::visit(Maker(), options);
}

Status validate(const FilterOptions& options) {
  return std::visit([](const auto& each) { return each.validate(); }, options);
}

}  // namespace engram::ltm
