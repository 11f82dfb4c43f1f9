// midair for C++17: the functions of midair.h as classes, which free their handles and throw errors.
//
// Only a header; programs link with the library midair. Units and rules are those of midair.h.
#ifndef MIDAIR_HPP
#define MIDAIR_HPP

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "midair.h"

namespace midair {

using Point = std::array<double, 3>;
using Points = std::vector<Point>;
using Complex = std::complex<float>;

/// An error: one line that names the item, its value and the cure.
class Error : public std::runtime_error {
public:
    Error(midair_result result, const std::string &message, const std::string &code = "invalid")
        : std::runtime_error(message), result(result), code(code) {}

    const midair_result result;
    /// One of docs/errors.md, such as "too-near".
    const std::string code;
};

namespace detail {

/// Calls a function with a buffer for its message, and returns its warnings.
template <class Function, class... Arguments> std::string call(Function function, Arguments... arguments) {
    char message[1024];
    const midair_result result = function(arguments..., message, sizeof message);
    if (result != MIDAIR_RESULT_OK) {
        throw Error(result, message, midair_last_code());
    }
    return message;
}

/// Returns the address of a list of numbers, one for each of count points, or NULL if the list is empty; item is its name.
inline const double *list(const char *item, const std::vector<double> &values, std::size_t count) {
    if (!values.empty() && values.size() != count) {
        throw Error(MIDAIR_RESULT_INVALID, std::string(item) + " is " + std::to_string(values.size()) +
                                               " values: give one for each of the " + std::to_string(count) + " points");
    }
    return values.empty() ? nullptr : values.data();
}

inline const double *flat(const Points &points) { return points.empty() ? nullptr : points.data()->data(); }

inline midair_complex *plain(Complex *values) { return reinterpret_cast<midair_complex *>(values); }

inline const midair_complex *plain(const Complex *values) { return reinterpret_cast<const midair_complex *>(values); }

struct Free {
    void operator()(midair_array *array) const { midair_array_free(array); }
    void operator()(midair_session *session) const { midair_session_free(session); }
    void operator()(midair_board *board) const { midair_board_free(board); }
};

template <class Handle> using Owned = std::unique_ptr<Handle, Free>;

} // namespace detail

/// An array of N transducers.
class Array {
public:
    /// Makes an array at positions, facing along normals, or along +z without normals.
    explicit Array(const Points &positions, const Points &normals = {}) {
        if (!normals.empty() && normals.size() != positions.size()) {
            throw Error(MIDAIR_RESULT_INVALID, "normals is " + std::to_string(normals.size()) +
                                                   " of them: give one for each of the " +
                                                   std::to_string(positions.size()) + " positions");
        }
        make(midair_array_new, detail::flat(positions), detail::flat(normals), positions.size());
    }

    /// Makes the array of a preset, such as "autd3", with this many boards along x and y.
    static Array preset(const std::string &name, std::size_t tiles_x = 1, std::size_t tiles_y = 1) {
        Array array;
        array.make(midair_array_preset, name.c_str(), tiles_x, tiles_y);
        return array;
    }

    /// Makes a flat grid with a pitch in m.
    static Array grid(std::size_t nx, std::size_t ny, double pitch) {
        Array array;
        array.make(midair_array_grid, nx, ny, pitch);
        return array;
    }

    /// Returns a copy that is rotated about the origin, then translated in m. The rotation has 3 numbers of an axis times the
    /// angle in rad, 4 of a quaternion w, x, y, z, 9 of a matrix, or none.
    Array moved(const std::vector<double> &rotation, const Point &translation = {}) const {
        Array array;
        array.make(midair_array_moved, get(), rotation.data(), rotation.size(), translation.data());
        return array;
    }

    /// Makes one array of several, in their order.
    static Array join(const std::vector<Array> &parts) {
        std::vector<const midair_array *> each;
        for (const Array &part : parts)
            each.push_back(part.get());
        Array array;
        array.make(midair_array_join, each.data(), each.size());
        return array;
    }

    /// Returns the number of transducers N.
    std::size_t size() const { return midair_array_count(get()); }

