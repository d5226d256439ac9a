// SPDX-License-Identifier: Apache-2.0
// The scene in 3D: objects, hand, proxy, tool, force, torque, contacts and the trail.

import {
  AmbientLight, BackSide, BufferAttribute, BufferGeometry, Color, CylinderGeometry, ConeGeometry,
  DirectionalLight, DoubleSide, DynamicDrawUsage, GridHelper, Group, Line, LineBasicMaterial,
  Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Plane, Quaternion, Raycaster,
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
const FAR = 8; // of the objects' radius: a hand that is farther from their middle is not in the first view
const THROUGH = 0.35; // how opaque objects are that are seen through
const FULL_FORCE = 3; // N, of the trail's brightest colour
// From no force to FULL_FORCE: cividis, safe for the colour-blind, without the end that is lost on the
// ground of the theme.
const CIVIDIS = ['#35456c', '#666970', '#948e77', '#c8b866', '#fee838'].map((text) => new Color(text));
const RAMPS = { dark: CIVIDIS, light: [...CIVIDIS.slice(0, -1).reverse(), new Color('#00224e')] };

const UP = new Vector3(0, 1, 0);
const BACK = new Vector3(0.5, 0.42, 0.85).normalize(); // from what is seen to the camera, at first
const BORDER = 1.15; // of the window, beside what is seen
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
    this.renderer.localClippingEnabled = true;
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(40, 1, 1e-4, 100);
    this.camera.position.set(0.5, 0.4, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => { this.dirty = true; });
    this.controls.addEventListener('start', () => { this.taken = true; });
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(0.5, 0.9, 1);
    this.camera.add(sun);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 0.9));
    this.objects = new Map();
    this.geometries = new Map();
    this.size = 0.1;
    this.framed = false;
    this.taken = false; // the user turned the view or touched an object: it is not turned by itself any more
    this.look = 'whole';
    this.cutAt = 0.5;
    this.cut = new Plane();
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
      // Of what the scene holds fast, which may be seen through or cut open.
      fixed: new MeshLambertMaterial(), fixedTouched: new MeshLambertMaterial(),
      // The inside of what was cut open, in one flat colour: so it looks filled.
      section: new MeshBasicMaterial({ side: BackSide, clippingPlanes: [this.cut] }),
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
    materials.surface.color = materials.fixed.color = themed('--surface');
    materials.touched.color = materials.fixedTouched.color = themed('--surface').lerp(themed('--late'), 0.22);
    materials.section.color = themed('--surface').lerp(themed('--depth'), 0.45);
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

  /** Gives the surface of an asset: the bytes that to_bytes() of mesh_bytes.hpp makes. */
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
      if (mesh.userData.asset === asset) mesh.geometry = mesh.userData.inside.geometry = geometry;
    }
    this.framed = false;
    this.dirty = true;
  }

  /** Where the hand goes: what is seen where no object is drawn. */
  setPath(places) {
    this.path = new Sphere().setFromPoints(places.map(vector));
    this.path.radius = Math.max(this.path.radius, 1e-3);
  }

  /** A sphere about what is drawn of some meshes. */
  around(meshes) {
    const all = new Sphere();
    all.makeEmpty();
    for (const mesh of meshes) {
      if (!mesh.geometry.boundingSphere) continue;
      mesh.updateWorldMatrix(true, false);
      all.union(mesh.geometry.boundingSphere.clone().applyMatrix4(mesh.matrixWorld));
    }
    return all;
  }

  /** Takes the scene's size from its objects, or else from the hand's path; false where there is
   *  neither. */
  measure() {
    const all = this.around(this.objects.values());
    if (all.isEmpty() && this.path) all.copy(this.path);
    if (all.isEmpty()) return false;
    this.middle = all.center;
    this.size = Math.max(2 * all.radius, 1e-4);
    this.layGrid();
    return true;
  }

  /** Puts the camera where it sees all objects, the tool and the hand. */
  frame() {
    if (!this.measure()) return false;
    const all = [new Sphere(this.middle, this.size / 2)];
    if (this.path) all.push(this.path);
    if (this.hand.visible) all.push(new Sphere(this.hand.position, 0.03 * this.size));
    if (this.tool.visible) all.push(this.around(this.tool.children));
    const most = FAR * this.size / 2;
    this.lookAt(all.filter(({ center, radius }) => radius >= 0 && center.distanceTo(this.middle) < most));
    return true;
  }

  /** Puts the camera as near as it may come and still sees some spheres whole, from the usual side. */
  lookAt(spheres) {
    const { camera, controls: { target } } = this;
    const right = new Vector3().crossVectors(UP, BACK).normalize(), up = BACK.clone().cross(right);
    const tall = Math.tan(camera.fov * Math.PI / 360) / BORDER, wide = tall * camera.aspect;
    target.copy(spheres[0].center);
    let away = 0;
    for (let pass = 0; pass < 8; ++pass) {
      const seen = spheres.map(({ center, radius }) => {
        const from = center.clone().sub(target);
        return { x: from.dot(right), y: from.dot(up), z: from.dot(BACK), radius };
      });
      away = Math.max(...seen.flatMap(({ x, y, z, radius }) => [
        z + (Math.abs(x) + radius * Math.hypot(1, wide)) / wide,
        z + (Math.abs(y) + radius * Math.hypot(1, tall)) / tall]));
      // What is seen comes to lie in the middle.
      const middle = (axis) => (Math.min(...seen.map((s) => (s[axis] - s.radius) / (away - s.z)))
        + Math.max(...seen.map((s) => (s[axis] + s.radius) / (away - s.z)))) / 2;
      target.addScaledVector(right, away * middle('x')).addScaledVector(up, away * middle('y'));
    }
    camera.position.copy(target).addScaledVector(BACK, away);
    camera.near = away / 200;
    camera.far = away * 20;
    camera.updateProjectionMatrix();
    this.controls.update();
  }

  /** How objects that cannot be moved are drawn, or all where each can be: `whole`, `through` (seen
   *  through) or `cut` (open towards the viewer), so that a peg is seen in its hole. `share`, 0 to 1:
   *  where the cut is, from the nearest to the farthest place of the scene. */
  setLook(look, share = this.cutAt) {
    this.look = look;
    this.cutAt = share;
    const through = look === 'through', cut = look === 'cut';
    for (const material of [this.materials.fixed, this.materials.fixedTouched]) {
      Object.assign(material, { transparent: through, opacity: through ? THROUGH : 1, depthWrite: !through,
        clippingPlanes: cut ? [this.cut] : null, needsUpdate: true });
    }
    for (const { userData } of this.objects.values()) userData.inside.visible = cut && userData.isFixed;
    this.dirty = true;
  }

  /** The plane of the cut faces the viewer. */
  placeCut() {
    const facing = this.camera.getWorldDirection(new Vector3());
    const at = (this.middle ?? new Vector3()).clone().addScaledVector(facing, (this.cutAt - 0.5) * this.size);
    this.cut.setFromNormalAndCoplanarPoint(facing, at);
  }

  /** The last that was seen of a daemon that is gone: no force, and nothing that is touched. */
  setOver(over) {
    if (this.over === over) return;
    this.over = over;
    this.canvas.dataset.over = over;
    for (const now of [this.force, this.torque, ...this.patches]) now.visible &&= !over;
    this.body = [];
    this.dirty = true;
  }

  /** Shows a frame; `wish` is where the page leads the hand, or null. */
  show(frame, wish, toolAsset) {
    if (this.framed && isSame(frame.body, this.body) && wish === this.wished) return;
    this.body = frame.body;
    this.wished = wish;
    const seen = new Set();
    const allMovable = frame.objects.every(({ movable }) => movable);
    for (const object of frame.objects) {
      seen.add(object.id);
      this.placeObject(object, allMovable || !object.movable);
    }
    for (const [id, mesh] of this.objects) {
      if (seen.has(id)) continue;
      mesh.removeFromParent();
      this.objects.delete(id);
    }
    const device = frame.devices[0];
    if (device) this.placeHand(device, toolAsset);
    if (!this.framed && this.geometries.size) this.framed = this.taken ? this.measure() : this.frame();
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

  placeObject(object, isFixed) {
    let mesh = this.objects.get(object.id);
    if (!mesh) {
      mesh = new Mesh(this.geometries.get(object.asset) ?? new BufferGeometry(),
        this.materials.surface);
      mesh.userData = { asset: object.asset, id: object.id, inside: new Mesh(mesh.geometry, this.materials.section) };
      mesh.add(mesh.userData.inside);
      this.objects.set(object.id, mesh);
      this.scene.add(mesh);
      this.framed = false;
    }
    if (mesh.userData.asset !== object.asset) {
      mesh.userData.asset = object.asset;
      mesh.geometry = mesh.userData.inside.geometry = this.geometries.get(object.asset) ?? new BufferGeometry();
    }
    mesh.position.copy(vector(object.position));
    mesh.quaternion.copy(turn(object.orientation));
    mesh.scale.setScalar(object.scale);
    const { fixed, fixedTouched, surface, touched } = this.materials;
    if (isFixed) mesh.material = object.contact ? fixedTouched : fixed;
    else mesh.material = object.contact ? touched : surface;
    mesh.userData.isFixed = isFixed;
    mesh.userData.inside.visible = isFixed && this.look === 'cut';
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
    arrowGroup.visible = !this.over && length > this.size * 0.004;
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
    this.placeCut();
    const hit = this.ray.intersectObjects([...this.objects.values()], false)
      .find(({ object, point }) => this.look !== 'cut' || !object.userData.isFixed
        || this.cut.distanceToPoint(point) >= 0);
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
    this.placeCut();
    this.renderer.render(this.scene, this.camera);
  }
}
