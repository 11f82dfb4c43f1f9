/* midair for Node: sessions, solves and frames through Node-API, which Node 16 and newer can load. */
#define NAPI_VERSION 8
#include <stdlib.h>

#include <midair.h>
#include <node_api.h>

static const napi_type_tag SESSION = {0x6d69646169720001, 0x73657373696f6e01};

typedef struct {
    midair_session *session;
    size_t transducers;
} owned;

/* A buffer for a message of midair. Worker threads may call at the same time, so each call has its own. */
typedef char line[1024];

/* Throws an error if a call failed; returns whether it did. */
static int refused(napi_env env, midair_result result, const char *message)
{
    if (result != MIDAIR_RESULT_OK) {
        napi_throw_error(env, NULL, message);
    }
    return result != MIDAIR_RESULT_OK;
}

static napi_value wrong(napi_env env, const char *what)
{
    napi_throw_type_error(env, NULL, what);
    return NULL;
}

static napi_value string(napi_env env, const char *text)
{
    napi_value value;
    napi_create_string_utf8(env, text, NAPI_AUTO_LENGTH, &value);
    return value;
}

static void set(napi_env env, napi_value object, const char *name, double number)
{
    napi_value value;
    napi_create_double(env, number, &value);
    napi_set_named_property(env, object, name, value);
}

/* Reads a text argument, cut if it is longer than any name. */
static int text(napi_env env, napi_value value, char *buffer, size_t size)
{
    return napi_get_value_string_utf8(env, value, buffer, size, NULL) == napi_ok;
}

/* Finds the numbers of a typed array of one kind. */
static int numbers(napi_env env, napi_value value, napi_typedarray_type kind, void **data, size_t *length)
{
    napi_typedarray_type found;
    bool is = false;
    return napi_is_typedarray(env, value, &is) == napi_ok && is &&
           napi_get_typedarray_info(env, value, &found, length, data, NULL, NULL) == napi_ok && found == kind;
}

static owned *session_of(napi_env env, napi_value value)
{
    bool is = false;
    void *data = NULL;
    if (napi_check_object_type_tag(env, value, &SESSION, &is) != napi_ok || !is) {
        return NULL;
    }
    napi_unwrap(env, value, &data);
    return data;
}

static void let_go(napi_env env, void *data, void *hint)
{
    (void)env;
    (void)hint;
    midair_session_free(((owned *)data)->session);
    free(data);
}

/* open(object, preset, method): gives an object a session; returns warnings. */
static napi_value open_session(napi_env env, napi_callback_info info)
{
    napi_value arguments[3];
    size_t count = 3;
    char preset[64], method[64];
    midair_array *array = NULL;
    owned *own;
    line message;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    if (count < 3 || !text(env, arguments[1], preset, sizeof preset) || !text(env, arguments[2], method, sizeof method)) {
        return wrong(env, "give the names of a preset and a method");
    }
    if (refused(env, midair_array_preset(preset, 1, 1, &array, message, sizeof message), message)) {
        return NULL;
    }
    own = calloc(1, sizeof *own);
    if (own != NULL) {
        own->transducers = midair_array_count(array);
    }
    if (own == NULL || refused(env, midair_session_new(array, method, &own->session, message, sizeof message), message)) {
        midair_array_free(array);
        free(own);
        return NULL;
    }
    midair_array_free(array);
    if (napi_wrap(env, arguments[0], own, let_go, NULL, NULL) != napi_ok) {
        let_go(env, own, NULL);
        return wrong(env, "give an object without a session");
    }
    napi_type_tag_object(env, arguments[0], &SESSION);
    return string(env, message);
}

/* set(object, name, number or text): sets an option; returns warnings. */
static napi_value set_option(napi_env env, napi_callback_info info)
{
    napi_value arguments[3];
    size_t count = 3;
    char name[64], word[64];
    double number;
    midair_result result;
    owned *own;
    line message;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    own = session_of(env, arguments[0]);
    if (own == NULL || !text(env, arguments[1], name, sizeof name)) {
        return wrong(env, "give a session and the name of an option");
    }
    if (napi_get_value_double(env, arguments[2], &number) == napi_ok) {
        result = midair_session_set_number(own->session, name, number, message, sizeof message);
    } else if (text(env, arguments[2], word, sizeof word)) {
        result = midair_session_set_text(own->session, name, word, message, sizeof message);
    } else {
        return wrong(env, "give a number or a text for an option");
    }
    return refused(env, result, message) ? NULL : string(env, message);
}

