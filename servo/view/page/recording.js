// SPDX-License-Identifier: Apache-2.0
// A recording as the server gives it: ticks in columns, and what moved in its scene.

import { size3 } from './frame.js';

const STEP = 12; // numbers a step, as Playback::steps() writes them
const REMOVED = 5;
const CONTACT = 1; // a bit of the column flags
const TRAIL_SECONDS = 3;
const TRAIL_PLACES = 600;
const ROUNDING = 1e-9; // s, of times that were added up

async function bytesOf(path) {
  const response = await fetch(path);
  if (!response.ok) throw new Error(`${path}: status ${response.status}`);
  return response.arrayBuffer();
}

/** The last place of a sorted list whose value is at most `value`; -1 where there is none. */
export function lastAtMost(list, value) {
  let low = 0, high = list.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

export class Recording {
  /** `summary` is its entry in recordings.json. */
  constructor(summary, number, device) {
    Object.assign(this, { summary, number, device });
    this.path = `recording/${number}`;
    this.marks = summary.devices[device].marks;
    this.tool = summary.devices[device].tool;
  }

  async load() {
    const [rows, steps] = await Promise.all(
      [bytesOf(`${this.path}/rows/${this.device}`), bytesOf(`${this.path}/steps`)]);
    const [count, columns] = new Uint32Array(rows, 0, 2);
    this.count = count;
    this.ticks = new Float64Array(rows, 8, count);
    this.first = this.ticks[0];
    this.columns = {};
    this.summary.columns.slice(0, columns).forEach((name, i) => {
      this.columns[name] = new Float32Array(rows, 8 + 8 * count + 4 * count * i, count);
    });
    this.times = Float64Array.from(this.ticks, (tick) => this.timeOf(tick));
    this.length = this.times[count - 1];
    this.readSteps(new Float64Array(steps));
    return this;
  }

  /** s since its first tick. */
  timeOf(tick) { return (tick - this.first) / this.summary.rate_hz; }
  at(time) { return Math.max(0, lastAtMost(this.times, time + ROUNDING)); }
  vector(i, ...names) { return names.map((name) => this.columns[name][i]); }
  force(i) { return this.vector(i, 'fx', 'fy', 'fz'); }
  wanted(i) { return this.vector(i, 'wx', 'wy', 'wz'); }
  position(i) { return this.vector(i, 'x', 'y', 'z'); }

  /** Where the surface held the hand: at the depth along the law's force. */
  held(i) {
    const place = this.position(i), wanted = this.wanted(i), size = size3(wanted);
    if (size === 0) return place;
    const share = this.columns.depth[i] / size;
    return place.map((value, axis) => value + share * wanted[axis]);
  }

  readSteps(numbers) {
    this.objects = this.summary.objects.map((object) => ({ ...object, ticks: [], states: [] }));
    for (let at = 0; at + STEP <= numbers.length; at += STEP) {
      const [tick, kind, id, ...rest] = numbers.subarray(at, at + STEP);
      const object = this.objects[id] ??= { gone: true, ticks: [], states: [] };
      object.ticks.push(tick);
      object.states.push({ gone: kind === REMOVED, position: rest.slice(0, 3),
        orientation: rest.slice(3, 7), scale: rest[7], asset: rest[8] });
    }
  }

  objectsAt(tick) {
    const list = [];
    this.objects.forEach((object, id) => {
      const last = lastAtMost(object.ticks, tick);
      const state = last < 0 ? object : object.states[last];
      if (!state.gone) list.push({ id, contact: 0, ...state, movable: object.ticks.length > 0 });
    });
    return list;
  }

  /** Places before a row, the oldest first, with the force at each, for the trail. */
  trail(i) {
    const from = this.at(this.times[i] - TRAIL_SECONDS);
    const stride = Math.max(1, Math.ceil((i - from) / TRAIL_PLACES));
    const trail = [];
    for (let k = i - stride * Math.floor((i - from) / stride); k <= i; k += stride) {
      trail.push({ place: this.held(k), newtons: size3(this.force(k)) });
    }
    return trail;
  }

  /** A row in the form of a live frame. */
  frame(i) {
    const { columns } = this;
    const objects = this.objectsAt(this.ticks[i]);
    const contact = (columns.flags[i] & CONTACT) !== 0;
    if (contact && objects.length === 1) objects[0].contact = 1;
    return {
      body: [this.number, i],
      devices: [{
        position: this.position(i), orientation: this.vector(i, 'qw', 'qx', 'qy', 'qz'),
        force: this.force(i), torque: this.vector(i, 'tx', 'ty', 'tz'), depth: columns.depth[i],
        proxy: this.held(i), cause: columns.cause[i], contact, hasTool: columns.has_tool[i],
        toolPosition: this.vector(i, 'toolx', 'tooly', 'toolz'),
        toolOrientation: this.vector(i, 'toolqw', 'toolqx', 'toolqy', 'toolqz'),
      }],
      objects, contacts: [], trail: this.trail(i),
    };
  }

  /** How it was felt, in words. */
  words() {
    const methods = [...new Set(this.summary.objects.map((object) => object.method))];
    const stiffnesses = [...new Set(this.summary.objects.map((object) => Math.round(object.stiffness)))];
    return `${methods.join(', ')}, ${stiffnesses.join(', ')} N/m, `
      + `stabilization ${this.summary.stabilized ? 'on' : 'off'}`;
  }
}

/** How the forces of two recordings differ at the same time since their first ticks. */
export function compare(one, other) {
  const difference = new Float64Array(one.count);
  const found = { largest: 0, at: 0, apart: 0, squares: 0, count: 0 };
  for (let i = 0; i < one.count; ++i) {
    const time = one.times[i];
    if (time > other.length) {
      difference[i] = NaN;
      continue;
    }
    const k = other.at(time);
    const theirs = other.force(k), place = other.position(k);
    const size = size3(one.force(i).map((value, axis) => value - theirs[axis]));
    const apart = size3(one.position(i).map((value, axis) => value - place[axis]));
    difference[i] = size;
    found.squares += size * size;
    found.count += 1;
    if (size > found.largest) Object.assign(found, { largest: size, at: time });
    found.apart = Math.max(found.apart, apart);
  }
  found.rms = Math.sqrt(found.squares / Math.max(1, found.count));
  found.seconds = Math.min(one.length, other.length);
  return { difference, ...found };
}
