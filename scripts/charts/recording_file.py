# SPDX-License-Identifier: Apache-2.0
"""Reads recordings of spm-servo (run --record, or a black box). The one place in Python that knows the
layout of a row, which is RecordingRow in formats/motion/recording.hpp. Needs no package."""

import collections
import json
import struct
from collections.abc import Iterator

FORM = 6
CONTACT, FORGOT, LOST, TOUCHED, EDITED, EXCHANGED = 1, 2, 4, 8, 16, 32  # bits of a row's flags
FORCE_CAPPED, TORQUE_CAPPED, TOOL_CAPPED, TOOL, KEPT = 64, 128, 256, 512, 1024

# A field's name, its number's code for struct, how many of them. Hand's frame; of the tool the world's.
FIELDS = (
    ("tick", "Q", 1), ("position", "d", 3), ("orientation", "d", 4),
    ("wanted", "d", 3), ("wanted_torque", "d", 3), ("added", "d", 3), ("added_torque", "d", 3),
    ("sent", "d", 3), ("sent_torque", "d", 3), ("tool_position", "d", 3), ("tool_orientation", "d", 4),
    ("depth", "d", 1), ("wake_ns", "i", 1), ("busy_ns", "i", 1), ("buttons", "I", 1), ("level", "I", 1),
    ("refined", "I", 1), ("worked", "I", 1), ("culled", "I", 1), ("reserved", "I", 1),
    ("device", "H", 1), ("flags", "H", 1), ("cause", "H", 1), ("patches", "H", 1),
    ("first", "H", 1), ("exact", "H", 1), ("held", "H", 1), ("shortened", "H", 1))
LAYOUT = struct.Struct("<" + "".join(f"{count}{code}" for _, code, count in FIELDS))
Row = collections.namedtuple("Row", [name for name, _, _ in FIELDS])

_MAGIC, _START, _END, _ROW_KIND = b"SPM-REC1", 16, 16, 1
_NUMPY = {"Q": "<u8", "d": "<f8", "i": "<i4", "I": "<u4", "H": "<u2"}


class RecordingError(Exception):
    """Says in a sentence what is wrong with a file, and what to do."""


class Recording:
    """A header, as JSON, and the rows as bytes, ordered by tick and then by device."""

    def __init__(self, header: dict, content: bytes) -> None:
        self.header, self.content = header, content
        self.rate_hz: float = header["rate_hz"]
        self.causes: list[str] = header["causes"]

    def rows(self, device: int = 0) -> Iterator[Row]:
        """The rows of a device; vectors are tuples, `cause` is a number."""
        for numbers in LAYOUT.iter_unpack(self.content):
            at, fields = 0, []
            for _, _, count in FIELDS:
                fields.append(numbers[at] if count == 1 else numbers[at:at + count])
                at += count
            row = Row(*fields)
            if row.device == device:
                yield row

    @staticmethod
    def dtype() -> list:
        """Of a row, as numpy describes it: numpy.frombuffer(recording.content, recording.dtype())."""
        return [(name, _NUMPY[code]) if count == 1 else (name, _NUMPY[code], count)
                for name, code, count in FIELDS]


def read_recording(path: str) -> Recording:
    """Reads a whole file. Raises RecordingError."""
    try:
        with open(path, "rb") as file:
            content = file.read()
    except OSError as problem:
        raise RecordingError(f"{path}: {problem.strerror}; give a recording of spm-servo run --record") \
            from problem
    if content[:8] != _MAGIC or len(content) < _START + _END:
        raise RecordingError(f"{path}: is no recording; give one of spm-servo run --record")
    start = _START + int.from_bytes(content[8:12], "little")
    try:
        header = json.loads(content[_START:start])
    except ValueError as problem:
        raise RecordingError(f"{path}: was cut short; record it again") from problem
    if header.get("form") != FORM or header.get("row_bytes") != LAYOUT.size:
        raise RecordingError(f"{path}: is of form {header.get('form')}, this reads form {FORM}; use the "
                             f"spm-servo that recorded it, {header.get('spm_version')}, or record it again")
    rows, at, end = [], start, len(content) - _END
    while at + 8 <= end:
        kind, size = struct.unpack_from("<2I", content, at)
        at += 8
        if kind == _ROW_KIND:
            rows.append(content[at:at + size])
        at += size
    if at != end:
        raise RecordingError(f"{path}: was cut short; record it again")
    return Recording(header, b"".join(rows))
