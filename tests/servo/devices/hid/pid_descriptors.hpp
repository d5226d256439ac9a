// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

namespace spm::test {

/// Writes a HID report descriptor item by item, each with as many bytes as its value needs.
class DescriptorWriter {
 public:
  DescriptorWriter& page(int page) { return item(0x04, page); }
  DescriptorWriter& usages(std::initializer_list<int> all);
  /// A usage with its page, in four bytes.
  DescriptorWriter& wide_usage(int page, int usage);
  DescriptorWriter& range(int first, int last) { return item(0x18, first).item(0x28, last); }
  DescriptorWriter& logical(int least, int most) { return item(0x14, least).item(0x24, most); }
  DescriptorWriter& physical(int least, int most) { return item(0x34, least).item(0x44, most); }
  DescriptorWriter& unit(int code, int exponent) { return item(0x64, code).item(0x54, exponent); }
  DescriptorWriter& id(int id) { return item(0x84, id); }
  DescriptorWriter& size(int bits, int count) { return item(0x74, bits).item(0x94, count); }
  DescriptorWriter& input(int flags) { return item(0x80, flags); }
  DescriptorWriter& output(int flags) { return item(0x90, flags); }
  DescriptorWriter& feature(int flags) { return item(0xB0, flags); }
  DescriptorWriter& push() { return add({0xA4}); }
  DescriptorWriter& pop() { return add({0xB4}); }
  DescriptorWriter& begin(int kind) { return item(0xA0, kind); }
  /// A collection of one usage.
  DescriptorWriter& begin(int usage, int kind) { return usages({usage}).begin(kind); }
  DescriptorWriter& end() { return add({0xC0}); }
  DescriptorWriter& add(std::initializer_list<int> bytes);

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  DescriptorWriter& item(int prefix, int value);

  std::vector<std::uint8_t> bytes_;
};

constexpr int variable = 2, array = 0, constant = 3;

enum class PidStick {
  polar,        ///< 16 bits an axis, -10000 to 10000; directions are two angles
  no_constant,  ///< the same without Set Constant Force
  axes,         ///< 8 bits an axis, -255 to 255; axes are enabled, its controls are bits
  cartesian,    ///< as `polar`, directions have a part for each axis
};

/// The descriptor of a force feedback stick.
[[nodiscard]] std::vector<std::uint8_t> pid_descriptor(PidStick stick);

}  // namespace spm::test
