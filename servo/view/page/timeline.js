// SPDX-License-Identifier: Apache-2.0
// The time line: where the playing is, what is marked, and how it is moved.

const by = (id) => document.getElementById(id);
const SPEEDS = [0.01, 0.03, 0.1, 0.25, 0.5, 1, 2, 4, 8];
export const MARKS = [
  { kind: 'off', word: 'no force' }, { kind: 'lost', word: 'ticks missing' },
  { kind: 'late', word: 'late tick' }, { kind: 'capped', word: 'cap met' },
  { kind: 'edited', word: 'scene edited' }, { kind: 'exchanged', word: 'asset exchanged' },
];

export class TimeLine {
  /** `moved(time)` is called when the time changes. */
  constructor(recording, length, moved) {
    Object.assign(this, { recording, length, moved });
    this.time = 0;
    this.playing = false;
    this.bar = by('time');
    Object.assign(this.bar, { min: 0, max: length, step: 1 / recording.summary.rate_hz, value: 0 });
    this.bar.addEventListener('input', () => this.go(Number(this.bar.value)));
    by('play').addEventListener('click', () => this.toggle());
    by('back').addEventListener('click', () => this.step(-1));
    by('on').addEventListener('click', () => this.step(1));
    by('before').addEventListener('click', () => this.toMark(-1));
    by('after').addEventListener('click', () => this.toMark(1));
    by('speed').replaceChildren(...SPEEDS.map((speed) => new Option(`${speed} ×`, speed, speed === 1,
      speed === 1)));
    document.addEventListener('keydown', (event) => this.key(event));
    this.showMarks();
  }

  get speed() { return Number(by('speed').value); }

  /** To a time in s since the first tick. */
  go(time) {
    this.time = Math.min(Math.max(time, 0), this.length);
    this.bar.value = this.time;
    this.moved(this.time);
  }

  step(rows) {
    this.play(false);
    const { recording } = this, i = recording.at(this.time) + rows;
    this.go(recording.times[Math.min(Math.max(i, 0), recording.count - 1)]);
  }

  toggle() { this.play(!this.playing); }
  play(on) {
    if (on && this.time >= this.length) this.go(0);
    this.playing = on;
    by('play').textContent = on ? 'Pause' : 'Play';
    by('play').setAttribute('aria-pressed', String(on));
  }

  /** Called for each picture, with the seconds since the last one. */
  advance(seconds) {
    if (!this.playing) return;
    this.go(this.time + seconds * this.speed);
    if (this.time >= this.length) this.play(false);
  }

  /** To the next mark, or the one before. */
  toMark(way) {
    const half = 0.5 / this.recording.summary.rate_hz;
    const times = this.recording.marks.list.map((mark) => this.recording.timeOf(mark.first));
    const found = way > 0 ? times.find((time) => time > this.time + half)
      : times.findLast((time) => time < this.time - half);
    if (found === undefined) return;
    this.play(false);
    this.go(found);
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (/^(BUTTON|SELECT|A|SUMMARY)$/.test(event.target.tagName) && event.key === ' ') return;
    const does = { ' ': () => this.toggle(), ',': () => this.step(-1), '.': () => this.step(1),
      '[': () => this.toMark(-1), ']': () => this.toMark(1),
      Home: () => this.go(0), End: () => this.go(this.length) }[event.key];
    if (!does) return;
    event.preventDefault();
    does();
  }

  /** A row of the strip for each kind, so that they differ without colours. */
  showMarks() {
    const { marks, summary } = this.recording;
    const here = MARKS.filter(({ kind }) => marks.found[kind] > 0);
    by('marks').replaceChildren(...here.map(({ kind }) => {
      const row = document.createElement('div');
      row.className = `row ${kind}`;
      for (const mark of marks.list.filter((one) => one.kind === kind)) {
        const span = row.appendChild(document.createElement('span'));
        const from = this.recording.timeOf(mark.first);
        const to = this.recording.timeOf(mark.last + 1);
        span.style.left = `${100 * from / this.length}%`;
        span.style.width = `${100 * Math.max(0, to - from) / this.length}%`;
      }
      return row;
    }));
    by('mark-counts').textContent = here.map(({ kind, word }) => `${word}: ${marks.found[kind]}`)
      .join(' · ') || 'nothing to mark: no fault, no late tick, no cap met';
    by('mark-list').replaceChildren(...marks.list.slice(0, 200).map((mark) => {
      const item = document.createElement('li');
      const button = item.appendChild(document.createElement('button'));
      button.type = 'button';
      const time = this.recording.timeOf(mark.first);
      const lasts = 1000 * (this.recording.timeOf(mark.last + 1) - time);
      const cause = summary.causes[mark.cause];
      const { word } = MARKS.find(({ kind }) => kind === mark.kind);
      button.textContent = `${time.toFixed(3)} s`;
      button.addEventListener('click', () => { this.play(false); this.go(time); });
      const what = mark.kind === 'off' ? `${word}: ${cause.name}` : word;
      item.append(` ${what}, ${lasts.toFixed(0)} ms`);
      if (mark.kind === 'off' && cause.cure) item.append(`; ${cause.cure}`);
      return item;
    }));
  }
}
