// SPDX-License-Identifier: Apache-2.0
// The surface in 3D, coloured by error, with the worst places.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Scene, SphereGeometry, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { BEYOND, colourAt, UNKNOWN } from './colours.js';

/** The bytes of a list that is deflated and in base64. */
async function inflate(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}

/** Whole numbers of which all lowest bytes come first, then the next. */
function joined(buffer, width) {
  const bytes = new Uint8Array(buffer), count = bytes.length / width;
  const numbers = new Uint32Array(count);
  for (let place = 0; place < width; ++place) {
    for (let i = 0; i < count; ++i) numbers[i] |= bytes[place * count + i] << (8 * place);
  }
  return numbers;
}

/** The lists of a surface, as surface_json() of report_surface.hpp packs them. */
export async function unpacked(surface) {
  const [positions, triangles, errors] = await Promise.all(
    [surface.positions, surface.triangles, surface.errors].map(inflate));
  const corners = joined(triangles, 4);
  for (let i = 1; i < corners.length; ++i) corners[i] += corners[i - 1];
  return { ...surface, errors: new Float32Array(errors), triangles: corners,
    positions: Float32Array.from(joined(positions, 2),
      (step, i) => surface.origin_m[i % 3] + step * surface.step_m) };
}

function coloured(errors, most) {
  const colours = new Float32Array(3 * errors.length), beyond = new Color(BEYOND), mix = new Color();
  errors.forEach((error, i) => {
    if (error > most) mix.copy(beyond);
    else mix.setRGB(...(error < 0 ? UNKNOWN : colourAt(error / most)), 'srgb');
    mix.toArray(colours, 3 * i);
  });
  return colours;
}

export class Surface {
  /** Takes what unpacked() gives. Throws where there is no WebGL. */
  constructor(canvas, { positions, triangles, errors, scale_um: most }, worst) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(35, 1, 1e-4, 100);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.draw());
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(0.4, 0.8, 1);
    this.camera.add(sun);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 1.5));
    const indexed = new BufferGeometry();
    indexed.setAttribute('position', new BufferAttribute(positions, 3));
    indexed.setAttribute('color', new BufferAttribute(
      coloured(errors, most), 3));
    indexed.setIndex(new BufferAttribute(triangles, 1));
    // Each triangle lit by its own direction: what is sharp stays sharp.
    const geometry = indexed.toNonIndexed();
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
    this.ball = geometry.boundingSphere;
    this.scene.add(new Mesh(geometry, new MeshLambertMaterial({ vertexColors: true, side: DoubleSide })));
    for (const place of worst) this.mark(place);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
    this.whole();
  }

  mark({ point, error_um: error, kind }) {
    const red = error === null || kind !== 'within';
    const ball = new Mesh(new SphereGeometry(this.ball.radius * 0.008, 12, 8),
      new MeshBasicMaterial({ color: red ? BEYOND : '#8a5cd6' }));
    ball.position.set(...point);
    this.scene.add(ball);
  }

  /** Sine of half of the view's angle, the narrower way of the window. */
  narrowest() {
    return Math.sin(Math.atan(Math.tan(Math.PI * 17.5 / 180) * Math.min(1, this.camera.aspect)));
  }

  whole() {
    const { center, radius } = this.ball;
    this.place(center, new Vector3(0.5, 0.4, 0.85).normalize(), 1.05 * radius / this.narrowest());
  }

  /** From outside, close to a place, in metres. */
  look(point) {
    const place = new Vector3(...point);
    this.place(place, place.clone().sub(this.ball.center).normalize(), 0.8 * this.ball.radius);
  }

  place(middle, towards, away) {
    this.camera.position.copy(middle).addScaledVector(towards, away);
    this.camera.near = away / 200;
    this.camera.far = away + 4 * this.ball.radius;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(middle);
    this.controls.update();
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    const before = this.narrowest();
    this.camera.aspect = width / height;
    // What was seen whole still is.
    const { target } = this.controls;
    this.camera.position.sub(target).multiplyScalar(before / this.narrowest()).add(target);
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() { this.renderer.render(this.scene, this.camera); }
}
