// Stub, see README.md.
#pragma once
#include <memory>
#include <string>
#include <vector>
#include "std_msgs/msg/header.hpp"
namespace sensor_msgs::msg
{
struct JointState
{
  using SharedPtr = std::shared_ptr<JointState>;
  std_msgs::msg::Header header;
  std::vector<std::string> name;
  std::vector<double> position, velocity, effort;
};
}  // namespace sensor_msgs::msg
