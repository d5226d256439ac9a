#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The live view's pointer and sliders, as events of a real browser."""

import math
import time
import unittest

from watched_view import Watched, prepare


def setUpModule():
    prepare()


class Drag(Watched):
    def count_events(self):
        """From now on, in `window.events`: those that the browser itself made."""
        self.browser.run("window.events = {}; window.counts = new AbortController();"
                         "for (const name of ['pointerdown', 'pointermove', 'pointerup'])"
                         "  window.addEventListener(name, (event) => {"
                         "    if (event.isTrusted) window.events[name] = (window.events[name] ?? 0) + 1; },"
                         "    {capture: true, signal: window.counts.signal})")
        self.addCleanup(self.browser.run, "window.counts.abort()")

    def test_a_pointer_that_moves_while_it_is_pressed_leads_the_hand_and_lets_go(self):
        """Press, moves and release are events of their own, as from a mouse."""
        self.count_events()
        x, y = self.on_object()
        places = [(x + 9 * i, y - 3 * i) for i in range(-3, 4)]
        seen = []
        for x, y in self.browser.drag(places):
            self.browser.wait("spmView.frame.leads === 1 && !spmView.hand.round.length")
            # The ball that the surface holds is where the pointer is.
            self.browser.wait("(([x, y]) => Math.hypot(x - arguments[0], y - arguments[1]) < 4)("
                              "  spmView.stage.project(spmView.stage.proxy.position))", x, y)
            state = self.settled()
            self.assertGreater(state["force"], 0.05)
            seen.append(self.browser.run("return [...spmView.frame.devices[0].position]"))
            if (x, y) == places[3]:
                self.picture("drag")
        for one, other in zip(seen, seen[1:]):
            self.assertGreater(math.dist(one, other), 5e-4)
        self.browser.wait("spmView.frame.devices[0].hand === 1")
        events = self.browser.run("return window.events")
        self.assertEqual((events["pointerdown"], events["pointerup"]), (1, 1))
        self.assertGreaterEqual(events["pointermove"], len(places) - 1)

    def test_a_pointer_that_sweeps_over_the_object_is_followed_without_a_pause(self):
        x, y = self.on_object()
        self.browser.press(x - 25, y)
        try:
            self.browser.wait("spmView.frame.leads === 1 && !spmView.hand.round.length")
            self.count_events()
            sent = self.browser.run("return spmView.hand.number")
            self.browser.move(x + 25, y, 800)
            # Each event becomes a command; how many there are is the browser's choice.
            told, moved = self.browser.run("return [spmView.hand.number, window.events.pointermove]")
            self.assertGreaterEqual(moved, 1)
            self.assertGreaterEqual(told - sent, moved)
            self.browser.wait("(([x, y]) => Math.hypot(x - arguments[0], y - arguments[1]) < 4)("
                              "  spmView.stage.project(spmView.stage.proxy.position))", x + 25, y)
        finally:
            self.browser.release()
        self.browser.wait("spmView.frame.devices[0].hand === 1")

    def test_a_slider_sends_what_changed_alone_and_not_more_often_than_its_pause(self):
        self.addCleanup(self.slide_stiffness, 283)
        self.browser.run("window.told = []; const link = spmView.link, send = link.send;"
                         "window.untold = () => { link.send = send; };"
                         "link.send = function (message) { if (['feel', 'cap'].includes(message.t))"
                         "  window.told.push([performance.now(), message]);"
                         "  return send.call(this, message); }")
        self.addCleanup(self.browser.run, "window.untold()")
        # Events of sliders that are where they were.
        self.browser.run("for (const name of ['stiffness', 'friction', 'damping', 'texture', 'cap'])"
                         "  document.getElementById(`slide-${name}`).dispatchEvent(new Event('input'))")
        time.sleep(0.3)
        self.assertEqual(self.browser.run("return window.told"), [])
        # Two sliders at once, by 400 events.
        self.browser.run("window.slid = 0; const one = document.getElementById('slide-stiffness'),"
                         "  other = document.getElementById('slide-damping');"
                         "(function next() { for (let i = 0; i < 10; ++i, ++window.slid)"
                         "    for (const slider of [one, other]) {"
                         "      slider.value = 300 + window.slid; slider.dispatchEvent(new Event('input')); }"
                         "  if (window.slid < 200) setTimeout(next, 4); })()")
        self.browser.wait("window.slid === 200")
        self.browser.wait("Math.abs(spmView.scene.objects[0].stiffness - 5000 * 0.499 ** 2) < 1")
        self.browser.wait("Math.abs(spmView.scene.objects[0].damping - 20 * 0.499 ** 2) < 0.01")
        told = self.browser.run("return window.told")
        pauses = [later[0] - sooner[0] for sooner, later in zip(told, told[1:])]
        self.assertGreaterEqual(min(pauses), 55)  # ms
        values = [message[1] for message in told]
        self.assertFalse(any(one == other for one, other in zip(values, values[1:])))


if __name__ == "__main__":
    unittest.main()
