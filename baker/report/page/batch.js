// SPDX-License-Identifier: Apache-2.0
// The page of spm-bake batch --report. Its data stands in the page itself; names of others become text.

import { short } from './rows.js';

const data = JSON.parse(document.getElementById('data').textContent);
const by = (id) => document.getElementById(id);
const count = (value) => (Number.isFinite(value) ? value.toLocaleString('en') : '');
const number = (value, unit) => (Number.isFinite(value) ? `${short(value)} ${unit}` : '');

// What failed comes first, then what was not begun.
const rank = ({ ok }) => (ok === false ? 0 : ok === null ? 1 : 2);
const stateOf = (asset) => ['failed', 'not begun', asset.tolerance_met === false ? 'inexact' : 'done'][rank(asset)];

const COLUMNS = [
  { key: 'picture', head: '', of: () => null },
  { key: 'name', head: 'name', of: ({ name }) => name, text: ({ name }) => name },
  { key: 'state', head: 'state', of: rank, text: stateOf },
  { key: 'triangles', head: 'triangles', of: ({ triangles }) => triangles, text: ({ triangles }) => count(triangles) },
  { key: 'bytes', head: 'bytes', of: ({ bytes }) => bytes, text: ({ bytes }) => count(bytes) },
  { key: 'tolerance', head: 'tolerance', of: ({ tolerance_um: um }) => um, text: ({ tolerance_um: um }) => number(um, 'µm') },
  { key: 'certified', head: 'proven', of: ({ certified_um: um }) => um, text: ({ certified_um: um }) => number(um, 'µm') },
  { key: 'measured', head: 'measured', of: ({ measured_um: um }) => um, text: ({ measured_um: um }) => number(um, 'µm') },
  { key: 'seconds', head: 'seconds', of: ({ seconds }) => seconds, text: ({ seconds }) => number(seconds, 's') },
  { key: 'memory', head: 'memory', of: ({ memory }) => memory, text: ({ memory }) => number(memory === null ? NaN : memory / 1e6, 'MB') },
  { key: 'cache', head: 'cache', of: ({ cache }) => cache, text: ({ cache }) => cache ?? '' },
  { key: 'said', head: 'what is said', of: ({ error, notes }) => error ?? (notes ?? []).join(' '),
    text: ({ error, notes, cache_reason: reason, cache }) => [error, ...(notes ?? []),
      cache === 'miss' ? `cache: ${reason}` : ''].filter(Boolean).join('; ') },
];
const NUMBERS = new Set(['triangles', 'bytes', 'tolerance', 'certified', 'measured', 'seconds', 'memory']);

function lineOf(asset) {
  const line = document.createElement('tr');
  line.dataset.state = stateOf(asset);
  for (const { key, text } of COLUMNS) {
    const cell = line.appendChild(document.createElement('td'));
    if (NUMBERS.has(key)) cell.className = 'number';
    if (text) cell.textContent = text(asset);
    else if (asset.picture) {
      const picture = cell.appendChild(document.createElement('img'));
      Object.assign(picture, { src: asset.picture, alt: `The surface of ${asset.name}`, width: 64, height: 64 });
    }
  }
  return line;
}

/** What is missing comes last, whatever the order. */
function compare(one, other) {
  const missing = (value) => value === null || value === undefined || value === '';
  if (missing(one) || missing(other)) return missing(one) - missing(other);
  return typeof one === 'string' ? one.localeCompare(other, 'en', { numeric: true }) : one - other;
}

const lines = data.assets.map((asset, i) => ({ asset, i, line: lineOf(asset) }));
const order = { key: 'state', down: false };

function show() {
  const { of } = COLUMNS.find(({ key }) => key === order.key);
  const missing = (value) => value === null || value === undefined || value === '';
  lines.sort((one, other) => {
    const a = of(one.asset), b = of(other.asset);
    const way = order.down && !missing(a) && !missing(b) ? -1 : 1;
    return way * compare(a, b) || one.i - other.i;
  });
  const wanted = by('filter').value.trim().toLowerCase();
  const seen = lines.filter(({ line }) => line.textContent.toLowerCase().includes(wanted));
  by('assets').tBodies[0].replaceChildren(...seen.map(({ line }) => line));
  by('shown').textContent = `${seen.length} of ${lines.length}`;
  for (const head of by('assets').querySelectorAll('th')) {
    const sorted = head.dataset.key === order.key;
    head.setAttribute('aria-sort', sorted ? (order.down ? 'descending' : 'ascending') : 'none');
  }
}

function makeHeads() {
  const heads = by('assets').tHead.rows[0];
  for (const { key, head } of COLUMNS) {
    const cell = heads.appendChild(document.createElement('th'));
    cell.dataset.key = key;
    cell.scope = 'col';
    if (!head) continue;
    const button = cell.appendChild(document.createElement('button'));
    button.type = 'button';
    button.textContent = head;
    button.addEventListener('click', () => {
      order.down = order.key === key && !order.down;
      order.key = key;
      show();
    });
  }
}

function tellAll() {
  const { assets } = data;
  const failed = assets.filter(({ ok }) => ok === false).length;
  const left = assets.filter(({ ok }) => ok === null).length;
  by('title').textContent = data.manifest.split('/').at(-1);
  document.title = `${data.manifest.split('/').at(-1)}: batch`;
  const verdict = by('verdict');
  verdict.dataset.passed = failed + left === 0;
  verdict.textContent = failed + left === 0 ? `All ${assets.length} assets are baked`
    : `${failed} of ${assets.length} assets failed${left ? `, ${left} were not begun` : ''}`;
  const sum = (of) => assets.reduce((total, asset) => total + (of(asset) ?? 0), 0);
  const cached = assets.filter(({ cache }) => cache && cache !== 'off').length;
  const hits = assets.filter(({ cache }) => cache === 'hit').length;
  by('totals').textContent = [`${count(sum(({ bytes }) => bytes))} bytes`,
    `${short(sum(({ seconds, cache }) => (cache === 'hit' ? 0 : seconds)))} s of baking`,
    cached ? `cache: ${hits} of ${cached} hit` : 'no cache'].join(' · ');
}

tellAll();
makeHeads();
by('filter').addEventListener('input', show);
show();
window.spmBatch = data; // for tests, and for the curious
