/* midair_mex: the C library of midair in MATLAB and Octave. midair_build compiles this file.
 *
 * midair_mex(COMMAND, ...) makes one call of the library. Only the functions of +midair call it. The sessions of scenes stand in
 * a table. MATLAB has only their places in it, so no number can be an address that is not there.
 *
 * Real and imaginary parts are separate arrays: this is the API that `mex` of MATLAB and Octave takes by default. In the
 * interleaved API of Octave 7, complex arrays have half of their memory.
 *
 * Errors and warnings are made by error() and warning() of the language, because mexErrMsgIdAndTxt of Octave writes the name of
 * this file before the line. error() does not return. No function of the library is active then, and the language frees all
 * memory of mxMalloc and mxCreate.
 */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "mex.h"
#include "midair.h"

/* The most scenes that are open at a time. */
#define PLACES 4096

typedef const mxArray *const *Inputs;

/* The sessions of open scenes; NULL at a free place. */
static midair_session *sessions[PLACES];

/* The library's line, or its warnings. */
static char message[8192];

/* Calls error() or warning() with a line. */
static void report(const char *function, const char *code, const char *line)
{
    char id[64], *letter;
    mxArray *inputs[3];
    snprintf(id, sizeof id, "midair:%s", code);
    /* Identifiers of MATLAB have no hyphens. */
    while ((letter = strchr(id, '-')) != NULL) {
        *letter = '_';
    }
    inputs[0] = mxCreateString(id);
    inputs[1] = mxCreateString("%s");
    inputs[2] = mxCreateString(line);
    mexCallMATLAB(0, NULL, 3, inputs, function);
}

/* Makes the error of a wrong input. */
static void refuse(const char *code, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(message, sizeof message, format, values);
    va_end(values);
    report("error", code, message);
}

/* Makes the errors and warnings of a call of the library. */
static void check(midair_result result)
{
    if (result != MIDAIR_RESULT_OK) {
        report("error", midair_last_code(), message);
    }
    for (const char *line = strtok(message, "\n"); line != NULL; line = strtok(NULL, "\n")) {
        report("warning", "scene", line);
    }
}

/* Returns the place of a session in the table. */
static midair_session **find(const mxArray *input)
{
    double place = input != NULL && mxIsDouble(input) && !mxIsEmpty(input) ? mxGetScalar(input) : 0.0;
    size_t k = place >= 1.0 && place <= PLACES ? (size_t)place - 1 : 0;
    if (place != (double)k + 1.0 || sessions[k] == NULL) {
        refuse("missing", "the scene is closed: make another one by midair.Scene");
    }
    return &sessions[k];
}

/* Returns a text in UTF-8, as Octave stores it. (Octave never frees the memory of mxArrayToString.) */
static const char *text(const char *item, const mxArray *input)
{
    if (input == NULL || !mxIsChar(input)) {
        refuse("type", "%s is no text: give one", item);
    }
#ifdef MATLAB_MEX_FILE
    return mxArrayToUTF8String(input);
#else
    size_t size = mxGetNumberOfElements(input) + 1;
    char *copy = mxCalloc(size, 1);
    mxGetString(input, copy, size);
    return copy;
#endif
}

/* Returns real numbers, or NULL if they are left out: [], as opposed to an empty selection of 0 x 3. */
static const double *reals(const char *item, const mxArray *input)
{
    if (input == NULL || (mxIsDouble(input) && mxGetM(input) == 0 && mxGetN(input) == 0)) {
        return NULL;
    }
    if (!mxIsDouble(input) || mxIsComplex(input) || mxIsSparse(input)) {
        refuse("type", "%s is of class %s%s%s: give real numbers of class double", item, mxGetClassName(input),
               mxIsComplex(input) ? ", complex" : "", mxIsSparse(input) ? ", sparse" : "");
    }
    return mxGetPr(input);
}

/* Returns points row by row. */
static const double *points(const mxArray *input, size_t *count)
{
    const double *columns = reals("points", input);
    *count = columns == NULL ? 0 : mxGetM(input);
    if (columns != NULL && (mxGetN(input) != 3 || *count == 0)) {
        refuse("shape", "points is %zu x %zu: give M x 3, a row for each point", *count, (size_t)mxGetN(input));
    }
    double *rows = mxMalloc((3 * *count + 1) * sizeof *rows);
    for (size_t k = 0; k < 3 * *count; k++) {
        rows[k] = columns[k / 3 + *count * (k % 3)];
    }
    return rows;
}

