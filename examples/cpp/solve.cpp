// Solves a focus that circles above an AUTD3 board, a thousand times, and measures the rate; then requests a point too near.
//
//     c++ -std=c++17 solve.cpp $(pkg-config --cflags --libs midair) -o solve
#include <cmath>
#include <complex>
#include <cstdio>
#include <vector>

#include <midair.hpp>

int main() {
    const auto array = midair::Array::preset("autd3");
    midair::Session session(array, "fast");
    session.set("quantization", "autd3");

    std::vector<midair::Complex> drive(array.size());
    double least = 1.0;
    for (int step = 0; step < 1000; ++step) {
        const double angle = 2e-3 * 3.14159265358979 * step;
        const midair::Points points = {{0.03 * std::cos(angle), 0.03 * std::sin(angle), 0.2}};
        const midair_answer answer = session.solve_into(drive.data(), drive.size(), points, {2000.0});
        least = std::fmin(least, answer.metrics.accuracy);
    }
    std::printf("%zu transducers, 1000 frames: at least %.3f of 2000 Pa\n", array.size(), least);
    const auto there = session.field(drive, {{0.03, 0.0, 0.2}});
    std::printf("the field of the last one: %.0f Pa\n", std::abs(there[0]));

    try {
        session.solve({array.positions()[0]});
    } catch (const midair::Error &error) {
        std::printf("refused: %s\n", error.what());
    }
}
