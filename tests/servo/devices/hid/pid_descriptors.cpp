// SPDX-License-Identifier: Apache-2.0
#include "tests/servo/devices/hid/pid_descriptors.hpp"

namespace spm::test {

namespace {

constexpr int desktop = 0x01, buttons = 0x09, ordinals = 0x0A, pid = 0x0F;
constexpr int application = 1, logical_set = 2;

/// Duration, trigger repeat interval, sample period and start delay, in milliseconds.
void add_times(DescriptorWriter& w) {
  w.push().usages({0x50, 0x54, 0x51, 0xA7}).logical(0, 32767).physical(0, 32767);
  w.unit(0x1003, -3).size(16, 4).output(variable).pop();
}

void add_block_index(DescriptorWriter& w) {
  w.usages({0x22}).logical(1, 40).size(8, 1).output(variable);
}

void add_effect_types(DescriptorWriter& w, PidStick stick) {
  w.begin(0x25, logical_set);
  if (stick == PidStick::no_constant) {
    w.usages({0x27, 0x40}).logical(1, 2);
  } else {
    w.usages({0x27, 0x26, 0x40}).logical(1, 3);
  }
  w.size(8, 1);
}

void add_set_effect(DescriptorWriter& w, PidStick stick) {
  w.begin(0x21, logical_set).id(0x11);
  add_block_index(w);
  add_effect_types(w, stick);
  w.output(array).end();
  add_times(w);
  w.usages({0x52}).logical(0, 255).size(8, 1).output(variable);
  w.usages({0x53}).logical(1, 8).size(8, 1).output(variable);
  w.begin(0x55, logical_set).page(desktop).usages({0x30, 0x31}).logical(0, 1).size(1, 2);
  w.output(variable).end();
  w.page(pid).usages({0x56}).size(1, 1).output(variable).size(1, 5).output(constant);
  if (stick != PidStick::axes) w.begin(0x57, logical_set);
  if (stick == PidStick::cartesian) {
    w.page(desktop).usages({0x30, 0x31}).logical(-127, 127).size(8, 2).output(variable).end();
  } else if (stick != PidStick::axes) {
    w.wide_usage(ordinals, 1).wide_usage(ordinals, 2).logical(0, 36000).size(16, 2);
    w.output(variable).end();
  }
  w.page(pid).end();
}

void add_controls(DescriptorWriter& w, bool as_bits) {
  w.begin(0x95, logical_set).id(0x1C).begin(0x96, logical_set);
  w.usages({0x97, 0x98, 0x99, 0x9A, 0x9B, 0x9C});
  if (as_bits) {
    // As OpenFFBoard has it: single bits with the range of an array.
    w.logical(1, 6).size(1, 6).output(variable).size(1, 2).output(constant);
  } else {
    w.logical(1, 6).size(8, 1).output(array);
  }
  w.end().end();
}

void add_memory(DescriptorWriter& w, PidStick stick) {
  // The number of an output report is used again, as devices do.
  w.begin(0xAB, logical_set).id(0x11);
  add_effect_types(w, stick);
  w.feature(array).end();
  w.page(desktop).usages({0x3B}).logical(0, 511).size(10, 1).feature(variable);
  w.size(6, 1).feature(constant).page(pid).end();
  w.begin(0x89, logical_set).id(0x12).usages({0x22}).logical(1, 40).size(8, 1).feature(variable);
  w.begin(0x8B, logical_set).usages({0x8C, 0x8D, 0x8E}).logical(1, 3).size(8, 1).feature(array);
  w.end().usages({0xAC}).logical(0, 65535).size(16, 1).feature(variable).end();
  w.begin(0x7F, logical_set).id(0x13).usages({0x80}).size(16, 1).feature(variable);
  w.usages({0x83}).logical(0, 255).size(8, 1).feature(variable);
  w.usages({0xA9, 0xAA}).logical(0, 1).size(1, 2).feature(variable).size(6, 1).feature(constant);
  w.end();
}

void add_input(DescriptorWriter& w, PidStick stick) {
  if (stick == PidStick::axes) {
    w.begin(0x01, 0).id(3).page(buttons).range(1, 4).logical(0, 1).size(1, 4).input(variable);
    w.size(4, 1).input(constant).page(desktop).usages({0x30, 0x31}).logical(0, 255).size(8, 2);
    w.input(variable).end();
    return;
  }
  w.begin(0x01, 0).id(1).usages({0x30, 0x31}).logical(-32767, 32767).size(16, 2).input(variable);
  w.page(buttons).range(1, 8).logical(0, 1).size(1, 8).input(variable).end();
  w.page(pid).begin(0x92, logical_set).id(2).usages({0x9F, 0xA0, 0xA4, 0xA6, 0x94}).size(1, 5);
  w.input(variable).size(3, 1).input(constant).end();
}

}  // namespace

DescriptorWriter& DescriptorWriter::add(std::initializer_list<int> bytes) {
  for (const int byte : bytes) bytes_.push_back(static_cast<std::uint8_t>(byte));
  return *this;
}

DescriptorWriter& DescriptorWriter::item(int prefix, int value) {
  if (value >= -128 && value <= 127) return add({prefix | 1, value});
  if (value >= -32768 && value <= 32767) return add({prefix | 2, value, value >> 8});
  return add({prefix | 3, value, value >> 8, value >> 16, value >> 24});
}

DescriptorWriter& DescriptorWriter::usages(std::initializer_list<int> all) {
  // One byte even above 127: usages have no sign.
  for (const int usage : all) add({0x09, usage});
  return *this;
}

DescriptorWriter& DescriptorWriter::wide_usage(int page, int usage) {
  return add({0x0B, usage, usage >> 8, page, page >> 8});
}

std::vector<std::uint8_t> pid_descriptor(PidStick stick) {
  DescriptorWriter w;
  w.page(desktop).begin(0x04, application);
  add_input(w, stick);
  w.page(pid);
  add_set_effect(w, stick);
  if (stick != PidStick::no_constant) {
    w.begin(0x73, logical_set).id(0x15);
    add_block_index(w);
    const int most = stick == PidStick::axes ? 255 : 10000;
    w.usages({0x70}).logical(-most, most).size(16, 1).output(variable).end();
  }
  w.begin(0x77, logical_set).id(0x1A);
  add_block_index(w);
  w.begin(0x78, logical_set).usages({0x79, 0x7A, 0x7B}).logical(1, 3).size(8, 1).output(array);
  w.end().usages({0x7C}).logical(0, 255).size(8, 1).output(variable).end();
  w.begin(0x90, logical_set).id(0x1B);
  add_block_index(w);
  w.end();
  add_controls(w, stick == PidStick::axes);
  if (stick != PidStick::axes) {
    w.begin(0x7D, logical_set).id(0x1D).usages({0x7E}).logical(0, 255).size(8, 1);
    w.output(variable).end();
  }
  add_memory(w, stick);
  w.end();
  return w.bytes();
}

}  // namespace spm::test