/* Returns the answer of one problem as an object; its drive is a row of the buffer. */
static napi_value answer_of(napi_env env, napi_value buffer, size_t transducers, const midair_answer *found, size_t row)
{
    static const char *const endings[] = {"done", "out_of_steps", "stopped", "missed"};
    napi_value answer, drive;
    napi_create_typedarray(env, napi_float32_array, 2 * transducers, buffer, row * transducers * sizeof(midair_complex),
                           &drive);
    napi_create_object(env, &answer);
    napi_set_named_property(env, answer, "drive", drive);
    napi_set_named_property(env, answer, "status", string(env, endings[found[row].status]));
    set(env, answer, "scale", found[row].scale);
    set(env, answer, "accuracy", found[row].metrics.accuracy);
    set(env, answer, "uniformity", found[row].metrics.uniformity);
    set(env, answer, "level", found[row].metrics.level);
    return answer;
}

/* Returns the answers of several problems as an array, which also has their warnings. */
static napi_value answers_of(napi_env env, napi_value buffer, size_t transducers, const midair_answer *found,
                             size_t count, const char *message)
{
    napi_value answers;
    napi_create_array_with_length(env, count, &answers);
    for (size_t row = 0; row < count; row++) {
        napi_set_element(env, answers, (uint32_t)row, answer_of(env, buffer, transducers, found, row));
    }
    napi_set_named_property(env, answers, "warning", string(env, message));
    return answers;
}

/* Finds the pressures of some points, which may be undefined; returns 0 if their number is wrong. */
static int pressures_of(napi_env env, napi_value value, size_t points, void **pressures)
{
    napi_valuetype kind;
    size_t given;
    *pressures = NULL;
    return napi_typeof(env, value, &kind) == napi_ok &&
           (kind == napi_undefined ||
            (numbers(env, value, napi_float64_array, pressures, &given) && given == points));
}

/* Returns a whole number; 0 for any other value. */
static size_t whole(napi_env env, napi_value value)
{
    double number = 0;
    napi_get_value_double(env, value, &number);
    return number >= 1 && number < 4294967296.0 ? (size_t)number : 0;
}

/* solveBatch(object, points, points per problem, pressures or undefined, threads): returns an array of answers as
   solve gives. */
static napi_value solve_batch(napi_env env, napi_callback_info info)
{
    napi_value arguments[5], buffer, answers = NULL;
    size_t count = 5, coordinates, each, problems;
    void *points, *pressures, *data;
    midair_answer *found;
    owned *own;
    line message;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    own = session_of(env, arguments[0]);
    each = whole(env, arguments[2]);
    if (own == NULL || !numbers(env, arguments[1], napi_float64_array, &points, &coordinates) || each == 0 ||
        coordinates % (3 * each) != 0) {
        return wrong(env, "give a session and problems of as many points x, y, z each");
    }
    if (!pressures_of(env, arguments[3], coordinates / 3, &pressures)) {
        return wrong(env, "give pressures as a Float64Array of one for each point, or leave them out");
    }
    problems = coordinates / 3 / each;
    found = calloc(problems + 1, sizeof *found);
    napi_create_arraybuffer(env, problems * own->transducers * sizeof(midair_complex), &data, &buffer);
    if (found != NULL &&
        !refused(env, midair_session_solve_batch(own->session, points, pressures, NULL, problems, each,
                                                 whole(env, arguments[4]), data, own->transducers, found, message,
                                                 sizeof message),
                 message)) {
        answers = answers_of(env, buffer, own->transducers, found, problems, message);
    }
    free(found);
    return answers;
}

/* Returns the text of a list's element, which the caller must free; NULL if it is not a text. */
static char *element(napi_env env, napi_value list, size_t index)
{
    napi_value value;
    size_t length;
    char *found;
    if (napi_get_element(env, list, (uint32_t)index, &value) != napi_ok ||
        napi_get_value_string_utf8(env, value, NULL, 0, &length) != napi_ok || (found = malloc(length + 1)) == NULL) {
        return NULL;
    }
    napi_get_value_string_utf8(env, value, found, length + 1, NULL);
    return found;
}

