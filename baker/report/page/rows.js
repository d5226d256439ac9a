// SPDX-License-Identifier: Apache-2.0

/** Three digits that count. */
export const short = (value) => (Number.isFinite(value) ? Number(value.toPrecision(3)).toLocaleString('en',
  { maximumSignificantDigits: 3 }) : 'none');

export function row(cells) {
  const line = document.createElement('tr');
  line.append(...cells.map((text) => {
    const cell = document.createElement('td');
    cell.textContent = text;
    return cell;
  }));
  return line;
}

export function fill(table, lines) {
  table.tBodies[0].append(...lines.map(row));
}
