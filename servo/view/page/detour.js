// SPDX-License-Identifier: Apache-2.0
// The way of a hand to a place that an object hides from it: a real hand would go round the object too.

import { Quaternion, Raycaster, Vector3 } from 'three';

const SLACK = 0.02; // of the scene's size: the hand may lie on a surface, and the spot does
const OUTSIDE = 0.6; // of the scene's size, from its middle: clear of all objects
const STEP = Math.PI / 5; // rad, round the scene

/** Whether an object lies between the hand and a spot of a surface, seen from just outside the spot. */
function isHidden(stage, hand, spot) {
  const slack = SLACK * stage.size;
  const outside = spot.point.clone().addScaledVector(spot.normal, slack);
  const way = hand.clone().sub(outside), length = way.length();
  if (length < 2 * slack) return false;
  const ray = new Raycaster(outside, way.divideScalar(length), 0, length - slack);
  return ray.intersectObjects([...stage.objects.values()], false).length > 0;
}

/** The places to go through: out, round the scene, and in along the line of sight; none where nothing
 *  is in the way. */
export function detour(stage, hand, spot) {
  if (!stage.middle || !isHidden(stage, hand, spot)) return [];
  const { middle, size } = stage, radius = OUTSIDE * size;
  const begin = hand.clone().sub(middle).normalize();
  const sight = stage.camera.position.clone().sub(spot.point).normalize();
  const end = spot.point.clone().addScaledVector(sight, size).sub(middle).normalize();
  if (begin.lengthSq() === 0) begin.copy(end);
  const whole = new Quaternion().setFromUnitVectors(begin, end);
  const count = Math.ceil(begin.angleTo(end) / STEP) + 1;
  return Array.from({ length: count }, (_, i) => {
    const turn = new Quaternion().slerp(whole, count > 1 ? i / (count - 1) : 1);
    return begin.clone().applyQuaternion(turn).multiplyScalar(radius).add(middle);
  });
}
