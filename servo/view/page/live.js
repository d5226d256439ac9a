// SPDX-License-Identifier: Apache-2.0
// The live page: what a running daemon does, and its hand.

import { Charts } from './charts.js';
import { readFrame, size3 } from './frame.js';
import { Hand } from './hand.js';
import { Link } from './link.js';
import { offerLooks } from './looks.js';
import { Panel } from './panel.js';
import { Stage } from './stage.js';
import { followTheme } from './theme.js';

const HAND_OWN = 0;
const SOFTWARE_CHARTS = 400; // ms between pictures of the charts, where the processor draws
const by = (id) => document.getElementById(id);
const say = (id, text) => {
  by(id).hidden = !text;
  if (by(id).textContent !== text) by(id).textContent = text;
};

export function startLive() {
  let scene = null, frame = null, stage = null, hand = null, charts = null;
  const meshes = new Map(); // the number of each asset's mesh that is here or on its way

  followTheme(() => {
    charts?.build();
    stage?.paint();
  });

  async function fetchMeshes() {
    for (const [asset, { mesh, number }] of scene.assets.entries()) {
      if (mesh !== 'ready' || meshes.get(asset) === number) continue;
      meshes.set(asset, number);
      try {
        const response = await fetch(`mesh/${asset}`);
        if (!response.ok) throw new Error(`status ${response.status}`);
        stage?.setMesh(asset, await response.arrayBuffer());
      } catch {
        meshes.delete(asset); // with the next scene
      }
    }
  }

  /** The tool's asset is the one of no object, where there is just one such. */
  function toolAsset() {
    const used = new Set(scene?.objects.map((object) => object.asset));
    const free = (scene?.assets ?? []).map((_, i) => i).filter((i) => !used.has(i));
    return free.length === 1 ? free[0] : -1;
  }

  const link = new Link({
    open() { panel.tell(''); },
    closed() {
      panel.status('the view does not answer: start spm-servo view again', 'bad');
      setOver(true);
    },
    message(message) {
      if (message.t === 'scene') {
        if (scene && message.process !== scene.process && message.process) meshes.clear();
        scene = message;
        panel.scene(scene);
        void fetchMeshes();
      } else if (message.t === 'refused') {
        panel.tell(message.text);
      }
    },
    frame(numbers) {
      const read = readFrame(numbers);
      if (!read) return panel.status('this page is of another version: reload it', 'bad');
      frame = read;
      view.frames += 1;
      hand?.heard(frame.echo);
      panel.frame(frame);
      setOver(panel.over);
      const device = frame.devices[0];
      if (device && !panel.over) {
        charts.add(frame.time, { force: size3(device.force), depth: 1000 * device.depth,
          late: frame.late, energy: 1000 * device.energy });
      }
      showHeld(device);
      stage?.show(frame, hand?.target, toolAsset());
    },
  });

  /** Whether what is shown is the last of a daemon that is gone. */
  function setOver(over) {
    panel.setOver(over);
    charts.setOver(over);
    stage?.setOver(over);
    if (over) hand?.letGo();
  }

  /** Why the hand cannot be led, where it cannot. */
  function showHeld(device) {
    let text = '';
    if (frame.daemon > 0) text = scene?.message ?? '';
    else if (device?.hand === HAND_OWN) {
      text = 'This hand goes its own way. To lead one here, run the daemon with --device sim:hand=live';
    } else if (frame.leads === 2) text = 'Another page or application leads the hand: you watch';
    else if (!hand?.target && !showHeld.led) text = 'Drag over the object to touch it';
    showHeld.led ||= Boolean(hand?.target);
    say('held', text);
  }

  charts = new Charts(by('charts'));
  const panel = new Panel({ link });
  const view = { frames: 0, get frame() { return frame; }, get scene() { return scene; } };

  try {
    stage = new Stage(by('scene'));
    stage.coarsens = true;
    if (stage.pause) charts.pause = SOFTWARE_CHARTS;
    hand = new Hand({
      link,
      stage,
      allowed: () => frame?.daemon === 0 && frame.devices[0]?.hand !== HAND_OWN && frame.leads !== 2,
      pressChanged(share, depth) {
        by('press').value = Math.round(100 * share);
        by('pressed').textContent = `${(1000 * depth).toFixed(1)} mm`;
      },
    });
    by('press').addEventListener('input', () => hand.setPress(by('press').value / 100));
    by('home').addEventListener('click', () => { stage.frame(); stage.dirty = true; });
    offerLooks(stage);
    stage.controls.saveState();
  } catch {
    say('noscene', 'This browser has no WebGL, so the scene is not drawn; numbers, charts and settings go on.');
    by('scene').hidden = true;
    by('tools').hidden = true;
    by('legend').hidden = true;
  }

  let last = performance.now();
  function everyFrame(now) {
    if (hand) {
      hand.pollGamepads(Math.min((now - last) / 1000, 0.1));
      hand.pressChanged(hand.press, hand.depth);
    }
    last = now;
    stage?.draw();
    requestAnimationFrame(everyFrame);
  }
  requestAnimationFrame(everyFrame);

  Object.assign(view, { stage, hand, link, charts });
  window.spmView = view; // for tests, and for the curious
}