    Points positions() const {
        Points positions(size());
        detail::call(midair_array_positions, get(), positions.data()->data(), nullptr, size());
        return positions;
    }

    Points normals() const {
        Points normals(size());
        detail::call(midair_array_positions, get(), nullptr, normals.data()->data(), size());
        return normals;
    }

    const midair_array *get() const { return handle.get(); }

private:
    Array() = default;

    template <class Function, class... Arguments> void make(Function function, Arguments... arguments) {
        midair_array *made = nullptr;
        detail::call(function, arguments..., &made);
        handle.reset(made);
    }

    detail::Owned<midair_array> handle;
};

/// A drive, and the numbers of midair_answer.
struct Solution : midair_answer {
    std::vector<Complex> drive;
};

/// The drives (problems, N), one after the other, an answer for each, and the warnings, one per line.
struct Batch {
    Batch(std::size_t problems, std::size_t transducers) : drives(problems * transducers), answers(problems) {}

    std::vector<Complex> drives;
    std::vector<midair_answer> answers;
    std::string warning;
};

/// Solves several scenes, given as the texts of scene files, on at most this many threads (0 for one per processor). Each drive
/// is a row of N numbers, filled with 0 if a scene has fewer transducers. folder is the folder of files that scenes name.
inline Batch solve_scenes(const std::vector<std::string> &scenes, std::size_t transducers,
                          const std::string &folder = {}, std::size_t threads = 0) {
    Batch batch(scenes.size(), transducers);
    std::vector<const char *> texts;
    for (const std::string &scene : scenes) {
        texts.push_back(scene.c_str());
    }
    batch.warning = detail::call(midair_solve_scenes, texts.data(), folder.empty() ? nullptr : folder.c_str(),
                                 texts.size(), threads, detail::plain(batch.drives.data()), transducers,
                                 batch.answers.data());
    return batch;
}

/// An array and a method, for use by one thread at a time.
class Session {
public:
    Session(const Array &array, const std::string &method) : transducers(array.size()) {
        midair_session *made = nullptr;
        warnings = detail::call(midair_session_new, array.get(), method.c_str(), &made);
        handle.reset(made);
    }

    /// Makes a session from the text of a scene file; folder is the folder of the files that the scene names.
    static Session open(const std::string &scene, const std::string &folder = {}) {
        midair_session *made = nullptr;
        Session session;
        session.warnings =
            detail::call(midair_session_open, scene.c_str(), folder.empty() ? nullptr : folder.c_str(), &made);
        session.handle.reset(made);
        session.transducers = midair_session_transducers(made);
        return session;
    }

    midair_session *get() const { return handle.get(); }

    /// Solves the scene's own request.
    Solution solve() { return solve(Points{}); }

    void set(const std::string &name, double value) {
        warnings = detail::call(midair_session_set_number, handle.get(), name.c_str(), value);
    }

    void set(const std::string &name, const std::string &value) {
        warnings = detail::call(midair_session_set_text, handle.get(), name.c_str(), value.c_str());
    }

    template <class Bool, class = std::enable_if_t<std::is_same_v<Bool, bool>>>
    void set(const std::string &name, Bool value) {
        set(name, std::string(value ? "true" : "false"));
    }

    void set(const std::string &name, std::initializer_list<double> values) {
        set(name, std::vector<double>(values));
    }

    void set(const std::string &name, const std::vector<double> &values) {
        warnings =
            detail::call(midair_session_set_numbers, handle.get(), name.c_str(), values.data(), values.size());
    }

    /// Computes a drive for points; pressures and weights have one number for each point, or are left out.
    Solution solve(const Points &points, const std::vector<double> &pressures = {},
                   const std::vector<double> &weights = {}) {
        Solution solution;
        solution.drive.resize(transducers);
        static_cast<midair_answer &>(solution) =
            solve_into(solution.drive.data(), transducers, points, pressures, weights);
        return solution;
    }

    /// Does the same as solve(), into a buffer of N complex numbers. From the second call with the same sizes on, it allocates
    /// nothing.
    midair_answer solve_into(Complex *drive, std::size_t count, const Points &points,
                             const std::vector<double> &pressures = {}, const std::vector<double> &weights = {}) {
        midair_answer answer;
        const std::size_t each = points.size();
        warnings = detail::call(midair_session_solve, handle.get(), detail::flat(points),
                                detail::list("pressures", pressures, each), detail::list("weights", weights, each),
                                each, detail::plain(drive), count, &answer);
        return answer;
    }