/* Returns a number for each of count points. */
static const double *numbers(const char *item, const mxArray *input, size_t count)
{
    const double *values = reals(item, input);
    size_t size = values == NULL ? 0 : mxGetNumberOfElements(input);
    if (values != NULL && (count == 0 || (size != 1 && size != count))) {
        refuse("shape", "%s has %zu numbers for %zu points: give points, and one number or one for each", item, size, count);
    }
    if (size != 1) {
        return values;
    }
    double *list = mxMalloc(count * sizeof *list);
    for (size_t k = 0; k < count; k++) {
        list[k] = values[0];
    }
    return list;
}

static midair_complex *room(size_t count) { return mxCalloc(count + 1, sizeof(midair_complex)); }

/* Returns the complex numbers of drives. */
static const midair_complex *drives(const mxArray *input, size_t *count)
{
    if (input == NULL || !mxIsDouble(input) || mxIsSparse(input) || mxIsEmpty(input)) {
        refuse("type", "drive has no numbers: give a column of complex numbers");
    }
    *count = mxGetNumberOfElements(input);
    const double *re = mxGetPr(input), *im = mxIsComplex(input) ? mxGetPi(input) : NULL;
    midair_complex *list = room(*count);
    for (size_t k = 0; k < *count; k++) {
        list[k].re = (float)re[k];
        list[k].im = im == NULL ? 0.0f : (float)im[k];
    }
    return list;
}

static mxArray *complexes(const midair_complex *list, size_t rows, size_t columns)
{
    mxArray *array = mxCreateDoubleMatrix(rows, columns, mxCOMPLEX);
    double *re = mxGetPr(array), *im = mxGetPi(array);
    for (size_t k = 0; k < rows * columns; k++) {
        re[k] = list[k].re;
        im[k] = list[k].im;
    }
    return array;
}

static mxArray *structure(int count, const char **names, mxArray **values)
{
    mxArray *structure = mxCreateStructMatrix(1, 1, count, names);
    for (int k = 0; k < count; k++) {
        mxSetFieldByNumber(structure, 0, k, values[k]);
    }
    return structure;
}

static mxArray *metrics_of(const midair_metrics *metrics)
{
    const char *names[] = {"accuracy", "sigma", "uniformity", "level", "residual", "leak"};
    mxArray *values[] = {mxCreateDoubleScalar(metrics->accuracy),   mxCreateDoubleScalar(metrics->sigma),
                         mxCreateDoubleScalar(metrics->uniformity), mxCreateDoubleScalar(metrics->level),
                         mxCreateDoubleScalar(metrics->residual),   mxCreateDoubleScalar(metrics->leak)};
    return structure(6, names, values);
}

static void open_scene(mxArray **out, Inputs in)
{
    const char *scene = text("scene", in[0]), *folder = text("folder", in[1]);
    size_t k = 0;
    for (; k < PLACES && sessions[k] != NULL; k++) {
    }
    if (k == PLACES) {
        refuse("memory", "%d scenes are open: clear some", PLACES);
    }
    *out = mxCreateDoubleScalar((double)k + 1.0);
    check(midair_session_open(scene, *folder == '\0' ? NULL : folder, &sessions[k], message, sizeof message));
}

static void solve(mxArray **out, Inputs in)
{
    static const char *const statuses[] = {"done", "out_of_steps", "stopped", "missed"};
    const char *names[] = {"drive", "points", "pressures", "status", "steps", "scale", "metrics"};
    midair_session *session = *find(in[0]);
    size_t transducers = midair_session_transducers(session), count;
    const double *requested = points(in[1], &count);
    midair_complex *drive = room(transducers);
    midair_answer answer;
    check(midair_session_solve(session, requested, numbers("pressures", in[2], count), numbers("weights", in[3], count),
                               count, drive, transducers, &answer, message, sizeof message));
    count = midair_session_points(session);
    midair_complex *pressures = room(count);
    double *rows = mxMalloc((3 * count + 1) * sizeof *rows);
    check(midair_session_pressures(session, pressures, rows, count, message, sizeof message));
    mxArray *places = mxCreateDoubleMatrix(count, 3, mxREAL);
    for (size_t k = 0; k < 3 * count; k++) {
        mxGetPr(places)[k / 3 + count * (k % 3)] = rows[k];
    }
    mxArray *values[] = {complexes(drive, transducers, 1),           places,
                         complexes(pressures, count, 1),             mxCreateString(statuses[answer.status]),
                         mxCreateDoubleScalar((double)answer.steps), mxCreateDoubleScalar(answer.scale),
                         metrics_of(&answer.metrics)};
    *out = structure(7, names, values);
}

static void field(mxArray **out, Inputs in)
{
    size_t transducers, count;
    const midair_complex *drive = drives(in[1], &transducers);
    const double *places = points(in[2], &count);
    midair_complex *pressures = room(count);
    check(midair_session_field(*find(in[0]), drive, transducers, places, count, pressures, message, sizeof message));
    *out = complexes(pressures, count, 1);
}

