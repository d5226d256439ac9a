// SPDX-License-Identifier: Apache-2.0
// The page that plays recordings: one, or two that are compared.

import { size3 } from './frame.js';
import { LongCharts, stripsOf } from './long_charts.js';
import { offerLooks } from './looks.js';
import { chartsSvg, download, Film, paint, pictureOf } from './pictures.js';
import { compare, Recording } from './recording.js';
import { Stage } from './stage.js';
import { followTheme } from './theme.js';
import { TimeLine } from './timeline.js';

const LONGEST_STEP = 0.1; // s between pictures: a page that was hidden does not jump
const MOST_FILM = 60; // s
const PATH_PLACES = 200; // of the hand, by which the camera looks where there is no object

const by = (id) => document.getElementById(id);
const say = (id, text) => {
  by(id).hidden = !text;
  if (by(id).textContent !== text) by(id).textContent = text;
};

class Player {
  async open() {
    followTheme(() => {
      this.charts?.build();
      this.stage?.paint();
    });
    const response = await fetch('recordings.json');
    if (!response.ok) throw new Error(`recordings.json: status ${response.status}`);
    const summaries = await response.json();
    this.chooseDevice(summaries[0]);
    this.recordings = await Promise.all(summaries.map((summary, i) =>
      new Recording(summary, i, this.deviceOf(summary)).load()));
    const [first, second] = this.recordings;
    this.comparison = second ? compare(first, second) : null;
    this.length = Math.max(...this.recordings.map((recording) => recording.length));
    this.tellWhat();
    this.makeStage();
    this.strips = stripsOf(this.recordings, this.comparison);
    this.base = this.recordings.find((recording) => recording.times === this.strips.times);
    this.charts = new LongCharts(by('charts'), this.strips, (time) => {
      this.line.play(false);
      this.line.go(time);
    });
    this.line = new TimeLine(first, this.length, (time) => this.show(time));
    this.listen();
    this.line.go(0);
    await this.fetchMeshes();
  }

  /** The device that the address names, or else the first that has ticks. */
  deviceOf({ devices }) {
    const wanted = Number(new URLSearchParams(location.search).get('device') ?? NaN);
    return devices[wanted]?.rows > 0 ? wanted : Math.max(0, devices.findIndex(({ rows }) => rows > 0));
  }

  /** A list of the devices, where there is more than one. */
  chooseDevice(summary) {
    const chosen = this.deviceOf(summary);
    const list = summary.devices.flatMap(({ name, rows }, i) =>
      (rows > 0 ? [new Option(`${i}: ${name}`, i, i === chosen, i === chosen)] : []));
    by('which').hidden = list.length < 2;
    by('device').replaceChildren(...list);
    by('device').addEventListener('change', () => { location.search = `?device=${by('device').value}`; });
  }

  /** What is played, in words. */
  tellWhat() {
    const [first, second] = this.recordings;
    const status = by('status');
    status.textContent = this.recordings.map(({ summary }) => summary.name).join(' and ');
    status.dataset.state = 'running';
    document.title = `${status.textContent}: SPM Haptics`;
    this.recordings.forEach((recording, i) => {
      const box = by('facts').appendChild(document.createElement('div'));
      const name = box.appendChild(document.createElement('dt'));
      name.textContent = second ? ['first', 'second'][i] : recording.summary.devices[recording.device].name;
      box.appendChild(document.createElement('dd')).textContent =
        `${recording.length.toFixed(2)} s, ${recording.words()}`;
    });
    const total = first.summary.devices[first.device].rows;
    const thinned = total > first.count ? `${total} ticks, of each ${Math.ceil(total / first.count)} the one `
      + 'with the largest force is shown' : '';
    const problems = this.recordings.flatMap(({ summary }) => [summary.loss,
      ...summary.assets.filter(({ problem }) => problem).map(({ name, problem }) => `${name}: ${problem}`)]);
    say('loss', [thinned, ...problems].filter(Boolean).join(' · '));
    if (!second) return;
    const { comparison } = this;
    by('compared').hidden = false;
    document.querySelector('#legend .second').hidden = false;
    by('difference').textContent = `At the same time since their first ticks the forces of `
      + `${first.summary.name} (${first.words()}) and ${second.summary.name} (${second.words()}) differ by at `
      + `most ${comparison.largest.toFixed(3)} N, at ${comparison.at.toFixed(3)} s, and by `
      + `${comparison.rms.toFixed(3)} N root mean square over ${comparison.seconds.toFixed(2)} s. The hands are at `
      + `most ${(1000 * comparison.apart).toFixed(3)} mm apart`
      + `${comparison.apart > 1e-6 ? ', so that some of it comes from their paths' : ': one path'}.`;
  }

  makeStage() {
    try {
      this.stage = new Stage(by('scene'));
      const [first] = this.recordings, stride = Math.ceil(first.count / PATH_PLACES);
      this.stage.setPath(Array.from({ length: Math.ceil(first.count / stride) }, (_, i) => first.position(stride * i)));
      by('home').addEventListener('click', () => { this.stage.frame(); this.stage.dirty = true; });
      offerLooks(this.stage);
    } catch {
      say('noscene', 'This browser has no WebGL, so the scene is not drawn; time line and charts go on.');
      for (const id of ['scene', 'tools', 'legend', 'png', 'film']) by(id).hidden = true;
    }
  }

