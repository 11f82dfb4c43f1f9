/* midair: drives for airborne ultrasound phased arrays, so that the pressure at given points is what you request.
 *
 * This file is made from capi/src by cbindgen: do not edit it. docs/c.md is the page for users, docs/conventions.md
 * states units, signs and rules.
 *
 * Every function that can fail returns MIDAIR_RESULT_OK, which is 0, or what went wrong, and writes a line that names
 * the item, its value and the cure to message, a buffer of message_size bytes, cut to fit and ended by NUL. With
 * MIDAIR_RESULT_OK the message is empty or holds warnings, a line each. NULL in its place is no message.
 *
 * SI units; points, positions and normals are x, y, z in a row; texts are UTF-8 ended by NUL, and names ignore case,
 * "-" and "_". Lists hold as many entries as the count beside them says; a complex number is one. Lists that are
 * written overlap no other of the same call. A call that fails leaves them as they were, and a new handle NULL.
 *
 * Arrays and boards never change: threads may share them. A session is used by one thread at a time. A handle is freed
 * once, by its own function, after its last use.
 */

#ifndef MIDAIR_H
#define MIDAIR_H

#include <stddef.h>
#include <stdint.h>

// The binary interface that this header describes; midair_abi() of a library that fits gives the same number.
#define MIDAIR_ABI 1

// The outcome of a call. Everything but MIDAIR_RESULT_OK left the caller's buffers as they were, but the message.
typedef enum {
    // Done. The message is empty, or remarks that the caller should hear, a line each.
    MIDAIR_RESULT_OK = 0,
    // An argument cannot be meant. The message names it, its value and the cure.
    MIDAIR_RESULT_INVALID = 1,
    // More memory than allowed, or than there is.
    MIDAIR_RESULT_MEMORY = 2,
    // A fault of the library's own, to be reported.
    MIDAIR_RESULT_FAULT = 3,
} midair_result;

// How a solve ended.
typedef enum {
    // The method ran to its end.
    MIDAIR_STATUS_DONE = 0,
    // The method's steps ran out before its tolerance was met.
    MIDAIR_STATUS_OUT_OF_STEPS = 1,
    // It was stopped; the answer is the best so far.
    MIDAIR_STATUS_STOPPED = 2,
    // The method ran to its end, and the targets are missed by more than 1 %.
    MIDAIR_STATUS_MISSED = 3,
} midair_status;

// The link that carries bytes to boards.
typedef enum {
    // A serial line.
    MIDAIR_LINK_KIND_SERIAL = 0,
    // FIFOs of FTDI chips, one a board.
    MIDAIR_LINK_KIND_FIFO = 1,
    // AUTD3's protocol over UDP.
    MIDAIR_LINK_KIND_UDP = 2,
} midair_link_kind;

// An array of transducers. It never changes: any number of threads may use it at the same time.
typedef struct midair_array midair_array;

// The boards behind an array. It never changes: any number of threads may use it at the same time.
typedef struct midair_board midair_board;

// An array, a method with its options, and the memory of their solves. One thread at a time may use a session;
// different sessions may be used by different threads at the same time.
typedef struct midair_session midair_session;

// A complex number, the same in memory as C's `float _Complex` and C++'s `std::complex<float>`.
typedef struct {
    // Real part.
    float re;
    // Imaginary part.
    float im;
} midair_complex;

// How good a drive is, over the points with a pressure and a weight above 0, x_j = |p_j| / target_j.
typedef struct {
    // sum |p_j| / sum target_j, unclipped: eq. (12).
    double accuracy;
    // Standard deviation (1/M) of x / max x: eq. (13) for equal targets. 0 for one point or silence.
    double sigma;
    // min x / max x; 1 for one point, 0 in silence.
    double uniformity;
    // Mean x.
    double level;
    // sum w (target - |p|)^2 / sum w target^2: eq. (7) relative to silence.
    double residual;
    // max |p_j| over the quiet points (target 0) over the largest target; 0 where there are none.
    double leak;
} midair_metrics;

// Results of a solve beside the drive.
typedef struct {
    // How it ended.
    midair_status status;
    // Steps taken.
    size_t steps;
    // The factor that supply or modulation must apply to the drive; 1 unless the board has no such amplitude.
    double scale;
    // How good it is, the scale counted in.
    midair_metrics metrics;
} midair_answer;

