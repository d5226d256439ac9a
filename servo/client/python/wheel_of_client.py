# SPDX-License-Identifier: Apache-2.0
"""Makes the package that pip installs (PEP 517): the three modules, without any other build tool."""

import base64
import hashlib
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
MODULES = ("spm_client.py", "spm_client_data.py", "spm_client_library.py")
VERSION = "0.1.0"
FACTS = f"spm_client-{VERSION}.dist-info"


def contents():
    metadata = f"Metadata-Version: 2.1\nName: spm-client\nVersion: {VERSION}\nLicense: Apache-2.0\n"
    yield from ((name, (HERE / name).read_bytes()) for name in MODULES)
    yield f"{FACTS}/METADATA", metadata.encode()
    yield f"{FACTS}/WHEEL", (b"Wheel-Version: 1.0\nGenerator: spm\nRoot-Is-Purelib: true\n"
                             b"Tag: py3-none-any\n")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    name = f"spm_client-{VERSION}-py3-none-any.whl"
    record = ""
    with zipfile.ZipFile(Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in contents():
            wheel.writestr(path, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=")
            record += f"{path},sha256={digest.decode()},{len(content)}\n"
        wheel.writestr(f"{FACTS}/RECORD", record + f"{FACTS}/RECORD,,\n")
    return name
