# SPDX-License-Identifier: Apache-2.0
"""What `spm-bench stability --json` measured as Markdown: flat borders, targets, the cases against
the methods, the largest good stiffness, the theory check, static loops, costs and how idle
stabilizers are."""

from markdown_table import table
from stability_rows import device_of, methods_of, names_of, themes_of, verdict_of

LETTERS = {"good": "+", "between": "~", "bad": "x", "popped": "P"}
WORDS = {"good": "good", "between": "between", "bad": "**BAD**", "popped": "**BAD**: popped"}
GENTLE = 0.6  # of the flat border: where the default is to hold


def spaced_table(head: list[str], rows: list[list[str]]) -> list[str]:
    return [*table(head, rows), ""]


def verdict_cell(rows: list[dict]) -> str:
    """A word where all profiles agree, else a letter a profile."""
    found = [verdict_of(row) for row in rows]
    if not found:
        return ""
    if len(set(found)) == 1:
        return WORDS[found[0]]
    return "`" + "".join(LETTERS[verdict] for verdict in found) + "`"


def reasons(rows: list[dict]) -> str:
    """Why the default is not good: the worst profile's words, and which others are not."""
    failed = sorted((row for row in rows if not row["stable"]),
                    key=lambda row: (row["verdict"] != "bad", -row["ripple_n"]))
    if not failed:
        return ""
    others = [device_of(row) for row in failed[1:]]
    return f"{device_of(failed[0])}: {failed[0]['reason']}" + (
        f" (and {', '.join(others)})" if others else "")


def flat_lines(report: dict) -> list[str]:
    return ["## Flat borders", "",
            "The largest stiffness at which the exact penalty holds a flat wall. The second is by the "
            "exact eigenvalue, which knows neither friction nor encoder steps.", "", *spaced_table(
                ["profile", "flat border, N/m", "of all that is linear, N/m"],
                [[row["device"], f"{row['border_n_m']:.0f}",
                  "" if row["linear_n_m"] is None else f"{row['linear_n_m']:.0f}"]
                 for row in report["flat_borders"]])]


def target_lines(report: dict) -> list[str]:
    def met(row: dict) -> str:
        return "goal" if row["meets_goal"] else "floor" if row["meets_floor"] else "**no**"

    return ["## Targets", "", *spaced_table(
        ["what", "measured", "floor", "goal", "met", "decided by"],
        [[row["target"] + (f", {row['unit']}" if row["unit"] else ""), f"{row['value']:.4g}",
          f"{row['floor']:.3g}", f"{row['goal']:g}", met(row), row["worst"]]
         for row in report["targets"]])]


def failing_lines(report: dict) -> list[str]:
    rows = [row for row in report["cases"]
            if row["method"] == "default" and row["fraction"] == GENTLE and not row["stable"]]
    lines = [f"## Where the default still fails at {GENTLE:g}", ""]
    if not rows:
        return [*lines, "Nowhere in this run.", ""]
    return lines + spaced_table(["case", "profile", "verdict", "reason"], [
        [row["case"], device_of(row), row["verdict"], row["reason"]] for row in rows])


def verdicts_at(report: dict, fraction: float) -> list[str]:
    rows = [row for row in report["cases"] if row["fraction"] == fraction]
    methods = methods_of(report["cases"])
    by_cell: dict[tuple[str, str], list[dict]] = {}
    for row in rows:
        by_cell.setdefault((row["case"], row["method"]), []).append(row)
    body = []
    for theme, cases in themes_of(report):
        cases = [case for case in cases if any((case, method) in by_cell for method in methods)]
        if cases and theme:
            body.append([f"**{theme}**", *[""] * (len(methods) + 1)])
        body += [[case, *(verdict_cell(by_cell.get((case, method), [])) for method in methods),
                  reasons(by_cell.get((case, "default"), []))] for case in cases]
    share = []
    for method in methods:
        tried = [row["stable"] for row in rows if row["method"] == method]
        share.append(f"{100 * sum(tried) / len(tried):.0f} %" if tried else "")
    return [f"At {fraction:g} of each profile's own flat border:", "",
            *spaced_table(["case", *methods, "why the default is not good"], body + [
                ["share good", *share, ""]])]


def verdict_lines(report: dict) -> list[str]:
    lines = ["## Cases against methods", "",
             "A word where all profiles agree; else a letter a profile, "
             f"{', '.join(names_of(report['cases'], 'device'))}: `+` good, `~` between, `x` bad, `P` "
             "popped through. The worst of a case's seeds counts. Nothing: the method has no such form, "
             "or not the effect that the case is about.", ""]
    for fraction in sorted({row["fraction"] for row in report["cases"]}):
        lines += verdicts_at(report, fraction)
    return lines


