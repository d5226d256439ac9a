// SPDX-License-Identifier: Apache-2.0
// Pointer, keys and gamepads to where the hand is to go.

import { Quaternion, Vector3 } from 'three';
import { detour } from './detour.js';

const THERE = 0.15; // of the scene's size: near enough to a place on a detour
const KEEP = 50; // ms, after which a hand that is held still says so again
const DEAD = 0.15; // of a stick
const STICK_SPEED = 0.6; // of the scene's size, a second
const KEY_STEP = 1 / 150; // of the scene's size
const TURN_STEP = 0.05; // rad
const TURN_PER_PIXEL = 0.01; // rad
const WHEEL_STEP = 0.0004; // of the press, for each unit of the wheel

export class Hand {
  /** `link` sends, `stage` picks, `allowed()` tells whether the page may lead, `told(press)` shows
   *  the depth in m. */
  constructor({ link, stage, allowed, pressChanged }) {
    Object.assign(this, { link, stage, allowed, pressChanged });
    this.number = 0;
    this.sentAt = new Map();
    this.latencies = [];
    this.press = 0.3; // of the deepest, 0 to 1
    this.turn = new Quaternion();
    this.target = null;
    this.round = []; // places to go through first
    this.lastSent = 0;
    const { canvas } = stage;
    canvas.addEventListener('pointerdown', (event) => this.down(event), { capture: true });
    // Of the window: a browser may take the capture of a pointer back while its button is held.
    window.addEventListener('pointermove', (event) => this.move(event));
    for (const name of ['pointerup', 'pointercancel']) {
      window.addEventListener(name, (event) => this.up(event));
    }
    canvas.addEventListener('wheel', (event) => this.wheel(event), { capture: true, passive: false });
    canvas.addEventListener('keydown', (event) => this.key(event));
    canvas.addEventListener('blur', () => { if (this.byKeys) this.letGo(); });
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.letGo(); });
    // By a timer of its own: pictures may be slow, and a hand of which nothing is heard goes slack.
    setInterval(() => this.keep(), KEEP / 2);
  }

  /** m: the deepest press is a tenth of what is seen. */
  get depth() { return this.press ** 2 * this.stage.size * 0.1; }
  setPress(share) {
    this.press = Math.min(Math.max(share, 0), 1);
    this.pressChanged(this.press, this.depth);
    this.aim();
  }

  down(event) {
    if (event.button !== 0 || !event.isPrimary || !this.allowed()) return;
    const hit = this.stage.pick(event.clientX, event.clientY);
    if (!hit) return;
    event.stopPropagation();
    this.stage.canvas.focus({ preventScroll: true });
    this.capture(event);
    this.stage.controls.enabled = false;
    this.stage.taken = true;
    this.pointer = event.pointerId;
    this.byKeys = false;
    this.spot = hit;
    this.at = [event.clientX, event.clientY];
    this.round = detour(this.stage, this.stage.hand.position, hit);
    this.aim();
  }

  /** So that it is heard of beside the window too. */
  capture({ pointerId }) {
    const { canvas } = this.stage;
    if (!canvas.hasPointerCapture(pointerId)) canvas.setPointerCapture(pointerId);
  }

  move(event) {
    if (event.pointerId !== this.pointer) return;
    if (event.buttons === 0) { // released where this page did not hear of it
      this.up(event);
      return;
    }
    this.capture(event);
    const { clientX: x, clientY: y } = event;
    if (event.shiftKey) {
      this.rotate(new Vector3(y - this.at[1], x - this.at[0], 0).multiplyScalar(TURN_PER_PIXEL));
      this.at = [x, y];
      return;
    }
    this.at = [x, y];
    // Beside the object the hand goes on at its distance, with the direction of the last press.
    this.spot = this.stage.pick(x, y)
      ?? { point: this.stage.onPlane(x, y, this.spot.point), normal: this.spot.normal };
    this.aim();
  }

  up(event) {
    if (event.pointerId !== this.pointer) return;
    this.pointer = undefined;
    this.stage.controls.enabled = true;
    this.letGo();
  }

  wheel(event) {
    if (this.pointer === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    this.setPress(this.press - event.deltaY * WHEEL_STEP);
  }

  /** Below the surface at the spot that is touched. */
  aim() {
    if (!this.spot) return;
    this.target = this.spot.point.clone().addScaledVector(this.spot.normal, -this.depth);
    this.send();
  }

  /** About the axes of the screen: right, up, towards the user; rad. */
  rotate(axes) {
    const angle = axes.length();
    if (angle === 0) return;
    const axis = axes.divideScalar(angle).applyQuaternion(this.stage.camera.quaternion);
    this.turn.premultiply(new Quaternion().setFromAxisAngle(axis, angle)).normalize();
    if (this.target) this.send();
  }

  /** By parts of the scene's size, along the axes of the screen. */
  shift(x, y, z) {
    if (!this.allowed()) return;
    this.spot = null;
    this.round = [];
    const way = new Vector3(x, y, z).multiplyScalar(this.stage.size);
    const from = this.target ?? this.from();
    this.target = from.clone().add(way.applyQuaternion(this.stage.camera.quaternion));
    this.send();
  }

  /** Where keys and sticks begin: at the hand, or before the object if it waits far away. */
  from() {
    const hand = this.stage.hand.position.clone();
    const { controls: { target: middle }, size } = this.stage;
    const away = hand.clone().sub(middle);
    return away.length() > size ? middle.clone().addScaledVector(away.normalize(), 0.7 * size) : hand;
  }

  key(event) {
    const ways = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0],
      ArrowDown: [0, -1, 0], PageUp: [0, 0, -1], PageDown: [0, 0, 1] };
    const turns = { ',': -1, '.': 1 };
    if (event.key === 'Escape') this.letGo();
    else if (event.key in ways) {
      this.byKeys = true;
      const step = KEY_STEP * (event.shiftKey ? 0.2 : 1);
      this.shift(...ways[event.key].map((part) => part * step));
    } else if (event.key in turns) {
      this.rotate(new Vector3(0, 0, -turns[event.key] * TURN_STEP));
    } else return;
    event.preventDefault();
  }

  /** Sticks; six axes are those of a SpaceMouse: three to move, three to turn. */
  pollGamepads(seconds) {
    for (const pad of navigator.getGamepads?.() ?? []) {
      if (!pad) continue;
      const at = pad.axes.map((value) => (Math.abs(value) < DEAD ? 0 : value));
      if (at.every((value) => value === 0)) continue;
      const step = STICK_SPEED * seconds;
      this.byKeys = false;
      if (at.length >= 6) {
        this.shift(at[0] * step, -at[2] * step, at[1] * step);
        this.rotate(new Vector3(at[3], -at[5], at[4]).multiplyScalar(2 * seconds));
      } else {
        this.shift(at[0] * step, -(at[1] ?? 0) * step, (at[3] ?? 0) * step);
      }
    }
  }

  send() {
    if (!this.target || !this.allowed()) return;
    const p = this.round[0] ?? this.target, q = this.turn;
    this.number += 1;
    this.lastSent = performance.now();
    this.sentAt.set(this.number, this.lastSent);
    if (this.sentAt.size > 200) this.sentAt.delete(this.sentAt.keys().next().value);
    this.link.send({ t: 'hand', device: 0, p: [p.x, p.y, p.z], q: [q.w, q.x, q.y, q.z],
      n: this.number });
  }

  /** A frame came that has seen the command of a number: how long its way was, ms. */
  heard(number) {
    const sent = this.sentAt.get(number);
    if (sent === undefined) return;
    this.sentAt.delete(number);
    this.latencies.push(performance.now() - sent);
    if (this.latencies.length > 500) this.latencies.shift();
  }

  /** A held hand must say so, and goes on where it came to a place of its detour. */
  keep() {
    if (this.round.length
        && this.stage.hand.position.distanceTo(this.round[0]) < THERE * this.stage.size) {
      this.round.shift();
      this.send();
    }
    if (this.target && performance.now() - this.lastSent >= KEEP) this.send();
  }

  letGo() {
    if (!this.target) return;
    this.target = this.spot = null;
    this.round = [];
    this.byKeys = false;
    this.link.send({ t: 'free', device: 0 });
  }
}
