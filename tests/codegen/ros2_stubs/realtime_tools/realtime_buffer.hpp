// Stub, see README.md.
#pragma once
namespace realtime_tools
{
template <class T>
class RealtimeBuffer
{
public:
  T * readFromRT() { return &data_; }
  void writeFromNonRT(const T & data) { data_ = data; }

private:
  T data_{};
};
}  // namespace realtime_tools
