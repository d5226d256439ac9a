// SPDX-License-Identifier: Apache-2.0
// The scene in 3D: objects, hand, proxy, tool, force, torque, contacts and the trail.

import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, CylinderGeometry, ConeGeometry,
  DirectionalLight, DoubleSide, DynamicDrawUsage, GridHelper, Group, Line, LineBasicMaterial,
  Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Quaternion, Raycaster,
  RingGeometry, Scene, SphereGeometry, Sphere, TorusGeometry, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { toCreasedNormals } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { isSame, size3 } from './frame.js';

const CREASE = Math.PI / 6;
const SOFTWARE_PAUSE = 30; // ms between pictures: 30 a second
const COARSE = 0.4; // of the window's pixels each way, while something moves
const STILL = 250; // ms, after which all of them are drawn again
const TRAIL = 900; // places: 15 s
const FULL_FORCE = 3; // N, of the trail's brightest colour
// From no force to FULL_FORCE: cividis, safe for the colour-blind, without the end that is lost on the
// ground of the theme.
const CIVIDIS = ['#35456c', '#666970', '#948e77', '#c8b866', '#fee838'].map((text) => new Color(text));
const RAMPS = { dark: CIVIDIS, light: [...CIVIDIS.slice(0, -1).reverse(), new Color('#00224e')] };

const UP = new Vector3(0, 1, 0);
const vector = (from) => new Vector3(from[0], from[1], from[2]);
const turn = (from) => new Quaternion(from[1], from[2], from[3], from[0]);
const themed = (name) => new Color(
  getComputedStyle(document.documentElement).getPropertyValue(name).trim());

function rampColour(share, to) {
  const ramp = RAMPS[document.documentElement.dataset.theme] ?? RAMPS.light;
  const at = Math.min(Math.max(share, 0), 1) * (ramp.length - 1);
  const low = Math.min(Math.floor(at), ramp.length - 2);
  return to.copy(ramp[low]).lerp(ramp[low + 1], at - low);
}

/** Whether WebGL is drawn by the processor: then fewer pictures leave it to the loop. */
function drawsInSoftware() {
  const gl = document.createElement('canvas').getContext('webgl2');
  const info = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|basic render/i.test(name);
}

/** An arrow of length 1 along y. */
function arrow(material) {
  const group = new Group();
  const shaft = new Mesh(new CylinderGeometry(0.028, 0.028, 0.78, 12), material);
  shaft.position.y = 0.39;
  const head = new Mesh(new ConeGeometry(0.085, 0.22, 18), material);
  head.position.y = 0.89;
  group.add(shaft, head);
  group.visible = false;
  return group;
}

