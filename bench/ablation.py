# ruff: noqa: E501, SIM905 (each part is one line)
"""What each part of `uniform` and `best` earns: the solvers run without it, and groups of scenes judge them.

`python bench/ablation.py` copies the core to a temporary folder, gives each part below a switch, builds the
bench `levels` once, and writes the table of docs/performance/steps.md. Half an hour on one core. With names of
parts it prints their rows only.
"""

import json
import math
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
SOLVER = "core/src/solvers/even_field"
PAGE = ROOT / "docs/performance/steps.md"

#: Groups of scenes of core/benches/levels.rs; in the last two the error counts, in the others the level.
GROUPS = "few,spaced,regular,unequal,many,dense,quiet,2 phases,4 phases,16 phases,wanted,pictures".split(",")
ERRORS = GROUPS[-2:]

#: Each part: its file, a text of it, and the text instead, where {} is whether the part is left out.
PARTS = {
    "weighted sweeps": ("sweeps.rs", "0..=run.plan.sweeps", "0..=if {} {{ 0 }} else {{ run.plan.sweeps }}"),
    "a point's own part removed": ("sweeps.rs", "= RELAXATION *", "= if {} {{ 0.0 }} else {{ RELAXATION }} *"),
    "more starts for regular sets": ("mod.rs", "&& (symmetric ||", "&& !{} && (symmetric ||"),
    "path of separate points": ("mod.rs", "if found != Found::Separate &&", "if !{} && found != Found::Separate &&"),
    "branch and bound": ("race.rs", "&& rows.targeted <= FEW {", "&& rows.targeted <= FEW && !{} {{"),
    "a look at dependent points": ("race.rs", "uneven || many &&", "uneven || !{} && many &&"),
    "several fields to the end": ("run.rs", "if self.wide { 3 }", "if {} {{ 1 }} else if self.wide {{ 3 }}"),
    "cones as starts": ("race.rs", "in plan.cones()", "in if {} {{ &[][..] }} else {{ plan.cones() }}"),
    "random drives as starts": ("race.rs", "if rows.equations() <= FEW_ENOUGH", "if !{} && rows.equations() <= FEW_ENOUGH"),
    "ascent from least squares": ("mod.rs", "&& !ended(run, search)\n", "&& !{} && !ended(run, search)\n"),
    "slow rest of the path": ("race.rs", "if run.plan.wide { Course::SLOW_REST }", "if run.plan.wide && !{} {{ Course::SLOW_REST }}"),
    "a second, closer end": ("race.rs", "if !run.plan.wide && self", "if !{} && !run.plan.wide && self"),
    "metric D": ("newton.rs", "sqrtf(root.max(least))", "sqrtf(if {} {{ mean.max(least) }} else {{ root.max(least) }})"),
    "some quiet points for all": ("quiet.rs", "if count <= FEW {", "if count <= FEW || {} {{"),
    "ascent beside quiet points": ("mod.rs", "if silence.crowded {", "if silence.crowded && !{} {{"),
    "lift to the target": ("mod.rs", "if below && !run", "if !{} && below && !run"),
    "error diffusion": ("grid.rs", "&& even\n", "&& even && !{}\n"),
    "search with few phases": ("mod.rs", "&& !run.stopped\n        {\n            grid", "&& !run.stopped && !{}\n        {{\n            grid"),
}  # fmt: skip


class Group(NamedTuple):
    """Results of a group: levels or errors, which scenes are uneven, and s of CPU."""

    values: list[float]
    uneven: list[bool]
    seconds: float


def switched(copy: Path) -> None:
    """Give each part of a copy of the sources its switch, the number in MIDAIR_WITHOUT."""
    library = copy / "core/src/lib.rs"
    switch = """
/// Whether a part is left out.
pub(crate) fn without(part: usize) -> bool {
    static PART: std::sync::OnceLock<Option<usize>> = std::sync::OnceLock::new();
    *PART.get_or_init(|| std::env::var("MIDAIR_WITHOUT").ok()?.parse().ok()) == Some(part)
}
"""
    library.write_text(library.read_text("utf-8") + switch, encoding="utf-8")
    for number, (part, (file, old, new)) in enumerate(PARTS.items()):
        source = copy / SOLVER / file
        text = source.read_text("utf-8")
        if text.count(old) != 1:
            sys.exit(f"{part}: {file} contains {old!r} {text.count(old)} times, not once")
        source.write_text(text.replace(old, new.format(f"crate::without({number})")), encoding="utf-8")


