# SPDX-License-Identifier: Apache-2.0
"""What the charts and tables of `spm-bench stability` share: the order of methods, the themes of the
cases, words and colours of a verdict."""

COLOURS = {"good": "#3f9168", "between": "#edc55a", "bad": "#cf4a32", "popped": "#4a1942"}
WORDS = {"good": "good", "between": "between good and bad", "bad": "bad: vibrates, never settles",
         "popped": "popped through the surface"}
THEMES = {"walls": "walls", "thin": "thin parts", "grooves": "grooves", "effects": "effects",
          "moving": "moving", "loops": "loops", "meshes": "real objects",
          "six degrees of freedom": "6 degrees"}
RIVALS = ("paper", "distance-field", "exact-penalty", "mesh-proxy")


def names_of(rows: list[dict], key: str) -> list[str]:
    return list(dict.fromkeys(row[key] for row in rows))


def methods_of(rows: list[dict]) -> list[str]:
    """The rivals, each method of ours with its stabilizers beside it, the default last."""
    found = names_of(rows, "method")

    def place(method: str):
        base = method.split("+")[0]
        if method == "default":
            return (3, "", 0)
        return (0, "", found.index(method)) if base in RIVALS else (
            1 if base == "spm" else 2, base, found.index(method))

    return sorted(found, key=place)


def verdict_of(row: dict) -> str:
    return "popped" if row["popped"] else row["verdict"]


def themes_of(report: dict) -> list[tuple[str, list[str]]]:
    """Each theme with its cases, as the catalogue has them."""
    themes: dict[str, list[str]] = {}
    for row in report["catalogue"]:
        name = row.get("theme", "")
        themes.setdefault(THEMES.get(name, name), []).append(row["case"])
    return list(themes.items())


def device_of(row: dict) -> str:
    """The profile; in six degrees of freedom also whether it turns the tool."""
    return row["device"] + ("" if row.get("torque", True) else " without torque")
