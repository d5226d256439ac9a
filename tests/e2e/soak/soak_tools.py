# SPDX-License-Identifier: Apache-2.0
"""What the soak programs share: the daemon in a process of its own, what it recorded, the loop's
time grid, assets and scenes, and how results are written."""

import atexit
import ctypes
import functools
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, os.pardir, os.pardir, os.pardir))
sys.path[:0] = [os.path.join(HERE, os.pardir), os.path.join(SOURCE, "servo", "client", "python"),
                os.path.join(SOURCE, "scripts", "charts")]

from programs import BAKE, BIN, SERVO, generate  # noqa: E402

os.environ.setdefault("SPM_CLIENT_LIBRARY", os.path.join(BIN, os.pardir, "lib", "libspm_client.so"))

import recording_file  # noqa: E402
import spm_client_library  # noqa: E402
from spm_client import Client, ClientError, Code, DaemonState  # noqa: E402

PATIENCE = 60.0  # s, beyond any machine's worst moment
HOME = (0.0, 0.205, 0.025)  # m, where a WoodenHaptics stands at home, world frame
UPWARDS = (math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0)  # turns z to y


def program(name: str) -> str:
    """A program of the build's, or the end with what to do."""
    path = os.path.join(BIN, name)
    if not os.path.exists(path):
        sys.exit(f"{path} is not there: build the project, and name the folder in SPM_BIN")
    return path


class Folder:
    """A folder of its own, gone afterwards; the daemon's state and socket lie in it."""

    def __enter__(self) -> str:
        self.path = tempfile.mkdtemp(prefix="spm-soak-")
        return self.path

    def __exit__(self, *unused) -> None:
        shutil.rmtree(self.path, ignore_errors=True)


def bake(folder: str, model: str, *options: str) -> tuple[str, list[float], list[float]]:
    """Bakes a model of models/generate.py: the asset, and the corners of its box in metres."""
    generate(folder, model)
    asset = os.path.join(folder, model + ".spm.exr")
    done = subprocess.run([BAKE, "build", os.path.join(folder, model + ".obj"), "-o", asset,
                           *options, "--json"], check=True, capture_output=True, text=True)
    box = json.loads(done.stdout)["mesh"]["bbox_m"]
    return asset, box["min"], box["max"]


