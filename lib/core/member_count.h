// lib/core/member_count.h -- counts the members of a structure, so that a table of them can be found incomplete.
#pragma once

#include <cstddef>

namespace tempolux {

/// Converts to the type of any member. Only named in unevaluated expressions.
struct AnyMember {
  template <class T>
  operator T() const;
};

/// Number of members of an aggregate without base classes and without arrays in square brackets.
template <class Aggregate, class... Members>
consteval std::size_t member_count() {
  if constexpr (requires { Aggregate{Members{}..., AnyMember{}}; })
    return member_count<Aggregate, Members..., AnyMember>();
  else return sizeof...(Members);
}

}  // namespace tempolux
