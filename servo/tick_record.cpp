// SPDX-License-Identifier: Apache-2.0
#include "servo/tick_record.hpp"

namespace spm::servo {

TickRing make_tick_ring(double rate_hz, std::size_t devices) {
  const auto capacity = static_cast<std::size_t>(ring_seconds * rate_hz) * devices;
  TickRing ring(capacity);
  TickRecord record;
  while (ring.try_enqueue(record)) {
  }
  while (ring.try_dequeue(record)) {
  }
  return ring;
}

}  // namespace spm::servo
