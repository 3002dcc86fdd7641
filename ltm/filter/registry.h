// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <variant>

#include "ltm/filter/equality_filter.h"
#include "ltm/filter/event_filter.h"
#include "ltm/filter/frequency_filter.h"
#include "ltm/filter/similarity_filter.h"

namespace engram::ltm {

/// The options of one filter of any kind.
using FilterOptions =
    std::variant<FrequencyFilter::Options, EqualityFilter::Options, SimilarityFilter::Options,
                 ImportanceFilter::Options, TriggerFilter::Options>;

/// The names of all filters, in the order of FilterOptions.
[[nodiscard]] std::span<const std::string_view> all_filters();

/// Makes a filter of the kind that the options are of.
/// Errors: kInvalidArgument if the options do not validate.
Result<std::unique_ptr<Filter>> make_filter(const FilterOptions& options);

[[nodiscard]] Status validate(const FilterOptions& options);

}  // namespace engram::ltm
