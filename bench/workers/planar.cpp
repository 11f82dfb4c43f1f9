// The search of textbook.cpp, arranged for the compiler: real and imaginary parts in separate float arrays, points in the inner
// loop, for -Ofast -march=native.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

extern "C" const char *version() { return __VERSION__; }

// The arguments are those of textbook.cpp.
extern "C" void greedy(int n, int m, const double *positions, const double *points, const double *targets,
                       double p0, double k, int phases, unsigned seed, double *drive) {
    std::vector<float> x(m), y(m), z(m), t(m), r(m), row_re(m), row_im(m), field_re(m), field_im(m);
    std::vector<float> cosine(phases), sine(phases);
    for (int j = 0; j < m; j++) {
        x[j] = float(points[3 * j]);
        y[j] = float(points[3 * j + 1]);
        z[j] = float(points[3 * j + 2]);
        t[j] = float(targets[j]);
    }
    for (int l = 0; l < phases; l++) {
        cosine[l] = float(std::cos(2 * M_PI * l / phases));
        sine[l] = float(std::sin(2 * M_PI * l / phases));
    }
    std::vector<int> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    for (int i : order) {
        float at_x = float(positions[3 * i]), at_y = float(positions[3 * i + 1]), at_z = float(positions[3 * i + 2]);
        for (int j = 0; j < m; j++) {
            float dx = x[j] - at_x, dy = y[j] - at_y, dz = z[j] - at_z;
            r[j] = std::sqrt(dx * dx + dy * dy + dz * dz);
        }
        // Two loops, because compilers merge sin and cos of one loop into a sincos that is not vectorised.
        for (int j = 0; j < m; j++) row_re[j] = float(p0) / r[j] * std::cos(float(k) * r[j]);
        for (int j = 0; j < m; j++) row_im[j] = float(p0) / r[j] * std::sin(float(k) * r[j]);
        float least = std::numeric_limits<float>::max();
        int best = 0;
        for (int l = 0; l < phases; l++) {
            float energy = 0;
            for (int j = 0; j < m; j++) {
                float re = field_re[j] + row_re[j] * cosine[l] - row_im[j] * sine[l];
                float im = field_im[j] + row_re[j] * sine[l] + row_im[j] * cosine[l];
                float miss = t[j] - std::sqrt(re * re + im * im);
                energy += miss * miss;
            }
            if (energy < least) {
                least = energy;
                best = l;
            }
        }
        for (int j = 0; j < m; j++) {
            field_re[j] += row_re[j] * cosine[best] - row_im[j] * sine[best];
            field_im[j] += row_re[j] * sine[best] + row_im[j] * cosine[best];
        }
        drive[2 * i] = cosine[best];
        drive[2 * i + 1] = sine[best];
    }
}
