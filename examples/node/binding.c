/* midair for Node: sessions, solves and frames by Node-API, which any Node from 16 on can load. */
#define NAPI_VERSION 8
#include <stdlib.h>

#include <midair.h>
#include <node_api.h>

static const napi_type_tag SESSION = {0x6d69646169720001, 0x73657373696f6e01};

typedef struct {
    midair_session *session;
    size_t transducers;
} held;

/* A buffer for what midair says; workers may call at the same time, so that each call has its own. */
typedef char line[1024];

/* Throws what midair refused; whether there was something. */
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

/* A text argument, cut where it is longer than any name. */
static int text(napi_env env, napi_value value, char *buffer, size_t size)
{
    return napi_get_value_string_utf8(env, value, buffer, size, NULL) == napi_ok;
}

/* The numbers of a typed array of one kind. */
static int numbers(napi_env env, napi_value value, napi_typedarray_type kind, void **data, size_t *length)
{
    napi_typedarray_type found;
    bool is = false;
    return napi_is_typedarray(env, value, &is) == napi_ok && is &&
           napi_get_typedarray_info(env, value, &found, length, data, NULL, NULL) == napi_ok && found == kind;
}

static held *session_of(napi_env env, napi_value value)
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
    midair_session_free(((held *)data)->session);
    free(data);
}

/* open(object, preset, method): gives an object a session; returns warnings. */
static napi_value open_session(napi_env env, napi_callback_info info)
{
    napi_value arguments[3];
    size_t count = 3;
    char preset[64], method[64];
    midair_array *array = NULL;
    held *own;
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

/* set(object, name, number or text): returns warnings. */
static napi_value set_option(napi_env env, napi_callback_info info)
{
    napi_value arguments[3];
    size_t count = 3;
    char name[64], word[64];
    double number;
    midair_result result;
    held *own;
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

/* solve(object, points, pressures or undefined): the drive as a Float32Array of re, im, and what is told of it. */
static napi_value solve(napi_env env, napi_callback_info info)
{
    static const char *const endings[] = {"done", "out_of_steps", "stopped"};
    napi_value arguments[3], answer, buffer, drive;
    size_t count = 3, coordinates, asked;
    void *points, *pressures = NULL, *data;
    napi_valuetype kind;
    midair_answer told;
    held *own;
    line message;
    napi_get_cb_info(env, info, &count, arguments, NULL, NULL);
    own = session_of(env, arguments[0]);
    if (own == NULL || !numbers(env, arguments[1], napi_float64_array, &points, &coordinates) || coordinates % 3 != 0) {
        return wrong(env, "give a session and points as a Float64Array of x, y, z");
    }
    napi_typeof(env, arguments[2], &kind);
    if (kind != napi_undefined && (!numbers(env, arguments[2], napi_float64_array, &pressures, &asked) ||
                                   asked != coordinates / 3)) {
        return wrong(env, "give pressures as a Float64Array of one for each point, or leave them out");
    }
    napi_create_arraybuffer(env, own->transducers * sizeof(midair_complex), &data, &buffer);
    if (refused(env, midair_session_solve(own->session, points, pressures, NULL, coordinates / 3, data, own->transducers,
                                          &told, message, sizeof message),
                message)) {
        return NULL;
    }
    napi_create_typedarray(env, napi_float32_array, 2 * own->transducers, buffer, 0, &drive);
    napi_create_object(env, &answer);
    napi_set_named_property(env, answer, "drive", drive);
    napi_set_named_property(env, answer, "status", string(env, endings[told.status]));
    napi_set_named_property(env, answer, "warning", string(env, message));
    set(env, answer, "scale", told.scale);
    set(env, answer, "accuracy", told.metrics.accuracy);
    set(env, answer, "uniformity", told.metrics.uniformity);
    set(env, answer, "level", told.metrics.level);
    return answer;
}

/* frame(board, drive): the bytes that make a board play a drive, a Float32Array of re, im. */
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
    } functions[] = {{"open", open_session}, {"set", set_option}, {"solve", solve}, {"frame", frame}};
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        napi_value function;
        napi_create_function(env, functions[i].name, NAPI_AUTO_LENGTH, functions[i].call, NULL, &function);
        napi_set_named_property(env, exports, functions[i].name, function);
    }
    return exports;
}
