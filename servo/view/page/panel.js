// SPDX-License-Identifier: Apache-2.0
// The numbers, causes, sliders and lists beside the scene. Names of others become text, never markup.

import { size3 } from './frame.js';

const by = (id) => document.getElementById(id);
const element = (name, text) => {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  return made;
};
const short = (value, digits = 3) => Number(value.toPrecision(digits)).toString();
const SEND_EVERY = 60; // ms, between two commands of sliders that are dragged

// Sliders go from 0 to 1000; `root` bends them so that small values have room.
const SLIDERS = [
  { key: 'stiffness', label: 'Stiffness', most: 5000, root: 2, show: (v) => `${short(v)} N/m`,
    read: (feel) => feel.stiffness, wish: (v) => ({ stiffness: v }) },
  { key: 'friction', label: 'Friction', most: 1.5, root: 1, show: (v) => `${short(v, 2)} µ`, paper: false,
    read: (feel) => feel.friction[0], wish: (v) => ({ friction: [v, 0.8 * v] }) },
  { key: 'damping', label: 'Damping', most: 20, root: 2, show: (v) => `${short(v, 2)} N s/m`, paper: false,
    read: (feel) => feel.damping, wish: (v) => ({ damping: v }) },
  { key: 'texture', label: 'Texture', most: 3e-4, root: 2, show: (v) => `${short(1e6 * v, 2)} µm`, paper: false,
    read: (feel) => feel.texture[0],
    wish: (v, feel) => ({ texture: [v, feel.texture[1] || 1e-3] }) },
];
const CAP = { key: 'cap', label: 'Force cap', most: 20, root: 2, show: (v) => `${short(v, 2)} N` };

const METHODS = ['spm', 'paper', 'proxy']; // by the numbers of spm_client.h
const STATES = ['running', 'stalled: no tick comes', 'ended', 'gone', 'no daemon'];
const OVER = 2; // and the states behind it: no tick will come

export class Panel {
  constructor({ link, wishesChanged }) {
    this.link = link;
    this.wishesChanged = wishesChanged;
    this.facts = new Map();
    this.busyUntil = 0;
    this.makeSliders();
    by('object').addEventListener('change', () => this.showFeel(true));
    by('method').addEventListener('change', () => this.choose(
      { t: 'method', object: this.object.id, method: Number(by('method').value) }));
    by('stabilized').addEventListener('change', () => this.choose(
      { t: 'stabilize', on: by('stabilized').checked ? 1 : 0 }));
    by('acknowledge').addEventListener('click', () => link.send({ t: 'acknowledge', device: 0 }));
  }

  makeSliders() {
    this.sliders = [...SLIDERS, CAP].map((kind) => {
      const line = element('label');
      line.className = 'slider';
      const input = element('input');
      Object.assign(input, { type: 'range', min: 0, max: 1000, step: 1, id: `slide-${kind.key}` });
      const output = element('output');
      line.append(element('span', kind.label), input, output);
      by('sliders').append(line);
      const slider = { kind, input, output, line, value: 0, sent: input.value };
      input.addEventListener('input', () => this.slid(slider));
      return slider;
    });
  }

  put(slider, value) {
    const { kind, input, output } = slider;
    slider.value = value;
    if (Number.isFinite(value)) {
      input.value = Math.round(1000 * Math.min(value / kind.most, 1) ** (1 / kind.root));
      output.textContent = kind.show(value);
    } else {
      input.value = 1000;
      output.textContent = 'none';
    }
    input.setAttribute('aria-valuetext', output.textContent);
    slider.sent = input.value; // the daemon has it
  }

  /** A slider was moved: its newest value is sent, with a pause between any two commands. */
  slid(slider) {
    const { kind, input } = slider;
    slider.value = kind.most * (input.value / 1000) ** kind.root;
    slider.output.textContent = kind.show(slider.value);
    input.setAttribute('aria-valuetext', slider.output.textContent);
    this.busyUntil = performance.now() + 800;
    this.sendNext();
  }

  /** Sends what one slider was moved to, if that is not what the daemon has, and comes back after a
   *  pause for others. */
  sendNext() {
    if (this.pause) return;
    const slider = this.sliders.find((one) => one.input.value !== one.sent);
    if (!slider) return;
    slider.sent = slider.input.value;
    by('refused').textContent = '';
    this.wish(slider);
    this.pause = setTimeout(() => {
      this.pause = 0;
      this.sendNext();
    }, SEND_EVERY);
  }

  wish({ kind, value }) {
    if (kind === CAP) {
      this.link.send({ t: 'cap', device: 0, newtons: value });
    } else if (this.object) {
      this.link.send({ t: 'feel', object: this.object.id, ...kind.wish(value, this.object) });
    }
    this.showBorder();
  }

  /** Method and stabilization, which the loop may refuse. */
  choose(wish) {
    by('refused').textContent = '';
    this.link.send(wish);
  }

