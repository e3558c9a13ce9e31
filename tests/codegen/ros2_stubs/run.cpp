// Runs the controller or the node of package "leg", whose sources stand above, over rows of numbers: leg_run MODE IN OUT [PARAMETER=NUMBER,...]...
// Each row of IN: angles, velocities, reference, then a counter, whether a measurement and whether a reference is
// written. Each row of OUT: torques, status, faults. MODE is chained, topic, or node; "configure" only configures.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>

using namespace leg_ros2;
using controller_interface::CallbackReturn;
using sensor_msgs::msg::JointState;
using trajectory_msgs::msg::JointTrajectory;

struct Row
{
  double q[kJoints], v[kJoints];
  double reference[kReferences == 0 ? 1 : kReferences];
  double counter, measured, referred;
};

static constexpr std::size_t kRow = 2 * kJoints + kReferences + 3;

static bool next(std::FILE * file, Row & row)
{
  std::vector<double> x(kRow);
  if (std::fread(x.data(), sizeof(double), kRow, file) != kRow) {
    return false;
  }
  const double * at = x.data();
  std::memcpy(row.q, at, sizeof row.q);
  std::memcpy(row.v, at + kJoints, sizeof row.v);
  std::memcpy(row.reference, at + 2 * kJoints, kReferences * sizeof(double));
  row.counter = x[kRow - 3];
  row.measured = x[kRow - 2];
  row.referred = x[kRow - 1];
  return true;
}

// Messages have the joints in the opposite order, which their names say.
static JointState::SharedPtr state_of(const Row & row, const std::vector<std::string> & joints)
{
  auto message = std::make_shared<JointState>();
  message->header.stamp.sec = static_cast<int>(row.counter);
  for (std::size_t j = kJoints; j-- > 0;) {
    message->name.push_back(joints[j]);
    message->position.push_back(row.q[j]);
    message->velocity.push_back(row.v[j]);
  }
  return message;
}

static JointTrajectory::SharedPtr trajectory_of(const Row & row, const std::vector<std::string> & joints)
{
  auto message = std::make_shared<JointTrajectory>();
  message->points.resize(1);
  auto & point = message->points[0];
  std::vector<double> * channels[] = {&point.positions, &point.velocities, &point.accelerations};
  for (std::size_t j = kJoints; j-- > 0;) {
    message->joint_names.push_back(joints[j]);
    for (std::size_t k = 0; k < kReferences / kJoints; ++k) {
      channels[k]->push_back(row.reference[k * kJoints + j]);
    }
  }
  return message;
}

static rclcpp::NodeOptions options_of(int argc, char ** argv)
{
  rclcpp::NodeOptions options;
  for (int k = 4; k < argc; ++k) {
    const std::string text = argv[k], name = text.substr(0, text.find('=')), values = text.substr(name.size() + 1);
    std::vector<double> numbers;
    std::stringstream stream(values);
    for (std::string one; std::getline(stream, one, ',');) {
      numbers.push_back(std::atof(one.c_str()));
    }
    if (name == "torque_limit") {
      options.stub_overrides[name] = numbers;
    } else if (name == "counter_interface") {
      options.stub_overrides[name] = values;
    } else if (name == "joints") {
      options.stub_overrides[name] = std::vector<std::string>(numbers.size(), values);
    } else {
      options.stub_overrides[name] = numbers.at(0);
    }
  }
  return options;
}

static int run_node(const rclcpp::NodeOptions & options, std::FILE * in, std::FILE * out)
{
  JointStateNode node(options);
  const std::vector<std::string> joints(kJointNames.begin(), kJointNames.end());
  auto states = node.stub_topic<rclcpp::Subscription<JointState>>("joint_states");
  auto commands = node.stub_topic<rclcpp::Publisher<JointState>>("~/command");
  if (node.stub_timer->stub_period != std::chrono::nanoseconds(1000000000 / kRate)) {
    return 1;
  }
  for (Row row; next(in, row);) {
    if (row.measured != 0.0) {
      states->stub_receive(state_of(row, joints));
    }
    if (row.referred != 0.0 && kReferences > 0) {
      node.stub_topic<rclcpp::Subscription<JointTrajectory>>("~/reference")->stub_receive(trajectory_of(row, joints));
    }
    node.stub_timer->stub_call();
    const double last[2] = {-1.0, -1.0};
    std::fwrite(commands->stub_last.effort.data(), sizeof(double), kJoints, out);
    std::fwrite(last, sizeof(double), 2, out);
  }
  return 0;
}

