// Stub, see README.md: checks that the class can be made and is of its base class.
#pragma once
#include <type_traits>
#define PLUGINLIB_EXPORT_CLASS(Derived, Base) \
  static_assert(std::is_base_of_v<Base, Derived> && std::is_default_constructible_v<Derived>);
