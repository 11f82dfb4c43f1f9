"""The version: stated in Cargo.toml, and the same in every other file that states it."""

import json
import re
import runpy
import tomllib
from pathlib import Path
from types import SimpleNamespace

import pytest

import midair

ROOT = Path(__file__).parents[2]
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]["version"]

#: Files that repeat the version, each with the pattern of its line.
REPEATED = {
    "CITATION.cff": r"^version: (\S+)$",
    "docs/javascript.md": r"^npm install \./midair-(\S+)\.tgz ",
    "docs/index.md": r"^\| `midair-(\S+)\.crate` ",
    "python/conda/recipe.yaml": r'^  version: "(\S+)"$',
    "docs/citing.md": r"^  version = \{(\S+)\},$",
    "capi/include/midair.h": r'^// Returns the version of the library, such as "(\S+)"\.',
    "studio/door/Cargo.toml": r'^version = "(\S+)"$',
}


def test_the_package_has_it() -> None:
    assert midair.__version__ == VERSION
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert "version" in project["dynamic"], "the wheel takes it from Cargo.toml"


@pytest.mark.parametrize("crate", ["core", "python", "capi"])
def test_the_crates_have_it(crate: str) -> None:
    package = tomllib.loads((ROOT / crate / "Cargo.toml").read_text("utf-8"))["package"]
    assert package["version"] == {"workspace": True}


@pytest.mark.parametrize("file", sorted(REPEATED))
def test_files_that_repeat_it_agree(file: str) -> None:
    assert re.findall(REPEATED[file], (ROOT / file).read_text("utf-8"), re.MULTILINE) == [VERSION]


@pytest.mark.parametrize("folder", ["npm", "studio", "unity"])
def test_packages_for_node_and_unity_agree(folder: str) -> None:
    assert json.loads((ROOT / folder / "package.json").read_text("utf-8"))["version"] == VERSION


def test_the_changelog_begins_with_it_or_with_what_comes_next() -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text("utf-8")
    (word, newest), *_ = re.findall(r"^## (Unreleased: )?(\d+\.\d+\.\d+)", changelog, re.MULTILINE)
    ours, theirs = ([int(part) for part in version.split(".")] for version in (VERSION, newest))
    assert ours < theirs if word else ours == theirs


def test_the_list_of_bundled_software_is_that_of_the_lock_file() -> None:
    release = SimpleNamespace(**runpy.run_path(str(ROOT / "python" / "release.py")))
    assert release.third_party() == (ROOT / "python" / "THIRD-PARTY.md").read_text("utf-8")


def test_the_recipe_for_conda_needs_what_the_wheel_needs() -> None:
    recipe = (ROOT / "python" / "conda" / "recipe.yaml").read_text("utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    (run,) = re.findall(r"^  run:\n((?:    - .*\n)+)", recipe, re.MULTILINE)
    given = [line.removeprefix("    - ").replace(" ", "") for line in run.splitlines()]
    # conda's matplotlib includes graphical backends; the package needs only matplotlib-base.
    needed = [each.replace("matplotlib", "matplotlib-base") for each in project["dependencies"]]
    assert given == [f"python{project['requires-python']}", *needed]


def test_the_day_of_the_release_is_the_changelogs() -> None:
    (day,) = re.findall(r"^date-released: (\S+)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.MULTILINE)
    assert re.search(rf"^## {re.escape(VERSION)}, {day}$", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE)


def test_workflows_test_pull_requests_and_build_tags_on_three_systems() -> None:
    tests, wheels = (
        (ROOT / ".github" / "workflows" / f"{name}.yml").read_text("utf-8") for name in ("tests", "wheels")
    )
    assert re.search(r"^  pull_request:$", tests, re.MULTILINE)
    assert 'tags: ["v*"]' in wheels
    for system in ("ubuntu", "macos", "windows"):
        assert f"{system}-latest" in tests
        assert f"{system}-latest" in wheels


def test_the_containers_run_the_readmes_two_commands() -> None:
    dockerfile = (ROOT / "Dockerfile").read_text("utf-8")
    assert re.findall(r"^make (\w+) ", (ROOT / "README.md").read_text("utf-8"), re.MULTILINE) == [
        "demo",
        "test",
    ]
    assert "\nRUN make demo\n" in dockerfile
    assert dockerfile.endswith('CMD ["make", "test"]\n')
    container = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text("utf-8"))
    assert f" AS {container['build']['target']}\n" in dockerfile
    assert container["postCreateCommand"] == "make demo"
    (rust,) = re.findall(r"^FROM rust:(\d+)\.(\d+)-", dockerfile, re.MULTILINE)
    oldest = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]["rust-version"]
    assert [*map(int, rust)] >= [int(part) for part in oldest.split(".")]


def test_the_crate_brings_its_licence() -> None:
    assert (ROOT / "core" / "LICENSE").read_text("utf-8") == (ROOT / "LICENSE").read_text("utf-8")


def test_the_header_names_the_librarys_binary_interface() -> None:
    (header,) = re.findall(
        r"^#define MIDAIR_ABI (\d+)$", (ROOT / "capi/include/midair.h").read_text("utf-8"), re.MULTILINE
    )
    (library,) = re.findall(r"MIDAIR_ABI: u32 = (\d+);", (ROOT / "capi/src/abi.rs").read_text("utf-8"))
    assert header == library
    assert f"`libmidair.so.{library}`" in (ROOT / "docs/c.md").read_text("utf-8")