def share_text(row: dict | None) -> str:
    if row is None:
        return ""
    share = row["border_n_m"] / row["flat_border_n_m"]
    return f"{share:.2f}" if share > 0 else "**0**"


def border_lines(report: dict) -> list[str]:
    if not report["borders"]:
        return []
    first = report["flat_borders"][0]["device"]
    cells = {(row["case"], row["method"], row["device"]): row for row in report["borders"]}
    cases = names_of(report["borders"], "case")
    methods = methods_of(report["borders"])
    lines = ["## Largest good stiffness", "",
             f"As a share of the profile's flat border, within {100 * report['border_share']:g} %; 0: it "
             "fails at all that was tried.", "", f"On {first}:", ""]
    lines += spaced_table(["case", *methods], [
        [case, *(share_text(cells.get((case, method, first))) for method in methods)]
        for case in cases])
    devices = names_of(report["borders"], "device")
    everywhere = [method for method in ("proxy", "default") if method in methods]
    if len(devices) > 1 and everywhere:
        pairs = [(device, method) for device in devices for method in everywhere]
        lines += ["On every profile, bare and with the default's stabilizers:", ""]
        lines += spaced_table(["case", *(f"{device}, {method}" for device, method in pairs)], [
            [case, *(share_text(cells.get((case, method, device))) for device, method in pairs)]
            for case in cases if any((case, method, devices[1]) in cells for method in everywhere)])
    return lines


def theory_lines(report: dict) -> list[str]:
    if not report["theory"]:
        return []
    body = []
    for criterion in names_of(report["theory"], "criterion"):
        rows = [row for row in report["theory"] if row["criterion"] == criterion]
        offs = sorted(100 * (row["off"] or 0) for row in rows)
        body.append([criterion, rows[0]["kind"], str(len(rows)), f"{offs[0]:+.3f} to {offs[-1]:+.3f} %"])
    return ["## Theory against the plant", "",
            "Passivity and stability are different borders; each is held against its own criterion.",
            "", *spaced_table(["criterion", "kind", "loops", "the plant is off by"], body)]


def loop_lines(report: dict) -> list[str]:
    if not report["loops"]:
        return []
    return ["## Static loops of 10 mm", "", *spaced_table(
        ["object", "baked to, um", "method", "most gained, uJ", "median, uJ", "loops"],
        [[row["object"], f"{1e6 * row['tolerance_m']:g}", row["method"],
          f"{1e6 * row['gained_j']:.3g}", f"{1e6 * row['median_j']:.3g}", str(row["loops"])]
         for row in report["loops"]])]


def cost_lines(report: dict) -> list[str]:
    if not report["costs"]:
        return []
    costs = {row["method"]: row for row in report["costs"]}
    return ["## Errors and times on a slide over teeth", "",
            "Force off the exact penalty's, of its RMS. A proxy that is left behind weighs most in the "
            "RMS; lost are the ticks that are off by more than all of the exact force.", "", *spaced_table(
                ["method", "RMS, %", "median, %", "ticks lost, %", "mean, us", "99th per cent, us"],
                [[method, f"{100 * costs[method]['relative_error']:.3g}",
                  f"{100 * costs[method]['median_error']:.2g}",
                  f"{100 * costs[method]['lost_share']:.2g}", f"{costs[method]['mean_us']:.2f}",
                  f"{costs[method]['p99_us']:.2f}"] for method in methods_of(report["costs"])])]


def idle_lines(report: dict) -> list[str]:
    if not report["idle"]:
        return []
    cells = {(row["method"], row["device"]): row["added_step_n"] for row in report["idle"]}
    devices = names_of(report["idle"], "device")
    return ["## Stabilizers on a gentle press", "",
            "How much a tick's step of force grows by the stabilizer at half of the flat border, N.", "",
            *spaced_table(["method", *devices], [
                [method, *(f"{cells[method, device]:.3f}" if (method, device) in cells else ""
                           for device in devices)] for method in methods_of(report["idle"])])]


def stability_tables(report: dict) -> list[str]:
    """Every table of the laboratory, each under its heading."""
    lines = flat_lines(report) + target_lines(report) + failing_lines(report)
    lines += verdict_lines(report) + border_lines(report) + theory_lines(report)
    lines += loop_lines(report) + cost_lines(report) + idle_lines(report)
    return "\n".join(lines).rstrip().split("\n")