static void judge(mxArray **out, Inputs in)
{
    size_t transducers, count;
    const midair_complex *drive = drives(in[1], &transducers);
    const double *places = points(in[2], &count);
    midair_metrics metrics;
    check(midair_session_judge(*find(in[0]), drive, transducers, places, numbers("pressures", in[3], count),
                               numbers("weights", in[4], count), count, &metrics, message, sizeof message));
    *out = metrics_of(&metrics);
}

static void sequence(mxArray **out, Inputs in)
{
    const char *names[] = {"drives", "points", "targets", "rate", "closed"};
    midair_session *session = *find(in[0]);
    size_t transducers = midair_session_transducers(session);
    midair_motion motion;
    check(midair_session_motion(session, &motion, message, sizeof message));
    mwSize shape[] = {3, motion.points, motion.frames};
    midair_complex *drives = room(transducers * motion.frames);
    mxArray *places = mxCreateNumericArray(3, shape, mxDOUBLE_CLASS, mxREAL);
    mxArray *targets = mxCreateDoubleMatrix(motion.points, motion.frames, mxREAL);
    check(midair_session_frames(session, 0, motion.frames, mxGetPr(places), mxGetPr(targets), message, sizeof message));
    check(midair_session_follow(session, 0, motion.frames, drives, transducers, message, sizeof message));
    mxArray *values[] = {complexes(drives, transducers, motion.frames), places, targets, mxCreateDoubleScalar(motion.rate),
                         mxCreateLogicalScalar(motion.closed != 0)};
    *out = structure(5, names, values);
}

static void encode(mxArray **out, Inputs in)
{
    midair_session *session = *find(in[0]);
    const char *kind = text("board", in[1]);
    size_t transducers = midair_session_transducers(session), numbers;
    const midair_complex *drive = drives(in[2], &numbers);
    if (numbers == 0 || numbers % transducers != 0) {
        refuse("shape", "drives has %zu numbers: give %zu for each frame", numbers, transducers);
    }
    midair_board *board;
    midair_result result = midair_board_of_session(kind, session, &board, message, sizeof message);
    size_t size = midair_board_frame_size(board);
    *out = mxCreateNumericMatrix(size, numbers / transducers, mxUINT8_CLASS, mxREAL);
    for (size_t k = 0; k < numbers / transducers && result == MIDAIR_RESULT_OK; k++) {
        result = midair_board_encode(board, drive + k * transducers, transducers, (uint8_t *)mxGetData(*out) + k * size, size,
                                     message, sizeof message);
    }
    midair_board_free(board);
    check(result);
}

static void silence(mxArray **out, Inputs in)
{
    const char *kind = text("board", in[1]);
    midair_board *board;
    midair_result result = midair_board_of_session(kind, *find(in[0]), &board, message, sizeof message);
    size_t size = midair_board_silence_size(board);
    *out = mxCreateNumericMatrix(size, 1, mxUINT8_CLASS, mxREAL);
    if (result == MIDAIR_RESULT_OK) {
        result = midair_board_silence(board, mxGetData(*out), size, message, sizeof message);
    }
    midair_board_free(board);
    check(result);
}

static void close_scene(mxArray **out, Inputs in)
{
    midair_session **session = find(in[0]);
    (void)out;
    midair_session_free(*session);
    *session = NULL;
}

static void close_all(void)
{
    for (size_t k = 0; k < PLACES; k++) {
        midair_session_free(sessions[k]);
        sessions[k] = NULL;
    }
}

static const struct {
    const char *name;
    void (*run)(mxArray **out, Inputs in);
    int inputs;
} commands[] = {{"open", open_scene, 2}, {"close", close_scene, 1},   {"solve", solve, 4},   {"field", field, 3},
                {"judge", judge, 5},     {"sequence", sequence, 1}, {"encode", encode, 3}, {"silence", silence, 2}};

void mexFunction(int outputs, mxArray *out[], int inputs, const mxArray *in[])
{
    const mxArray *all[5] = {NULL}; /* inputs that the caller leaves out are NULL */
    char name[16] = "";
    size_t k = 0, count = sizeof commands / sizeof *commands;
    if (!mexIsLocked()) {
        mexLock(); /* `clear all` must not forget the table */
        mexAtExit(close_all);
    }
    if (inputs > 0 && mxIsChar(in[0])) {
        mxGetString(in[0], name, sizeof name);
    }
    for (; k < count && strcmp(name, commands[k].name) != 0; k++) {
    }
    if (k == count || inputs - 1 > commands[k].inputs || outputs > 1) {
        refuse("unknown", "midair_mex has no such call \"%s\" of %d inputs: see the help of midair.solve", name, inputs - 1);
    }
    memcpy(all, in + 1, (size_t)(inputs - 1) * sizeof *all);
    commands[k].run(out, all);
}