// How bytes reach boards, and what these do by themselves; 1 for yes, 0 for no.
typedef struct {
    // The link that carries the bytes.
    midair_link_kind kind;
    // Number of lines; a frame consists of one part for each line, all of the same length, one after the other.
    size_t lines;
    // Bits a second of a serial line, ten to a byte; else 0.
    uint32_t baud;
    // Frames a second that the line can carry.
    double rate;
    // The byte that exchanges the two banks of a board that has them, else -1.
    int32_t swap;
    // Whether opening the port may restart the board.
    int32_t restarts;
    // Whether the lines of two boards may be the two of one chip.
    int32_t one_chip;
    // Whether amplitudes can be modulated.
    int32_t modulates;
    // Whether the boards can play a sequence by themselves.
    int32_t holds_sequence;
} midair_link;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Makes the array of a preset, such as "autd3" or "paper20", of tiles_x by tiles_y boards (1 by 1 for a single one).
midair_result midair_array_preset(const char *name,
                                  size_t tiles_x,
                                  size_t tiles_y,
                                  midair_array **array,
                                  char *message,
                                  size_t message_size);

// Makes the array of a kind of board, such as "nano16": its preset, or a grid for a kind that each owner wires differently.
midair_result midair_array_board(const char *kind,
                                 midair_array **array,
                                 char *message,
                                 size_t message_size);

// Makes a flat grid of nx by ny transducers, pitch metres apart, centred in z = 0, x fastest, that radiate to +z.
midair_result midair_array_grid(size_t nx,
                                size_t ny,
                                double pitch,
                                midair_array **array,
                                char *message,
                                size_t message_size);

// Makes an array of count transducers at positions (count, 3) in m that look along normals (count, 3); with normals
// NULL along +z.
midair_result midair_array_new(const double *positions,
                               const double *normals,
                               size_t count,
                               midair_array **array,
                               char *message,
                               size_t message_size);

// Number of transducers N; 0 for NULL.
size_t midair_array_count(const midair_array *array);

// Writes positions (count, 3) in m and unit normals (count, 3), count being N; either may be NULL.
midair_result midair_array_positions(const midair_array *array,
                                     double *positions,
                                     double *normals,
                                     size_t count,
                                     char *message,
                                     size_t message_size);

// Frees an array. Sessions made of it go on. NULL is nothing to free.
void midair_array_free(midair_array *array);

// Solves problems of count points each by one call, over this many threads at most (0 for one a processor): points
// (problems, count, 3) in m, pressures and weights (problems, count) as in midair_session_solve(), drives (problems,
// transducers), answers (problems,), which may be NULL. Each answer is bit for bit that of midair_session_solve() for the
// problem alone in a new session, whatever the threads. A refused problem is named, and nothing is written. A weight of 0
// fills up problems of fewer points.
midair_result midair_session_solve_batch(midair_session *session,
                                         const double *points,
                                         const double *pressures,
                                         const double *weights,
                                         size_t problems,
                                         size_t count,
                                         size_t threads,
                                         midair_complex *drives,
                                         size_t transducers,
                                         midair_answer *answers,
                                         char *message,
                                         size_t message_size);

// Solves the requests of count scenes by one call, over this many threads at most (0 for one a processor): scenes (count,) are
// texts as midair_session_open() takes them, folder is where they look up files, or NULL. drives (count, transducers) have a
// row for each scene, with 0 behind the drive of a scene of fewer transducers; answers (count,) may be NULL. A refused scene
// is named, and nothing is written.
midair_result midair_solve_scenes(const char *const *scenes,
                                  const char *folder,
                                  size_t count,
                                  size_t threads,
                                  midair_complex *drives,
                                  size_t transducers,
                                  midair_answer *answers,
                                  char *message,
                                  size_t message_size);

// Makes as many boards of a kind, such as "sonicsurface" or "openmpd", as an array of this many transducers needs, in the
// order of the kind's preset.
midair_result midair_board_new(const char *name,
                               size_t transducers,
                               midair_board **board,
                               char *message,
                               size_t message_size);

// Makes as many boards of a kind as a session's array needs: one channel for the transducers that its option "channels", its
// preset or its scene wires together, and none for those that its mask switches off. The session may be freed.
midair_result midair_board_of_session(const char *name,
                                      midair_session *session,
                                      midair_board **board,
                                      char *message,
                                      size_t message_size);

// Bytes of a frame, for all boards; 0 for NULL.
size_t midair_board_frame_size(const midair_board *board);

// Writes the frame that makes the boards play a drive of this many transducers, size being midair_board_frame_size().
midair_result midair_board_encode(const midair_board *board,
                                  const midair_complex *drive,
                                  size_t transducers,
                                  uint8_t *frame,
                                  size_t size,
                                  char *message,
                                  size_t message_size);

