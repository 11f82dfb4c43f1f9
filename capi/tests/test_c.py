"""C and C++: headers without warnings, examples, docs/c.md, shared and static linking, installed files."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from conftest import ROOT, STRICT, need, run
from library import Library

Build = Callable[..., Path]
PAGE = ROOT / "docs" / "c.md"
EXAMPLES = sorted((ROOT / "examples").glob("c*/solve.c*"))


@pytest.mark.parametrize(
    ("compiler", "header"),
    [
        (["cc", "-std=c99", "-xc"], "midair.h"),
        (["cc", "-std=c11", "-xc"], "midair.h"),
        (["c++", "-std=c++17", "-xc++"], "midair.h"),
        (["c++", "-std=c++17", "-xc++"], "midair.hpp"),
        (["c++", "-std=c++20", "-xc++"], "midair.hpp"),
    ],
    ids=lambda part: part[1] if isinstance(part, list) else part,
)
def test_headers_stand_alone(flags: list[str], tmp_path: Path, compiler: list[str], header: str) -> None:
    source = tmp_path / "source"
    source.write_text(f"#include <{header}>\n#include <{header}>\nint nothing;\n", "utf-8")
    run(*compiler, *STRICT, "-c", source, *flags, "-o", tmp_path / "object")


@pytest.mark.parametrize("source", EXAMPLES, ids=lambda path: path.name)
def test_examples(compiled: Build, source: Path) -> None:
    lines = run(compiled(source)).splitlines()
    assert len(lines) == 3
    assert re.fullmatch(r"\d+ transducers.* (0\.9\d\d|1\.000).*", lines[0])


@pytest.mark.parametrize("language", ["c", "cpp"])
def test_the_page(compiled: Build, tmp_path: Path, language: str) -> None:
    blocks = re.findall(rf"^```{language}\n(.*?)^```", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    assert blocks
    for block in blocks:
        source = tmp_path / f"page.{language}"
        source.write_text(block, "utf-8")
        # The programs on the page check their results themselves.
        assert "assert(" in block
        run(compiled(source))


def test_a_session_in_cpp_takes_every_kind_of_value_and_warns(compiled: Build, tmp_path: Path) -> None:
    source = tmp_path / "values.cpp"
    source.write_text(
        """
#include <cstdio>
#include <midair.hpp>

int main() {
    midair::Session session(midair::Array::grid(16, 16, 0.01), "uniform");
    session.set("balance", true);
    session.set("aim", "target");
    session.set("temperature", 20);
    session.set("bead.gravity", {0, 0, -9.81});
    const midair::Solution solution = session.solve({{0, 0, 0.15}}, {50});
    std::printf("%.0f\\n", std::abs(session.pressures().at(0)));
    std::string warning;
    midair::Board("sonicsurface", 256).encode(solution.drive, &warning);
    std::printf("%s\\n", warning.c_str());
    session.solve({{0.005, 0.005, 0.001}}, {50});
    std::printf("%s\\n", session.warning().c_str());
    try {
        session.set("temperature", "warm");
    } catch (const midair::Error &error) {
        std::printf("%s: %s\\n", error.code.c_str(), error.what());
    }
}
""",
        "utf-8",
    )
    pressure, weak, near, refusal = run(compiled(source)).splitlines()
    assert pressure == "50"
    assert ": sonicsurface switches all transducers off; multiply the drive" in weak
    assert "nearer than a quarter of the wavelength" in near
    assert refusal == "type: medium.temperature is warm: set it with midair_session_set_number"


def test_the_page_lists_every_function(library: Library) -> None:
    listed = re.findall(r"^\| `(midair_\w+)` \|", PAGE.read_text("utf-8"), re.MULTILINE)
    assert listed == list(library.arguments)


def test_a_static_link(prefix: Path, flags: list[str], tmp_path: Path) -> None:
    folder = str(prefix / "lib" / "pkgconfig")
    said = run("pkg-config", "--static", "--libs", "midair", PKG_CONFIG_PATH=folder)
    others = [word for word in said.split() if word != "-lmidair"]
    library, program = prefix / "lib" / "libmidair.a", tmp_path / "solve"
    source = ROOT / "examples" / "c" / "solve.c"
    run("cc", "-std=c99", *STRICT, f"-I{prefix / 'include'}", source, library, *others, "-o", program)
    assert "midair" not in run("ldd", program)
    assert len(run(program).splitlines()) == 3


def test_what_is_installed(prefix: Path, library: Library) -> None:
    found = sorted(str(path.relative_to(prefix)) for path in prefix.rglob("*") if not path.is_dir())
    version = library.plain("version").decode()
    shared = ["libmidair.so", f"libmidair.so.{version}", f"libmidair.so.{library.abi}"]
    libraries = sorted([*shared, "libmidair.a", "pkgconfig/midair.pc"])
    assert found == ["include/midair.h", "include/midair.hpp", *(f"lib/{name}" for name in libraries)]
    assert all(prefix.joinpath("lib", name).resolve().name == shared[1] for name in shared)
    need("readelf", "pkg-config")
    assert f"soname: [libmidair.so.{library.abi}]" in run("readelf", "-d", prefix / "lib" / "libmidair.so")
    folder = str(prefix / "lib" / "pkgconfig")
    assert run("pkg-config", "--modversion", "midair", PKG_CONFIG_PATH=folder).strip() == version


def test_only_its_own_names_are_exported(prefix: Path, library: Library) -> None:
    need("nm")
    lines = run("nm", "-D", "--defined-only", prefix / "lib" / "libmidair.so").splitlines()
    assert sorted(line.split()[-1] for line in lines) == sorted(library.arguments)
