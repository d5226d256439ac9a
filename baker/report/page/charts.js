// SPDX-License-Identifier: Apache-2.0
// Pictures of numbers, as SVG.

import { BEYOND, colourText, RAMP } from './colours.js';
import { short } from './rows.js';

const SPACE = 'http://www.w3.org/2000/svg';

function draw(parent, name, attributes, text) {
  const made = parent.appendChild(document.createElementNS(SPACE, name));
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

function sheet(place, width, height, label) {
  return draw(place, 'svg', { viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': label });
}

/** What the colours of errors mean: from none to `most` um, and beyond. */
export function colourBar(place, most) {
  if (!most) return;
  const svg = sheet(place, 400, 40, `Colours from no error to ${short(most)} micrometres, and red beyond`);
  const steps = 64, width = 320;
  for (let i = 0; i < steps; ++i) {
    draw(svg, 'rect', { x: i * width / steps, y: 4, width: width / steps + 0.5, height: 14,
      fill: colourText(i / (steps - 1)) });
  }
  draw(svg, 'rect', { x: width + 8, y: 4, width: 40, height: 14, fill: BEYOND });
  draw(svg, 'text', { x: 0, y: 33 }, '0');
  draw(svg, 'text', { x: width / 2, y: 33, 'text-anchor': 'middle' }, `${short(most / 2)} µm`);
  draw(svg, 'text', { x: width, y: 33, 'text-anchor': 'end' }, `${short(most)} µm, tolerance`);
  draw(svg, 'text', { x: width + 28, y: 33, 'text-anchor': 'middle' }, 'more');
}

/** How many places have which error; counts in powers of ten. */
export function histogram(place, { bins_to_um: most, counts }, tolerance) {
  const width = 480, height = 230, left = 46, bottom = 36, top = 10;
  const svg = sheet(place, width, height, `Histogram of the error of the distance; ${counts.at(-1)} places of `
    + `${counts.reduce((sum, one) => sum + one, 0)} are beyond ${short(most)} micrometres`);
  const decades = Math.max(1, Math.ceil(Math.log10(Math.max(...counts, 1) + 1)));
  const y = (value) => height - bottom
    - (value > 0 ? Math.log10(value) + 0.3 : 0) / (decades + 0.3) * (height - bottom - top);
  const step = (width - left - 8) / counts.length;
  for (let decade = 0; decade <= decades; ++decade) {
    draw(svg, 'line', { x1: left, x2: width, y1: y(10 ** decade), y2: y(10 ** decade) });
    draw(svg, 'text', { x: left - 5, y: y(10 ** decade) + 4, 'text-anchor': 'end' },
      (10 ** decade).toLocaleString('en', { notation: 'compact' }));
  }
  const group = draw(svg, 'g', { class: 'bars' });
  counts.forEach((value, i) => {
    const last = i === counts.length - 1;
    const bar = draw(group, 'rect', { x: left + i * step, y: y(value), width: Math.max(step - 1, 1),
      height: height - bottom - y(value), class: last ? 'beyond' : '' });
    draw(bar, 'title', {}, last ? `more: ${value}` : `up to ${short((i + 1) * most / (counts.length - 1))} µm: ${value}`);
  });
  for (let i = 0; i <= 4; ++i) {
    draw(svg, 'text', { x: left + i / 4 * step * (counts.length - 1), y: height - bottom + 14,
      'text-anchor': i === 4 ? 'end' : 'middle' }, short(i / 4 * most));
  }
  draw(svg, 'text', { x: (left + width) / 2, y: height - 4, 'text-anchor': 'middle' },
    `error of the distance, µm${tolerance ? ' (to the tolerance; red: beyond)' : ''}`);
  draw(svg, 'text', { x: 10, y: (height - bottom) / 2, transform: `rotate(-90 10 ${(height - bottom) / 2})`,
    'text-anchor': 'middle' }, 'places');
}
