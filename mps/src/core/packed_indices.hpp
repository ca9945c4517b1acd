// Lists of indices in three bytes each: neighbour lists are most of a rank's memory.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <vector>

#include "core/room.hpp"

namespace embacle::mps {

/// One after the other, without gaps. A read takes four bytes and drops one, so that one byte follows the last index.
class PackedIndices {
 public:
  static constexpr int width = 3;  ///< [bytes]
  static constexpr std::uint32_t largest = 0xffffff;

  /// Random access, by value.
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = std::uint32_t;
    using difference_type = std::ptrdiff_t;
    using pointer = const std::uint32_t*;
    using reference = std::uint32_t;

    Iterator() = default;
    explicit Iterator(const std::uint8_t* at) : at_(at) {}
    std::uint32_t operator[](std::ptrdiff_t k) const {
      const std::uint8_t* at = at_ + width * k;
      if constexpr (std::endian::native == std::endian::little) {
        std::uint32_t index = 0;
        std::memcpy(&index, at, sizeof index);
        return index & largest;
      } else {
        return at[0] | (std::uint32_t{at[1]} << 8U) | (std::uint32_t{at[2]} << 16U);
      }
    }
    std::uint32_t operator*() const { return (*this)[0]; }
    /// The next four, each times a power of two; much cheaper than one by one.
    template <std::size_t Factor>
    [[nodiscard]] std::array<std::size_t, 4> four() const {
      static_assert(std::has_single_bit(Factor));
      if constexpr (std::endian::native == std::endian::little) {
        constexpr int shift = std::countr_zero(Factor);
        constexpr std::uint64_t mask = std::uint64_t{largest} << shift;
        std::uint64_t low = 0, high = 0;  // bytes 0 to 7, and 4 to 11
        std::memcpy(&low, at_, sizeof low);
        std::memcpy(&high, at_ + 4, sizeof high);
        return {(low << shift) & mask, (low >> (24 - shift)) & mask, (high >> (16 - shift)) & mask,
                (high >> (40 - shift)) & mask};
      } else {
        return {Factor * (*this)[0], Factor * (*this)[1], Factor * (*this)[2], Factor * (*this)[3]};
      }
    }
    Iterator& operator++() { return *this += 1; }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    Iterator& operator+=(std::ptrdiff_t n) {
      at_ += width * n;
      return *this;
    }
    friend Iterator operator+(Iterator it, std::ptrdiff_t n) { return it += n; }
    friend std::ptrdiff_t operator-(Iterator a, Iterator b) { return (a.at_ - b.at_) / width; }
    friend bool operator==(Iterator a, Iterator b) { return a.at_ == b.at_; }
    friend bool operator<(Iterator a, Iterator b) { return a.at_ < b.at_; }

   private:
    const std::uint8_t* at_ = nullptr;
  };

  [[nodiscard]] Iterator begin() const { return Iterator(bytes_.data()); }
  [[nodiscard]] std::size_t size() const { return (bytes_.size() - 1) / width; }
  [[nodiscard]] std::size_t memory() const { return bytes_.capacity(); }  ///< [bytes]

  void clear() { bytes_.assign(1, 0); }
  void reserve(std::size_t n) { bytes_.reserve(width * n + 1); }
  /// See make_room of vectors.
  void make_room(std::size_t n) { mps::make_room(bytes_, width * n + 1); }
  void swap(PackedIndices& other) { bytes_.swap(other.bytes_); }
  /// Appends `n` indices, each at most `largest`, and fills up to a multiple of `multiple` with `filler`.
  void append(const std::uint32_t* indices, std::size_t n, std::size_t multiple, std::uint32_t filler) {
    const std::size_t before = size(), after = (before + n + multiple - 1) / multiple * multiple;
    if (width * after + 1 > bytes_.capacity()) reserve(after + after / 64);
    bytes_.resize(width * after + 1);
    std::uint8_t* out = bytes_.data() + width * before;
    for (std::size_t k = 0; k < after - before; ++k, out += width) {
      const std::uint32_t index = k < n ? indices[k] : filler;
      for (int byte = 0; byte < width; ++byte) out[byte] = static_cast<std::uint8_t>(index >> (8 * byte));
    }
  }
  void append(const PackedIndices& other) {
    bytes_.insert(bytes_.end() - 1, other.bytes_.begin(), other.bytes_.end() - 1);
  }

 private:
  std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(1);
};

}  // namespace embacle::mps
