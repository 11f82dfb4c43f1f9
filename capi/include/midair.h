/* midair: drives for airborne ultrasound phased arrays, so that the pressure at given points is what you request.
 *
 * cbindgen generates this file from capi/src: do not edit it. docs/c.md is the page for users; docs/conventions.md
 * states units, signs and rules.
 *
 * Every function that can fail returns MIDAIR_RESULT_OK, which is 0, or an error code. It writes a line that names the
 * item, its value and the cure to message, a buffer of message_size bytes; the line is cut to fit and ends with NUL.
 * With MIDAIR_RESULT_OK the message is empty or contains warnings, one per line. message may be NULL.
 *
 * Units are SI. Points, positions and normals are consecutive x, y, z. Texts are UTF-8 and end with NUL; in names, case,
 * "-" and "_" do not matter. The count beside a list is its number of entries; a complex number is one entry. A list
 * that is written must not overlap another list of the same call. A call that fails does not change the lists, and sets
 * a new handle to NULL.
 *
 * Arrays and boards never change, so threads may share them. Only one thread at a time may use a session. Free each
 * handle once, with its own function, after its last use.
 */

#ifndef MIDAIR_H
#define MIDAIR_H

#include <stddef.h>
#include <stdint.h>

// The binary interface that this header describes; midair_abi() of a compatible library returns the same number.
#define MIDAIR_ABI 1

// The result of a call. Unless it is MIDAIR_RESULT_OK, the caller's buffers have not changed, except for the message.
typedef enum {
    // Success. The message is empty or contains warnings, one per line.
    MIDAIR_RESULT_OK = 0,
    // An argument is invalid. The message names it, its value and the cure.
    MIDAIR_RESULT_INVALID = 1,
    // More memory than the limit, or than the machine has.
    MIDAIR_RESULT_MEMORY = 2,
    // An error of the library itself; please report it.
    MIDAIR_RESULT_FAULT = 3,
} midair_result;

// How a solve ended.
typedef enum {
    // The method ran to its end.
    MIDAIR_STATUS_DONE = 0,
    // The method's steps ran out before its tolerance was met.
    MIDAIR_STATUS_OUT_OF_STEPS = 1,
    // The solve was stopped; the answer is the best result so far.
    MIDAIR_STATUS_STOPPED = 2,
    // The method ran to its end, and the targets are missed by more than 1 %.
    MIDAIR_STATUS_MISSED = 3,
} midair_status;

// The link that carries bytes to boards.
typedef enum {
    // A serial line.
    MIDAIR_LINK_KIND_SERIAL = 0,
    // FIFOs of FTDI chips, one for each board.
    MIDAIR_LINK_KIND_FIFO = 1,
    // AUTD3's protocol over UDP.
    MIDAIR_LINK_KIND_UDP = 2,
} midair_link_kind;

// An array of transducers. It never changes: any number of threads may use it at the same time.
typedef struct midair_array midair_array;

// The boards of an array. They never change: any number of threads may use them at the same time.
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

// Results of a solve besides the drive.
typedef struct {
    // How the solve ended.
    midair_status status;
    // The number of steps taken.
    size_t steps;
    // The factor that supply voltage or modulation must apply to the drive; 1 unless the board's amplitudes are too coarse.
    double scale;
    // Metrics of the drive, with the scale applied.
    midair_metrics metrics;
} midair_answer;

// How bytes reach the boards, and what the boards can do by themselves. Of the int32_t fields, all but swap are 1 for yes, 0
// for no.
typedef struct {
    // The link that carries the bytes.
    midair_link_kind kind;
    // The number of lines. A frame consists of one part for each line, all of the same length, one after the other.
    size_t lines;
    // Bits per second of a serial line, where a byte takes ten bits; 0 for other links.
    uint32_t baud;
    // The most frames per second that the line can transmit.
    double rate;
    // The byte that exchanges the two banks of a board; -1 if it has no banks.
    int32_t swap;
    // Whether opening the port may restart the board.
    int32_t restarts;
    // Whether two boards may use the two lines of one chip.
    int32_t one_chip;
    // Whether amplitudes can be modulated.
    int32_t modulates;
    // Whether the boards can play a sequence by themselves.
    int32_t holds_sequence;
} midair_link;

// The frames of a motion.
typedef struct {
    // The number of frames T.
    size_t frames;
    // The number of points M.
    size_t points;
    // Frames per second.
    double rate;
    // Whether the last frame continues to the first: 1 for yes, 0 for no.
    int32_t closed;
} midair_motion;

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

// Makes the array of a kind of board, such as "nano16": its preset, or a grid if each owner wires this kind differently.
midair_result midair_array_board(const char *kind,
                                 midair_array **array,
                                 char *message,
                                 size_t message_size);

// Makes a flat grid of nx by ny transducers that radiate to +z, with a pitch in m. It lies in the plane z = 0, centred on the
// origin; x varies fastest.
midair_result midair_array_grid(size_t nx,
                                size_t ny,
                                double pitch,
                                midair_array **array,
                                char *message,
                                size_t message_size);

