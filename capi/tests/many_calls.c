/* Many calls, valid and invalid ones, in one process: many_calls MODE CALLS.
 *
 * The mode "solves" solves with one session. In the mode "all", each call also makes a new array, session and board, solves
 * for 1 to 4 points in turn, and makes invalid calls of each function. The program fails if the memory in use has grown
 * after the first tenth of the calls. glibc counts the caches and arenas of threads as memory in use, unless
 * GLIBC_TUNABLES=glibc.malloc.tcache_count=0:glibc.malloc.arena_max=1. It also counts 304 bytes for each cached stack.
 */
#define _POSIX_C_SOURCE 199309L

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <midair.h>

#define N 64
/* So many problems that several threads get a part. */
#define MANY 2100

/* The most bytes that cached stacks take: less than a leak of 16 bytes in every tenth of 4000 calls. */
#define STACKS 2048

static char message[1024];

static void expect(midair_result result, midair_result wanted)
{
    if (result != wanted || (message[0] == '\0') != (wanted == MIDAIR_RESULT_OK)) {
        fprintf(stderr, "%d instead of %d: %s\n", (int)result, (int)wanted, message);
        exit(EXIT_FAILURE);
    }
}

static void granted(midair_result result) { expect(result, MIDAIR_RESULT_OK); }

static void refused(midair_result result) { expect(result, MIDAIR_RESULT_INVALID); }

