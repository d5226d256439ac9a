# SPDX-License-Identifier: Apache-2.0
"""What the shared libraries promise to programs that are built already: which symbols they export,
and where the members of the headers' structs are. Run as a program with the folder of the headers,
it prints the layouts, which struct_layouts.txt keeps."""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

HEADERS = ("spm_query.h", "spm_client.h")
STRUCT = re.compile(r"typedef struct (spm_\w+) \{(.*?)\} \1;", re.DOTALL)
KEPT = Path(__file__).with_name("struct_layouts.txt")
SOURCE = Path(__file__).resolve().parents[2]
LISTS = {"query": SOURCE / "formats/query/spm_query.map", "client": SOURCE / "servo/client/spm_client.map"}


def members(body):
    body = re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL)
    return [re.search(r"(\w+)(\[\w+\])*$", line.strip())[1] for line in body.split(";")
            if line.strip()]


def layouts(headers):
    """A line for each struct: its name, its size, then each member and its offset."""
    text = "".join(path.read_text(encoding="utf-8") for path in sorted(Path(headers).glob("spm_*.h")))
    prints = []
    for name, body in sorted(STRUCT.findall(text)):
        facts = [f"sizeof({name})"] + [f"offsetof({name}, {member})" for member in members(body)]
        names = " ".join(f"{member} %zu" for member in members(body))
        prints.append(f'  printf("{name} %zu {names}\\n", {", ".join(facts)});\n')
    assert len(prints) > 10, "the headers have structs"
    program = "".join(f"#include <{header}>\n" for header in HEADERS)
    program += "#include <stdio.h>\nint main(void) {\n" + "".join(prints) + "  return 0;\n}\n"
    with tempfile.TemporaryDirectory(prefix="spm-layouts-") as folder:
        source, binary = Path(folder) / "layouts.c", Path(folder) / "layouts"
        source.write_text(program, encoding="utf-8")
        subprocess.run(["cc", f"-I{headers}", "-o", binary, source], check=True)
        return subprocess.run([binary], check=True, capture_output=True, text=True).stdout


def kept_symbols(library):
    """The symbols that a library's list names."""
    return sorted(re.findall(r"^    (spm_\w+);$", LISTS[library].read_text(encoding="utf-8"), re.MULTILINE))


def exported_symbols(library):
    shown = subprocess.run(["nm", "-D", "--defined-only", library], check=True, capture_output=True,
                           text=True).stdout
    return sorted(line.split()[-1].split("@")[0] for line in shown.splitlines())


if __name__ == "__main__":
    print(layouts(sys.argv[1]), end="")
