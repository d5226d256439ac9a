// SPDX-License-Identifier: Apache-2.0
// Light or dark: as the system says, or as the button does.

/** `changed()` is called after each change. */
export function followTheme(changed) {
  const apply = (theme) => { document.documentElement.dataset.theme = theme; };
  const dark = matchMedia('(prefers-color-scheme: dark)');
  apply(dark.matches ? 'dark' : 'light');
  dark.addEventListener('change', () => {
    apply(dark.matches ? 'dark' : 'light');
    changed();
  });
  document.getElementById('theme').addEventListener('click', () => {
    apply(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
    changed();
  });
}

/** The value of a colour of the theme. */
export const themeColour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(name).trim();
