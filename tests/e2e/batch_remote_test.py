#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The remote cache, against a real nginx: what it spares, what is refused, what happens without it."""

import hashlib
import json
import os
import shutil
import socket
import struct
import subprocess
import tempfile
import unittest

from dav_server import TOKEN, DavServer, free_port, needs_nginx
from programs import BAKE, Case, digest, obj, run, tetrahedron

SMALL = ("--max-depth", "10mm", "--margin", "5mm")  # bakes soonest


def forged(entry, change):
    """An entry whose description and asset were changed, with all checksums made right again."""
    mark, content = entry.split(b"\n", 1)
    head, asset = content.split(b"\n", 1)
    description = json.loads(head)
    asset = change(description, asset)
    description["asset_sha256"] = hashlib.sha256(asset).hexdigest()
    description["asset_bytes"] = len(asset)
    content = json.dumps(description, separators=(",", ":")).encode() + b"\n" + asset
    return mark.rsplit(b" ", 1)[0] + b" " + hashlib.sha256(content).hexdigest().encode() + b"\n" + content


class RemoteCase(Case):
    def setUp(self):
        super().setUp()
        self.environment = {"no_proxy": "127.0.0.1"}
        self.mesh = self.write("m.obj", obj(tetrahedron(0.05)))

    def bake(self, *arguments):
        """Runs the program with the environment of this test."""
        return subprocess.run(
            [BAKE, *map(str, arguments)], capture_output=True, text=True, timeout=300, check=False,
            env={**os.environ, "LC_ALL": "C.UTF-8", **self.environment})

    def build(self, machine, *options, mesh=None, url=None, tolerance="1mm"):
        """A build on a machine: each has a local cache of its own."""
        result = self.bake("build", mesh or self.mesh, "-o", self.path("m.spm.exr"), *SMALL,
                           "--tolerance", tolerance, "--json", "--cache", self.path(machine),
                           "--remote-cache", url or self.server.url(), *options)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout), result.stderr