// Bytes that silence the boards; 0 for NULL.
size_t midair_board_silence_size(const midair_board *board);

// Writes the bytes that silence the boards from any state, size being midair_board_silence_size().
midair_result midair_board_silence(const midair_board *board,
                                   uint8_t *bytes,
                                   size_t size,
                                   char *message,
                                   size_t message_size);

// Writes how bytes reach the boards.
midair_result midair_board_link(const midair_board *board,
                                midair_link *link,
                                char *message,
                                size_t message_size);

// Frees a board. NULL is nothing to free.
void midair_board_free(midair_board *board);

// Makes a session of an array and a method, such as "uniform" or "fast", in the array's own medium. The session keeps
// what it needs of the array, which may be freed.
midair_result midair_session_new(const midair_array *array,
                                 const char *method,
                                 midair_session **session,
                                 char *message,
                                 size_t message_size);

// Makes a session of a scene file's text, TOML or JSON: its array, medium, obstacles, signature, solver and points. Files
// that it names are looked up in folder; with NULL they are refused, as are shapes, images and meshes, which need Python.
// midair_session_solve() with 0 points solves the scene's own.
midair_result midair_session_open(const char *scene,
                                  const char *folder,
                                  midair_session **session,
                                  char *message,
                                  size_t message_size);

// Number N of a session's transducers, so that a drive has room; 0 for NULL and for a session at work.
size_t midair_session_transducers(const midair_session *session);

// Sets an option to a number: of the medium (every key of `[medium]` in a scene file, such as "temperature"), of the
// transducers ("source_pressure", "directivity." and the name of a directivity that takes a parameter, as in
// "directivity.piston"), of the bead that traps are made for ("bead.radius", "bead.density", "bead.sound_speed"), or of the
// method. A session whose options are set begins again.
midair_result midair_session_set_number(midair_session *session,
                                        const char *name,
                                        double value,
                                        char *message,
                                        size_t message_size);

// Sets an option to a text: "directivity" ("point", "t4010a1", ...), "quantization" (a board's name, or "none" for any
// drive), "balance" ("true" or "false"), "aim" ("target" or "max"), or one of the method.
midair_result midair_session_set_text(midair_session *session,
                                      const char *name,
                                      const char *value,
                                      char *message,
                                      size_t message_size);

// Sets an option to a list: "mask" (N, 1 for on and 0 for off), "response" (N, 2; real and imaginary part), "channels" (N, the
// driven channel of each), "bead.gravity" (3, along x, y and z in m/s^2), or one of the method.
midair_result midair_session_set_numbers(midair_session *session,
                                         const char *name,
                                         const double *values,
                                         size_t count,
                                         char *message,
                                         size_t message_size);

// Finds a drive for points (count, 3) in m and writes it to drive (transducers,), transducers being N. pressures (count,)
// are peak |p| in Pa; with NULL all are the level that the array reaches at all points at once. weights (count,) may be
// NULL, for 1 everywhere, and answer, too. With 0 points, a session of a scene solves the scene's own request. Warnings in
// the message come once a session for each kind; without a message they are not looked for.
midair_result midair_session_solve(midair_session *session,
                                   const double *points,
                                   const double *pressures,
                                   const double *weights,
                                   size_t count,
                                   midair_complex *drive,
                                   size_t transducers,
                                   midair_answer *answer,
                                   char *message,
                                   size_t message_size);

// Judges a drive (transducers,) at points (count, 3) in m, in double precision; pressures and weights (count,) as in
// midair_session_solve().
midair_result midair_session_judge(midair_session *session,
                                   const midair_complex *drive,
                                   size_t transducers,
                                   const double *points,
                                   const double *pressures,
                                   const double *weights,
                                   size_t count,
                                   midair_metrics *metrics,
                                   char *message,
                                   size_t message_size);

// Writes the complex pressures (count,) in Pa (peak) of a drive (transducers,) at any points (count, 3) in m.
midair_result midair_session_field(midair_session *session,
                                   const midair_complex *drive,
                                   size_t transducers,
                                   const double *points,
                                   size_t count,
                                   midair_complex *pressures,
                                   char *message,
                                   size_t message_size);

// Frees a session. NULL is nothing to free.
void midair_session_free(midair_session *session);

// Version of the library, such as "0.2.0". The text lives as long as the library is loaded.
const char *midair_version(void);

// Number of the library's binary interface, to be compared with MIDAIR_ABI.
uint32_t midair_abi(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* MIDAIR_H */
