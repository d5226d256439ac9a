#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the live view in headless Chromium: from a pointer that moved to the force that the page shows,
what the page weighs, what its scripts hold after minutes, and the ticks that the loop missed beside
--views pages and without any."""

import argparse
import gzip
import json
import statistics
import subprocess
import sys
import tempfile
import time

from soak_tools import show
from view_tools import PAGE, SERVO, Watched, bake_box, watched_box

from browser import Browser, is_there

# A press from the surface into it: from the event of the pointer to the next picture after the frame in
# which the force has risen.
MEASURE = """
const done = arguments[0], canvas = spmView.stage.canvas;
const [x, y] = spmView.stage.project(spmView.stage.middle);
const force = () => Math.hypot(...spmView.frame.devices[0].force);
const from = performance.now(), before = force();
const at = { clientX: x, clientY: y, button: 0, pointerId: 1, isPrimary: true, bubbles: true };
canvas.setPointerCapture = () => {};
canvas.dispatchEvent(new PointerEvent('pointerdown', at));
const look = () => {
  if (force() > before + 0.05 && spmView.hand.target) {
    requestAnimationFrame(() => {
      const took = performance.now() - from;
      canvas.dispatchEvent(new PointerEvent('pointerup', at));
      done(took);
    });
  } else if (performance.now() - from > 5000) done(-1);
  else requestAnimationFrame(look);
};
look();
"""


def pressed(browser):
    """ms, from a pointer's event to the picture with its force."""
    took = browser.ask("POST", f"{browser.session}/execute/async", {"script": MEASURE, "args": []})
    # The hand is slack, and rests where the surface leaves it.
    browser.wait("spmView.frame.devices[0].hand === 1")
    time.sleep(0.5)
    return took


SETTLING = 5  # s, in which a daemon, and pages, come up


def page_bytes():
    parts = b"".join(path.read_bytes() for path in sorted(PAGE.iterdir()) if path.suffix)
    return len(gzip.compress(parts, 9))


def open_page(url):
    browser = Browser(1280, 800)
    browser.open(url)
    browser.wait("window.spmView && spmView.stage && spmView.stage.framed")
    return browser


def latency(presses):
    with watched_box() as watched:
        browser = open_page(watched.url)
        try:
            # A first press brings the hand from where it waits.
            pressed(browser)
            took = sorted(pressed(browser) for _ in range(presses))
            frames = browser.run("return spmView.frames")
            time.sleep(3)
            rate = (browser.run("return spmView.frames") - frames) / 3
        finally:
            browser.close()
    return {"presses": presses, "p50_ms": statistics.median(took), "p90_ms": took[int(0.9 * len(took))],
            "max_ms": took[-1], "frames_a_second": rate}


def memory(minutes):
    """Bytes that the page's scripts hold, at the beginning and at the end."""
    with watched_box() as watched:
        browser = open_page(watched.url)
        try:
            time.sleep(min(20, 20 * minutes))
            samples = [browser.heap()]
            deadline = time.monotonic() + 60 * minutes
            while time.monotonic() < deadline:
                pressed(browser)
                time.sleep(min(10, 6 * minutes))
                samples.append(browser.heap())
            errors = browser.errors()
        finally:
            browser.close()
    return {"minutes": minutes, "first_bytes": samples[0], "last_bytes": samples[-1],
            "largest_bytes": max(samples), "errors": errors}


def missed(seconds, views):
    """Ticks that a loop missed with and without pages, in turns on the same machine."""
    rows = {}
    with tempfile.TemporaryDirectory(prefix="spm-view-") as models:
        asset = bake_box(models)
        for pages in (0, 1, views):
            with tempfile.TemporaryDirectory(prefix="spm-view-") as folder:
                watched = Watched(folder, asset, "try")
                browsers = [open_page(watched.url) for _ in range(pages)]
                try:
                    time.sleep(SETTLING)
                    before = look(watched)
                    time.sleep(seconds)
                    after = look(watched)
                finally:
                    for browser in browsers:
                        browser.close()
                rows[str(pages)] = counts_between(before, after)
                watched.end()
    return {"seconds": seconds, "pages": rows}


def look(watched):
    """What `top` says of the daemon."""
    done = subprocess.run([SERVO, "top", "--once", "--json"], env=watched.environment,
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"view.py: {done.stderr}")
    return json.loads(done.stdout)


def counts_between(first, last):
    return {"ticks": last["ticks"] - first["ticks"],
            "missed": last["missed"]["total"] - first["missed"]["total"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--presses", type=int, default=50)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seconds", type=float, default=30)
    parser.add_argument("--views", type=int, default=4)
    parser.add_argument("--out", metavar="PREFIX")
    options = parser.parse_args()
    if not is_there() or not PAGE.is_dir():
        print("view.py: it needs chromium, chromium-driver and the built page (scripts/build_page)",
              file=sys.stderr)
        return 5
    report = {"page_gzip_bytes": page_bytes(), "latency": latency(options.presses),
              "missed": missed(options.seconds, options.views), "memory": memory(options.minutes)}
    seen, held, lost = report["latency"], report["memory"], report["missed"]
    rows = [["page with gzip, kB", report["page_gzip_bytes"] / 1e3],
            ["presses", seen["presses"]],
            ["pointer moved to force seen, p50, ms", seen["p50_ms"]],
            ["pointer moved to force seen, p90, ms", seen["p90_ms"]],
            ["pointer moved to force seen, max, ms", seen["max_ms"]],
            ["frames that come, a second", seen["frames_a_second"]],
            *[[f"{pages} pages open: ticks missed of {row['ticks']:,}", row["missed"]]
              for pages, row in lost["pages"].items()],
            ["minutes that a page was open and pressed", held["minutes"]],
            ["its scripts hold at first, MB", held["first_bytes"] / 1e6],
            ["its scripts hold at last, MB", held["last_bytes"] / 1e6],
            ["errors on its console", len(held["errors"])]]
    show(options.out, "The live view in headless Chromium, drawn in software", ["what", "found"], rows,
         report)
    return 0


if __name__ == "__main__":
    sys.exit(main())
