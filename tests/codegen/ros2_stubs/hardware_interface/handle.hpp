// Stub, see README.md.
#pragma once
#include <optional>
#include <string>
#include <utility>
namespace hardware_interface
{
class Handle
{
public:
  Handle(const std::string & prefix_name, const std::string & interface_name, double * value_ptr)
  : prefix_(prefix_name), name_(prefix_name + "/" + interface_name), value_(value_ptr)
  {
  }
  const std::string & get_prefix_name() const { return prefix_; }
  const std::string & get_name() const { return name_; }
  template <typename T = double>
  [[nodiscard]] std::optional<T> get_optional() const
  {
    return value_ == nullptr ? std::nullopt : std::optional<T>(*value_);
  }
  template <typename T>
  [[nodiscard]] bool set_value(const T & value)
  {
    *value_ = value;
    return true;
  }

private:
  std::string prefix_, name_;
  double * value_;
};
class StateInterface : public Handle
{
public:
  using Handle::Handle;
};
class CommandInterface : public Handle
{
public:
  using Handle::Handle;
  CommandInterface(const CommandInterface &) = delete;
  CommandInterface(CommandInterface &&) = default;
};
}  // namespace hardware_interface