    /// Computes drives for problems of `each` points, one problem after the other, on at most this many threads (0 for one per
    /// processor). pressures and weights have one number for each point, or are left out.
    Batch solve_batch(const Points &points, std::size_t each, const std::vector<double> &pressures = {},
                      const std::vector<double> &weights = {}, std::size_t threads = 0) {
        if (each == 0 || points.size() % each != 0) {
            throw Error(MIDAIR_RESULT_INVALID, "points is " + std::to_string(points.size()) +
                                                   " of them: give " + std::to_string(each) + " for each problem");
        }
        Batch batch(points.size() / each, transducers);
        batch.warning =
            detail::call(midair_session_solve_batch, handle.get(), detail::flat(points),
                         detail::list("pressures", pressures, points.size()),
                         detail::list("weights", weights, points.size()), batch.answers.size(), each, threads,
                         detail::plain(batch.drives.data()), transducers, batch.answers.data());
        return batch;
    }

    /// Computes the metrics of any drive.
    midair_metrics judge(const std::vector<Complex> &drive, const Points &points,
                         const std::vector<double> &pressures = {}, const std::vector<double> &weights = {}) const {
        midair_metrics metrics;
        const std::size_t each = points.size();
        detail::call(midair_session_judge, handle.get(), detail::plain(drive.data()), drive.size(),
                     detail::flat(points), detail::list("pressures", pressures, each),
                     detail::list("weights", weights, each), each, &metrics);
        return metrics;
    }

    /// Computes the complex pressures in Pa of any drive at any points.
    std::vector<Complex> field(const std::vector<Complex> &drive, const Points &points) const {
        std::vector<Complex> pressures(points.size());
        detail::call(midair_session_field, handle.get(), detail::plain(drive.data()), drive.size(),
                     detail::flat(points), points.size(), detail::plain(pressures.data()));
        return pressures;
    }

    /// Returns the complex pressures in Pa at the points of the last solution.
    std::vector<Complex> pressures() const {
        std::vector<Complex> values(midair_session_points(get()));
        detail::call(midair_session_pressures, get(), detail::plain(values.data()), nullptr, values.size());
        return values;
    }

    /// Returns the warnings of the last call that made, set or solved, one per line; empty if there are none.
    const std::string &warning() const { return warnings; }

private:
    Session() = default;

    std::size_t transducers = 0;
    std::string warnings;
    detail::Owned<midair_session> handle;
};

/// The boards of an array of N transducers.
class Board {
public:
    Board(const std::string &name, std::size_t transducers) {
        midair_board *made = nullptr;
        detail::call(midair_board_new, name.c_str(), transducers, &made);
        handle.reset(made);
    }

    /// Makes the boards for a session's array, with its channels and its mask.
    Board(const std::string &name, const Session &session) {
        midair_board *made = nullptr;
        detail::call(midair_board_of_session, name.c_str(), session.get(), &made);
        handle.reset(made);
    }

    const midair_board *get() const { return handle.get(); }

    /// Returns the frame that plays a drive, and writes a warning if it switches all off.
    std::vector<std::uint8_t> encode(const std::vector<Complex> &drive, std::string *warning = nullptr) const {
        std::vector<std::uint8_t> frame(midair_board_frame_size(get()));
        const std::string said = detail::call(midair_board_encode, get(), detail::plain(drive.data()), drive.size(),
                                              frame.data(), frame.size());
        if (warning)
            *warning = said;
        return frame;
    }

    /// Returns the bytes that switch the boards off.
    std::vector<std::uint8_t> silence() const {
        std::vector<std::uint8_t> bytes(midair_board_silence_size(handle.get()));
        detail::call(midair_board_silence, handle.get(), bytes.data(), bytes.size());
        return bytes;
    }

private:
    detail::Owned<midair_board> handle;
};

} // namespace midair

#endif // MIDAIR_HPP