  showChoices() {
    by('method').value = String(METHODS.indexOf(this.object.method));
    by('stabilized').checked = this.object.stabilized;
  }

  fact(name, text) {
    let value = this.facts.get(name);
    if (!value) {
      const box = element('div');
      value = element('dd');
      box.append(element('dt', name), value);
      by('facts').append(box);
      this.facts.set(name, value);
    }
    if (value.textContent !== text) value.textContent = text;
  }

  /** What seldom changes. */
  scene(scene) {
    this.scenes = scene;
    const chosen = this.object?.id;
    const list = by('object');
    list.replaceChildren(...scene.objects.map((object, i) => {
      const option = element('option', object.name || `object ${i + 1}`);
      option.value = String(object.id);
      return option;
    }));
    if (scene.objects.some((object) => object.id === chosen)) list.value = String(chosen);
    this.showFeel(false);
    by('applications').replaceChildren(...scene.applications.map((application) => element('li',
      `${application.name || 'without a name'}, process ${application.process}`
      + `${application.supervisor ? ', supervisor' : application.observer ? ', observer' : ''}`)));
    const failed = scene.assets.filter((asset) => asset.mesh === 'failed');
    if (failed.length) this.tell(`No picture of ${failed[0].name}: ${failed[0].error}`);
  }

  showFeel(anew) {
    const id = Number(by('object').value);
    this.object = this.scenes?.objects.find((object) => object.id === id) ?? this.scenes?.objects[0];
    const { object } = this;
    by('feel').hidden = !object;
    if (!object || (!anew && performance.now() < this.busyUntil)) return;
    for (const slider of this.sliders) {
      if (slider.kind === CAP) continue;
      this.put(slider, slider.kind.read(object));
      slider.input.disabled = object.method === 'paper' && slider.kind.paper === false;
    }
    this.showChoices();
    this.showBorder();
  }

  /** How far the stiffest object is from the border at which the device shakes. */
  showBorder() {
    const device = this.scenes?.devices[0];
    const stabilized = this.object?.stabilized;
    const border = device && (stabilized ? device.stabilized_border : device.bare_border);
    by('border').hidden = !border;
    if (!border) return;
    const slider = this.sliders[0];
    const others = this.scenes.objects.filter((object) => object !== this.object);
    const stiffest = Math.max(slider.value, ...others.map((object) => object.stiffness));
    const share = stiffest / border;
    by('meter').value = share;
    const word = share < 0.61 ? 'safe' : share < 1 ? 'near the border' : 'beyond the border: it may shake';
    by('margin').textContent = `${word}: ${short(stiffest)} of ${short(border)} N/m, at which the `
      + `laboratory's ${device.name} began to shake ${stabilized ? 'with' : 'without'} stabilization `
      + '(simulated)';
    by('meter').textContent = `${Math.round(100 * share)} %`;
  }

  tell(text) {
    by('refused').textContent = text;
    if (this.object) this.showChoices();
  }

  status(text, state) {
    const status = by('status');
    if (status.textContent !== text) status.textContent = text;
    status.dataset.state = state;
  }

  /** What changes with each frame. */
  frame(frame) {
    const device = frame.devices[0];
    this.status(STATES[frame.daemon] ?? 'unknown', frame.daemon === 0 ? 'running' : 'bad');
    this.setOver(frame.daemon >= OVER);
    if (!device || this.over) return;
    this.fact('force', `${size3(device.force).toFixed(2)} N`);
    this.fact('depth', `${(1000 * device.depth).toFixed(2)} mm`);
    this.fact('rate', `${frame.rate.toFixed(0)} Hz`);
    this.fact('missed', `${frame.missed} of ${frame.ticks}`);
    this.fact('cap met', `${device.capHits}`);
    if (frame.objectTotal > frame.objects.length) {
      this.fact('shown', `${frame.objects.length} of ${frame.objectTotal} objects`);
    }
    const cap = this.sliders.at(-1);
    if (performance.now() > this.busyUntil && cap.value !== device.forceCap) this.put(cap, device.forceCap);
    this.cause(device.cause);
  }

  /** Whether there is no daemon any more: no number is one of now, and no setting is followed. */
  setOver(over) {
    if (this.over === over) return;
    this.over = over;
    by('feel').inert = over;
    if (!over) return;
    for (const value of this.facts.values()) value.textContent = '–';
    by('causes').hidden = true;
    this.shownCause = undefined;
  }

  cause(number) {
    if (number === this.shownCause) return;
    this.shownCause = number;
    const cause = this.scenes?.causes[number];
    const box = by('causes');
    box.hidden = number === 0;
    by('acknowledge').hidden = cause?.name !== 'unacknowledged';
    if (!number) return;
    const name = element('p');
    name.append(element('strong', `No force: ${cause?.name ?? `cause ${number}`}`));
    box.replaceChildren(name, element('p', cause?.cure ?? ''));
  }
}
