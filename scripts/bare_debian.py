# SPDX-License-Identifier: Apache-2.0
"""A bare Debian in a folder, for trials of set-up and packages. Needs root and debootstrap. It is got
from where this machine has its packages from; another release from the same place."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Callable

PATH = "/usr/sbin:/usr/bin:/sbin:/bin"
# What this machine needs to reach the network goes along, where it is there.
NETWORK_FILES = ("etc/resolv.conf", "etc/hosts")
NETWORK_VARIABLES = ("http_proxy", "https_proxy", "no_proxy", "HTTP_PROXY", "HTTPS_PROXY", "NO_PROXY")
# Whom this machine believes; a file of its own, since ca-certificates would write over the usual one.
CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
CERTIFICATES_IN_IT = "etc/network-certificates.crt"
CERTIFICATE_VARIABLES = ("SSL_CERT_FILE", "NODE_EXTRA_CA_CERTS")
APT_SETTINGS = ("Acquire::http", "Acquire::https", "Acquire::Check-Valid-Until", "Acquire::Check-Date")
IN_IT = "SPM_BARE_DEBIAN"  # the folder, for whoever runs apart
PROGRAM = Path(sys.argv[0]).name


def called(*command, **options) -> str:
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"{PROGRAM}: {command[0]} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout


def codename_here() -> str:
    """Of this machine's Debian."""
    for line in Path("/etc/os-release").read_text(encoding="utf-8").splitlines():
        if line.startswith("VERSION_CODENAME="):
            return line.partition("=")[2].strip('"')
    sys.exit(f"{PROGRAM}: this is no Debian with a codename (/etc/os-release)")


def sources(release: str) -> list[tuple[str, str, str, bool]]:
    """Where a release is had from: address, suite, component, whether to believe it."""
    listed = called("apt-get", "indextargets", "--format",
                    "$(REPO_URI)|$(CODENAME)|$(COMPONENT)|$(TRUSTED)", "Created-By: Packages")
    here = codename_here()
    rows = []
    for line in listed.splitlines():
        address, suite, component, trusted = line.split("|")
        if suite.split("-")[0] == here:
            rows.append((address, release + suite[len(here):], component, trusted == "yes"))
    if not rows:
        sys.exit(f"{PROGRAM}: apt has no lists of {here} (apt-get update), so where {release} is had from "
                 "is not known")
    return list(dict.fromkeys(rows))


def run_apart(work: Callable[[Path], int], gigabytes: int) -> int:
    """Calls `work` with an empty folder, in a process whose mounts and children end with it: when the
    folder is removed nothing is mounted in it any more, and nothing runs there."""
    if IN_IT in os.environ:
        return work(Path(os.environ.pop(IN_IT)))
    if os.geteuid() != 0 or not shutil.which("debootstrap"):
        sys.exit(f"{PROGRAM}: needs root and debootstrap (apt-get install debootstrap)")
    where = os.environ.get("TMPDIR", "/var/tmp")
    if (free := shutil.disk_usage(where).free) < gigabytes * 1e9:
        sys.exit(f"{PROGRAM}: {where} has {free / 1e9:.0f} GB free, {gigabytes} are needed; TMPDIR names "
                 "another place")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    with tempfile.TemporaryDirectory(prefix="spm-bare-", dir=where) as folder:
        apart = ["unshare", "--mount", "--propagation", "private", "--pid", "--fork", "--kill-child",
                 "--mount-proc"]
        try:
            return subprocess.run([*apart, sys.executable, *sys.argv], check=False,
                                  env={**os.environ, IN_IT: folder}).returncode
        except KeyboardInterrupt:
            return 130


class BareDebian:
    """A Debian with nothing but what every one has, below `root`. Only within `run_apart`."""

    def __init__(self, root: Path, release: str, mirror: str | None = None) -> None:
        self.root = root
        rows = sources(release) if mirror is None else [(mirror, release, "main", False)]
        first = next(row for row in rows if row[1] == release)
        begun = time.monotonic()
        called("debootstrap", "--variant=minbase", *(["--no-check-gpg"] if first[3] else []), release,
               root, first[0])
        self.seconds = time.monotonic() - begun
        lines = [f"deb {'[trusted=yes] ' if row[3] else ''}{row[0]} {row[1]} {row[2]}" for row in rows]
        (root / "etc/apt/sources.list").write_text("\n".join(lines) + "\n", encoding="utf-8")
        settings = called("apt-config", "dump", "--no-empty", *APT_SETTINGS)
        (root / "etc/apt/apt.conf.d/90network").write_text(settings, encoding="utf-8")
        for name in NETWORK_FILES:
            if Path("/", name).exists():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(Path("/", name), root / name)
        self.certificates = {}
        if CERTIFICATES.exists():
            shutil.copyfile(CERTIFICATES, root / CERTIFICATES_IN_IT)
            self.certificates = dict.fromkeys(CERTIFICATE_VARIABLES, f"/{CERTIFICATES_IN_IT}")
        for kind, place in (("proc", "proc"), ("sysfs", "sys"), ("tmpfs", "run")):
            called("mount", "-t", kind, kind, root / place)
        called("mount", "--rbind", "/dev", root / "dev")
        called("mount", "-t", "tmpfs", "tmpfs", root / "dev/shm")

    def command(self, *command, folder: str = "/", **variables: str) -> list[str]:
        """What runs a command there, with no more of this machine's environment than the network needs."""
        network = {name: os.environ[name] for name in NETWORK_VARIABLES if name in os.environ}
        given = {"PATH": PATH, "LC_ALL": "C.UTF-8", "DEBIAN_FRONTEND": "noninteractive", "HOME": "/root",
                 **network, **self.certificates, **variables}
        return ["chroot", str(self.root), "/usr/bin/env", "-i", f"--chdir={folder}",
                *[f"{name}={value}" for name, value in given.items()], *map(str, command)]

    def run(self, *command) -> str:
        return called(*self.command(*command))

    def packages(self) -> dict[str, int]:
        """Installed packages and the bytes that each says it takes."""
        listed = self.run("dpkg-query", "-W", "-f", "${Package} ${Installed-Size}\\n")
        return {line.split()[0]: int(line.split()[1]) * 1024 for line in listed.splitlines()}

    def has(self, program: str) -> bool:
        return any((self.root / folder / program).exists() for folder in ("usr/bin", "bin"))