@needs_nginx
class Store(RemoteCase):
    @classmethod
    def setUpClass(cls):
        """The bake that most tests begin with, once: its cache, and what it left in the store."""
        cls.baked = tempfile.mkdtemp(prefix="spm-e2e-remote-")
        cls.addClassCleanup(shutil.rmtree, cls.baked, ignore_errors=True)
        first = cls()
        first.setUp()
        try:
            report, told = first.build("here")
            cls.first = {"report": report, "told": told, "requests": first.server.requests()}
            for name, path in {"here": first.path("here"), "store": first.server.store(),
                               "m.spm.exr": first.path("m.spm.exr")}.items():
                shutil.move(path, os.path.join(cls.baked, name))
        finally:
            first.doCleanups()

    def setUp(self):
        super().setUp()
        self.server = DavServer()
        self.addCleanup(self.server.stop)

    def bake_here(self):
        """As if the machine `here` had just baked the mesh and sent it to the store."""
        shutil.copytree(os.path.join(self.baked, "here"), self.path("here"))
        shutil.copytree(os.path.join(self.baked, "store"), self.server.store(), dirs_exist_ok=True)
        shutil.copy(os.path.join(self.baked, "m.spm.exr"), self.folder)

    def test_what_one_machine_baked_another_one_takes(self):
        self.assertEqual((self.first["report"]["cache"], self.first["told"]), ("miss", ""))
        self.assertEqual(self.first["requests"], ["GET", "PUT"])
        self.bake_here()
        self.assertEqual(len(self.server.entries()), 1)
        right = digest(self.path("m.spm.exr"))
        os.unlink(self.path("m.spm.exr"))
        second, told = self.build("there")
        self.assertEqual((second["cache"], second["cache_reason"], told),
                         ("hit", "the same build, from the remote cache", ""))
        self.assertEqual(digest(self.path("m.spm.exr")), right)
        before = self.server.requests()
        self.assertEqual(before, ["GET"])
        self.assertEqual(self.build("there")[0]["cache"], "hit")
        self.assertEqual(self.server.requests(), before)  # it is in the folder by now

    def test_a_rehearsal_asks_and_fetches_nothing(self):
        self.bake_here()
        manifest = self.write("a.toml", '[[asset]]\nmesh = "m.obj"\noutput = "m.spm.exr"\n'
                              'max-depth = "10mm"\nmargin = "5mm"\ntolerance = "1mm"\n')
        result = self.bake("batch", manifest, "--dry-run", "--json", "--cache", self.path("there"),
                           "--remote-cache", self.server.url())
        self.assertEqual(json.loads(result.stdout)["cache"], "hit", result.stderr)
        self.assertEqual(self.server.requests()[-1], "HEAD")

    @staticmethod
    def content(path):
        with open(path, "rb") as file:
            return file.read()

    def refused(self, why):
        """The store's entry is refused for a reason, baked anew, and put right."""
        right = digest(self.path("m.spm.exr"))
        os.unlink(self.path("m.spm.exr"))
        report, told = self.build("victim")
        self.assertEqual((report["cache"], report["cache_reason"]),
                         ("miss", "the remote entry was refused"))
        self.assertIn("warning: an entry of the remote cache is refused", told)
        self.assertIn(why, told)
        self.assertEqual(digest(self.path("m.spm.exr")), right)
        asset = self.content(self.entry).split(b"\n", 2)[2]
        self.assertEqual(hashlib.sha256(asset).hexdigest(), right)
        shutil.rmtree(self.path("victim"))

    def test_a_poisoned_entry_is_refused_and_baked_anew(self):
        self.bake_here()
        self.entry, = self.server.entries()
        good = self.content(self.entry)
        shutil.copytree(self.path("here"), self.path("other"))
        other_mesh = self.write("other.obj", obj(tetrahedron(0.06)))
        self.build("other", mesh=other_mesh)
        self.build("other", tolerance="4mm")
        shutil.copy(os.path.join(self.baked, "m.spm.exr"), self.folder)  # the first one's again

        def asset_of(wanted):
            for path in self.server.entries():
                content = self.content(path).split(b"\n", 2)
                if wanted(json.loads(content[1])["key"]):
                    return content[2]
            return self.fail("no such entry")

        mesh_of_good = digest(self.mesh)
        foreign = asset_of(lambda key: key["mesh"] != mesh_of_good)
        coarse = asset_of(lambda key: key["tolerance"] > 0.002)
        cases = {
            "its checksum is wrong": good[:-50] + b"x" + good[-49:],
            "does not begin as an entry": b"<html>welcome</html>",
            "its asset is not intact": forged(good, lambda head, asset: asset[:-64]),
            "of another mesh": forged(good, lambda head, asset: foreign),
            "promises less than was asked for": forged(good, lambda head, asset: coarse),
            "that of another key": forged(
                good, lambda head, asset: head["key"].update(seed=2) or asset),
        }
        for why, bytes_of_it in cases.items():
            with self.subTest(why):
                with open(self.entry, "wb") as file:
                    file.write(bytes_of_it)
                self.refused(why)

    def test_a_mesh_of_two_files_is_shared_and_verified_and_baked_anew_when_either_changes(self):
        vertices, triangles = tetrahedron(0.05)

        def write_buffer(scale):
            self.write("m.bin", b"".join(struct.pack("<3f", *(scale * value for value in point))
                                         for point in vertices)
                       + b"".join(struct.pack("<3H", *triangle) for triangle in triangles))

        write_buffer(1)
        mesh = self.write("m.gltf", json.dumps({
            "asset": {"version": "2.0"}, "buffers": [{"byteLength": 72, "uri": "m.bin"}],
            "bufferViews": [{"buffer": 0, "byteLength": 48},
                            {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]}))
        self.assertEqual(self.build("here", mesh=mesh)[0]["cache"], "miss")
        self.assertEqual(self.build("there", mesh=mesh)[0]["cache"], "hit")
        self.run_json("verify", self.path("m.spm.exr"), mesh, "--samples", "1000")
        write_buffer(1.1)
        report, _ = self.build("there", mesh=mesh)
        self.assertEqual((report["cache"], report["cache_reason"]),
                         ("miss", "the mesh's bytes changed"))

    def test_a_token_from_the_environment_opens_a_locked_store(self):
        url = self.server.url("locked")
        report, told = self.build("here", url=url)
        self.assertEqual(report["cache"], "miss")
        self.assertIn("SPM_REMOTE_CACHE_TOKEN", told)
        self.assertEqual(self.server.entries("locked"), [])
        self.environment["SPM_REMOTE_CACHE_TOKEN"] = TOKEN
        shutil.rmtree(self.path("here"))
        self.assertEqual(self.build("here", url=url)[1], "")
        self.assertEqual(self.build("there", url=url)[0]["cache"], "hit")

    def test_a_store_that_cannot_be_written_is_still_read(self):
        self.bake_here()
        shutil.copytree(self.server.store(), self.server.store("readable"), dirs_exist_ok=True)
        url = self.server.url("readable")
        report, told = self.build("there", url=url)
        self.assertEqual((report["cache"], told), ("hit", ""))
        _, told = self.build("there", "--seed", "3", url=url)
        self.assertIn("cannot be written", told)

    def test_a_store_that_fails_costs_a_batch_one_warning(self):
        for place in range(2):
            self.write(f"{place}.obj", obj(tetrahedron(0.04 + place / 1000)))
        manifest = self.write("a.toml", '[[asset]]\nmesh = "[01].obj"\noutput = "{stem}.spm.exr"\n'
                              'max-depth = "10mm"\nmargin = "5mm"\ntolerance = "1mm"\n')
        silent = socket.create_server(("127.0.0.1", 0))  # takes connections, and never answers
        self.addCleanup(silent.close)
        for name, url in {"no host": f"http://127.0.0.1:{free_port()}/x",
                          "no answer": f"http://127.0.0.1:{silent.getsockname()[1]}/x",
                          "failing": self.server.url("broken")}.items():
            with self.subTest(name):
                result = self.bake("batch", manifest, "-j", "2", "--json", "--cache", self.path(name),
                                   "--remote-cache", url, "--remote-timeout", "1")
                self.assertEqual(result.returncode, 0, result.stderr)
                lines = [json.loads(line) for line in result.stdout.splitlines()]
                self.assertEqual([line["cache"] for line in lines], ["miss"] * 2)
                self.assertEqual(result.stderr.count("warning: "), 1, result.stderr)
                self.assertIn("the remote cache cannot be read, and is left alone", result.stderr)


class CommandLine(RemoteCase):
    def test_an_address_that_cannot_be_used_is_refused(self):
        def build(*options):
            return run("build", self.mesh, "-o", self.path("m.spm.exr"), *options)

        cache = ("--cache", self.path("c"))
        self.expect_refusal(build("--remote-cache", "http://host/x"), 1, "--cache")
        self.expect_refusal(build(*cache, "--remote-cache", "ftp://host/x"), 1, "ftp://host/x")
        self.expect_refusal(build(*cache, "--remote-cache", "http://me:secret@host/x"), 1, "token")
        self.expect_refusal(build(*cache, "--remote-cache", "http://h", "--remote-timeout", "0"), 1,
                            "--remote-timeout")


if __name__ == "__main__":
    unittest.main()
