// SPDX-License-Identifier: Apache-2.0
// What is shown as a file: PNG, SVG, and a film in WebM.

import { themeColour } from './theme.js';

const WIDE = 960, STRIP = 150, LEFT = 70, RIGHT = 20, TOP = 46, GAP = 42; // px, of the SVG
const FILM_WIDTH = 1280, FILM_RATE = 30, CAPTION = 34; // px, pictures a second
const FILM_BITS = 6e6; // a second

const escaped = (text) => String(text).replace(/[&<>"']/g,
  (mark) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;', "'": '&#39;' })[mark]);

export function download(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Round steps of an axis, about `count` of them. */
function steps(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((n) => n * power >= rough) * power;
  const list = [];
  for (let n = Math.ceil(low / step); n * step <= high * (1 + 1e-9); ++n) list.push(+(n * step).toPrecision(12));
  return list;
}

/** A curve with the smallest and the largest value of each pixel, so that no peak is lost. */
function curve(times, column, from, to, x, y) {
  let text = '', pixel = -1, low = 0, high = 0, first = 0, last = 0, open = false;
  const put = (px, value) => {
    text += `${open ? 'L' : 'M'}${px.toFixed(1)} ${y(value).toFixed(1)}`;
    open = true;
  };
  const flush = () => {
    if (pixel < 0) return;
    put(pixel, first);
    if (high !== low) {
      put(pixel, low);
      put(pixel, high);
      put(pixel, last);
    }
  };
  for (let i = 0; i < times.length; ++i) {
    if (times[i] < from || times[i] > to) continue;
    const value = column[i];
    const known = value !== null && !Number.isNaN(value);
    const here = Math.round(2 * x(times[i])) / 2;
    if (here !== pixel || !known) {
      flush();
      pixel = known ? here : -1;
      if (!known) open = false;
      low = high = first = value;
    }
    low = Math.min(low, value);
    high = Math.max(high, value);
    last = value;
  }
  flush();
  return text;
}

/** The charts as they are now, from `from` to `to` (s), as SVG. */
export function chartsSvg({ times, strips }, { from, to, title, names, offs }) {
  const height = TOP + strips.length * (STRIP + GAP) + 20;
  const x = (time) => LEFT + (WIDE - LEFT - RIGHT) * (time - from) / (to - from);
  const ink = themeColour('--ink'), soft = themeColour('--soft'), line = themeColour('--line');
  const out = [`<svg xmlns="http://www.w3.org/2000/svg" width="${WIDE}" height="${height}" `
    + `viewBox="0 0 ${WIDE} ${height}" font-family="system-ui, sans-serif" font-size="12">`,
  `<title>${escaped(title)}</title>`,
  `<rect width="${WIDE}" height="${height}" fill="${themeColour('--ground')}"/>`,
  `<text x="${LEFT}" y="20" fill="${ink}" font-size="15" font-weight="600">${escaped(title)}</text>`];
  names.forEach((name, i) => out.push(`<text x="${LEFT + i * 420}" y="38" fill="${i ? themeColour('--second') : ink}">`
    + `${i ? '- - ' : '— '}${escaped(name)}</text>`));
  strips.forEach(({ title: about, unit, colour, columns }, s) => {
    const top = TOP + s * (STRIP + GAP) + 18, bottom = top + STRIP;
    let most = 1e-3, least = 0;
    for (const column of columns) {
      for (let i = 0; i < times.length; ++i) {
        if (times[i] < from || times[i] > to || !Number.isFinite(column[i])) continue;
        most = Math.max(most, column[i]);
        least = Math.min(least, column[i]);
      }
    }
    const y = (value) => bottom - STRIP * (value - least) / (1.08 * (most - least));
    out.push(`<text x="${LEFT}" y="${top - 5}" fill="${ink}">${escaped(about)}, ${escaped(unit)}</text>`);
    for (const [a, b] of offs) {
      if (b < from || a > to) continue;
      const left = x(Math.max(a, from));
      out.push(`<rect x="${left.toFixed(1)}" y="${top}" width="${Math.max(1, x(Math.min(b, to)) - left).toFixed(1)}" `
        + `height="${STRIP}" fill="${soft}" fill-opacity=".18"/>`);
    }
    for (const value of steps(least, 1.08 * most, 4)) {
      out.push(`<path d="M${LEFT} ${y(value).toFixed(1)}H${WIDE - RIGHT}" stroke="${line}"/>`,
        `<text x="${LEFT - 6}" y="${(y(value) + 4).toFixed(1)}" text-anchor="end" fill="${soft}">${value}</text>`);
    }
    for (const time of steps(from, to, 8)) {
      out.push(`<path d="M${x(time).toFixed(1)} ${top}V${bottom}" stroke="${line}"/>`,
        `<text x="${x(time).toFixed(1)}" y="${bottom + 15}" text-anchor="middle" fill="${soft}">${time} s</text>`);
    }
    columns.forEach((column, i) => out.push(`<path d="${curve(times, column, from, to, x, y)}" fill="none" `
      + `stroke="${themeColour(i ? '--second' : colour)}" stroke-width="1.3"${i ? ' stroke-dasharray="5 3"' : ''}/>`));
  });
  out.push(`<text x="${LEFT}" y="${height - 6}" fill="${soft}">grey: no force · time since the first tick</text>`, '</svg>');
  return out.join('\n');
}

/** An SVG as a picture that canvases can draw. */
export async function pictureOf(svg) {
  const image = new Image();
  image.src = URL.createObjectURL(new Blob([svg], { type: 'image/svg+xml' }));
  await image.decode();
  URL.revokeObjectURL(image.src);
  return image;
}

/** Draws the scene, a caption, and the charts as pictureOf() has them, from `from` to `to` (s), with
 *  a line at `time`. */
export function paint(canvas, stage, { charts, from, to, time, caption }) {
  const scene = stage.canvas, scale = FILM_WIDTH / charts.width;
  const high = 2 * Math.round(FILM_WIDTH * scene.height / scene.width / 2);
  const height = high + CAPTION + 2 * Math.round(charts.height * scale / 2);
  if (canvas.width !== FILM_WIDTH || canvas.height !== height) {
    Object.assign(canvas, { width: FILM_WIDTH, height });
  }
  const draw = canvas.getContext('2d');
  draw.fillStyle = themeColour('--ground');
  draw.fillRect(0, 0, FILM_WIDTH, height);
  // In the same task as it is drawn: WebGL forgets its picture after it.
  stage.redraw();
  draw.drawImage(scene, 0, 0, FILM_WIDTH, high);
  draw.fillStyle = themeColour('--ink');
  draw.font = '18px system-ui, sans-serif';
  draw.fillText(caption, 14, high + 23, FILM_WIDTH - 28);
  const top = high + CAPTION;
  draw.drawImage(charts, 0, top, FILM_WIDTH, charts.height * scale);
  const share = (time - from) / (to - from);
  if (share < 0 || share > 1) return;
  draw.fillStyle = themeColour('--focus');
  draw.fillRect(scale * (LEFT + (WIDE - LEFT - RIGHT) * share) - 1, top + scale * TOP, 2,
    scale * (charts.height - TOP - 40));
}

/** A film of a canvas that is painted again for each picture: start(), then finish(). */
export class Film {
  constructor() { this.canvas = document.createElement('canvas'); }

  start() {
    const type = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm']
      .find((name) => MediaRecorder.isTypeSupported(name));
    this.parts = [];
    this.recorder = new MediaRecorder(this.canvas.captureStream(FILM_RATE),
      { mimeType: type, videoBitsPerSecond: FILM_BITS });
    this.recorder.ondataavailable = ({ data }) => { if (data.size) this.parts.push(data); };
    this.recorder.start(500);
  }

  finish() {
    return new Promise((resolve) => {
      this.recorder.onstop = () => resolve(new Blob(this.parts, { type: 'video/webm' }));
      this.recorder.stop();
    });
  }
}
