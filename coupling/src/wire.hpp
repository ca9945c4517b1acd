// Messages as bytes: what one side writes the other reads in the same order. All ranks run the same kind of machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "embacle/coupling/types.hpp"

namespace embacle::coupling {

using Bytes = std::vector<std::byte>;

class Writer {
 public:
  explicit Writer(Bytes& bytes) : bytes_(bytes) { bytes_.clear(); }

  template <typename T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void put(T value) { put_raw(&value, sizeof value); }
  void put(const Vec3& value) { put_raw(value.data(), 3 * sizeof(double)); }
  void put(const Box& value) {
    put(value.lower);
    put(value.upper);
  }
  void put(const Load& value) {
    put(value.force);
    put(value.torque);
  }
  void put(const State& value) {
    put(value.position);
    put_raw(value.orientation.coeffs().data(), 4 * sizeof(double));
    put(value.velocity);
    put(value.angular_velocity);
    put(value.contact_force);
    put(value.contact_torque);
  }
  void put(const std::string& value) {
    put(static_cast<std::uint64_t>(value.size()));
    put_raw(value.data(), value.size());
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    if constexpr (std::is_arithmetic_v<T>) {
      put_raw(values.data(), values.size() * sizeof(T));
    } else {
      for (const T& value : values) put(value);
    }
  }

 private:
  void put_raw(const void* data, std::size_t size) {
    if (size == 0) return;
    const std::size_t end = bytes_.size();
    bytes_.resize(end + size);
    std::memcpy(bytes_.data() + end, data, size);
  }

  Bytes& bytes_;
};

class Reader {
 public:
  explicit Reader(const Bytes& bytes) : bytes_(bytes) {}

  template <typename T>
  [[nodiscard]] T get() {
    T value{};
    get(value);
    return value;
  }
  template <typename T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void get(T& value) { get_raw(&value, sizeof value); }
  void get(Vec3& value) { get_raw(value.data(), 3 * sizeof(double)); }
  void get(Box& value) {
    get(value.lower);
    get(value.upper);
  }
  void get(Load& value) {
    get(value.force);
    get(value.torque);
  }
  void get(State& value) {
    get(value.position);
    get_raw(value.orientation.coeffs().data(), 4 * sizeof(double));
    get(value.velocity);
    get(value.angular_velocity);
    get(value.contact_force);
    get(value.contact_torque);
  }
  void get(std::string& value) {
    value.resize(get<std::uint64_t>());
    get_raw(value.data(), value.size());
  }
  template <typename T>
  void get(std::vector<T>& values) {
    values.resize(get<std::uint64_t>());
    if constexpr (std::is_arithmetic_v<T>) {
      get_raw(values.data(), values.size() * sizeof(T));
    } else {
      for (T& value : values) get(value);
    }
  }
  [[nodiscard]] bool at_end() const { return position_ == bytes_.size(); }

 private:
  void get_raw(void* data, std::size_t size) {
    if (size > bytes_.size() - position_) throw std::logic_error("coupling: a message is shorter than its content");
    if (size > 0) std::memcpy(data, bytes_.data() + position_, size);
    position_ += size;
  }

  const Bytes& bytes_;
  std::size_t position_ = 0;
};

}  // namespace embacle::coupling