  async fetchMeshes() {
    const [first] = this.recordings;
    for (const [asset, { drawn }] of first.summary.assets.entries()) {
      if (!drawn || !this.stage) continue;
      const response = await fetch(`${first.path}/mesh/${asset}`);
      if (response.ok) this.stage.setMesh(asset, await response.arrayBuffer());
      this.show(this.line.time);
    }
    if (this.stage && !this.stage.framed) this.stage.framed = this.stage.frame();
    this.ready = true;
  }

  /** Everything at a time in s since the first tick. */
  show(time) {
    const rows = this.recordings.map((recording) => recording.at(time));
    const [first, second] = this.recordings;
    const frame = first.frame(rows[0]);
    this.frame = frame;
    if (second) frame.other = second.frame(rows[1]).devices[0];
    this.stage?.show(frame, null, first.tool ?? -1);
    this.charts.show(time, [this.base.at(time)]);
    const [device] = frame.devices;
    const force = size3(device.force);
    const cause = first.summary.causes[device.cause];
    by('now').textContent = `${time.toFixed(3)} s of ${this.length.toFixed(3)} s`;
    by('time').setAttribute('aria-valuetext',
      `${time.toFixed(3)} seconds, force ${force.toFixed(2)} newtons${device.cause ? `, no force: ${cause.name}` : ''}`);
    say('held', device.cause ? `No force: ${cause.name}${cause.cure ? `; ${cause.cure}` : ''}` : '');
  }

  caption() {
    const rows = this.recordings.map((recording) => recording.at(this.line.time));
    const parts = this.recordings.map((recording, i) => `${recording.summary.name}: `
      + `${size3(recording.force(rows[i])).toFixed(2)} N, ${(1000 * recording.columns.depth[rows[i]]).toFixed(2)} mm deep`);
    return `${this.line.time.toFixed(3)} s   ${parts.join('   ')}`;
  }

  listen() {
    by('png').addEventListener('click', () => this.savePicture());
    by('svg').addEventListener('click', () => this.saveCharts());
    by('film').addEventListener('click', () => (this.film ? this.endFilm() : this.startFilm()));
    let last = performance.now();
    const everyFrame = (now) => {
      this.line.advance(Math.min((now - last) / 1000, LONGEST_STEP));
      last = now;
      this.stage?.draw();
      if (this.film) this.shoot(this.film);
      if (this.film && (!this.line.playing || now > this.filmEnds)) void this.endFilm();
      requestAnimationFrame(everyFrame);
    };
    requestAnimationFrame(everyFrame);
  }

  fileName(ending) { return `${this.recordings[0].summary.name.replace(/\.[^.]*$/, '')}.${ending}`; }

  /** What the charts show now as SVG; with `keys` only the strips of these. */
  svg(keys) {
    const { times, strips } = this.strips;
    const [first] = this.recordings;
    const offs = first.marks.list.filter(({ kind }) => kind === 'off')
      .map((mark) => [first.timeOf(mark.first), first.timeOf(mark.last + 1)]);
    return chartsSvg({ times, strips: strips.filter(({ key }) => !keys || keys.includes(key)) },
      { ...this.span(), offs, title: by('status').textContent,
        names: this.recordings.map((recording) => `${recording.summary.name}: ${recording.words()}`) });
  }

  /** The stretch of time that the charts show, s. */
  span() {
    const { min, max } = this.charts.plots[0].scales.x;
    return { from: min, to: max };
  }

  async picture() {
    const canvas = document.createElement('canvas');
    paint(canvas, this.stage, { charts: await pictureOf(this.svg()), ...this.span(), time: this.line.time,
      caption: this.caption() });
    return new Promise((resolve) => { canvas.toBlob(resolve, 'image/png'); });
  }

  async savePicture() {
    download(await this.picture(), this.fileName('png'));
    by('saved').textContent = `Saved ${this.fileName('png')}`;
  }

  saveCharts() {
    download(new Blob([this.svg()], { type: 'image/svg+xml' }), this.fileName('svg'));
    by('saved').textContent = `Saved ${this.fileName('svg')}`;
  }

  /** From here on, until the end or the button. */
  async startFilm() {
    by('film').disabled = true;
    const film = new Film();
    this.filmCharts = { charts: await pictureOf(this.svg(['force', 'difference'])), ...this.span() };
    this.filmEnds = performance.now() + 1000 * MOST_FILM;
    this.line.play(true);
    this.shoot(film);
    film.start();
    this.film = film;
    by('film').disabled = false;
    by('film').textContent = 'End the film';
    by('film').setAttribute('aria-pressed', 'true');
    by('saved').textContent = 'Filming: until the end, a minute, or the button';
  }

  shoot(film) {
    paint(film.canvas, this.stage, { ...this.filmCharts, time: this.line.time, caption: this.caption() });
  }

  async endFilm() {
    const { film } = this;
    this.film = null;
    this.line.play(false);
    by('film').textContent = 'Film (WebM)';
    by('film').setAttribute('aria-pressed', 'false');
    this.filmed = await film.finish();
    download(this.filmed, this.fileName('webm'));
    by('saved').textContent = `Saved ${this.fileName('webm')}`;
  }
}

export async function startPlayer() {
  const player = new Player();
  window.spmPlayer = player; // for tests, and for the curious
  try {
    await player.open();
  } catch (problem) {
    by('status').textContent = `the recording could not be loaded (${problem.message}): start spm-servo view again`;
    by('status').dataset.state = 'bad';
  }
}
