// Stub, see README.md.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>
#include "hardware_interface/loaned.hpp"
#include "rclcpp_lifecycle/lifecycle_node.hpp"
namespace controller_interface
{
using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;

enum class return_type : std::uint8_t { OK = 0, ERROR = 1 };
enum class interface_configuration_type : std::uint8_t { ALL = 0, INDIVIDUAL = 1, NONE = 2 };

struct InterfaceConfiguration
{
  interface_configuration_type type;
  std::vector<std::string> names = {};
};

class ControllerInterfaceBase : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface
{
public:
  virtual CallbackReturn on_init() = 0;
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual return_type update(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() { return stub_node; }
  std::shared_ptr<const rclcpp_lifecycle::LifecycleNode> get_node() const { return stub_node; }
  unsigned int get_update_rate() const { return stub_update_rate; }
  template <typename ParameterT>
  auto auto_declare(const std::string & name, const ParameterT & default_value)
  {
    return stub_node->declare_parameter<ParameterT>(name, default_value);
  }

  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> stub_node;
  unsigned int stub_update_rate = 0;
  std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
  std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;
};

class ChainableControllerInterface : public ControllerInterfaceBase
{
public:
  return_type update(const rclcpp::Time & time, const rclcpp::Duration & period) final
  {
    if (!stub_chained) {
      const return_type result = update_reference_from_subscribers(time, period);
      if (result != return_type::OK) {
        return result;
      }
    }
    return update_and_write_commands(time, period);
  }
  std::vector<hardware_interface::CommandInterface> stub_references() { return on_export_reference_interfaces(); }
  std::vector<hardware_interface::StateInterface> stub_states() { return on_export_state_interfaces(); }
  bool stub_chain(bool chained)
  {
    stub_chained = chained;
    return on_set_chained_mode(chained);
  }

protected:
  virtual std::vector<hardware_interface::CommandInterface> on_export_reference_interfaces() = 0;
  virtual std::vector<hardware_interface::StateInterface> on_export_state_interfaces() = 0;
  virtual bool on_set_chained_mode(bool chained_mode) = 0;
  virtual return_type update_reference_from_subscribers(
    const rclcpp::Time & time, const rclcpp::Duration & period) = 0;
  virtual return_type update_and_write_commands(const rclcpp::Time & time, const rclcpp::Duration & period) = 0;
  std::vector<double> reference_interfaces_;
  std::vector<double> state_interfaces_values_;

private:
  bool stub_chained = false;
};
}  // namespace controller_interface