def built(copy: Path) -> str:
    """Return the program of a copy of the sources."""
    settings = {"CARGO_PROFILE_BENCH_LTO": "off", "CARGO_PROFILE_BENCH_CODEGEN_UNITS": "16"}
    command = "cargo bench --quiet --package midair --bench levels --no-run --message-format=json".split()
    lines = subprocess.run(command, cwd=copy, env=os.environ | settings, check=True, stdout=subprocess.PIPE).stdout
    programs = [json.loads(line).get("executable") for line in lines.splitlines()]
    return next(program for program in programs if program)


def judged(program: str, part: int | None) -> dict[tuple[str, str], Group]:
    """Return the results of each method and group without a part."""
    results = {}
    environment = os.environ if part is None else os.environ | {"MIDAIR_WITHOUT": str(part)}
    for method in ("uniform", "best"):
        for group in GROUPS:
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            run = subprocess.run(
                [program, method, group], env=environment, check=True, capture_output=True, encoding="utf-8"
            )
            seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
            rows = [[float(value) for value in line.split("|")[2:]] for line in run.stdout.splitlines()]
            values = [max(error, 1e-4) if group in ERRORS else level for level, _, error in rows]
            results[method, group] = Group(values, [uneven > 5e-3 for _, uneven, _ in rows], seconds)
    return results


def cell(group: str, whole: Group, less: Group) -> str:
    """Return what a group loses without a part, in %, the scenes that become uneven, and the share of the time."""
    pairs = zip(whole.values, less.values, strict=True)
    change = sum(math.log(b / a) for a, b in pairs) / len(whole.values)
    loss = 100 * (math.exp(change if group in ERRORS else -change) - 1)
    uneven = sum(less.uneven) - sum(whole.uneven)
    share = less.seconds / max(whole.seconds, 1e-9)
    texts = [f"{loss:+.1f}" if abs(loss) >= 0.5 else "", f"{uneven:+d} uneven" if uneven else ""]
    texts.append(f"time {share:.1f}" if whole.seconds > 0.2 and abs(share - 1) > 0.15 else "")
    return ", ".join(text for text in texts if text)


def main(names: list[str]) -> None:
    """Print the rows, and write them to the page if no part is named."""
    head = [["without", "method", *GROUPS], ["---"] * (2 + len(GROUPS))]
    lines = [f"| {' | '.join(row)} |" for row in head]
    with tempfile.TemporaryDirectory() as place:
        copy = Path(place)
        command = ["git", "ls-files", "Cargo.*", "core", "python/Cargo.toml", "python/src", "capi"]
        for name in subprocess.run(
            command, cwd=ROOT, check=True, capture_output=True, encoding="utf-8"
        ).stdout.splitlines():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).write_bytes((ROOT / name).read_bytes())
        switched(copy)
        program = built(copy)
        whole = judged(program, None)
        for part in names or PARTS:
            less = judged(program, list(PARTS).index(part))
            for method in ("uniform", "best"):
                cells = [cell(group, whole[method, group], less[method, group]) for group in GROUPS]
                row = f"| {part} | `{method}` | {' | '.join(cells)} |".replace("|  ", "|")
                print(row, flush=True)
                if any(cells):
                    lines.append(row)
    if not names:
        before, rest = PAGE.read_text("utf-8").split("<!-- ablation:begin -->")
        after = rest.split("<!-- ablation:end -->")[1]
        page = [f"{before}<!-- ablation:begin -->", *lines, f"<!-- ablation:end -->{after}"]
        PAGE.write_text("\n".join(page), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
