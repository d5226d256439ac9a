#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What viewers of others get: a recording as MCAP, and a running daemon by the Foxglove protocol, both read
by the viewers' own npm packages."""

import json
import math
import os
import shutil
import subprocess
import tempfile
import unittest

from programs import BIN, SERVO, THIN_BAND, Case, bake_box, digest, run

PACKAGES = os.path.join(BIN, os.pardir, os.pardir, "page")
PAGE = os.path.join(BIN, os.pardir, "share", "spm-haptics", "view", "index.html")
READER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "foxglove_reader.cjs")
PATIENCE = 60.0  # s
STIFFNESS = 400.0  # N/m

WITHOUT = "" if shutil.which("node") and os.path.isdir(os.path.join(
    PACKAGES, "node_modules", "@mcap", "core")) and os.path.exists(PAGE) else (
    "npm has not got the viewers' packages: run scripts/build_page")


def read(*arguments):
    """What foxglove_reader.cjs found."""
    done = subprocess.run(["node", READER, PACKAGES, *map(str, arguments)], capture_output=True, text=True,
                          timeout=PATIENCE, check=False)
    if done.returncode:
        raise AssertionError(done.stderr)
    return json.loads(done.stdout)


@unittest.skipIf(WITHOUT, WITHOUT)
class Mcap(Case):
    @classmethod
    def setUpClass(cls):
        bake_box(cls, *THIN_BAND, "--tolerance", "100um")
        cls.recording = os.path.join(cls.models, "run.spmrec")
        done = run("run", "--asset", cls.asset, "--device", "sim", "--duration", "0.5", "--realtime", "off",
                   "--socket", "off", "--black-box", "off", "--record", cls.recording, "--method", "spm",
                   "--stiffness", f"{STIFFNESS}N/m", "--json", program=SERVO)
        assert done.returncode == 0, done.stderr
        cls.ticks = json.loads(done.stdout)["ticks"]

    def export(self, recording, name):
        return self.run_json("export-mcap", recording, self.path(name), program=SERVO)

    def test_the_formats_own_reader_gets_every_tick_with_its_force(self):
        told = self.export(self.recording, "run.mcap")
        found = read("mcap", self.path("run.mcap"))
        self.assertEqual(found["messages"], told["messages"])
        self.assertEqual(found["messages"], sum(topic["count"] for topic in found["topics"].values()))
        self.assertGreaterEqual(set(told["topics"]), set(found["topics"]))
        self.assertTrue(found["library"].startswith("spm-servo "))
        tick = found["topics"]["/hand/0/tick"]
        self.assertEqual(tick["count"], told["ticks"])
        self.assertLessEqual(told["ticks"], self.ticks)
        self.assertGreater(told["ticks"], 0.8 * self.ticks)
        self.assertEqual(tick["schema"], "spm.Tick")
        self.assertEqual(found["topics"]["/hand/0/pose"]["schema"], "foxglove.PoseInFrame")
        for topic in ("pose", "held", "force", "log"):
            self.assertTrue(found["topics"][f"/hand/0/{topic}"]["official"], topic)
        self.assertEqual(tick["lastTime"], tick["last"]["tick"] * 1_000_000)
        self.assertEqual(tick["last"]["cause"], "stopping")
        self.assertIn("no force: stopping", found["topics"]["/hand/0/log"]["last"]["message"])

    def test_equal_recordings_give_equal_bytes(self):
        for name in ("a.mcap", "b.mcap"):
            self.export(self.recording, name)
        self.assertEqual(digest(self.path("a.mcap")), digest(self.path("b.mcap")))

    def test_of_a_recording_that_was_cut_the_whole_part_is_written_and_the_rest_told(self):
        cut = self.path("cut.spmrec")
        shutil.copy(self.recording, cut)
        os.truncate(cut, os.path.getsize(cut) // 2)
        done = run("export-mcap", cut, self.path("cut.mcap"), "--json", program=SERVO)
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        self.assertFalse(told["whole"])
        self.assertIn("cut.spmrec: was cut short", done.stderr)
        found = read("mcap", self.path("cut.mcap"))
        self.assertEqual(found["topics"]["/hand/0/tick"]["count"], told["ticks"])

    def test_bad_input_is_refused_and_leaves_nothing(self):
        out = self.path("never.mcap")
        for recording, code in ((self.path("none.spmrec"), 2), (self.write("a.spmrec", b"no recording"), 3)):
            self.expect_refusal(run("export-mcap", recording, out, program=SERVO), code, recording)
        self.expect_refusal(run("export-mcap", self.recording, self.path("no", "a.mcap"), program=SERVO), 2,
                            self.path("no", "a.mcap"))
        self.assertEqual([name for name in os.listdir(self.folder) if name.endswith("mcap")], [])


@unittest.skipIf(WITHOUT, WITHOUT)
class Live(Case):
    """A daemon and its view, which all tests share."""

    @classmethod
    def setUpClass(cls):
        bake_box(cls, *THIN_BAND, "--tolerance", "100um")
        cls.room = tempfile.mkdtemp(prefix="spm-e2e-foxglove-")
        cls.addClassCleanup(shutil.rmtree, cls.room, ignore_errors=True)
        environment = {**os.environ, "XDG_RUNTIME_DIR": cls.room}
        cls.start(environment, "run", "--asset", cls.asset, "--device", "sim", "--realtime", "off",
                  "--black-box", "off", "--stiffness", f"{STIFFNESS}N/m", "--quiet",
                  stdout=subprocess.DEVNULL)
        view = cls.start(environment, "view", "--json", "--allow-origin", "https://viewer.example",
                         stdout=subprocess.PIPE, text=True)
        cls.addClassCleanup(view.stdout.close)
        cls.url = json.loads(view.stdout.readline())["foxglove"]

    @classmethod
    def start(cls, environment, *words, **how):
        process = subprocess.Popen([SERVO, *words], env=environment, **how)

        def end():
            process.terminate()
            process.wait(PATIENCE)
        cls.addClassCleanup(end)
        return process

    def test_the_viewers_own_client_sees_hand_and_force(self):
        found = read("live", self.url, 30)
        self.assertEqual(found["server"]["name"], "spm-servo view")
        self.assertEqual(found["protocol"], "foxglove.websocket.v1")
        self.assertEqual(found["statuses"], [])
        tick = found["topics"]["/hand/0/tick"]
        self.assertGreater(tick["last"]["tick"], tick["first"]["tick"])
        self.assertGreater(tick["lastTime"], tick["firstTime"])
        force = tick["last"]["force"]
        self.assertAlmostEqual(math.hypot(force["x"], force["y"], force["z"]), tick["last"]["force_size"])
        for topic in ("pose", "held", "force"):
            self.assertTrue(found["topics"][f"/hand/0/{topic}"]["official"], topic)

    def test_a_named_origin_may_watch_and_no_other(self):
        self.assertIn("topics", read("live", self.url, 1, "https://viewer.example"))
        refused = read("live", self.url, 1, "https://other.example")
        self.assertEqual(refused["refused"], 403)
        self.assertIn("--allow-origin", refused["text"])

    def test_a_wrong_token_is_refused(self):
        head, _, tail = self.url.rpartition("/")
        wrong = head[:-1] + ("0" if head[-1] != "0" else "1") + "/" + tail
        self.assertEqual(read("live", wrong, 1)["refused"], 403)


if __name__ == "__main__":
    unittest.main()
