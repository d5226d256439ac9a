#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Python and the C# package, against one server.

Usage: client_package_test.py [unittest options]; in the build folder, or with the environment of
client_daemon.py.
"""

import ctypes
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from client_daemon import (CAN_C_SHARP, C_SHARP_FOLDER, LIBRARY, PATIENCE, SOURCE, WithDaemon,
                           c_sharp_environment, compile_c_sharp, eventually)
from client_structs import STRUCTS, header_sizes
from made_checkout import find_in_checkout

import spm_client_library
from spm_client import (Cause, Client, ClientError, Code, DaemonState, Effect, EffectKind, EventKind,
                        HandState, Material, Method)


class Package(WithDaemon):
    def test_the_daemon_is_described(self) -> None:
        info = self.client().info()
        self.assertEqual((info.devices, info.assets, info.objects), (["hand"], ["bunny"], ["first"]))
        self.assertEqual(info.rate_hz, 1000)
        self.assertEqual(info.process, self.daemon.pid)
        self.assertEqual(info.daemon_version, info.library_version)

    def test_the_state_moves_on_with_the_ticks(self) -> None:
        client = self.client()
        self.assertTrue(eventually(lambda: client.daemon_state()[0] == DaemonState.RUNNING))
        first = client.device(0)
        self.assertTrue(eventually(lambda: client.device(0).tick > first.tick + 10))
        later = client.device(0)
        self.assertAlmostEqual(later.position[0], later.tick * 1e-6, places=12)
        devices, objects = client.all()
        self.assertEqual((len(devices), len(objects)), (1, 1))

    def test_objects_are_added_moved_and_removed(self) -> None:
        client = self.client()
        added = client.add(0, (0.1, 0.0, 0.0), scale=2.0,
                           material=Material(stiffness=800.0, friction=(0.5, 0.4),
                                             texture=(5e-5, 1e-3, 3)))
        self.assertTrue(eventually(lambda: len(client.all()[1]) == 2))
        client.move(added, (0.2, 0.3, 0.4), (0.0, 1.0, 0.0, 0.0), period=1 / 90)
        self.assertTrue(eventually(lambda: client.object(added).position == (0.2, 0.3, 0.4)))
        self.assertEqual(client.object(added).orientation, (0.0, 1.0, 0.0, 0.0))
        client.set_material(added, Material(damping=2.0))
        client.set_clutch(0, True)
        client.remove(added)
        self.assertTrue(eventually(lambda: len(client.all()[1]) == 1))
        self.assertEqual(client.refusals().refused, 0)

    def test_a_hand_is_pushed_and_gets_effects(self) -> None:
        client = self.client()
        client.push(0, (0.0, 0.5, 0.0), 0.1)
        for number, kind in enumerate(EffectKind):
            client.set_effect(0, number, Effect(kind, stiffness=100.0, damping=1.0, range=0.02,
                                                most_force=1.0, spacing=0.004,
                                                axis=(0.0, 1.0, 0.0)))
        client.remove_effect(0, 2)
        client.remove_effect(0)
        self.assertTrue(eventually(lambda: client.refusals().taken == 7))
        self.assertEqual(client.refusals().refused, 0)
        for wrong in (lambda: client.push(0, (math.nan, 0.0, 0.0), 0.1),
                      lambda: client.push(0, (1e9, 0.0, 0.0), 0.1),
                      lambda: client.push(0, (1.0, 0.0, 0.0), 2.0),
                      lambda: client.set_effect(0, 0, Effect(EffectKind.DETENTS, stiffness=1.0))):
            with self.assertRaises(ClientError) as caught:
                wrong()
            self.assertEqual(caught.exception.code, Code.BAD_ARGUMENT)
        with self.assertRaises(ClientError) as caught:
            client.push(7, (1.0, 0.0, 0.0), 0.1)
        self.assertEqual(caught.exception.code, Code.NOT_THERE)

    def test_a_hand_is_led_and_let_go_and_belongs_to_the_first(self) -> None:
        client, other = self.client(), self.client(application="other")
        self.assertEqual(client.device(0).hand, HandState.FREE)
        client.lead_hand(0, (0.0, 0.01, 0.0), hold=1.0)
        self.assertTrue(eventually(lambda: client.device(0).hand == HandState.LED))
        other.lead_hand(0, (0.0, 0.02, 0.0))
        self.assertTrue(eventually(lambda: other.refusals().refused == 1))
        client.free_hand(0)
        self.assertTrue(eventually(lambda: client.device(0).hand == HandState.FREE))
        for wrong in (lambda: client.lead_hand(0, (math.nan, 0.0, 0.0)),
                      lambda: client.lead_hand(0, (0.0, 0.0, 0.0), hold=2.0)):
            with self.assertRaises(ClientError) as caught:
                wrong()
            self.assertEqual(caught.exception.code, Code.BAD_ARGUMENT)

    def test_how_an_object_feels_and_where_its_asset_lies_is_read(self) -> None:
        # What tests/servo/support/loop_stand_in.cpp has.
        client = self.client()
        feel = client.feel(0)
        self.assertEqual((feel.method, feel.stabilized, feel.stiffness), (Method.SPM, True, 750))
        self.assertEqual((feel.friction, feel.texture[2]), ((0.5, 0.4), 3))
        self.assertEqual(client.asset_path(0), "/models/bunny.spm.exr")
        self.assertEqual(client.borders(0), (900, 1800))
        for wrong in (lambda: client.feel(4711), lambda: client.asset_path(7),
                      lambda: client.borders(7)):
            with self.assertRaises(ClientError) as caught:
                wrong()
            self.assertEqual(caught.exception.code, Code.NOT_THERE)

    def test_the_tool_and_where_it_touches_are_read(self) -> None:
        client = self.client()
        self.assertEqual(client.contacts(0), [])
        hand = client.device(0)
        self.assertTrue(hand.has_tool)
        self.assertEqual((hand.tool_position[:2], hand.tool_orientation), ((0.5, 0.25), (0, 1, 0, 0)))
        self.tell("c")
        self.assertTrue(eventually(lambda: len(client.contacts(0)) == 2))
        first, second = client.contacts(0)
        self.assertEqual((first.place, first.normal, first.force), ((0.1, 0.2, 0.3), (0, 1, 0), (0, 2, 0)))
        self.assertEqual((first.depth, first.object, second.object), (1e-3, 0, 7))
        self.assertEqual(client.device(0).contact_count, 2)

    def test_what_cannot_be_done_is_told_with_its_reason(self) -> None:
        client = self.client()
        with self.assertRaises(ClientError) as caught:
            client.move(4711, (0.0, 0.0, 0.0))
        self.assertEqual(caught.exception.code, Code.NOT_THERE)
        self.assertIn("no such object", str(caught.exception))
        with self.assertRaises(ClientError) as caught:
            client.move(0, (0.0, 0.0))
        self.assertEqual(str(caught.exception), "position has 2 numbers: it has to have 3")
        # Of its own objects a client cannot know whether the loop has come to them.
        own = client.add(0)
        client.remove(own)
        client.move(own, (0.0, 0.0, 0.0))
        self.assertTrue(eventually(lambda: client.refusals().refused == 1))
        self.assertIn("no such object", client.refusals().reason)
        for wrong in (lambda: client.move(0, (math.nan, 0.0, 0.0)),
                      lambda: client.move(0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))):
            with self.assertRaises(ClientError) as caught:
                wrong()
            self.assertEqual(caught.exception.code, Code.BAD_ARGUMENT)
        with self.assertRaises(ClientError) as caught:
            client.add(7)
        self.assertEqual(caught.exception.code, Code.NOT_THERE)

    def test_a_cause_of_zero_force_comes_with_its_cure(self) -> None:
        client = self.client()
        self.tell("g")
        self.assertTrue(eventually(lambda: client.device(0).cause == Cause.DEVICE_GONE))
        self.assertTrue(client.device(0).cause_text.startswith("device_gone: "))
        self.assertIn("plug", client.device(0).cause_text)
        client.acknowledge(0)  # which the test daemon takes as the end of the fault
        self.assertTrue(eventually(lambda: client.device(0).cause_text == ""))
        with self.assertRaises(ClientError):
            client.acknowledge(7)

    def test_events_are_told_once(self) -> None:
        client = self.client()
        self.assertTrue(eventually(lambda: client.daemon_state()[0] == DaemonState.RUNNING))
        self.assertEqual(list(client.events()), [])
        kinds: list[EventKind] = []

        def has(kind: EventKind) -> bool:
            kinds.extend(event.kind for event in client.events())
            return kind in kinds

        self.tell("c")
        self.assertTrue(eventually(lambda: has(EventKind.CONTACT_BEGAN)))
        self.tell("fb")
        self.assertTrue(eventually(lambda: has(EventKind.CONTACT_ENDED)))
        self.assertTrue(eventually(lambda: has(EventKind.BUTTON_PRESSED)))
        self.assertEqual(kinds.count(EventKind.CONTACT_BEGAN), 1)

    def test_what_the_loop_counted_is_read(self) -> None:
        client = self.client(application="counts")
        self.tell("c")
        self.assertTrue(eventually(lambda: client.daemon_state()[0] == DaemonState.RUNNING and
                                   client.device_counts().contact_ticks > 0))
        # What tests/servo/support/loop_stand_in.cpp counts.
        loop, counts = client.loop(), client.device_counts()
        self.assertEqual((loop.missed, loop.skipped), (loop.ticks + 7, loop.ticks + 8))
        self.assertEqual((sum(loop.wake), sum(loop.busy)), (loop.ticks, loop.ticks))
        self.assertEqual((loop.wake[1], loop.busy[3]), (loop.ticks, loop.ticks))
        self.assertAlmostEqual(client.bucket_end(1), 256e-9)
        self.assertEqual((counts.cap_hits, counts.slew_hits), (12, 13))
        self.assertEqual((counts.force_max, counts.energy, counts.generated_max), (1.5, 2.5, 3.5))
        self.assertEqual([(one.name, one.process) for one in client.applications()],
                         [("counts", os.getpid())])

    def test_a_daemon_that_is_killed_is_gone(self) -> None:
        client = self.client()
        self.daemon.kill()
        self.daemon.wait()
        self.daemon.stdin.close()
        self.assertEqual(client.daemon_state()[0], DaemonState.GONE)
        with self.assertRaises(ClientError) as caught:
            Client(path=self.socket)
        self.assertEqual(caught.exception.code, Code.NO_DAEMON)
        self.assertIn("has ended", str(caught.exception))

    def test_without_a_daemon_the_error_names_the_cure(self) -> None:
        with self.assertRaises(ClientError) as caught:
            Client(path=self.socket + ".not")
        self.assertEqual(caught.exception.code, Code.NO_DAEMON)
        self.assertIn("spm-servo run", str(caught.exception))

    def test_ticks_are_waited_for_one_by_one(self) -> None:
        with self.client() as client:
            ticks = [client.wait_tick(timeout=PATIENCE)]
            for _ in range(5):
                ticks.append(client.wait_tick(ticks[-1], timeout=PATIENCE))
            self.assertEqual(ticks, sorted(set(ticks)))
            self.assertIsNone(client.wait_tick(2**63, timeout=0.01))
            client.set_force_cap(0, 1.5)
            client.set_method(0, Method.PROXY)
            client.stabilize(False)
            with self.assertRaises(ClientError):
                client.set_force_cap(0, -1.0)
            device = client.device(0)
            self.assertEqual((len(device.proxy), device.force_cap), (3, 0.0))

    def test_the_daemons_own_user_may_supervise_and_may_name_whom_it_trusts(self) -> None:
        with self.client(supervisor=True, server_user=os.getuid()) as client:
            self.assertTrue(client.applications()[0].supervisor)
            self.assertTrue(eventually(lambda: client.daemon_state()[1] >= 0))

    def test_a_socket_in_a_folder_that_others_may_write_to_is_not_trusted(self) -> None:
        os.chmod(self.folder.name, 0o777)
        with self.assertRaises(ClientError) as caught:
            Client(path=self.socket)
        os.chmod(self.folder.name, 0o700)
        self.assertEqual(caught.exception.code, Code.REFUSED)
        self.assertIn("open to writing by others", str(caught.exception))

    def test_a_client_that_is_closed_says_so(self) -> None:
        with self.client() as client:
            client.device(0) if eventually(lambda: client.daemon_state()[1] >= 0) else None
        client.close()
        with self.assertRaises(ClientError):
            client.device(0)


class Installed(unittest.TestCase):
    """What a user copies or installs is whole without the rest of the project."""

    def test_pip_installs_the_python_package_by_its_folder(self) -> None:
        with tempfile.TemporaryDirectory(prefix="spm-client-") as folder:
            source = os.path.join(folder, "source")
            shutil.copytree(SOURCE / "servo" / "client" / "python", source,
                            ignore=shutil.ignore_patterns("__pycache__"))
            done = subprocess.run(
                [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps",
                 "--target", os.path.join(folder, "there"), source],
                capture_output=True, text=True)
            if "No module named pip" in done.stderr:
                self.skipTest("pip is not installed")
            self.assertEqual(done.returncode, 0, done.stderr)
            used = subprocess.run(
                [sys.executable, "-c", "import spm_client; print(spm_client.__file__)"], cwd=folder,
                env={**os.environ, "PYTHONPATH": os.path.join(folder, "there")},
                capture_output=True, text=True)
            self.assertEqual((used.returncode, used.stderr), (0, ""))
            self.assertIn(os.path.join(folder, "there"), used.stdout)

    def test_in_a_checkout_the_python_package_finds_the_library_of_the_build_folder(self) -> None:
        with tempfile.TemporaryDirectory(prefix="spm-client-") as folder:
            found = find_in_checkout(
                Path(folder), SOURCE / "servo" / "client" / "python", "servo/client/python",
                str(LIBRARY), "libspm_client.so",
                "import spm_client_library; print(spm_client_library.load()._name)")
        self.assertEqual(found, "build/release/lib/libspm_client.so")

    def test_the_c_sharp_folder_is_an_assembly_of_its_own(self) -> None:
        names = {path.name for path in C_SHARP_FOLDER.iterdir()}
        self.assertEqual(names, {"SpmClient.cs", "SpmClientData.cs", "SpmClientLibrary.cs",
                                 "SpmHaptics.asmdef", "README.md"})
        assembly = json.loads((C_SHARP_FOLDER / "SpmHaptics.asmdef").read_text(encoding="utf-8"))
        self.assertEqual(assembly["name"], "SpmHaptics")
        page = (C_SHARP_FOLDER / "README.md").read_text(encoding="utf-8")
        self.assertLessEqual(len(page.strip().splitlines()), 10)

    @unittest.skipUnless(CAN_C_SHARP, "mcs or mono is not installed (mono-mcs and mono-runtime)")
    def test_the_c_sharp_folder_compiles_alone(self) -> None:
        with tempfile.TemporaryDirectory(prefix="spm-client-") as folder:
            copy = shutil.copytree(C_SHARP_FOLDER, os.path.join(folder, "SpmHaptics"))
            done = subprocess.run(
                ["mcs", "-warn:4", "-warnaserror", "-target:library",
                 "-out:" + os.path.join(folder, "SpmHaptics.dll"), *sorted(Path(copy).glob("*.cs"))],
                capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""))


class Structs(unittest.TestCase):
    def test_the_structs_are_as_long_as_the_headers(self) -> None:
        sizes = header_sizes()
        self.assertEqual(set(sizes), {name for name, _ in STRUCTS})
        for name, kind in STRUCTS:
            with self.subTest(struct=name):
                self.assertEqual(ctypes.sizeof(getattr(spm_client_library, kind)), sizes[name])


@unittest.skipUnless(CAN_C_SHARP, "mcs or mono is not installed (mono-mcs and mono-runtime)")
class CSharp(WithDaemon):
    """SpmClient.cs, by a program that uses each of its functions and says what came of it."""

    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory(prefix="spm-client-")
        cls.addClassCleanup(folder.cleanup)
        cls.program = os.path.join(folder.name, "ClientTest.exe")
        compile_c_sharp(cls.program, Path(__file__).with_name("ClientTest.cs"))

    def facts(self, argument: str):
        """Pairs of name and value, as they come."""
        with subprocess.Popen(["mono", self.program, argument], stdout=subprocess.PIPE, text=True,
                              env=c_sharp_environment()) as process:
            for line in process.stdout:
                yield line.rstrip("\n").split("=", 1)
        self.assertEqual(process.returncode, 0)

    def test_the_structs_are_as_long_as_the_headers(self) -> None:
        sizes = header_sizes()
        expected = {kind: sizes[name] for name, kind in STRUCTS}
        expected["CommandCountsData"] = expected.pop("CountsData")
        self.assertEqual({name: int(size) for name, size in self.facts("sizes")}, expected)

    def test_each_function_does_what_the_header_says(self) -> None:
        commands = {"contact": "c", "button": "b", "gone": "g"}
        found, applications = {}, []
        for name, value in self.facts(self.socket):
            if name == "now":
                self.tell(commands[value])
            elif name == "application":
                applications.append(value)
            else:
                found[name] = value
        for name in ("running", "versions", "added", "moved", "removed", "refused_then", "contact",
                     "button", "cut", "all_woke", "contact_ticks", "waited", "led", "freed"):
            self.assertEqual(found[name], "True", name)
        self.assertEqual((found["process"], found["rate"]), (str(self.daemon.pid), "1000"))
        self.assertEqual(found["names"], "hand bunny first")
        self.assertEqual((found["turned"], found["refused"]), ("1", "0"))
        self.assertEqual((found["waited_in_vain"], found["proxy"]), ("False", "3"))
        self.assertEqual((found["hand"], found["feel"]), ("Free", "Spm 1 750 0.4 3"))
        self.assertEqual((found["borders"], found["path"]), ("900 1800", "/models/bunny.spm.exr"))
        self.assertEqual(found["contacts"], "2 0.3 7 0.25")
        self.assertIn("no such object", found["reason"])
        self.assertEqual((found["not_a_number"], found["too_hard"]), ("BadArgument", "BadArgument"))
        self.assertTrue(found["cause"].startswith("device_gone: plug"), found["cause"])
        # What tests/servo/support/loop_stand_in.cpp counts.
        self.assertGreater(int(found["ticks"]), 0)
        self.assertEqual((found["missed"], found["skipped"], found["busy_max"]), ("7", "8", "500"))
        self.assertEqual((found["wake"], found["busy"]), ("1", "3"))
        self.assertEqual(found["bucket_end"], "256")
        self.assertEqual(found["counts"], "12 13 1.5 2.5 3.5")
        self.assertEqual([line.rpartition(" ")[0] for line in applications], ["C# test"])
        self.assertIn("NoDaemon no daemon answers at", found["without_daemon"])


if __name__ == "__main__":
    unittest.main()
