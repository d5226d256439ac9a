// SPDX-License-Identifier: Apache-2.0
// The colours of errors: those of spm-bake's pictures, dark blue over green to pale yellow, which
// also the colour-blind tell apart, and red beyond.

export const RAMP = [[0.17, 0.17, 0.40], [0.16, 0.39, 0.53], [0.19, 0.60, 0.54], [0.57, 0.79, 0.40],
  [0.98, 0.92, 0.55]]; // ramp_at() of baker/pictures/picture.cpp
export const BEYOND = '#d91a1a';
export const UNKNOWN = [0.5, 0.5, 0.5];

export function colourAt(share) {
  const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1);
  const low = Math.min(Math.floor(at), RAMP.length - 2);
  return RAMP[low].map((part, i) => part + (at - low) * (RAMP[low + 1][i] - part));
}

export const colourText = (share) => `rgb(${colourAt(share).map((part) => Math.round(255 * part)).join()})`;
