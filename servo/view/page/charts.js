// SPDX-License-Identifier: Apache-2.0
// Strip charts of the last ten seconds. Their memory is of fixed size.

import uPlot from 'uplot';

const SECONDS = 10;
const ROOM = 640; // samples: 60 a second for ten seconds, and some
const DRAW_EVERY = 66; // ms
const HEIGHT = 98; // px
const STRIPS = [
  { key: 'force', title: 'Force', unit: 'N', colour: '--force', digits: 2 },
  { key: 'depth', title: 'Depth', unit: 'mm', colour: '--depth', digits: 2 },
  { key: 'late', title: 'Latest tick of each frame', unit: 'µs', colour: '--late', digits: 0 },
  { key: 'energy', title: 'Energy given to the hand', unit: 'mJ', colour: '--energy', digits: 2 },
];

const short = new Intl.NumberFormat('en', { notation: 'compact' });
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Charts {
  constructor(place) {
    this.place = place;
    this.columns = Object.fromEntries(['time', ...STRIPS.map((strip) => strip.key)]
      .map((key) => [key, []]));
    this.drawn = 0;
    this.pause = DRAW_EVERY;
    this.values = {};
    this.build();
    new ResizeObserver(() => this.resize()).observe(place);
  }

  /** Anew, in the colours of the theme. */
  build() {
    this.plots?.forEach((plot) => plot.destroy());
    this.place.replaceChildren();
    this.plots = STRIPS.map((strip) => this.strip(strip));
  }

  strip({ key, title, unit, colour: name, digits }) {
    const box = this.place.appendChild(document.createElement('div'));
    box.className = 'chart';
    const head = box.appendChild(document.createElement('h2'));
    head.appendChild(document.createElement('span')).textContent = `${title}, ${unit}`;
    const value = head.appendChild(document.createElement('span'));
    this.values[key] = (number) => { value.textContent = `${Number.isNaN(number) ? '–' : number.toFixed(digits)} ${unit}`; };
    const line = colour(name), soft = colour('--soft'), grid = { stroke: colour('--line'), width: 1 };
    const axis = { stroke: soft, grid, ticks: { ...grid, size: 3 }, gap: 3, font: '11px system-ui',
      size: 44, space: 24 };
    return new uPlot({
      width: this.width(), height: HEIGHT, legend: { show: false }, cursor: { show: false },
      padding: [6, 14, 0, 0],
      scales: { x: { time: false, range: [-SECONDS, 0] }, y: { range: (_, low, high) => range(low, high) } },
      axes: [{ ...axis, size: 20, space: 60,
        values: (_, ticks) => ticks.map((tick) => (tick ? `${tick} s` : this.over ? 'end' : 'now')) },
      { ...axis, values: (_, ticks) => ticks.map((tick) => short.format(tick)) }],
      series: [{}, { stroke: line, width: 1.6, fill: `${line}22`, points: { show: false } }],
    }, this.data(key), box);
  }

  /** Whether nothing comes any more: the last sample is none of now. */
  setOver(over) {
    if (this.over === over) return;
    this.over = over;
    this.plots.forEach((plot) => plot.redraw(false, true));
    if (over) for (const { key } of STRIPS) this.values[key](NaN);
  }

  width() { return Math.max(160, this.place.clientWidth); }
  resize() {
    this.plots.forEach((plot) => plot.setSize({ width: this.width(), height: HEIGHT }));
  }

  data(key) {
    const { time } = this.columns;
    const now = time.at(-1) ?? 0;
    return [time.map((moment) => moment - now), this.columns[key].slice()];
  }

  /** A sample, with its moment in s. */
  add(time, sample) {
    const times = this.columns.time;
    if (times.length && time <= times.at(-1)) {
      if (times.at(-1) - time < 1) return;
      this.clear(); // another daemon
    }
    times.push(time);
    for (const { key } of STRIPS) this.columns[key].push(sample[key]);
    let drop = 0;
    while (times[drop] < time - SECONDS) ++drop;
    drop = Math.max(drop, times.length - ROOM);
    if (drop > 0) for (const column of Object.values(this.columns)) column.splice(0, drop);
    const now = performance.now();
    if (now - this.drawn < this.pause) return;
    this.drawn = now;
    STRIPS.forEach(({ key }, i) => {
      this.plots[i].setData(this.data(key));
      this.values[key](sample[key]);
    });
  }

  clear() { for (const column of Object.values(this.columns)) column.length = 0; }
}

/** Room above the curve, and never a range of nothing. */
function range(low, high) {
  const from = Math.min(0, low ?? 0), to = Math.max(high ?? 0, from + 0.02);
  return [from, to + 0.12 * (to - from)];
}