/* solveScenes(texts, transducers, folder or undefined, threads): returns an array of answers as solve gives. */
static napi_value solve_scenes(napi_env env, napi_callback_info info)
{
    napi_value arguments[4], buffer, answers = NULL;
    size_t count = 4, transducers, known;
    uint32_t scenes = 0;
    char folder[4096], **texts;
    void *data;
    midair_answer *found;
    line message;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    transducers = whole(env, arguments[1]);
    if (napi_get_array_length(env, arguments[0], &scenes) != napi_ok || transducers == 0) {
        return wrong(env, "give an array of scenes and the number of transducers of a row");
    }
    texts = calloc(scenes + 1, sizeof *texts);
    found = calloc(scenes + 1, sizeof *found);
    for (known = 0; texts != NULL && known < scenes; known++) {
        if ((texts[known] = element(env, arguments[0], known)) == NULL) {
            break;
        }
    }
    napi_create_arraybuffer(env, scenes * transducers * sizeof(midair_complex), &data, &buffer);
    if (known < scenes || texts == NULL || found == NULL) {
        wrong(env, "give the text of each scene");
    } else if (!refused(env, midair_solve_scenes((const char *const *)texts,
                                                 text(env, arguments[2], folder, sizeof folder) ? folder : NULL, scenes,
                                                 whole(env, arguments[3]), data, transducers, found, message,
                                                 sizeof message),
                        message)) {
        answers = answers_of(env, buffer, transducers, found, scenes, message);
    }
    for (size_t k = 0; texts != NULL && k < known; k++) {
        free(texts[k]);
    }
    free(texts);
    free(found);
    return answers;
}

/* solve(object, points, pressures or undefined): returns an answer whose drive is a Float32Array of re, im. */
static napi_value solve(napi_env env, napi_callback_info info)
{
    napi_value arguments[3], answer, buffer;
    size_t count = 3, coordinates;
    void *points, *pressures, *data;
    midair_answer found;
    owned *own;
    line message;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    own = session_of(env, arguments[0]);
    if (own == NULL || !numbers(env, arguments[1], napi_float64_array, &points, &coordinates) || coordinates % 3 != 0) {
        return wrong(env, "give a session and points as a Float64Array of x, y, z");
    }
    if (!pressures_of(env, arguments[2], coordinates / 3, &pressures)) {
        return wrong(env, "give pressures as a Float64Array of one for each point, or leave them out");
    }
    napi_create_arraybuffer(env, own->transducers * sizeof(midair_complex), &data, &buffer);
    if (refused(env, midair_session_solve(own->session, points, pressures, NULL, coordinates / 3, data, own->transducers,
                                          &found, message, sizeof message),
                message)) {
        return NULL;
    }
    answer = answer_of(env, buffer, own->transducers, &found, 0);
    napi_set_named_property(env, answer, "warning", string(env, message));
    return answer;
}

/* frame(board, drive): returns the bytes that make a board play a drive, a Float32Array of re, im. */
static napi_value frame(napi_env env, napi_callback_info info)
{
    napi_value arguments[2], buffer, bytes;
    size_t count = 2, length, size;
    void *drive, *data;
    char name[64];
    midair_board *board = NULL;
    line message;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    if (!text(env, arguments[0], name, sizeof name) ||
        !numbers(env, arguments[1], napi_float32_array, &drive, &length) || length % 2 != 0) {
        return wrong(env, "give the name of a board and a drive as a Float32Array of re, im");
    }
    if (refused(env, midair_board_new(name, length / 2, &board, message, sizeof message), message)) {
        return NULL;
    }
    size = midair_board_frame_size(board);
    napi_create_arraybuffer(env, size, &data, &buffer);
    napi_create_typedarray(env, napi_uint8_array, size, buffer, 0, &bytes);
    if (refused(env, midair_board_encode(board, drive, length / 2, data, size, message, sizeof message), message)) {
        bytes = NULL;
    }
    midair_board_free(board);
    return bytes;
}

NAPI_MODULE_INIT()
{
    static const struct {
        const char *name;
        napi_callback call;
    } functions[] = {{"open", open_session}, {"set", set_option}, {"solve", solve}, {"solveBatch", solve_batch},
                     {"solveScenes", solve_scenes}, {"frame", frame}};
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        napi_value function;
        napi_create_function(env, functions[i].name, NAPI_AUTO_LENGTH, functions[i].call, NULL, &function);
        napi_set_named_property(env, exports, functions[i].name, function);
    }
    return exports;
}
