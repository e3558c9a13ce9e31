// Stub, see README.md.
#pragma once
#include <any>
#include <chrono>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include "builtin_interfaces/msg/time.hpp"
namespace rclcpp
{
class Logger
{
};

__attribute__((format(printf, 1, 2))) inline void stub_log(const char * format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  std::vfprintf(stderr, format, arguments);
  std::fputc('\n', stderr);
  va_end(arguments);
}
#define RCLCPP_ERROR(logger, ...) ((void)(logger), rclcpp::stub_log(__VA_ARGS__))
#define RCLCPP_WARN(logger, ...) ((void)(logger), rclcpp::stub_log(__VA_ARGS__))

class Time
{
public:
  operator builtin_interfaces::msg::Time() const { return {1, 0}; }
};

class Duration
{
};

class QoS
{
};
class SystemDefaultsQoS : public QoS
{
};
class SensorDataQoS : public QoS
{
};

class Parameter
{
public:
  explicit Parameter(std::any value) : value_(std::move(value)) {}
  std::vector<std::string> as_string_array() const { return get_value<std::vector<std::string>>(); }
  std::vector<double> as_double_array() const { return get_value<std::vector<double>>(); }
  std::string as_string() const { return get_value<std::string>(); }
  double as_double() const { return get_value<double>(); }
  template <typename T>
  T get_value() const
  {
    return std::any_cast<T>(value_);
  }

private:
  std::any value_;
};

class NodeOptions
{
public:
  std::map<std::string, std::any> stub_overrides;
};

class TimerBase
{
public:
  using SharedPtr = std::shared_ptr<TimerBase>;
  std::function<void()> stub_call;
  std::chrono::nanoseconds stub_period{0};
};

template <typename Message>
class Subscription
{
public:
  using SharedPtr = std::shared_ptr<Subscription>;
  std::function<void(std::shared_ptr<Message>)> stub_receive;
};

template <typename Message>
class Publisher
{
public:
  using SharedPtr = std::shared_ptr<Publisher>;
  void publish(const Message & message) { stub_last = message; }
  Message stub_last;
};

// Parameters, topics and timers of a node; the topics can be looked up by name.
class Node
{
public:
  explicit Node(const std::string & name, const NodeOptions & options = NodeOptions())
  : stub_overrides(options.stub_overrides), name_(name)
  {
  }
  virtual ~Node() = default;
  const char * get_name() const { return name_.c_str(); }
  Logger get_logger() const { return Logger(); }
  Time now() const { return Time(); }
  bool has_parameter(const std::string & name) const { return parameters_.count(name) > 0; }
  Parameter get_parameter(const std::string & name) const { return Parameter(parameters_.at(name)); }
  template <typename T>
  T declare_parameter(const std::string & name, const T & value)
  {
    const auto given = stub_overrides.find(name);
    parameters_[name] = given == stub_overrides.end() ? std::any(value) : given->second;
    return get_parameter(name).get_value<T>();
  }
  template <typename Message, typename Callback>
  typename Subscription<Message>::SharedPtr create_subscription(
    const std::string & topic, const QoS &, Callback && callback)
  {
    auto made = std::make_shared<Subscription<Message>>();
    made->stub_receive = std::forward<Callback>(callback);
    stub_topics[topic] = made;
    return made;
  }
  template <typename Message>
  typename Publisher<Message>::SharedPtr create_publisher(const std::string & topic, const QoS &)
  {
    auto made = std::make_shared<Publisher<Message>>();
    stub_topics[topic] = made;
    return made;
  }
  template <typename Callback>
  TimerBase::SharedPtr create_wall_timer(std::chrono::nanoseconds period, Callback && callback)
  {
    stub_timer = std::make_shared<TimerBase>();
    stub_timer->stub_call = std::forward<Callback>(callback);
    stub_timer->stub_period = period;
    return stub_timer;
  }
  template <typename T>
  std::shared_ptr<T> stub_topic(const std::string & name)
  {
    return std::any_cast<std::shared_ptr<T>>(stub_topics.at(name));
  }

  std::map<std::string, std::any> stub_overrides, stub_topics;
  TimerBase::SharedPtr stub_timer;

private:
  std::string name_;
  std::map<std::string, std::any> parameters_;
};

inline void init(int, const char * const *) {}
inline void spin(const std::shared_ptr<Node> &) {}
inline bool shutdown() { return true; }
}  // namespace rclcpp
