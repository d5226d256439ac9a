#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How `spm-servo run` starts: what it says first, and what many assets cost."""

import fcntl
import os
import re
import shutil
import subprocess
import time
import unittest

from programs import SERVO, THIN_BAND, Case, bake_box

ASSETS = 50
LONG = 30  # s, for what is done at once
WRITE = "1 0x2 "  # /proc/PID/syscall of x86-64: write to standard error


def status_of(process, key):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        return int(re.search(rf"^{key}:\s+(\d+)", file.read(), re.MULTILINE).group(1))


class Start(Case):
    @classmethod
    def setUpClass(cls):
        bake_box(cls, "--tolerance", "200um", *THIN_BAND)

    def servo(self, *options, stderr=subprocess.PIPE):
        process = subprocess.Popen([SERVO, "run", "--device", "sim", "--socket", "off", *options],
                                   stdout=subprocess.DEVNULL, stderr=stderr)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def test_it_says_what_it_serves_before_the_first_tick(self):
        """Standard error is a full pipe, so the program waits in the middle of its first line. The
        thread of the ticks comes only after that."""
        read, write = os.pipe()
        fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, 4096)
        os.write(write, b"x" * fcntl.fcntl(write, fcntl.F_GETPIPE_SZ))
        process = self.servo("--asset", self.asset, stderr=write)
        os.close(write)
        self.wait_until_it_writes(process)
        waiting = status_of(process, "Threads")
        with os.fdopen(read, "rb") as pipe:
            said = b""
            while b"\n" not in said:
                said += pipe.read1().lstrip(b"x")
            self.wait_for(lambda: status_of(process, "Threads") > waiting)
            process.terminate()
            self.assertEqual(process.wait(LONG), 0)
        for words in ("serving", self.asset, "200 um", "1000 Hz", "on sim", "Ctrl-C"):
            self.assertIn(words, said.decode().splitlines()[0])

    def test_a_run_lasts_as_long_as_is_said_in_seconds_or_with_a_unit(self):
        for text, ticks in (("0.2", 200), ("200ms", 200), ("0.2s", 200), ("0.004min", 240)):
            with self.subTest(text):
                report = self.run_json("run", "--asset", self.asset, "--device", "sim:hand=live",
                                       "--realtime", "off", "--socket", "off", "--black-box", "off",
                                       "--duration", text, program=SERVO)
                # A machine that is busy skips ticks beyond the end too.
                self.assertGreaterEqual(report["ticks"] + report["skipped"], ticks)
                self.assertLess(report["ticks"], 1.1 * ticks)

    def wait_until_it_writes(self, process):
        end = time.monotonic() + LONG
        while time.monotonic() < end:
            try:
                with open(f"/proc/{process.pid}/syscall", encoding="ascii") as file:
                    if file.read().startswith(WRITE):
                        return
            except OSError:
                self.skipTest("the kernel does not tell what a program waits for")
            if process.poll() is not None:
                self.fail("it ended before it said anything")
            time.sleep(0.01)
        self.skipTest("the kernel does not tell what a program waits for")

    def test_fifty_assets_take_no_more_threads_and_hardly_more_locked_memory_than_one(self):
        """Of each thread the whole stack is locked, which is more than most assets."""
        text = ""
        for k in range(ASSETS):
            shutil.copy(self.asset, self.path(f"a{k}.spm.exr"))
            text += f'[[object]]\nasset = "a{k}.spm.exr"\npose = [{0.15 * k}, 0, 0]\n\n'
        scene = self.write("scene.toml", text)
        many = self.measured("--scene", scene)
        shutil.copy(self.asset, self.path("a.spm.exr"))
        one = self.measured("--scene", self.write("one.toml", '[[object]]\nasset = "a.spm.exr"\n'))
        self.assertEqual(many["Threads"], one["Threads"])
        # What is locked is all or nothing; a stack is 8 MB.
        self.assertLess(many["VmLck"] - one["VmLck"], 8 * 1024)

    def measured(self, *options):
        process = self.servo(*options)
        self.assertIn(b"serving", process.stderr.readline())
        # Once it serves, its threads start, and then the memory is locked.
        numbers, same = {}, 0
        for _ in range(2 * LONG):
            before, numbers = numbers, {k: status_of(process, k) for k in ("Threads", "VmLck")}
            same = same + 1 if before == numbers else 0
            if same == 4:
                break
            time.sleep(0.5)
        process.terminate()
        process.communicate(timeout=LONG)
        return numbers


if __name__ == "__main__":
    unittest.main()
