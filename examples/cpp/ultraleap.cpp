// Plays control points on an Ultraleap device. Its own SDK computes the drives; midair provides the positions.
//
//   midair.write("points.csv", path, layout="points", rate=1000)      t,x,y,z,intensity and, if points are modulated, frequency
//   c++ -std=c++17 -I SDK/include examples/cpp/ultraleap.cpp -o ultraleap ...    and the SDK's library, as for its own examples
//   ./ultraleap points.csv                                            again and again, until Enter is pressed
//
// Names of the SDK are those of its example Streaming_Circle.cpp. Without the SDK this compiles to a program that reports it.
// Positions are in the device's frame: m from the middle of the array, z away from it.

#if __has_include(<ultraleap/haptics/streaming.hpp>)
#include <ultraleap/haptics/streaming.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

using namespace Ultraleap::Haptics;
using Seconds = std::chrono::duration<double>;

namespace {

constexpr double TURN = 6.283185307179586;

struct Point {
    double x, y, z, intensity, frequency;
};

/// Points at rising times; after the last frame the first follows.
struct Points {
    std::vector<double> times;
    std::vector<std::vector<Point>> frames;
    LocalTimePoint start;

    double period() const {
        return times.back() - times.front() + (times.size() > 1 ? times[1] - times[0] : 1.0);
    }

    /// Returns a point at a time since the start, interpolated between two frames.
    Point at(double time, std::size_t which) const {
        const double turns = time / period();
        const double now = times.front() + period() * (turns - std::floor(turns));
        const auto next = std::upper_bound(times.begin(), times.end(), now);
        const auto k = static_cast<std::size_t>(next - times.begin()) - 1;
        const double end = next == times.end() ? times.front() + period() : *next;
        const double part = (now - times[k]) / (end - times[k]);
        const Point &a = frames[k][which], &b = frames[(k + 1) % frames.size()][which];
        const auto between = [part](double from, double to) { return from + part * (to - from); };
        const double swing = a.frequency > 0 ? 0.5 - 0.5 * std::cos(TURN * a.frequency * time) : 1.0;
        return {between(a.x, b.x), between(a.y, b.y), between(a.z, b.z), swing * between(a.intensity, b.intensity), 0};
    }
};

bool read(const char *path, Points &points) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line); // skips the names of the columns
    while (std::getline(file, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream row(line);
        Point point{};
        double time = 0;
        if (!(row >> time >> point.x >> point.y >> point.z >> point.intensity)) {
            return false;
        }
        row >> point.frequency;
        if (points.times.empty() || time > points.times.back()) {
            points.times.push_back(time);
            points.frames.emplace_back();
        }
        points.frames.back().push_back(point);
    }
    const auto alike = [&points](const std::vector<Point> &frame) { return frame.size() == points.frames[0].size(); };
    return !points.frames.empty() && std::all_of(points.frames.begin(), points.frames.end(), alike);
}

/// The SDK calls this for the points of a time interval before it emits them.
void emit(const StreamingEmitter &, OutputInterval &interval, const LocalTimePoint &, void *given) {
    const auto &points = *static_cast<const Points *>(given);
    for (auto &sample : interval) {
        const Seconds time = sample - points.start;
        for (std::size_t which = 0; which < points.frames[0].size(); ++which) {
            const Point point = points.at(time.count(), which);
            Vector3 place;
            place.x = static_cast<float>(point.x);
            place.y = static_cast<float>(point.y);
            place.z = static_cast<float>(point.z);
            sample.controlPoint(which).setPosition(place);
            sample.controlPoint(which).setIntensity(static_cast<float>(point.intensity));
        }
    }
}

template <typename Result> bool fails(const char *act, Result &&result) {
    if (result) {
        return false;
    }
    std::cerr << act << ": " << result.error().message() << '\n';
    return true;
}

} // namespace

int main(int count, char **words) {
    Points points;
    if (count != 2 || !read(words[1], points)) {
        std::cerr << "give a file of midair.write(\"points.csv\", ..., layout=\"points\")\n";
        return 2;
    }
    Library library;
    if (fails("the library does not connect", library.connect())) {
        return 1;
    }
    auto device = library.findDevice(DeviceFeatures::StreamingHaptics);
    if (fails("no device is found", device)) {
        return 1;
    }
    StreamingEmitter emitter{library};
    points.start = LocalTimeClock::now();
    if (fails("the device is refused", emitter.addDevice(device.value())) ||
        fails("so many points are refused", emitter.setControlPointCount(points.frames[0].size(), AdjustRate::All)) ||
        fails("the points are refused", emitter.setEmissionCallback(&emit, &points)) ||
        fails("the emitter does not start", emitter.start())) {
        return 1;
    }
    std::cout << "plays until Enter is pressed" << std::endl;
    std::cin.get();
    return fails("the emitter does not stop: switch its supply off", emitter.stop()) ? 1 : 0;
}
#else
#include <cstdio>

int main() {
    std::fputs("this needs Ultraleap's haptics SDK: compile it with the SDK's include folder and library\n", stderr);
    return 1;
}
#endif