export class Stage {
  /** Throws where there is no WebGL. */
  constructor(canvas) {
    this.canvas = canvas;
    this.pause = drawsInSoftware() ? SOFTWARE_PAUSE : 0;
    this.drawnAt = 0;
    this.coarsens = false; // where the processor draws, fewer pixels while something moves: sooner seen
    this.coarse = false;
    this.body = [];
    this.renderer = new WebGLRenderer({ canvas, antialias: this.pause === 0 });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(40, 1, 1e-4, 100);
    this.camera.position.set(0.5, 0.4, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => { this.dirty = true; });
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(0.5, 0.9, 1);
    this.camera.add(sun);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 0.9));
    this.objects = new Map();
    this.geometries = new Map();
    this.size = 0.1;
    this.framed = false;
    this.ray = new Raycaster();
    this.makeHand();
    this.paint();
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
  }

  makeHand() {
    const make = (geometry, material) => {
      const mesh = new Mesh(geometry, material);
      mesh.visible = false;
      this.scene.add(mesh);
      return mesh;
    };
    const flat = () => new MeshBasicMaterial({ depthTest: false, transparent: true });
    this.materials = {
      proxy: new MeshLambertMaterial(), hand: flat(), wish: flat(), force: flat(), torque: flat(),
      contact: new MeshLambertMaterial(), tool: new MeshLambertMaterial({ side: DoubleSide }),
      surface: new MeshLambertMaterial(), touched: new MeshLambertMaterial(),
    };
    this.proxy = make(new SphereGeometry(1, 24, 16), this.materials.proxy);
    this.hand = make(new TorusGeometry(1.25, 0.16, 10, 32), this.materials.hand);
    this.wish = make(new RingGeometry(0.28, 0.5, 4), this.materials.wish);
    this.force = arrow(this.materials.force);
    this.torque = arrow(this.materials.torque);
    this.scene.add(this.force, this.torque);
    this.tool = new Group();
    this.tool.visible = false;
    this.scene.add(this.tool);
    this.patches = [];
    const trail = new BufferGeometry();
    for (const name of ['position', 'color']) {
      const attribute = new BufferAttribute(new Float32Array(3 * TRAIL), 3);
      trail.setAttribute(name, attribute.setUsage(DynamicDrawUsage));
    }
    trail.setDrawRange(0, 0);
    this.trail = new Line(trail, new LineBasicMaterial({ vertexColors: true }));
    this.trail.frustumCulled = false;
    this.scene.add(this.trail);
    this.trailLength = 0;
    // Of a second recording, beside the first.
    this.materials.other = new MeshLambertMaterial();
    this.materials.otherForce = flat();
    this.other = make(new SphereGeometry(1, 24, 16), this.materials.other);
    this.otherForce = arrow(this.materials.otherForce);
    this.scene.add(this.otherForce);
    for (const [mesh, order] of [[this.hand, 3], [this.wish, 4], [this.force, 5], [this.torque, 5]]) {
      mesh.traverse((part) => { part.renderOrder = order; });
    }
  }

  /** Takes the colours of the theme. */
  paint() {
    this.renderer.setClearColor(themed('--ground'));
    const { materials } = this;
    materials.proxy.color = themed('--depth');
    materials.hand.color = themed('--soft');
    materials.wish.color = themed('--ink');
    materials.force.color = themed('--force');
    materials.torque.color = themed('--late');
    materials.other.color = materials.otherForce.color = themed('--second');
    materials.contact.color = themed('--force');
    materials.tool.color = themed('--energy');
    materials.surface.color = themed('--surface');
    materials.touched.color = themed('--surface').lerp(themed('--late'), 0.22);
    this.layGrid();
    this.dirty = true;
  }

  /** A floor below the objects, whose squares tell the size. */
  layGrid() {
    this.grid?.removeFromParent();
    this.grid?.geometry.dispose();
    this.square = 10 ** Math.floor(Math.log10(this.size / 2));
    const count = 2 * Math.ceil(this.size / this.square);
    const line = themed('--line');
    this.grid = new GridHelper(count * this.square, count, line, line);
    this.grid.position.copy(this.middle ?? new Vector3());
    this.grid.position.y -= this.size * 0.5;
    this.scene.add(this.grid);
    const scale = this.square >= 1 ? `${this.square} m` : `${+(1000 * this.square).toPrecision(2)} mm`;
    document.getElementById('scalebar').textContent = `squares of ${scale}`;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.setPixels();
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  setPixels() {
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * (this.coarse ? COARSE : 1));
  }

  /** Gives the surface of an asset: the bytes that to_bytes() of surface_mesh.hpp makes. */
  setMesh(asset, bytes) {
    const [vertices, triangles] = new Uint32Array(bytes, 0, 2);
    const soup = new BufferGeometry();
    soup.setAttribute('position',
      new BufferAttribute(new Float32Array(bytes, 8, 3 * vertices), 3));
    soup.setIndex(new BufferAttribute(new Uint32Array(bytes, 8 + 12 * vertices, 3 * triangles), 1));
    const geometry = toCreasedNormals(soup, CREASE);
    geometry.computeBoundingSphere();
    this.geometries.get(asset)?.dispose();
    this.geometries.set(asset, geometry);
    for (const mesh of this.objects.values()) {
      if (mesh.userData.asset === asset) mesh.geometry = geometry;
    }
    this.framed = false;
    this.dirty = true;
  }

  /** Where the hand goes: what is seen where no object is drawn. */
  setPath(places) {
    this.path = new Sphere().setFromPoints(places.map(vector));
    this.path.radius = Math.max(this.path.radius, 1e-3);
  }

  /** Puts the camera where it sees all objects, or else the hand's path. */
  frame() {
    const all = new Sphere();
    all.makeEmpty();
    for (const mesh of this.objects.values()) {
      if (!mesh.geometry.boundingSphere) continue;
      mesh.updateMatrixWorld();
      all.union(mesh.geometry.boundingSphere.clone().applyMatrix4(mesh.matrixWorld));
    }
    if (all.isEmpty() && this.path) all.copy(this.path);
    if (all.isEmpty()) return false;
    this.middle = all.center;
    this.size = Math.max(2 * all.radius, 1e-4);
    const half = Math.atan(Math.tan(this.camera.fov * Math.PI / 360) * Math.min(1, this.camera.aspect));
    const away = 1.15 * all.radius / Math.sin(half);
    this.camera.position.set(0.5, 0.42, 0.85).normalize().multiplyScalar(away).add(all.center);
    this.camera.near = away / 200;
    this.camera.far = away * 20;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(all.center);
    this.controls.update();
    this.layGrid();
    return true;
  }

  /** Shows a frame; `wish` is where the page leads the hand, or null. */
  show(frame, wish, toolAsset) {
    if (this.framed && isSame(frame.body, this.body) && wish === this.wished) return;
    this.body = frame.body;
    this.wished = wish;
    const seen = new Set();
    for (const object of frame.objects) {
      seen.add(object.id);
      this.placeObject(object);
    }
    for (const [id, mesh] of this.objects) {
      if (seen.has(id)) continue;
      mesh.removeFromParent();
      this.objects.delete(id);
    }
    if (!this.framed && this.geometries.size) this.framed = this.frame();
    const device = frame.devices[0];
    if (device) this.placeHand(device, toolAsset);
    if (frame.trail) this.retrace(frame.trail);
    else if (device) this.leave(vector(device.proxy), size3(device.force));
    this.placeOther(frame.other);
    this.wish.visible = Boolean(wish);
    if (wish) {
      this.wish.position.copy(wish);
      this.wish.scale.setScalar(this.size * 0.03);
    }
    this.placePatches(frame.contacts);
    this.dirty = true;
  }

  placeObject(object) {
    let mesh = this.objects.get(object.id);
    if (!mesh) {
      mesh = new Mesh(this.geometries.get(object.asset) ?? new BufferGeometry(),
        this.materials.surface);
      mesh.userData = { asset: object.asset, id: object.id };
      this.objects.set(object.id, mesh);
      this.scene.add(mesh);
      this.framed = false;
    }
    if (mesh.userData.asset !== object.asset) {
      mesh.userData.asset = object.asset;
      mesh.geometry = this.geometries.get(object.asset) ?? new BufferGeometry();
    }
    mesh.position.copy(vector(object.position));
    mesh.quaternion.copy(turn(object.orientation));
    mesh.scale.setScalar(object.scale);
    mesh.material = object.contact ? this.materials.touched : this.materials.surface;
  }

  placeHand(device, toolAsset) {
    const { size } = this;
    const held = vector(device.proxy);
    this.proxy.visible = this.hand.visible = true;
    this.proxy.position.copy(held);
    this.proxy.scale.setScalar(size * 0.014);
    this.hand.position.copy(vector(device.position));
    this.hand.scale.setScalar(size * 0.014);
    this.point(this.force, held, device.force, size * 0.16);
    this.point(this.torque, held, device.torque, size * 4);
    this.tool.visible = device.hasTool > 0;
    if (this.tool.visible) {
      const geometry = this.geometries.get(toolAsset);
      if (geometry && this.tool.userData.geometry !== geometry) {
        this.tool.clear();
        this.tool.add(new Mesh(geometry, this.materials.tool));
        this.tool.userData.geometry = geometry;
      }
      this.tool.position.copy(vector(device.toolPosition));
      this.tool.quaternion.copy(turn(device.toolOrientation));
    }
  }

  /** The hand and the force of a second recording; undefined where there is none. */
  placeOther(device) {
    this.other.visible = this.otherForce.visible = Boolean(device);
    if (!device) return;
    const held = vector(device.proxy);
    this.other.position.copy(held);
    this.other.scale.setScalar(this.size * 0.011);
    this.point(this.otherForce, held, device.force, this.size * 0.16);
  }

  /** Draws an arrow for a vector; `scale` in m per N or N m. */
  point(arrowGroup, from, values, scale) {
    const length = size3(values) * scale;
    arrowGroup.visible = length > this.size * 0.004;
    if (!arrowGroup.visible) return;
    arrowGroup.position.copy(from);
    arrowGroup.quaternion.setFromUnitVectors(UP, vector(values).normalize());
    const shown = Math.min(length, this.size);
    const thick = Math.min(Math.max(shown, this.size * 0.12), this.size * 0.3);
    arrowGroup.scale.set(thick, shown, thick);
  }

  placePatches(contacts) {
    while (this.patches.length < contacts.length) {
      const patch = arrow(this.materials.contact);
      this.patches.push(patch);
      this.scene.add(patch);
    }
    this.patches.forEach((patch, i) => {
      if (i < contacts.length) {
        this.point(patch, vector(contacts[i].place), contacts[i].force, this.size * 0.1);
      } else {
        patch.visible = false;
      }
    });
  }

  /** Adds a place to the trail, the oldest first in its arrays. */
  leave(place, newtons) {
    const { position, color } = this.trail.geometry.attributes;
    const last = this.trailLength - 1;
    if (last >= 0 && place.distanceTo(new Vector3().fromBufferAttribute(position, last))
        < this.size * 1e-3) return;
    if (this.trailLength === TRAIL) {
      position.array.copyWithin(0, 3);
      color.array.copyWithin(0, 3);
      --this.trailLength;
    }
    rampColour(newtons / FULL_FORCE, this.mix ??= new Color());
    position.setXYZ(this.trailLength, place.x, place.y, place.z);
    color.setXYZ(this.trailLength, this.mix.r, this.mix.g, this.mix.b);
    position.needsUpdate = color.needsUpdate = true;
    this.trail.geometry.setDrawRange(0, ++this.trailLength);
  }

  /** The whole trail anew: places with the force at each, N. */
  retrace(trail) {
    const { position, color } = this.trail.geometry.attributes;
    this.mix ??= new Color();
    this.trailLength = Math.min(trail.length, TRAIL);
    trail.slice(-TRAIL).forEach(({ place, newtons }, i) => {
      rampColour(newtons / FULL_FORCE, this.mix);
      position.setXYZ(i, ...place);
      color.setXYZ(i, this.mix.r, this.mix.g, this.mix.b);
    });
    position.needsUpdate = color.needsUpdate = true;
    this.trail.geometry.setDrawRange(0, this.trailLength);
  }

  /** Where a place of the window (pixels) meets an object, or null. */
  pick(x, y) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(2 * (x - box.left) / box.width - 1, 1 - 2 * (y - box.top) / box.height);
    this.ray.setFromCamera(at, this.camera);
    const [hit] = this.ray.intersectObjects([...this.objects.values()], false);
    if (!hit) return null;
    const normal = hit.face.normal.clone().transformDirection(hit.object.matrixWorld);
    return { point: hit.point, normal, id: hit.object.userData.id };
  }

  /** Where a place of the window meets the plane through `through` that faces the camera. */
  onPlane(x, y, through) {
    this.pick(x, y);
    const { origin, direction } = this.ray.ray;
    const facing = this.camera.getWorldDirection(new Vector3());
    const way = through.clone().sub(origin).dot(facing) / direction.dot(facing);
    return origin.clone().addScaledVector(direction, way);
  }

  /** The window's place of a point, pixels. */
  project(point) {
    const box = this.canvas.getBoundingClientRect();
    const at = point.clone().project(this.camera);
    return [box.left + (at.x + 1) * box.width / 2, box.top + (1 - at.y) * box.height / 2];
  }

  draw() {
    const now = performance.now();
    const sharpens = !this.dirty && this.coarse && now - this.drawnAt > STILL;
    if (!sharpens && (!this.dirty || now - this.drawnAt < this.pause)) return;
    if (this.coarsens && this.pause && this.coarse === sharpens) {
      this.coarse = !sharpens;
      this.setPixels();
    }
    this.drawnAt = now;
    this.redraw();
  }

  /** At once; after it the canvas can be copied in the same task. */
  redraw() {
    this.dirty = false;
    for (const facing of [this.hand, this.wish]) facing.quaternion.copy(this.camera.quaternion);
    this.renderer.render(this.scene, this.camera);
  }
}
