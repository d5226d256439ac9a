// SPDX-License-Identifier: Apache-2.0
// Reads a frame in the order in which frame_of() of servo/view/view_frame.cpp writes it.

const HEAD = 20, DEVICE = 55, OBJECT = 18, CONTACT = 12;
const VERSION = 1;

class Reader {
  constructor(numbers) {
    this.numbers = numbers;
    this.at = 0;
  }

  one() { return this.numbers[this.at++]; }
  many(count) { return this.numbers.subarray(this.at, this.at += count); }
}

function readDevice(numbers) {
  const from = new Reader(numbers);
  return {
    connected: from.one(), position: from.many(3), orientation: from.many(4),
    velocity: from.many(3), force: from.many(3), torque: from.many(3), depth: from.one(),
    contact: from.one(), buttons: from.one(), cause: from.one(), health: from.one(),
    proxy: from.many(3), proxyOrientation: from.many(4), forceCap: from.one(),
    torqueCap: from.one(), limits: from.one(), hasTool: from.one(), toolPosition: from.many(3),
    toolOrientation: from.many(4), hand: from.one(), energy: from.one(), generated: from.one(),
    forceMax: from.one(), capHits: from.one(), level: from.one(), cuts: from.one(),
  };
}

function readObject(numbers) {
  const from = new Reader(numbers);
  return {
    id: from.one(), asset: from.one(), position: from.many(3), orientation: from.many(4),
    scale: from.one(), force: from.many(3), contact: from.one(), movable: from.one(),
    driven: from.one(),
  };
}

function readContact(numbers) {
  const from = new Reader(numbers);
  return {
    device: from.one(), object: from.one(), place: from.many(3), normal: from.many(3),
    force: from.many(3), depth: from.one(),
  };
}

/** Null for a frame of another version. */
export function readFrame(numbers) {
  const from = new Reader(numbers);
  if (from.one() !== VERSION) return null;
  const frame = {
    daemon: from.one(), tick: from.one(), time: from.one(), age: from.one(), ticks: from.one(),
    missed: from.one(), degraded: from.one(), rate: from.one(), late: from.one(),
    busy: from.one(),
  };
  const counts = [from.one(), from.one()];
  frame.objectTotal = from.one();
  counts.push(from.one());
  frame.refused = from.one();
  frame.leads = from.one(); // 1: this page leads a hand; 2: another one does
  frame.echo = from.one();
  frame.body = numbers.subarray(HEAD);
  let at = HEAD;
  const list = (count, length, read) => Array.from({ length: count }, () => {
    const part = numbers.subarray(at, at + length);
    at += length;
    return read(part);
  });
  frame.devices = list(counts[0], DEVICE, readDevice);
  frame.objects = list(counts[1], OBJECT, readObject);
  frame.contacts = list(counts[2], CONTACT, readContact);
  return frame;
}

/** Whether nothing has moved between two frames. */
export const isSame = (one, other) => one.length === other.length
  && one.every((value, i) => value === other[i]);

export const size3 = (vector) => Math.hypot(vector[0], vector[1], vector[2]);
