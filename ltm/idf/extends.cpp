// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/extends.h"

#include <limits>

#include "ltm/idf/element_visit.h"
#include "ltm/idf/place.h"

namespace engram::idf {

namespace {

std::optional<ElementType> scalar_element(TypeKind kind) {
  switch (kind) {
    case TypeKind::kInt:
      return ElementType::kInt32;
    case TypeKind::kLong:
      return ElementType::kInt64;
    case TypeKind::kFloat:
      return ElementType::kFloat32;
    case TypeKind::kDouble:
      return ElementType::kFloat64;
    default:
      return std::nullopt;
  }
}

/// True where `to` holds every number of `from` exactly.
bool is_widening(ElementType from, ElementType to) {
  return visit_element_type(from, [&]<typename From>(From) {
    return visit_element_type(to, []<typename To>(To) {
      using F = std::numeric_limits<From>;
      using T = std::numeric_limits<To>;
      return (T::is_signed || !F::is_signed) && (F::is_integer || !T::is_integer) &&
             T::digits >= F::digits;
    });
  });
}

bool is_subset(const Quantity& inner, const Quantity& outer) {
  const auto above = [](std::optional<double> bound, std::optional<double> min) {
    return !min || (bound && *bound >= *min);
  };
  const auto below = [](std::optional<double> bound, std::optional<double> max) {
    return !max || (bound && *bound <= *max);
  };
  return above(inner.minimum, outer.minimum) && below(inner.maximum, outer.maximum);
}

/// True where `outer` admits all shapes that `inner` admits.
bool is_subset(const Shape& inner, const Shape& outer) {
  if (inner.size() != outer.size()) return false;
  for (size_t i = 0; i < inner.size(); ++i)
    if (outer[i] != kFreeSize && inner[i] != outer[i]) return false;
  return true;
}

class Comparison {
 public:
  Status compare(const Type& provider, const Type& core, const Place& place) {
    if (provider.is_optional() && !core.is_optional())
      return differs(provider, core, place, "may be absent");
    const auto from = scalar_element(provider.kind());
    const auto to = scalar_element(core.kind());
    if (from && to) {
      if (!is_widening(*from, *to)) return differs(provider, core, place, "is not as wide");
      return compare_quantity(provider, core, place);
    }
    if (core.as_array()) return compare_arrays(provider, core, place);
    if (provider.kind() != core.kind()) return differs(provider, core, place, "is of another kind");
    return compare_same_kind(provider, core, place);
  }

 private:
  static Status differs(const Type& provider, const Type& core, const Place& place,
                        std::string_view why) {
    return invalid_argument("member '{}' {}: found {}, needs {}", place.path(), why,
                            brief(provider), brief(core));
  }

  static std::string brief(const Type& type) {
    if (type.kind() != TypeKind::kObject) return to_string(type);
    return fmt::format("{}Object {}", type.is_optional() ? "optional " : "", type.name());
  }

  static Status compare_quantity(const Type& provider, const Type& core, const Place& place) {
    if (core.quantity() == nullptr) return {};
    static const Quantity kNothing;
    const Quantity& found = provider.quantity() == nullptr ? kNothing : *provider.quantity();
    if (!core.quantity()->unit.empty() && found.unit != core.quantity()->unit)
      return differs(provider, core, place, "has another unit");
    if (!is_subset(found, *core.quantity()))
      return differs(provider, core, place, "is less bounded");
    return {};
  }

  static Status compare_arrays(const Type& provider, const Type& core, const Place& place) {
    const bool is_kind =
        provider.kind() == core.kind() || core.kind() == TypeKind::kNdArray ||
        (core.kind() == TypeKind::kQuaternion && provider.kind() == TypeKind::kOrientation);
    const auto found = provider.as_array();
    const auto needed = core.as_array();
    if (!is_kind || !found || !has_same_points(provider, core))
      return differs(provider, core, place, "is of another kind");
    if (!is_widening(found->element, needed->element))
      return differs(provider, core, place, "is not as wide");
    if (!is_subset(found->shape, needed->shape))
      return differs(provider, core, place, "has another shape");
    return compare_quantity(provider, core, place);
  }

  /// Images and clouds of equal shape may still have different meanings.
  static bool has_same_points(const Type& provider, const Type& core) {
    if (const auto* image = core.get_if<types::Image>())
      return provider.get<types::Image>().pixel == image->pixel;
    if (const auto* cloud = core.get_if<types::PointCloud>())
      return provider.get<types::PointCloud>().point == cloud->point;
    return true;
  }

  Status compare_same_kind(const Type& provider, const Type& core, const Place& place) {
    switch (core.kind()) {
      case TypeKind::kIntEnum:
        return compare_enums(provider, core, place);
      case TypeKind::kPose: {
        if (is_widening(provider.get<types::Pose>().element, core.get<types::Pose>().element))
          return {};
        return differs(provider, core, place, "is not as wide");
      }
      case TypeKind::kObject:
        return compare_members(provider, core, place);
      case TypeKind::kList: {
        const int64_t size = core.get<types::List>().size;
        if (!is_subset(Shape{provider.get<types::List>().size}, Shape{size}))
          return differs(provider, core, place, "has another size");
        return compare_parts(provider, core, place);
      }
      default:
        return compare_parts(provider, core, place);
    }
  }

  static Status compare_enums(const Type& provider, const Type& core, const Place& place) {
    for (const EnumValue& value : provider.get<types::IntEnum>().values) {
      const EnumValue* known = core.get<types::IntEnum>().find(value.value);
      if (known == nullptr || known->name != value.name)
        return differs(provider, core, place,
                       fmt::format("has the value {} = {}", value.name, value.value));
    }
    return {};
  }

  Status compare_parts(const Type& provider, const Type& core, const Place& place) {
    const std::vector<Member> found = provider.parts();
    const std::vector<Member> needed = core.parts();
    if (found.size() != needed.size()) return differs(provider, core, place, "has another size");
    for (size_t i = 0; i < found.size(); ++i) {
      // The element of a list or dict has no name: '*' stands for all of them.
      const std::string_view name = needed[i].name;
      const Place inner(place, name.empty() ? "*" : name);
      ENGRAM_RETURN_IF_ERROR(compare(found[i].type, needed[i].type, inner));
    }
    return {};
  }

  Status compare_members(const Type& provider, const Type& core, const Place& place) {
    const auto& object = provider.get<types::Object>();
    for (const Member& member : core.get<types::Object>().members) {
      const Place inner(place, member.name);
      const Member* found = object.find(member.name);
      if (found == nullptr)
        return invalid_argument("member '{}' is missing in {}: needs {}", inner.path(),
                                brief(provider), brief(member.type));
      ENGRAM_RETURN_IF_ERROR(compare(found->type, member.type, inner));
    }
    return {};
  }
};

}  // namespace

Status check_extends(const Type& provider, const Type& core) {
  const Status status = Comparison().compare(provider, core, Place());
  return status.ok() ? status
                     : status.with_context(fmt::format("type '{}' does not extend '{}'",
                                                       provider.name(), core.name()));
}

bool extends(const Type& provider, const Type& core) {
  return check_extends(provider, core).ok();
}

}  // namespace engram::idf