/* Returns the bytes in use, after a pause: a thread frees its last kilobyte a moment after it has returned its results. */
static size_t in_use(void)
{
    struct timespec pause = {0, 50000000};
    struct mallinfo2 info;
    nanosleep(&pause, NULL);
    info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

static void open_session(midair_array **array, midair_session **session)
{
    granted(midair_array_grid(8, 8, 0.0105, array, message, sizeof message));
    granted(midair_session_new(*array, "fast", session, message, sizeof message));
}

static void solve(midair_session *session, size_t call, size_t count)
{
    double points[12];
    midair_complex drive[N];
    midair_answer answer;
    size_t j;
    for (j = 0; j < count; j++) {
        points[3 * j] = 0.02 * cos(0.01 * (double)call + (double)j);
        points[3 * j + 1] = 0.02 * sin(0.01 * (double)call + (double)j);
        points[3 * j + 2] = 0.12;
    }
    granted(midair_session_solve(session, points, NULL, NULL, count, drive, N, &answer, message, sizeof message));
}

static void solve_many(midair_session *session)
{
    static const char *const scenes[3] = {
        "signature = \"trap\"\n[array]\ngrid = { nx = 6, ny = 6, pitch = 0.0105 }\n[[points]]\nposition = [0, 0, 0.02]\n",
        "[array]\ngrid = { nx = 8, ny = 8, pitch = 0.0105 }\n[[obstacles]]\npoint = [0, 0.1, 0]\nnormal = [0, -1, 0]\n"
        "[[points]]\nposition = [0, 0, 0.1]\n",
        "[array]\ngrid = { nx = 8 }\n"};
    static midair_complex drives[MANY * N];
    static midair_answer answers[MANY];
    static double points[MANY * 3];
    size_t k;
    for (k = 0; k < MANY; k++) {
        points[3 * k] = 1e-5 * (double)k;
        points[3 * k + 1] = 0.0;
        points[3 * k + 2] = 0.12;
    }
    granted(midair_session_solve_batch(session, points, NULL, NULL, MANY, 1, 3, drives, N, answers, message, sizeof message));
    granted(midair_solve_scenes(scenes, NULL, 2, 2, drives, N, answers, message, sizeof message));
    refused(midair_solve_scenes(scenes, NULL, 3, 2, drives, N, answers, message, sizeof message));
    points[50] = NAN;
    refused(midair_session_solve_batch(session, points, NULL, NULL, MANY, 1, 3, drives, N, NULL, message, sizeof message));
}

/* Arrays made of others, a session with a motion, and a board of a session: the handles that `all` does not make itself. */
static void move(void)
{
    static const char *const scene = "[array]\ngrid = { nx = 4, ny = 4, pitch = 0.01 }\n[motion]\nrate = 1000\n"
                                     "[[motion.path]]\nkind = \"line\"\nstart = [0, 0, 0.1]\nend = [0.001, 0, 0.1]\nspeed = 0.5\n";
    const double rotation[3] = {0.0, 0.0, 0.1}, translation[3] = {0.1, 0.0, 0.0};
    double points[9];
    midair_array *array, *moved, *joined, *none;
    const midair_array *both[2];
    midair_session *session;
    midair_board *board;
    midair_motion motion;
    midair_link link;
    midair_complex drives[48];
    granted(midair_array_board("nano16", &array, message, sizeof message));
    granted(midair_array_moved(array, rotation, 3, translation, &moved, message, sizeof message));
    both[0] = array;
    both[1] = moved;
    granted(midair_array_join(both, 2, &joined, message, sizeof message));
    refused(midair_array_join(both, 0, &none, message, sizeof message));
    granted(midair_session_open(scene, NULL, &session, message, sizeof message));
    granted(midair_session_motion(session, &motion, message, sizeof message));
    granted(midair_session_frames(session, 0, 3, points, NULL, message, sizeof message));
    granted(midair_session_follow(session, 0, 3, drives, 16, message, sizeof message));
    refused(midair_session_follow(session, 0, 3, drives, 15, message, sizeof message));
    granted(midair_board_of_session("nano16", session, &board, message, sizeof message));
    granted(midair_board_link(board, &link, message, sizeof message));
    midair_board_free(board);
    midair_session_free(session);
    midair_array_free(joined);
    midair_array_free(moved);
    midair_array_free(array);
}

static void all(size_t call)
{
    const double point[3] = {0.0, 0.0, 0.12}, nowhere[3] = {0.0, NAN, 0.12}, ones[N] = {1.0};
    double positions[3 * N];
    midair_array *array, *other, *none;
    midair_session *session, *lost;
    midair_board *board;
    midair_metrics metrics;
    midair_complex drive[N], pressure;
    unsigned char bytes[4096];
    open_session(&array, &session);
    solve(session, call, 1 + call % 4);
    granted(midair_array_positions(array, positions, NULL, N, message, sizeof message));
    granted(midair_array_new(positions, NULL, N, &other, message, sizeof message));
    granted(midair_session_set_numbers(session, "mask", ones, N, message, sizeof message));
    granted(midair_session_set_text(session, "balance", "true", message, sizeof message));
    granted(midair_session_set_number(session, "seed", (double)call, message, sizeof message));
    granted(midair_session_solve(session, point, NULL, NULL, 1, drive, N, NULL, message, sizeof message));
    granted(midair_session_pressures(session, &pressure, NULL, midair_session_points(session), message, sizeof message));
    granted(midair_session_judge(session, drive, N, point, NULL, NULL, 1, &metrics, message, sizeof message));
    granted(midair_session_field(session, drive, N, point, 1, &pressure, message, sizeof message));
    if (call % 10 == 0) {
        solve_many(session);
        move();
    }
    granted(midair_board_new("mega64", N, &board, message, sizeof message));
    granted(midair_board_encode(board, drive, N, bytes, midair_board_frame_size(board), message, sizeof message));
    granted(midair_board_silence(board, bytes, midair_board_silence_size(board), message, sizeof message));
    refused(midair_array_preset("autd4", 1, 1, &none, message, sizeof message));
    refused(midair_session_new(other, "fsat", &lost, message, sizeof message));
    refused(midair_session_set_number(session, "block", -1.0, message, sizeof message));
    refused(midair_session_set_text(session, "balance", "maybe", message, sizeof message));
    refused(midair_session_set_numbers(session, "response", ones, 3, message, sizeof message));
    refused(midair_session_solve(session, nowhere, NULL, NULL, 1, drive, N, NULL, message, sizeof message));
    refused(midair_session_judge(session, drive, 3, point, NULL, NULL, 1, &metrics, message, sizeof message));
    refused(midair_session_field(session, drive, N, NULL, 1, &pressure, message, sizeof message));
    refused(midair_board_encode(board, drive, N, bytes, 3, message, sizeof message));
    midair_board_free(board);
    midair_session_free(session);
    midair_array_free(other);
    midair_array_free(array);
}

int main(int count, char **arguments)
{
    size_t calls = count == 3 ? strtoul(arguments[2], NULL, 10) : 0, call, before = 0;
    midair_array *array;
    midair_session *session;
    open_session(&array, &session);
    for (call = 0; call < calls; call++) {
        if (call == calls / 10) {
            before = in_use();
        }
        if (strcmp(arguments[1], "all") == 0) {
            all(call);
        } else {
            solve(session, call, 4);
        }
    }
    if (calls == 0 || (strcmp(arguments[1], "all") == 0 ? in_use() > before + STACKS : in_use() != before)) {
        fprintf(stderr, "%zu calls: %zu bytes in use, %zu after a tenth of them\n", calls, in_use(), before);
        return EXIT_FAILURE;
    }
    midair_session_free(session);
    midair_array_free(array);
    return EXIT_SUCCESS;
}