// Makes an array of count transducers at positions (count, 3) in m. They face along normals (count, 3), or along +z if normals
// is NULL.
midair_result midair_array_new(const double *positions,
                               const double *normals,
                               size_t count,
                               midair_array **array,
                               char *message,
                               size_t message_size);

// Makes a copy of an array that is rotated about the origin, then translated by x, y, z in m. The rotation has numbers: 3 of
// an axis times the angle in rad, 4 of a quaternion w, x, y, z, or 9 of a matrix, row by row; NULL and 0 for none. translation
// may be NULL. Air, lobe, responses and board stay.
midair_result midair_array_moved(const midair_array *from,
                                 const double *rotation,
                                 size_t numbers,
                                 const double *translation,
                                 midair_array **array,
                                 char *message,
                                 size_t message_size);

// Makes one array of the transducers of count arrays, in their order. They must have the same frequency, transducers and
// phases and amplitudes. The arrays may be freed afterwards.
midair_result midair_array_join(const midair_array *const *arrays,
                                size_t count,
                                midair_array **array,
                                char *message,
                                size_t message_size);

// Returns the number of transducers N; 0 for NULL.
size_t midair_array_count(const midair_array *array);

// Writes positions (count, 3) in m and unit normals (count, 3), where count is N. Either may be NULL.
midair_result midair_array_positions(const midair_array *array,
                                     double *positions,
                                     double *normals,
                                     size_t count,
                                     char *message,
                                     size_t message_size);

// Frees an array. Sessions made from it can still be used. NULL is allowed.
void midair_array_free(midair_array *array);

// Solves problems of count points each by one call, on at most this many threads (0 for one per processor). The inputs are
// points (problems, count, 3) in m, and pressures and weights (problems, count) as in midair_session_solve(). The outputs are
// drives (problems, transducers) and answers (problems,), which may be NULL. Each answer has the same bits as that of
// midair_session_solve() for the problem alone in a new session, for any number of threads. If a problem is rejected, the
// message gives its index, and nothing is written. Problems with fewer points can be filled with points of weight 0.
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

// Solves the requests of count scenes by one call, on at most this many threads (0 for one per processor). scenes (count,) are
// texts as for midair_session_open(); folder is the folder of the files that scenes name, or NULL. drives (count, transducers)
// has one row for each scene; a row is filled with 0 after the drive of a scene with fewer transducers. answers (count,) may
// be NULL. If a scene is rejected, the message gives its index, and nothing is written.
midair_result midair_solve_scenes(const char *const *scenes,
                                  const char *folder,
                                  size_t count,
                                  size_t threads,
                                  midair_complex *drives,
                                  size_t transducers,
                                  midair_answer *answers,
                                  char *message,
                                  size_t message_size);

// Makes as many boards of this kind, such as "sonicsurface" or "openmpd", as an array of this many transducers needs. Drives
// must be in the order of the kind's preset; midair_board_of_session checks this.
midair_result midair_board_new(const char *name,
                               size_t transducers,
                               midair_board **board,
                               char *message,
                               size_t message_size);

// Makes as many boards of this kind as a session's array needs. The array stands in the order of the boards, moved and turned,
// or states its pins; otherwise the message names the order that fits. Transducers that its option "channels", its preset or
// its scene wires together share a channel; transducers that its mask switches off have none. The session may be freed
// afterwards.
midair_result midair_board_of_session(const char *name,
                                      midair_session *session,
                                      midair_board **board,
                                      char *message,
                                      size_t message_size);

// Returns the size of a frame in bytes, for all boards; 0 for NULL.
size_t midair_board_frame_size(const midair_board *board);

// Writes the frame that makes the boards play a drive of this many transducers; size is midair_board_frame_size(). The message
// warns of a drive so weak that all of it is off.
midair_result midair_board_encode(const midair_board *board,
                                  const midair_complex *drive,
                                  size_t transducers,
                                  uint8_t *frame,
                                  size_t size,
                                  char *message,
                                  size_t message_size);

// Returns the number of bytes that switch the boards off; 0 for NULL.
size_t midair_board_silence_size(const midair_board *board);

// Writes the bytes that switch the boards off from any state; size is midair_board_silence_size().
midair_result midair_board_silence(const midair_board *board,
                                   uint8_t *bytes,
                                   size_t size,
                                   char *message,
                                   size_t message_size);

// Writes to link how bytes reach the boards, and what the boards can do by themselves.
midair_result midair_board_link(const midair_board *board,
                                midair_link *link,
                                char *message,
                                size_t message_size);

// Frees a board. NULL is allowed.
void midair_board_free(midair_board *board);

// Writes to motion the number of frames, and more, of a session that was made from a scene file with [motion].
midair_result midair_session_motion(midair_session *session,
                                    midair_motion *motion,
                                    char *message,
                                    size_t message_size);

