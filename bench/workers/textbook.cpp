// Algorithm 2 of Suzuki et al. 2021, written directly: complex doubles, |p + G q| by the complex modulus, new energy sums for
// each candidate, transducers in random order. G is computed by libm within the measured time.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

using Complex = std::complex<double>;

extern "C" const char *version() { return __VERSION__; }

// Reads positions (n, 3) and points (m, 3) in m, targets (m) in Pa, p0 in Pa m and k in rad/m; writes drive (n, 2).
extern "C" void greedy(int n, int m, const double *positions, const double *points, const double *targets,
                       double p0, double k, int phases, unsigned seed, double *drive) {
    std::vector<Complex> gains(std::size_t(n) * m), field(m), candidates(phases);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < m; j++) {
            double dx = points[3 * j] - positions[3 * i];
            double dy = points[3 * j + 1] - positions[3 * i + 1];
            double dz = points[3 * j + 2] - positions[3 * i + 2];
            double r = std::sqrt(dx * dx + dy * dy + dz * dz);
            gains[std::size_t(i) * m + j] = std::polar(p0 / r, k * r);
        }
    }
    for (int l = 0; l < phases; l++) candidates[l] = std::polar(1.0, 2 * M_PI * l / phases);
    std::vector<int> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    for (int i : order) {
        const Complex *row = &gains[std::size_t(i) * m];
        double least = std::numeric_limits<double>::infinity();
        Complex best;
        for (Complex q : candidates) {
            double energy = 0;
            for (int j = 0; j < m; j++) {
                double miss = targets[j] - std::abs(field[j] + row[j] * q);
                energy += miss * miss;
            }
            if (energy < least) {
                least = energy;
                best = q;
            }
        }
        for (int j = 0; j < m; j++) field[j] += row[j] * best;
        drive[2 * i] = best.real();
        drive[2 * i + 1] = best.imag();
    }
}
