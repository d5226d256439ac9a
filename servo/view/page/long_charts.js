// SPDX-License-Identifier: Apache-2.0
// Charts over the whole length of one recording, or of two that are compared.

import uPlot from 'uplot';
import { size3 } from './frame.js';
import { themeColour } from './theme.js';

const HEIGHT = 112; // px
const DRAG = 6; // px, from which a press is a drag
const short = new Intl.NumberFormat('en', { notation: 'compact', maximumSignificantDigits: 4 });

/** What is drawn of a recording: the key of each strip and its value in a row. */
const STRIPS = [
  { key: 'force', title: 'Force on the hand', unit: 'N', colour: '--force', digits: 3,
    of: (recording, i) => size3(recording.force(i)) },
  { key: 'depth', title: 'Depth below the surface', unit: 'mm', colour: '--depth', digits: 3,
    of: (recording, i) => 1000 * recording.columns.depth[i] },
  { key: 'done', title: 'Tick done after', unit: 'µs', colour: '--late', digits: 0,
    of: (recording, i) => recording.columns.wake[i] + recording.columns.busy[i] },
  { key: 'work', title: 'Work done on the hand', unit: 'mJ', colour: '--energy', digits: 3,
    of: (recording, i) => 1000 * recording.columns.work[i] },
];

const columnOf = (recording, strip) =>
  Float64Array.from({ length: recording.count }, (_, i) => strip.of(recording, i));

/** The strips of some recordings: times in s, and a column for each recording (null where it has
 *  ended). The first recording's ticks are the times, or those of the second where it is longer.
 *  `comparison` is what compare() says. */
export function stripsOf(recordings, comparison) {
  const base = recordings.reduce((one, other) => (other.length > one.length ? other : one));
  const times = base.times;
  const strips = STRIPS.map((strip) => ({ ...strip, columns: recordings.map((recording) => {
    const own = columnOf(recording, strip);
    if (recording === base) return own;
    return Array.from(times, (time) => (time > recording.length ? null : own[recording.at(time)]));
  }) }));
  if (comparison) {
    const own = comparison.difference;
    const [first] = recordings;
    strips.splice(1, 0, { key: 'difference', title: 'Difference of the forces', unit: 'N',
      colour: '--ink', digits: 3, columns: [first === base ? Array.from(own, (n) => (n >= 0 ? n : null))
        : Array.from(times, (time) => (time > first.length ? null : own[first.at(time)]))] });
  }
  return { times, strips };
}

export class LongCharts {
  /** `seek(time)` is called with the time that was clicked. */
  constructor(place, { times, strips }, seek) {
    Object.assign(this, { place, times, strips, seek });
    this.time = 0;
    this.build();
    new ResizeObserver(() => this.resize()).observe(place);
  }

  build() {
    this.plots?.forEach((plot) => plot.destroy());
    this.place.replaceChildren();
    this.values = [];
    this.plots = this.strips.map((strip) => this.strip(strip));
    this.show(this.time);
  }

  strip({ title, unit, colour, columns }) {
    const box = this.place.appendChild(document.createElement('div'));
    box.className = 'chart';
    const head = box.appendChild(document.createElement('h2'));
    head.appendChild(document.createElement('span')).textContent = `${title}, ${unit}`;
    this.values.push(head.appendChild(document.createElement('span')));
    const soft = themeColour('--soft'), grid = { stroke: themeColour('--line'), width: 1 };
    const axis = { stroke: soft, grid, ticks: { ...grid, size: 3 }, gap: 3, font: '11px system-ui',
      size: 48, space: 24 };
    const lines = columns.map((_, i) => ({
      stroke: i === 0 ? themeColour(colour) : themeColour('--second'), width: i === 0 ? 1.4 : 1.2,
      dash: i === 0 ? [] : [5, 3], points: { show: false } }));
    const plot = new uPlot({
      width: this.width(), height: HEIGHT, legend: { show: false }, padding: [6, 14, 0, 0],
      cursor: { y: false, points: { show: false }, drag: { x: true, y: false, dist: DRAG } },
      scales: { x: { time: false }, y: { range: (_, low, high) => range(low, high) } },
      axes: [{ ...axis, size: 20, space: 60, values: (_, ticks) => ticks.map((tick) => `${+tick.toFixed(6)} s`) },
        { ...axis, values: (_, ticks) => ticks.map((tick) => short.format(tick)) }],
      series: [{}, ...lines],
      hooks: { setScale: [(from, key) => this.zoomed(from, key)], draw: [(made) => this.placeHead(made)] },
    }, [this.times, ...columns], box);
    this.addHead(plot);
    return plot;
  }

  addHead(plot) {
    const line = plot.over.appendChild(document.createElement('div'));
    line.className = 'playhead';
    plot.playhead = line;
    let pressed = 0;
    plot.over.addEventListener('mousedown', (event) => { pressed = event.clientX; });
    plot.over.addEventListener('click', (event) => {
      if (Math.abs(event.clientX - pressed) > DRAG) return;
      const box = plot.over.getBoundingClientRect();
      this.seek(plot.posToVal(event.clientX - box.left, 'x'));
    });
  }

  /** All charts show the same stretch of time. */
  zoomed(from, key) {
    if (key !== 'x') return;
    const { min, max } = from.scales.x;
    for (const plot of this.plots ?? []) {
      const { x } = plot.scales;
      if (x.min !== min || x.max !== max) plot.setScale('x', { min, max });
    }
  }

  placeHead(plot) {
    if (!plot.playhead) return;
    const place = plot.valToPos(this.time, 'x');
    plot.playhead.style.transform = `translateX(${place}px)`;
    plot.playhead.hidden = !(place >= 0 && place <= plot.over.clientWidth);
  }

  width() { return Math.max(160, this.place.clientWidth); }
  resize() {
    this.plots.forEach((plot) => plot.setSize({ width: this.width(), height: HEIGHT }));
  }

  /** Puts the line at a time and tells the values there; `rows` are the recordings' rows then. */
  show(time, rows = this.rows) {
    this.time = time;
    this.rows = rows;
    if (!rows) return;
    this.strips.forEach((strip, s) => {
      this.placeHead(this.plots[s]);
      const words = strip.columns.map((column) => column[rows[0]])
        .map((value) => (value === null || Number.isNaN(value) ? 'ended' : value.toFixed(strip.digits)));
      const text = `${words.join(' / ')} ${strip.unit}`;
      if (this.values[s].textContent !== text) this.values[s].textContent = text;
    });
  }
}

/** Room above the curve, and never a range of nothing. */
function range(low, high) {
  const from = Math.min(0, low ?? 0), to = Math.max(high ?? 0, from + 1e-3);
  return [from, to + 0.1 * (to - from)];
}