static int run_controller(const std::string & mode, const rclcpp::NodeOptions & options, std::FILE * in, std::FILE * out)
{
  Controller controller;
  const auto rate = options.stub_overrides.find("update_rate");
  controller.stub_node = std::make_shared<rclcpp_lifecycle::LifecycleNode>("leg_controller", options);
  controller.stub_update_rate =
    rate == options.stub_overrides.end() ? kRate : static_cast<unsigned>(std::any_cast<double>(rate->second));
  if (controller.on_init() != CallbackReturn::SUCCESS) {
    return 1;
  }
  if (controller.on_configure({}) != CallbackReturn::SUCCESS) {
    return 3;
  }
  if (mode == "configure") {
    return 0;
  }
  auto references = controller.stub_references();
  auto status = controller.stub_states();
  const auto measured = controller.state_interface_configuration().names;
  const auto commanded = controller.command_interface_configuration().names;
  const std::vector<std::string> joints(kJointNames.begin(), kJointNames.end());
  std::vector<double> readings(measured.size()), torques(commanded.size(), 99.0);
  std::vector<hardware_interface::StateInterface> state;
  std::vector<hardware_interface::CommandInterface> command;
  for (std::size_t k = 0; k < measured.size(); ++k) {
    const auto at = measured[k].rfind('/');
    state.emplace_back(measured[k].substr(0, at), measured[k].substr(at + 1), &readings[k]);
  }
  for (std::size_t k = 0; k < commanded.size(); ++k) {
    if (commanded[k] != joints[k] + "/effort") {
      return 4;
    }
    command.emplace_back(joints[k], "effort", &torques[k]);
  }
  for (auto & one : state) {
    controller.state_interfaces_.emplace_back(one);
  }
  if (controller.on_activate({}) != CallbackReturn::ERROR) {
    return 5;  // the command interfaces are missing
  }
  for (auto & one : command) {
    controller.command_interfaces_.emplace_back(one);
  }
  controller.stub_chain(mode == "chained");
  if (controller.on_activate({}) != CallbackReturn::SUCCESS) {
    return 6;
  }
  for (Row row; next(in, row);) {
    for (std::size_t k = 0; k < readings.size() && row.measured != 0.0; ++k) {
      readings[k] = k < kJoints ? row.q[k] : k < 2 * kJoints ? row.v[k - kJoints] : row.counter;
    }
    if (row.referred != 0.0 && mode == "chained") {
      for (std::size_t k = 0; k < references.size(); ++k) {
        if (!references[k].set_value(row.reference[k])) {
          return 7;
        }
      }
    } else if (row.referred != 0.0 && kReferences > 0) {
      controller.stub_node->stub_topic<rclcpp::Subscription<JointTrajectory>>("~/reference")
        ->stub_receive(trajectory_of(row, joints));
    }
    if (controller.update({}, {}) != controller_interface::return_type::OK) {
      return 8;
    }
    const double last[2] = {*status[0].get_optional(), *status[1].get_optional()};
    std::fwrite(torques.data(), sizeof(double), kJoints, out);
    std::fwrite(last, sizeof(double), 2, out);
  }
  if (controller.on_deactivate({}) != CallbackReturn::SUCCESS) {
    return 9;
  }
  for (double torque : torques) {
    if (torque != 0.0) {
      return 10;
    }
  }
  return 0;
}

int main(int argc, char ** argv)
{
  const std::string mode = argv[1];
  std::FILE * in = std::fopen(argv[2], "rb");
  std::FILE * out = std::fopen(argv[3], "wb");
  const auto options = options_of(argc, argv);
  const int result = mode == "node" ? run_node(options, in, out) : run_controller(mode, options, in, out);
  std::fclose(in);
  std::fclose(out);
  return result;
}
