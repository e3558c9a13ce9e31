// Stub, see README.md: loaned interfaces.
#pragma once
#include "hardware_interface/handle.hpp"
namespace hardware_interface
{
class LoanedStateInterface
{
public:
  explicit LoanedStateInterface(StateInterface & interface) : interface_(&interface) {}
  const std::string & get_name() const { return interface_->get_name(); }
  template <typename T = double>
  [[nodiscard]] std::optional<T> get_optional(unsigned int = 10) const
  {
    return interface_->get_optional<T>();
  }

private:
  StateInterface * interface_;
};
class LoanedCommandInterface
{
public:
  explicit LoanedCommandInterface(CommandInterface & interface) : interface_(&interface) {}
  const std::string & get_name() const { return interface_->get_name(); }
  template <typename T>
  [[nodiscard]] bool set_value(const T & value, unsigned int = 10)
  {
    return interface_->set_value(value);
  }

private:
  CommandInterface * interface_;
};
}  // namespace hardware_interface