// Writes the points (frames, points, 3) in m and the targets (frames, points) in Pa of some frames of a motion, from first on.
// A target of 0 stands for a point that is absent. targets may be NULL.
midair_result midair_session_frames(midair_session *session,
                                    size_t first,
                                    size_t frames,
                                    double *points,
                                    double *targets,
                                    char *message,
                                    size_t message_size);

// Solves some frames of a motion, from first on, one after another within the bound of the motion, and writes the drives
// (frames, transducers), where transducers is N. Frames that do not begin with 0 follow those of the last call.
midair_result midair_session_follow(midair_session *session,
                                    size_t first,
                                    size_t frames,
                                    midair_complex *drives,
                                    size_t transducers,
                                    char *message,
                                    size_t message_size);

// Returns the code of the error of this thread's last call that can fail, such as "too-near"; an empty text if it did not fail.
// docs/errors.md lists all codes. They never change, unlike the words of messages. The text is valid as long as the library is
// loaded.
const char *midair_last_code(void);

// Makes a session for an array and a method, such as "uniform" or "fast", with the array's default medium. The session has a
// copy of the array, which may be freed.
midair_result midair_session_new(const midair_array *array,
                                 const char *method,
                                 midair_session **session,
                                 char *message,
                                 size_t message_size);

// Makes a session from the text of a scene file, TOML or JSON: its array, medium, obstacles, signature, solver and points.
// folder is the folder of the files that the scene names; if folder is NULL, such files are errors. Shapes of text or
// drawings, images and files of meshes need the Python package, and are errors. midair_session_solve() with 0 points solves
// the scene's own request. Of a scene with [motion], midair_session_follow() solves the frames.
midair_result midair_session_open(const char *scene,
                                  const char *folder,
                                  midair_session **session,
                                  char *message,
                                  size_t message_size);

// Returns the number N of a session's transducers, the length of a drive; 0 for NULL and for a session in use by another
// thread.
size_t midair_session_transducers(const midair_session *session);

// Sets an option to a number: of the medium (every key of `[medium]` in a scene file, such as "temperature"), of the
// transducers ("source_pressure", or "directivity." and the name of a directivity with a parameter, as in
// "directivity.piston"), of the bead that traps are made for ("bead.radius", "bead.density", "bead.sound_speed"), or of the
// method. After an option is set, the session has no memory of earlier requests.
midair_result midair_session_set_number(midair_session *session,
                                        const char *name,
                                        double value,
                                        char *message,
                                        size_t message_size);

// Sets an option to a text: "directivity" ("point", "t4010a1", ...), "quantization" (a board's name, or "none" for any drive),
// "balance" ("true" or "false"), "aim" ("target" or "max"), or an option of the method.
midair_result midair_session_set_text(midair_session *session,
                                      const char *name,
                                      const char *value,
                                      char *message,
                                      size_t message_size);

// Sets an option to a list: "mask" (N, 1 for on and 0 for off), "response" (N, 2; real and imaginary part), "channels" (N,
// shared channels), "pins" (N, channels of the boards), "bead.gravity" (3, along x, y and z in m/s^2), or an option of the
// method.
midair_result midair_session_set_numbers(midair_session *session,
                                         const char *name,
                                         const double *values,
                                         size_t count,
                                         char *message,
                                         size_t message_size);

// Computes a drive for points (count, 3) in m, and writes it to drive (transducers,), where transducers is N. pressures
// (count,) are peak |p| in Pa; if NULL, all points get the level that the array can give to all of them at once. weights
// (count,) may be NULL for 1 everywhere; answer may be NULL. With 0 points, a session made from a scene solves the scene's own
// request. Each kind of warning is in the message once per session; without a message, warnings are not computed. Warnings
// about array and medium are in the message of the call that made the session, and in that of the first solve.
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

// Returns the number M of points of the session's last solution; 0 if there is none, and for a session in use by another
// thread.
size_t midair_session_points(const midair_session *session);

// Writes the complex pressures (count,) in Pa (peak) of the session's last solution, its scale applied, and its points
// (count, 3) in m; count is midair_session_points(). points may be NULL. With a signature the pressures are those of the foci
// before they become traps; midair_session_field() computes the real ones.
midair_result midair_session_pressures(midair_session *session,
                                       midair_complex *pressures,
                                       double *points,
                                       size_t count,
                                       char *message,
                                       size_t message_size);

// Computes the metrics of a drive (transducers,) at points (count, 3) in m, in double precision; pressures and weights
// (count,) are as in midair_session_solve(). With 0 points, a session made from a scene refers to the scene's own request.
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

// Frees a session. NULL is allowed.
void midair_session_free(midair_session *session);

// Returns the version of the library, such as "0.2.0". The text is valid as long as the library is loaded.
const char *midair_version(void);

// Returns the number of the library's binary interface, to compare with MIDAIR_ABI.
uint32_t midair_abi(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* MIDAIR_H */
