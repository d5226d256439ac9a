#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the live view shows of a scene, first, in part, and after the daemon has ended."""

import unittest

from watched_view import Other, Watched, prepare

FRAMED = "window.spmView && spmView.stage && spmView.stage.framed"


def setUpModule():
    prepare()


class Seen(Other):
    def test_the_first_view_shows_objects_tool_and_hand(self):
        browser = self.watched('[tool]\nasset = "tool.spm.exr"\nscale = 0.3\n\n'
                               '[[object]]\nasset = "box.spm.exr"\n')
        browser.wait(f"{FRAMED} && spmView.stage.tool.children.length")
        left, top, right, bottom, places = browser.run(
            "const s = spmView.stage, box = s.canvas.getBoundingClientRect();"
            "const meshes = [...s.objects.values(), ...s.tool.children];"
            "const corners = meshes.flatMap((mesh) => { mesh.geometry.computeBoundingBox();"
            "  const {min, max} = mesh.geometry.boundingBox; return [0, 1, 2, 3, 4, 5, 6, 7].map((i) =>"
            "    min.clone().set(...['x', 'y', 'z'].map((axis, bit) => (i >> bit & 1 ? max : min)[axis]))"
            "      .applyMatrix4(mesh.matrixWorld)); });"
            "return [box.left, box.top, box.right, box.bottom,"
            "  [s.hand.position, ...corners].map((place) => s.project(place))]")
        for x, y in places:
            self.assertTrue(left < x < right and top < y < bottom, (x, y))

    def test_what_is_fixed_is_seen_through_or_cut_open_to_see_what_is_in_it(self):
        """A small box that can be moved, in the middle of a large one that cannot."""
        browser = self.watched('[[object]]\nasset = "box.spm.exr"\n\n[[object]]\nasset = "box.spm.exr"\n'
                               'scale = 0.3\nmovable = true\n')
        browser.wait(f"{FRAMED} && spmView.stage.objects.size === 2")

        # As many pixels in each picture.
        browser.run("const s = spmView.stage; s.coarsens = s.coarse = false; s.setPixels()")

        def middle(look):
            browser.run("const look = document.getElementById('look'); look.value = arguments[0];"
                        "look.dispatchEvent(new Event('change'))", look)
            return browser.run(
                "const s = spmView.stage, gl = s.renderer.getContext(), width = gl.drawingBufferWidth,"
                "  line = new Uint8Array(4 * width), [x, y] = s.project(s.middle),"
                "  box = s.canvas.getBoundingClientRect(); s.redraw();"
                "gl.readPixels(0, (box.bottom - y) * gl.drawingBufferHeight / box.height, width, 1, gl.RGBA,"
                "  gl.UNSIGNED_BYTE, line); return {object: s.pick(x, y).id, colours: line.join()}")

        whole, through, cut = middle("whole"), middle("through"), middle("cut")
        self.assertEqual((whole["object"], through["object"], cut["object"]), (0, 0, 1))
        self.assertEqual(len({whole["colours"], through["colours"], cut["colours"]}), 3)
        self.assertFalse(browser.run("return document.getElementById('cut-line').hidden"))
        self.assertEqual(middle("whole")["object"], 0)
        self.assertEqual(browser.errors(), [])

    def test_after_the_daemon_ended_nothing_is_told_as_of_now(self):
        browser = self.watched('[[object]]\nasset = "box.spm.exr"\n')
        browser.wait(FRAMED)
        labels = "spmView.charts.plots.map((plot) => plot.axes[0]._values.at(-1))"
        browser.wait(f"{labels}.every((label) => label === 'now')")
        browser.press(*browser.run("return spmView.stage.project(spmView.stage.middle)"))
        browser.wait("spmView.stage.force.visible")
        Watched.end(self.daemon)
        browser.wait("document.getElementById('status').textContent === 'ended'")
        browser.wait(f"{labels}.every((label) => label === 'end')")
        self.assertEqual(set(browser.run("return [...document.querySelectorAll('#facts dd'), ...document"
                                         ".querySelectorAll('.chart h2 span:last-child')]"
                                         ".map((value) => value.textContent[0])")), {"–"})
        self.assertIn("start", browser.run("return document.getElementById('held').textContent"))
        self.assertFalse(browser.run("return spmView.stage.force.visible"))
        self.assertTrue(browser.run("return document.getElementById('feel').inert"))
        self.assertIsNone(browser.run("return spmView.hand.target"))
        browser.release()
        self.assertEqual(browser.errors(), [])

    def test_a_scene_of_two_hundred_objects_says_how_many_of_them_are_shown(self):
        browser = self.watched("".join(f'[[object]]\nasset = "box.spm.exr"\npose = [{0.2 * (i % 20)}, 0, '
                                       f"{0.2 * (i // 20)}]\n" for i in range(200)))
        browser.wait("window.spmView && spmView.frame && spmView.frame.objectTotal === 200")
        browser.wait("document.getElementById('facts').textContent.includes('64 of 200 objects')")
        browser.wait("spmView.stage.objects.size === 64")
        frames = browser.run("return spmView.frames")
        browser.wait(f"spmView.frames > {frames} + 20")
        self.assertEqual(browser.errors(), [])


if __name__ == "__main__":
    unittest.main()
