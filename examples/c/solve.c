/* Two foci above a SonicSurface, how even they are, the field between them, and the bytes that make the board play.
 *
 *     cc -std=c99 solve.c $(pkg-config --cflags --libs midair) -lm -o solve
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <midair.h>

static char message[1024];

/* Ends the program after an error, and prints warnings. */
static void check(midair_result result)
{
    if (message[0] != '\0') {
        fprintf(stderr, "%s: %s\n", result == MIDAIR_RESULT_OK ? "warning" : "refused", message);
    }
    if (result != MIDAIR_RESULT_OK) {
        exit(EXIT_FAILURE);
    }
}

int main(void)
{
    const double points[] = {-0.02, 0.0, 0.15, 0.02, 0.0, 0.15}; /* x, y, z in m */
    const double pressures[] = {1000.0, 1000.0};                 /* Pa, peak */
    const double between[] = {0.0, 0.0, 0.15};
    midair_array *array = NULL;
    midair_session *session = NULL;
    midair_board *board = NULL;
    midair_complex *drive, pressure;
    midair_answer answer;
    unsigned char *frame;
    size_t count, size;

    if (midair_abi() != MIDAIR_ABI) {
        fprintf(stderr, "midair.h is of another library than midair %s\n", midair_version());
        return EXIT_FAILURE;
    }
    check(midair_array_preset("sonicsurface", 1, 1, &array, message, sizeof message));
    check(midair_session_new(array, "uniform", &session, message, sizeof message));
    check(midair_session_set_number(session, "temperature", 23.0, message, sizeof message));

    count = midair_array_count(array);
    drive = malloc(count * sizeof *drive);
    if (drive == NULL) {
        return EXIT_FAILURE;
    }
    check(midair_session_solve(session, points, pressures, NULL, 2, drive, count, &answer, message, sizeof message));
    printf("%zu transducers: level %.3f, uniformity %.3f, scale %.3f\n", count, answer.metrics.level,
           answer.metrics.uniformity, answer.scale);

    check(midair_session_field(session, drive, count, between, 1, &pressure, message, sizeof message));
    printf("between the foci: %.0f Pa\n", hypotf(pressure.re, pressure.im));

    check(midair_board_of_session("sonicsurface", session, &board, message, sizeof message));
    size = midair_board_frame_size(board);
    frame = malloc(size);
    if (frame == NULL) {
        return EXIT_FAILURE;
    }
    check(midair_board_encode(board, drive, count, frame, size, message, sizeof message));
    printf("a frame of %zu bytes: %u %u %u ...\n", size, frame[0], frame[1], frame[2]);

    free(frame);
    free(drive);
    midair_board_free(board);
    midair_session_free(session);
    midair_array_free(array);
    return EXIT_SUCCESS;
}
