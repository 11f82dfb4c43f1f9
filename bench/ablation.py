"""What each part of `uniform` and `best` earns: the solvers are built without it, and judged in groups of scenes.

`python bench/ablation.py` copies the tracked files of the core to a temporary folder, replaces one text of its source for each
row, builds the bench `levels`, and writes the table of docs/performance/steps.md. Half an hour on two cores. With names of rows it
prints these rows only.
"""

from __future__ import annotations

import math
import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOLVER = "core/src/solvers/even_field"
PAGE = ROOT / "docs/performance/steps.md"

#: Groups of scenes of core/benches/levels.rs.
GROUPS = "few spaced regular unequal many dense quiet 2_phases 4_phases 16_phases asked pictures".split()

#: Each row: what is left out, the file, the text that is replaced, and the text instead.
PARTS = {
    "the weighted sweeps": ("sweeps.rs", "0..=run.plan.sweeps", "0..=0"),
    "the removal of a point's own part": ("sweeps.rs", "RELAXATION: f32 = 0.8", "RELAXATION: f32 = 0.0"),
    "more starts for regular and lossy points": (
        "mod.rs",
        "(symmetric || found == Found::Lossy)",
        "(symmetric && false)",
    ),
    "the path of separate points": ("mod.rs", "if found != Found::Separate &&", "if false &&"),
    "branch and bound for 2 and 3 points": ("race.rs", "&& rows.targeted <= FEW {", "&& rows.targeted < FEW - 2 {"),
    "points that depend on others are crowded": ("race.rs", "uneven || many && level", "uneven || false && level"),
    "the race (one field is followed)": ("run.rs", "if self.wide { 3 } else { 2 }", "1"),
    "cones as starts": ("race.rs", "in plan.cones()", "in plan.cones().iter().take(0)"),
    "random drives as starts": ("race.rs", "if rows.equations() <= FEW_ENOUGH", "if rows.equations() < 2"),
    "louder fields of least squares as starts": ("run.rs", "&[1.2, 1.6]", "&[]"),
    "the ascent from least squares": ("mod.rs", "&& !ended(run, search)\n", "&& false && !ended(run, search)\n"),
    "the slow rest of the path": ("path.rs", "factor: 0.85", "factor: 0.75"),
    "a second, closer end": ("race.rs", "if !run.plan.wide && self", "if false && self"),
    "the refusal of faint fields": ("race.rs", "FAINT: f32 = 0.4", "FAINT: f32 = 0.0"),
    "the metric D": ("newton.rs", "1.0 / sqrtf(root.max(least))", "1.0 / sqrtf(mean.max(least))"),
    "a few quiet points for many": ("quiet.rs", "FEW: usize = 8", "FEW: usize = 8000"),
    "the ascent beside crowded quiet points": ("mod.rs", "if silence.crowded {", "if silence.crowded && false {"),
    "the lift to the target": ("mod.rs", "if below && !run", "if below && false && !run"),
    "error diffusion": ("grid.rs", "&& quantization.phases() >= Some(FEWEST)", "&& quantization.phases().is_none()"),
    "the search with few phases": ("mod.rs", "&& !run.stopped\n        {\n            grid::raise", "&& !run.stopped && false\n        {\n            grid::raise"),
}


def built(folder: Path) -> str:
    """Return the path of the bench of a copy of the sources."""
    settings = {"CARGO_PROFILE_BENCH_LTO": "off", "CARGO_PROFILE_BENCH_CODEGEN_UNITS": "16", "RUSTFLAGS": ""}
    command = ["cargo", "bench", "--quiet", "--package", "midair", "--bench", "levels", "--no-run", "--message-format=json"]
    lines = subprocess.run(command, cwd=folder, env=os.environ | settings, check=True, capture_output=True, text=True)
    return next(line for line in lines.stdout.splitlines()[::-1] if '"executable":"' in line).split('"executable":"')[1].split('"')[0]


def judged(program: str) -> dict[tuple[str, str], tuple[list[float], int, float]]:
    """Return levels (or errors of pictures), the number of uneven scenes and s of CPU, for each method and group."""
    results = {}
    for method in ("uniform", "best"):
        for group in GROUPS:
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            command = [program, method, group.replace("_", " ")]
            text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
            rows = [[float(value) for value in line.split("|")[2:]] for line in text.splitlines()]
            values = [1 / max(error, 1e-4) if group in ("asked", "pictures") else level for level, _, error in rows]
            results[method, group] = values, sum(uneven > 5e-3 for _, uneven, _ in rows), seconds
    return results


def cells(whole: dict, less: dict, method: str) -> list[str]:
    """Return one cell for each group: the loss in %, the number of scenes that are uneven only now, the time."""
    texts = []
    for group in GROUPS:
        (values, uneven, seconds), (mine, more, took) = whole[method, group], less[method, group]
        ratio = math.exp(sum(math.log(b / a) for a, b in zip(values, mine, strict=True)) / len(values))
        loss = 100 * (1 - ratio)
        text = "" if abs(loss) < 0.05 else f"{loss:+.1f}"
        text += "" if more <= uneven else f" ({more - uneven} uneven)"
        quicker = seconds / max(took, 1e-9)
        texts.append(text + (f" x{quicker:.1f}" if quicker > 1.15 and seconds > 0.05 else ""))
    return texts


def main(names: list[str]) -> None:
    """Print the rows, and write them to the page if all are asked."""
    head = ["without", *(group.replace("_", " ") for group in GROUPS)]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    with tempfile.TemporaryDirectory() as place:
        copy = Path(place)
        files = subprocess.run(["git", "ls-files", "-z", "Cargo.*", "core", "python", "capi"], cwd=ROOT, check=True, capture_output=True)
        for name in files.stdout.decode().split("\0")[:-1]:
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).write_bytes((ROOT / name).read_bytes())
        if "avx512f" in Path("/proc/cpuinfo").read_text():
            # Kernels for other processors take most of the time of a build.
            kinds = copy / "core/src/kernels/simd/instruction_set.rs"
            arm = r"Kind::(Scalar|Avx2)\(\$simd\) => \$simd\.vectorize\(\s*#\[inline\(always\)\]\s*\|\| \$body,\s*\),"
            kinds.write_text(re.sub(arm, r"Kind::\1(_) => unreachable!(),", kinds.read_text()))
        whole = judged(built(copy))
        for part in names or PARTS:
            file, old, new = PARTS[part]
            source = copy / SOLVER / file
            text = source.read_text()
            if text.count(old) != 1:
                sys.exit(f"{part}: {file} contains {old!r} {text.count(old)} times, not once")
            source.write_text(text.replace(old, new))
            less = judged(built(copy))
            source.write_text(text)
            for method in ("uniform", "best"):
                lines.append("| " + " | ".join([f"{part}, `{method}`", *cells(whole, less, method)]) + " |")
                print(lines[-1], flush=True)
    if not names:
        begin, end = "<!-- ablation:begin -->", "<!-- ablation:end -->"
        before, after = PAGE.read_text().split(begin)[0], PAGE.read_text().split(end)[1]
        PAGE.write_text(before + "\n".join([begin, *lines, end]) + after)


if __name__ == "__main__":
    main(sys.argv[1:])