@functools.cache
def baked_box() -> tuple[str, float]:
    """An asset that bakes soon, in a folder that goes with the program: a box about the origin, and
    half its height in m."""
    folder = tempfile.mkdtemp(prefix="spm-soak-box-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    asset, _, high = bake(folder, "box", "--form", "full", "--resolution", "17")
    return asset, high[2]


def box_of(asset: str) -> tuple[list[float], list[float]]:
    """The corners of a baked asset's box, m."""
    done = subprocess.run([BAKE, "info", asset, "--json"], check=True, capture_output=True,
                          text=True)
    box = json.loads(done.stdout)["mesh"]["bbox_m"]
    return box["min"], box["max"]


def asset_or_demo(path: str | None, folder: str) -> tuple[str, list[float], list[float]]:
    """A baked asset, or where none is named the demo's: its path, and the corners of its box, m."""
    if not path:
        return bake(folder, "demo")
    return os.path.abspath(path), *box_of(os.path.abspath(path))


def write_scene(path: str, asset: str, poses: list[tuple[float, ...]], stiffness: float,
                movable: bool = False) -> str:
    """A scene of one asset at so many places; stiffness in N/m."""
    with open(path, "w", encoding="utf-8") as file:
        for pose in poses:
            numbers = ", ".join(repr(float(number)) for number in pose)
            file.write(f'[[object]]\nasset = "{asset}"\npose = [{numbers}]\n'
                       f'stiffness = "{stiffness!r}N/m"\nmovable = {str(movable).lower()}\n\n')
    return path


def below(point: tuple[float, float, float], half_height: float) -> tuple[float, ...]:
    """Pose of a model about its origin whose top, at z, is to lie at a point and look up."""
    return (point[0], point[1] - half_height, point[2], *UPWARDS)


class Daemon:
    """`spm-servo run --json` with an application's socket in `folder`, on the given cores; what
    plugs an emulated device in runs on any. It ticks, unless it is not `awaited`."""

    def __init__(self, folder: str, *arguments: str, mock: list[str] = (),
                 cores: set[int] | None = None, awaited: bool = True) -> None:
        self.folder = folder
        self.socket = os.path.join(folder, "servo.sock")
        self.messages = os.path.join(folder, "messages")
        command = [SERVO, "run", "--json", "--socket", self.socket, *arguments]
        if cores:
            command = ["taskset", "--cpu-list", ",".join(map(str, sorted(cores))), *command]
        if mock:
            command = [*mock, "--", *command]
        environment = {**os.environ, "XDG_RUNTIME_DIR": folder, "XDG_STATE_HOME": folder}
        environment.pop("FALCON_FIRMWARE", None)
        with open(self.messages, "w", encoding="utf-8") as messages:
            self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=messages,
                                            env=environment, text=True)
        if not awaited:
            self.pid = self.process.pid
            return
        try:
            self.pid = self._wait_until_it_ticks()
        except BaseException:
            self.kill()
            raise

    def _wait_until_it_ticks(self) -> int:
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline and self.process.poll() is None:
            if not os.path.exists(self.socket):
                time.sleep(0.02)
                continue
            try:
                with Client(path=self.socket, timeout=PATIENCE) as client:
                    while client.daemon_state()[0] != DaemonState.RUNNING:
                        if time.monotonic() > deadline:
                            break
                        time.sleep(0.01)
                    return client.info().process
            except ClientError as problem:
                if problem.code != Code.NO_DAEMON:
                    raise
                time.sleep(0.02)
        raise RuntimeError("the daemon does not start: " + self.told())

    def told(self) -> str:
        with open(self.messages, encoding="utf-8") as file:
            return file.read()

    def is_alive(self) -> bool:
        return self.process.poll() is None

    def real_time_priority(self) -> int:
        """Of the loop's thread: the threads of devices are above it. 0: it has none."""
        priorities = []
        for thread in os.listdir(f"/proc/{self.pid}/task"):
            if os.sched_getscheduler(int(thread)) == os.SCHED_FIFO:
                priorities.append(os.sched_getparam(int(thread)).sched_priority)
        return min(priorities, default=0)

    def required_priority(self) -> int:
        """The same; ends the program where it has none."""
        priority = self.real_time_priority()
        if priority == 0:
            self.kill()
            sys.exit("the loop has no real-time priority: run this as root, or allow it with "
                     "'rtprio 90' in /etc/security/limits.d")
        return priority

    def stop(self) -> dict:
        """Tells it to end; gives its report."""
        if self.is_alive():
            os.kill(self.pid, signal.SIGTERM)
        return self.finish(PATIENCE)

    def finish(self, patience: float) -> dict:
        """Waits for its end; gives its report."""
        output, _ = self.process.communicate(timeout=patience)
        if self.process.returncode != 0:
            raise RuntimeError(f"the daemon ended with {self.process.returncode}: {self.told()}")
        return json.loads(output.splitlines()[-1])

    def kill(self) -> None:
        if self.is_alive():
            self.process.kill()
            self.process.wait()


class Row(NamedTuple):
    """What a recording tells of one tick."""
    tick: int
    size: float  # N, of the force sent
    wake_ns: int
    busy_ns: int
    cause: str
    contact: bool
    lost: bool


def read_recording(path: str) -> tuple[float, list[Row]]:
    """Rate in Hz and the rows of the first device."""
    recording = recording_file.read_recording(path)
    return recording.rate_hz, [
        Row(row.tick, math.hypot(*row.sent), row.wake_ns, row.busy_ns, recording.causes[row.cause],
            bool(row.flags & recording_file.CONTACT), bool(row.flags & recording_file.LOST))
        for row in recording.rows()]


