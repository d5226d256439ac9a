// SPDX-License-Identifier: Apache-2.0
// How objects are drawn: whole, seen through, or cut open.

const by = (id) => document.getElementById(id);

export function offerLooks(stage) {
  const change = () => {
    by('cut-line').hidden = by('look').value !== 'cut';
    stage.setLook(by('look').value, by('cut').value / 100);
  };
  by('look').addEventListener('change', change);
  by('cut').addEventListener('input', change);
  change();
}
