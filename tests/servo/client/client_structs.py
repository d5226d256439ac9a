# SPDX-License-Identifier: Apache-2.0
"""The structs of the client library, as its headers say they are."""

import re
from pathlib import Path

CLIENT = Path(__file__).resolve().parents[3] / "servo" / "client"

# As the header, the Python package and the C# one call them.
STRUCTS = (("options", "OptionsData"), ("info", "InfoData"), ("tick", "TickData"),
           ("device", "DeviceData"), ("contact", "ContactData"), ("object", "ObjectData"),
           ("pose", "PoseData"),
           ("material", "MaterialData"), ("push", "PushData"),
           ("effect", "EffectData"), ("hand", "HandData"), ("feel", "FeelData"),
           ("command_counts", "CountsData"),
           ("event", "EventData"),
           ("loop", "LoopData"), ("device_counts", "DeviceCountsData"),
           ("application", "ApplicationData"))


def header_sizes() -> dict[str, int]:
    """Counted from the text of the headers, so that a field that is added there shows."""
    header = "".join((CLIENT / name).read_text(encoding="utf-8")
                     for name in ("spm_client.h", "spm_client_counts.h", "spm_client_live.h"))
    sizes = {"uint32_t": 4, "int32_t": 4, "uint64_t": 8, "int64_t": 8, "double": 8, "char": 1}
    found = {}
    structs = r"typedef struct spm_client_(\w+) \{(.*?)\} spm_client_\w+;"
    for name, body in re.findall(structs, header, re.DOTALL):
        found[name] = 0
        body = re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL)
        for line in filter(None, map(str.strip, body.split(";"))):
            field = re.fullmatch(r"(const )?(\w+)(\*?) (\w+)(?:\[(\d+)\])?", line)
            assert field is not None, line
            found[name] += (8 if field[3] else sizes[field[2]]) * int(field[5] or 1)
    return found