def overruns(rows: list[Row]) -> list[tuple[Row, int]]:
    """The ticks that ran over, each with how many were missed by it, as the loop counts them: those
    skipped, and itself."""
    return [(row, later.tick - row.tick) for row, later in zip(rows, rows[1:])
            if later.tick - row.tick > 1 and not later.lost]


def missed(rows: list[Row]) -> tuple[int, int]:
    """Ticks missed, and in how many stalls."""
    gaps = [count for _, count in overruns(rows)]
    return sum(gaps), len(gaps)


class TickClock:
    """When the loop's ticks are, as an application sees it."""

    def __init__(self, socket: str) -> None:
        self._library = spm_client_library.load()
        self._handle = ctypes.c_void_p()
        options = spm_client_library.sized(spm_client_library.OptionsData)
        options.path, options.timeout_ms = socket.encode(), int(PATIENCE * 1000)
        message = ctypes.create_string_buffer(512)
        code = self._library.spm_client_connect(ctypes.byref(options), ctypes.byref(self._handle),
                                                message, len(message))
        if code != 0:
            raise RuntimeError(message.value.decode())
        self._library.spm_client_read_tick.argtypes = [ctypes.c_void_p, ctypes.c_void_p]

    def now(self) -> tuple[int, int]:
        """The newest tick, and when it woke up, ns of CLOCK_MONOTONIC."""
        tick = spm_client_library.sized(spm_client_library.TickData)
        while self._library.spm_client_read_tick(self._handle, ctypes.byref(tick)) != 0:
            time.sleep(0.001)
        return tick.tick, tick.time_ns

    def close(self) -> None:
        self._library.spm_client_disconnect(self._handle)


def start_of_grid(sample: tuple[int, int], rate_hz: float, rows: list[Row]) -> float:
    """When tick 0 was due, ns, from a sample of TickClock and the recording."""
    tick, woke = sample
    wake = next(row.wake_ns for row in rows if row.tick == tick)
    return woke - wake - tick * 1e9 / rate_hz


def percentile(values: list[float], share: float) -> float:
    """By the nearest rank; 0 of nothing."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)] if ordered else 0.0


def stolen_seconds() -> float:
    """Time of the processors that the machine below gave to others, since its start."""
    with open("/proc/stat", encoding="ascii") as file:
        return int(file.readline().split()[8]) / os.sysconf("SC_CLK_TCK")


def cores_of(text: str | None) -> set[int] | None:
    return {int(core) for core in text.split(",")} if text else None


def add_common_options(parser) -> None:
    parser.add_argument("--cores", metavar="N,N", help="cores of the daemon and of what "
                        "is beside it (default: all)")
    parser.add_argument("--out", metavar="PREFIX", help="writes PREFIX.json and PREFIX.md")


class Table(NamedTuple):
    """A further table below that of a program, and the sentence above it."""
    sentence: str
    columns: list[str]
    rows: list[list]


def _lines(columns: list[str], rows: list[list]) -> list[str]:
    return ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns),
            *("| " + " | ".join(_cell(value) for value in row) + " |" for row in rows)]


def show(prefix: str | None, title: str, columns: list[str], rows: list[list], data: dict,
         *more: Table) -> None:
    """Prints tables, and writes them and all the data to files where they are named."""
    lines = [f"### {title}", "", *_lines(columns, rows)]
    for table in more:
        lines += ["", table.sentence, "", *_lines(table.columns, table.rows)]
    text = "\n".join(lines) + "\n"
    print(text, flush=True)
    if prefix:
        with open(prefix + ".md", "w", encoding="utf-8") as file:
            file.write(text)
        with open(prefix + ".json", "w", encoding="utf-8") as file:
            json.dump(data, file, indent=1)
            file.write("\n")


def _cell(value) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:,.1f}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) \
        else str(value)
