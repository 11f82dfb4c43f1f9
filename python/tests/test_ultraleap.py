"""examples/cpp/ultraleap.cpp: it compiles without the SDK, and with a stand-in SDK its points are on time."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import midair

EXAMPLE = Path(__file__).parents[2] / "examples" / "cpp" / "ultraleap.cpp"
COMPILER = shutil.which("c++")
pytestmark = [pytest.mark.slow, pytest.mark.skipif(COMPILER is None, reason="needs a C++ compiler")]

#: A stand-in with the SDK's names that the example uses; `start` requests samples of 1/4 ms and prints them.
SDK = """
#include <chrono>
#include <cstddef>
#include <iostream>
#include <vector>
namespace Ultraleap::Haptics {
struct Vector3 { float x, y, z; };
using LocalTimeClock = std::chrono::steady_clock;
using LocalTimePoint = LocalTimeClock::time_point;
struct Error { const char *message() const { return "?"; } };
struct Result { explicit operator bool() const { return true; } Error error() const { return {}; } };
struct Device {};
struct Found : Result { Device value() const { return {}; } };
enum class DeviceFeatures { StreamingHaptics };
enum class AdjustRate { All };
struct Library {
    Result connect() { return {}; }
    Found findDevice(DeviceFeatures) { return {}; }
};
struct ControlPoint {
    Vector3 place; float intensity;
    void setPosition(const Vector3 &p) { place = p; }
    void setIntensity(float i) { intensity = i; }
};
struct Sample {
    LocalTimePoint time; std::vector<ControlPoint> points;
    ControlPoint &controlPoint(std::size_t k) { return points[k]; }
    LocalTimeClock::duration operator-(const LocalTimePoint &t) const { return time - t; }
};
using OutputInterval = std::vector<Sample>;
struct StreamingEmitter {
    using Callback = void (*)(const StreamingEmitter &, OutputInterval &, const LocalTimePoint &, void *);
    std::size_t count = 0; Callback call = nullptr; void *data = nullptr;
    LocalTimePoint begin = LocalTimeClock::now();
    explicit StreamingEmitter(Library &) {}
    Result addDevice(const Device &) { return {}; }
    Result setControlPointCount(std::size_t n, AdjustRate) { count = n; return {}; }
    Result setEmissionCallback(Callback c, void *d) { call = c; data = d; return {}; }
    Result start() {
        OutputInterval samples;
        const std::vector<ControlPoint> points(count);
        for (int k = 0; k < 80; ++k)
            samples.push_back({begin + std::chrono::microseconds(250 * k), points});
        call(*this, samples, begin, data);
        for (auto &sample : samples)
            for (auto &p : sample.points)
                std::cout << p.place.x << ' ' << p.place.y << ' ' << p.place.z << ' ' << p.intensity << '\\n';
        return {};
    }
    Result stop() { return {}; }
};
}
"""


def compiled(folder: Path, *words: str) -> Path:
    program = folder / "ultraleap"
    command = [
        str(COMPILER),
        "-std=c++17",
        "-Wall",
        "-Wextra",
        "-Werror",
        *words,
        str(EXAMPLE),
        "-o",
        program,
    ]
    subprocess.run(command, check=True)
    return program


def test_without_the_sdk_it_says_so(tmp_path: Path) -> None:
    run = subprocess.run([compiled(tmp_path), "points.csv"], capture_output=True, encoding="utf-8")
    assert run.returncode == 1
    assert run.stderr.startswith("this needs Ultraleap's haptics SDK: ")
    assert run.stderr.count("\n") == 1


def test_points_come_at_their_times(tmp_path: Path) -> None:
    header = tmp_path / "ultraleap" / "haptics" / "streaming.hpp"
    header.parent.mkdir(parents=True)
    header.write_text(SDK, "utf-8")
    (tmp_path / "out").mkdir()
    program = compiled(tmp_path / "out", f"-I{tmp_path}")
    ring = midair.path.circle([0, 0, 0.2], 0.02, frequency=100, points=2)
    midair.write(tmp_path / "points.csv", ring, layout="points", rate=1000)
    run = subprocess.run([program, tmp_path / "points.csv"], input="\n", capture_output=True, encoding="utf-8")
    assert run.returncode == 0, run.stderr
    rows = [line for line in run.stdout.splitlines() if line[0] in "-0123456789"]
    got = np.array([row.split() for row in rows], float).reshape(80, 2, 4)
    # The stand-in's clock starts slightly before the program's.
    angle = np.unwrap(np.angle(got[:, 0, 0] + 1j * got[:, 0, 1]))
    times = (angle - angle[0]) / (2 * np.pi * 100)
    np.testing.assert_allclose(times, 250e-6 * np.arange(80), atol=2e-5)
    np.testing.assert_allclose(got[:, 1, :2], -got[:, 0, :2], atol=1e-6)
    radius = np.hypot(got[..., 0], got[..., 1])
    assert radius.max() <= 0.02 * (1 + 1e-5)
    assert radius.min() > 0.02 * np.cos(np.pi / 10) * (1 - 1e-5)
    np.testing.assert_allclose(got[..., 2:], [[[0.2, 1.0]] * 2] * 80, rtol=1e-5)
    reported = subprocess.run([program], capture_output=True, encoding="utf-8")
    assert reported.returncode == 2
    assert "midair.write" in reported.stderr
