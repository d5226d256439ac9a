// SPDX-License-Identifier: Apache-2.0
// The page of spm-bake's --report. Its data stands in the page itself; names of others become text.

import { fill, row, short } from './rows.js';
import { colourBar, histogram } from './charts.js';
import { Surface, unpacked } from './surface.js';

const data = JSON.parse(document.getElementById('data').textContent);
const by = (id) => document.getElementById(id);
const micrometres = (value) => (value === null ? 'none' : `${short(value)} µm`);
const count = (value) => value.toLocaleString('en');
const share = (value) => `${short(100 * value)} %`;

const CAPTIONS = {
  'maps.png': 'The distance maps of the support planes that have the most, seen along each normal: bright is near '
    + 'the plane, dark grey has no sample.',
  'surface.png': 'The mesh, and beside it the surface as the asset holds it.',
  'taken.png': 'What the mesh is taken for, from two sides: grey solids, orange lids that close holes, '
    + 'blue sheets, which are felt from both sides.',
  'structure.png': 'What answers where, on the surface and in a cut: blue one map, green '
    + 'two, yellow up to eight triangles, red more, grey deeper than the band, violet left out.',
  'direction.png': 'Errors of directions an eighth of the band inside, whole and close: dark blue none, '
    + 'pale yellow 15 degrees, red more, grey not judged.',
  'error.png': 'Errors of distances, seen from the side of the worst place: dark blue none, pale yellow '
    + 'the tolerance, red more.',
  'error-worst.png': 'The same around the worst place.',
  'error-section.png': 'The same in a cut through the band there; the exact surface is white.',
};

function showHead({ asset, verify }) {
  const name = asset.path.split('/').at(-1);
  document.title = `${name}: report`;
  by('title').textContent = name;
  const verdict = by('verdict');
  verdict.dataset.passed = verify.passed;
  verdict.textContent = `The promise is ${verify.verdict}`;
}

function showFacts({ asset, verify }) {
  const error = verify.distance_error_um, direction = verify.direction_error_deg;
  fill(by('facts'), [
    ['promised: largest error', micrometres(verify.tolerance_um)],
    ['proven: largest error', micrometres(asset.certified_um)],
    ['measured: largest error', micrometres(Math.max(error.max, verify.adversarial.distance_error_um.max))],
    ['measured: p50, p99, p99.9', [error.p50, error.p99, error.p999].map(micrometres).join(', ')],
    ['direction, p50, p99', `${short(direction.p50)}°, ${short(direction.p99)}°`],
    ['places judged', `${count(verify.samples)} even, ${count(verify.adversarial.samples)} hard`],
    ['without an answer', count(verify.counts.unanswered + verify.adversarial.counts.unanswered)],
    ['on the wrong side', count(verify.counts.wrong_side + verify.adversarial.counts.wrong_side)],
    ['largest jump between leaves', verify.jumps ? micrometres(verify.jumps.distance_um.max) : 'no octree'],
    ['band', `${short(1e3 * verify.band_m)} mm inside to ${short(1e3 * verify.margin_m)} mm outside`],
    ['mesh', `${count(asset.mesh.triangles)} triangles, ${asset.mesh.closed ? 'closed' : 'open'}, `
      + `${short(1e3 * asset.mesh.diagonal_m)} mm`],
    ['file', `${count(asset.bytes)} bytes, sha256 ${asset.content_sha256.slice(0, 16)}…`],
  ]);
}

function showWorst({ verify }, surface) {
  const body = by('worst').tBodies[0];
  verify.worst.forEach((place, i) => {
    const line = row([micrometres(place.error_um), place.kind.replaceAll('_', ' '),
      ...place.point.map((part) => (1e3 * part).toFixed(3)), '']);
    if (surface) {
      const show = document.createElement('button');
      show.textContent = 'show';
      show.setAttribute('aria-label', `Show the worst place number ${i + 1}`);
      show.addEventListener('click', () => surface.look(place.point));
      line.lastChild.append(show);
    }
    body.append(line);
  });
}

function showKept({ asset, build }) {
  const { octree, spm } = asset;
  const lines = [['form', spm.form], ['support planes', count(spm.planes)],
    ['distance maps', count(spm.tiles)],
    ['samples in them', count(spm.samples)], ['cells in the band', count(spm.cells)]];
  if (octree) {
    lines.push(['cubes with one distance map', count(octree.maps)],
      ['cubes with two', count(octree.pairs_of_maps)],
      ['cubes with triangles', count(octree.lists)], ['exact triangles', count(octree.triangles)]);
  }
  if (build?.fallback) lines.push(['answers from triangles', share(build.fallback.answers)]);
  fill(by('kept'), lines);
  const left = [...(build?.pruned ?? []).map((rule) => `Left out by the rule "${rule.rule}": `
    + `${count(rule.bytes)} bytes saved`),
  ...(build?.pruned_nothing ?? []).map((rule) => `The rule "${rule.rule ?? rule}" left nothing out`)];
  if (build && !left.length) left.push('Nothing was left out: no scene, or nothing that it does not need.');
  by('pruned').append(...left.map((text) => Object.assign(document.createElement('li'), { textContent: text })));
}

function bars(table, pairs, text) {
  const most = Math.max(...pairs.map(([, value]) => value), 1e-12);
  for (const [name, value] of pairs) {
    const line = row([name, '', text(value)]);
    line.children[1].className = 'bar';
    const bar = document.createElement('div');
    bar.style.width = `${100 * value / most}%`;
    line.children[1].append(bar);
    line.children[2].className = 'number';
    table.tBodies[0].append(line);
  }
}

function showBuild({ build }) {
  by('times-box').hidden = by('notes-box').hidden = !build;
  if (!build) return;
  const { total, stages, ...steps } = build.seconds;
  bars(by('times'), [...Object.entries(steps), ['total', total]], (value) => `${short(value)} s`);
  const said = [...build.notes, ...build.derived].map(String);
  if (!said.length) said.push('Nothing to say.');
  by('notes').append(...said.map((text) => Object.assign(document.createElement('li'), { textContent: text })));
}

function showPictures({ pictures }) {
  for (const { name, image } of pictures) {
    const figure = document.createElement('figure'), picture = document.createElement('img');
    picture.src = image;
    picture.alt = CAPTIONS[name] ?? name;
    const caption = document.createElement('figcaption');
    caption.textContent = CAPTIONS[name] ?? name;
    figure.append(picture, caption);
    by('pictures').append(figure);
  }
}

async function showSurface({ surface, verify }) {
  colourBar(by('colours'), surface.scale_um);
  if (surface.left_out) throw new Error(surface.left_out);
  return new Surface(by('scene'), await unpacked(surface), verify.worst);
}

let surface = null;
showHead(data);
try {
  surface = await showSurface(data);
} catch (problem) {
  by('scene').hidden = true;
  by('noscene').hidden = false;
  by('noscene').textContent = data.surface.left_out
    ?? 'This browser has no WebGL, so the surface is not drawn; the pictures below show it.';
}
showFacts(data);
showWorst(data, surface);
showKept(data);
histogram(by('histogram'), data.verify.histogram, data.verify.tolerance_um);
bars(by('bytes'), Object.entries(data.asset.bytes_by_kind), (value) => `${count(value)} bytes`);
showBuild(data);
showPictures(data);
window.spmReport = { data, surface }; // for tests, and for the curious
